"""The draws as columns, and the rows within brushes."""

import json
from dataclasses import replace

import numpy as np
import pytest
from builders import plain_scenario
from hypothesis import given
from hypothesis import strategies as st

from railjoule.core.studies.montecarlo import monte_carlo
from railjoule.core.studies.table import StudyTable
from railjoule.dashboard.pages.what_if.explorer import (
    COLUMNS,
    HINT,
    brush_words,
    common,
    held_rows,
    parse_brushes,
    varied,
)

RUNS = 120


@pytest.fixture(scope="module")
def table() -> StudyTable:
    return monte_carlo(plain_scenario().replace(**{"montecarlo.runs": RUNS, "montecarlo.seed": 1}))


def test_columns_are_quantities_in_which_the_runs_differ(table: StudyTable) -> None:
    columns = varied(table)
    assert columns.keys() >= {"load", "error", "resistance", "energy", "extra"}
    np.testing.assert_allclose(columns["energy"], table.energy_kwh)
    np.testing.assert_allclose(columns["load"], 100 * table["load_factor"])
    # nobody departs late here: such a column has nothing to explore
    assert "departure" not in columns


def test_runs_that_came_to_a_stand_are_left_out_and_counted(table: StudyTable) -> None:
    energies = table["energy_kwh"].copy()
    energies[:3] = np.nan
    stuck = replace(table, columns={**table.columns, "energy_kwh": energies})
    columns = varied(stuck)
    assert len(columns["load"]) == RUNS - 3
    assert "In 3 more the train comes to a stand." in brush_words(stuck, columns, {})[0]


def test_the_words_of_a_brush_count_its_runs_and_give_their_medians(table: StudyTable) -> None:
    columns = varied(table)
    held = (columns["load"] >= 40) & (columns["load"] < 60)
    assert np.array_equal(held_rows(columns, {"load": (40.0, 60.0)}), held)
    counted, medians = brush_words(table, columns, {"load": (40.0, 60.0)})
    assert counted.startswith(f"{held.sum()} of {RUNS} draws (")
    assert "load 40 to 60 %" in counted
    middle = COLUMNS["extra"].with_unit(100 * float(np.median(table.over_replanned[held])))
    assert f"extra energy {middle} (all: " in medians
    assert brush_words(table, columns, {})[0].endswith(HINT)


@pytest.mark.parametrize("bounds", [{"load": (1e6, 2e6)}, {"load": (60.0, 40.0)}])
def test_a_brush_may_hold_nothing(table: StudyTable, bounds: dict[str, tuple[float, float]]) -> None:
    (counted,) = brush_words(table, varied(table), bounds)
    assert counted.startswith(f"0 of {RUNS} draws (0.00 %): load ")


def test_only_what_lies_within_all_brushes_counts() -> None:
    brushes = {"draws": {"load": (0.0, 50.0), "extra": (1.0, 2.0)}, "draws_load": {"load": (20.0, 80.0)}}
    assert common(brushes) == {"load": (20.0, 50.0), "extra": (1.0, 2.0)}


SPANS = st.one_of(st.none(), st.integers(), st.floats(), st.text(max_size=3), st.lists(st.floats(), max_size=3))


@given(st.dictionaries(st.text(max_size=3), st.dictionaries(st.sampled_from([*COLUMNS, "other"]), SPANS, max_size=3)))
def test_what_a_browser_sends_is_finite_spans_of_columns_or_nothing(sent: object) -> None:
    for brush in parse_brushes(json.dumps(sent)).values():
        assert brush
        for name, (low, high) in brush.items():
            assert name in COLUMNS
            assert np.isfinite([low, high]).all()
            assert low <= high


@pytest.mark.parametrize("text", ["", "[", "[]", "1", '{"draws": 1}', "[" * 100_000])
def test_what_is_no_brush_is_none(text: str) -> None:
    assert parse_brushes(text) == {}
