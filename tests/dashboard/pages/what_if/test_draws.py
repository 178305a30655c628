"""The draws as a table of runs."""

from dataclasses import replace

import numpy as np
import pytest
from builders import plain_scenario

from railjoule.core.studies.montecarlo import monte_carlo
from railjoule.core.studies.table import StudyTable
from railjoule.dashboard.pages.what_if.chance_charts import INPUTS, draws_table

RUNS = 120


@pytest.fixture(scope="module")
def table() -> StudyTable:
    return monte_carlo(plain_scenario().replace(**{"montecarlo.runs": RUNS, "montecarlo.seed": 1}))


def test_columns_are_quantities_in_which_the_runs_differ(table: StudyTable) -> None:
    found = draws_table(table)
    assert found.columns.keys() >= {"load", "error", "resistance", "energy", "over_replanned"}
    assert found.inputs == tuple(name for name in found.columns if name in INPUTS)
    np.testing.assert_allclose(found.values["energy"], table.energy_kwh)
    np.testing.assert_allclose(found.values["load"], 100 * table["load_factor"])
    assert found.columns["load"].range == (100 * table["load_factor"].min(), 100 * table["load_factor"].max())
    assert (found.done, found.title) == (RUNS, f"{RUNS} random draws of What if")
    # nobody departs late here: such a column has nothing to explore
    assert "departure" not in found.columns


def test_runs_that_came_to_a_stand_are_left_out_and_counted(table: StudyTable) -> None:
    energies = table["energy_kwh"].copy()
    energies[:3] = np.nan
    found = draws_table(replace(table, columns={**table.columns, "energy_kwh": energies}))
    assert found.rows.tolist() == list(range(3, RUNS))
    assert len(found.values["load"]) == RUNS - 3
    assert found.done == RUNS


def test_draws_that_do_not_differ_are_no_table(table: StudyTable) -> None:
    same = {name: np.full(RUNS, values[0]) for name, values in table.columns.items() if np.shape(values) == (RUNS,)}
    assert draws_table(replace(table, columns={**table.columns, **same})) is None
