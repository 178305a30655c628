"""The draws as a dataset, their figures, and what a brush over them holds."""

import json
from dataclasses import replace

import numpy as np
import pytest
from builders import plain_scenario
from hypothesis import given
from hypothesis import strategies as st

from railjoule.core.studies.montecarlo import monte_carlo
from railjoule.core.studies.table import StudyTable
from railjoule.dashboard.look.tokens import THEMES
from railjoule.dashboard.pages.what_if.draw_columns import COLUMNS, Request, brushes_of, common, varied
from railjoule.dashboard.pages.what_if.draws import BINS, HINT, brush_words, dataset, draw

RUNS = 120


@pytest.fixture(scope="module")
def table() -> StudyTable:
    return monte_carlo(plain_scenario().replace(**{"montecarlo.runs": RUNS, "montecarlo.seed": 1}))


def test_what_was_drawn_are_keys_and_what_came_out_values(table: StudyTable) -> None:
    rows = dataset(table)
    drawn = {"load", "error", "resistance", "voltage", "speed", "d1", "d2", "d3"}
    assert {str(key.name) for key in rows.kdims} <= drawn
    assert {str(value.name) for value in rows.vdims} >= {"energy", "extra"}
    np.testing.assert_allclose(rows.dimension_values("energy"), table.energy_kwh)
    np.testing.assert_allclose(rows.dimension_values("load"), 100 * table["load_factor"])
    # nobody departs late here: such a column has nothing to explore
    assert "departure" not in varied(table)


def test_runs_that_came_to_a_stand_are_left_out_and_told(table: StudyTable) -> None:
    energies = table["energy_kwh"].copy()
    energies[:3] = np.nan
    stuck = replace(table, columns={**table.columns, "energy_kwh": energies})
    rows = dataset(stuck)
    assert len(rows) == RUNS - 3
    assert "In 3 more the train comes to a stand." in brush_words(stuck, rows, {})[0]


@pytest.mark.parametrize("dark", [False, True])
def test_points_and_a_histogram_of_each_other_column(table: StudyTable, dark: bool) -> None:
    figures = draw(Request(table, "load", "extra", dark)).figures
    assert figures.keys() == {"draws", *(f"draws_{name}" for name in varied(table).keys() - {"load", "extra"})}
    tokens = THEMES["dark" if dark else "light"]
    for one in figures.values():
        every, brushed = one.figure.renderers
        assert (every.glyph.fill_color, brushed.glyph.fill_color) == (tokens["line2"], tokens["driven"])
        assert one.figure.xaxis[0].major_label_text_color == tokens["ink3"]
        assert one.brushed is brushed.data_source
    points = figures["draws"]
    assert (points.figure.xaxis[0].axis_label, points.figure.yaxis[0].axis_label) == ("Load, %", "Extra energy, %")
    assert points.columns == ("load", "extra")
    counts = np.array(figures["draws_energy"].brushed.data["top"])
    # of the values this part is drawn: all but 0.3 % at both ends
    assert len(counts) == BINS
    assert RUNS - 2 <= counts.sum() <= RUNS


def test_a_brush_tells_how_many_and_what_became_of_them(table: StudyTable) -> None:
    rows = dataset(table)
    loads = 100 * table["load_factor"]
    held = (loads >= 40) & (loads < 60)
    counted, medians = brush_words(table, rows, {"load": (40.0, 60.0)})
    assert counted.startswith(f"{held.sum()} of {RUNS} draws (")
    assert "load 40 to 60 %" in counted
    middle = COLUMNS["extra"].told(100 * float(np.median(table.over_replanned[held])))
    assert f"extra energy {middle} (all: " in medians
    assert brush_words(table, rows, {})[0].endswith(HINT)


@pytest.mark.parametrize("bounds", [{"load": (1e6, 2e6)}, {"load": (60.0, 40.0)}])
def test_a_brush_may_hold_nothing(table: StudyTable, bounds: dict[str, tuple[float, float]]) -> None:
    (counted,) = brush_words(table, dataset(table), bounds)
    assert counted.startswith(f"0 of {RUNS} draws (0.00 %): load ")


def test_only_what_lies_within_all_brushes_counts() -> None:
    brushes = {"draws": {"load": (0.0, 50.0), "extra": (1.0, 2.0)}, "draws_load": {"load": (20.0, 80.0)}}
    assert common(brushes) == {"load": (20.0, 50.0), "extra": (1.0, 2.0)}


SPANS = st.one_of(st.none(), st.integers(), st.floats(), st.text(max_size=3), st.lists(st.floats(), max_size=3))


@given(st.dictionaries(st.text(max_size=3), st.dictionaries(st.sampled_from([*COLUMNS, "other"]), SPANS, max_size=3)))
def test_what_a_browser_tells_is_finite_spans_of_columns_or_nothing(told: object) -> None:
    for brush in brushes_of(json.dumps(told)).values():
        assert brush
        for name, (low, high) in brush.items():
            assert name in COLUMNS
            assert np.isfinite([low, high]).all()
            assert low <= high


@pytest.mark.parametrize("text", ["", "[", "[]", "1", '{"draws": 1}', "[" * 100_000])
def test_what_is_no_brush_is_none(text: str) -> None:
    assert brushes_of(text) == {}
