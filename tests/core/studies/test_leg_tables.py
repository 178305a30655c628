"""Tables of legs: the whole line's numbers again, and prices that are slopes."""

from itertools import accumulate

import numpy as np
import pytest

from railjoule.core import ScenarioError, load_scenario
from railjoule.core.studies.leg_tables import leg_tables
from railjoule.core.studies.whole_line import shared_line
from railjoule.core.task import Task, prepare_task


@pytest.fixture(scope="module")
def task() -> Task:
    """A metro with ten stations."""
    return prepare_task(load_scenario("metro-10-stations"))


def test_a_table_has_what_the_whole_line_has_for_the_same_times(task: Task) -> None:
    equal = shared_line(task, "equal")
    supplement = equal.legs[0].supplement_s
    tables = leg_tables(task, [supplement])
    assert len(tables) == len(equal.legs) == 9
    for table, leg in zip(tables, equal.legs, strict=True):
        assert table.shortest_time_s == pytest.approx(leg.shortest_time_s, rel=1e-12)
        assert table.energy_j[0] == pytest.approx(leg.energy_j, rel=1e-6)
        assert table.price_of_time_w[0] == pytest.approx(leg.price_of_time_w, rel=1e-4)


def test_prices_are_the_slopes_of_the_energy(task: Task) -> None:
    table = leg_tables(task, np.arange(10.0, 41.0))[0]
    # over ten seconds, as the price has steps of a per cent from cell to cell of the mesh
    fallen = table.energy_j[0:-10] - table.energy_j[10:]
    sums = np.array(list(accumulate(0.5 * (table.price_of_time_w[:-1] + table.price_of_time_w[1:]))))
    between = sums[9:] - np.append(0.0, sums[:-10])
    np.testing.assert_allclose(between, fallen, rtol=0.01)
    assert np.all(np.diff(table.energy_j) < 0)


@pytest.mark.parametrize("wrong", [0.0, -1.0, np.nan])
def test_a_leg_needs_more_than_its_shortest_time(task: Task, wrong: float) -> None:
    with pytest.raises(ScenarioError, match="above 0 s"):
        leg_tables(task, [5.0, wrong])
