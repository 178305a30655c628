"""Runs that follow one of two runs and go on with the other."""

import numpy as np
import pytest
from every_drive import train

from railjoule.core.dynamic_programming.hybrids import both_hybrids, hybrids
from railjoule.core.motion import running_time
from railjoule.core.strategies import prepare_task


@pytest.fixture(scope="module")
def task():
    return prepare_task(train("loss polynomial", 15.0, **{"timetable.travel_time_s": 100.0}))


def test_a_hybrid_changes_over_where_both_cross_nearest_to_the_timetable(task):
    """By hand: over cells of 10 m at 5 or 10 m/s, each cell takes 2 or 1 s."""
    data = task.course.data._replace(cell_length_m=np.full(8, 10.0))
    slow, fast = np.full(9, 25.0), np.full(9, 100.0)
    # they cross at both ends and in the middle, where the speeds are the same
    for run in (slow, fast):
        run[[0, 4, 8]] = 49.0
    (both,) = hybrids(data, slow, fast, running_time(data.cell_length_m, np.concatenate([slow[:4], fast[4:]])))
    assert both.tolist() == [49.0, 25.0, 25.0, 25.0, 49.0, 100.0, 100.0, 100.0, 49.0]


def test_runs_that_are_the_same_have_no_hybrid(task):
    assert hybrids(task.course.data, task.greatest_speed2, task.greatest_speed2, 100.0) == []


def test_both_orders_have_a_hybrid(task):
    """As above: the slow one first, then the fast one, and the other way round."""
    data = task.course.data._replace(cell_length_m=np.full(8, 10.0))
    slow, fast = np.full(9, 25.0), np.full(9, 100.0)
    slow[[0, 4, 8]] = fast[[0, 4, 8]] = 49.0
    found = both_hybrids(data, slow, fast, 12.0)
    assert [run[2] for run in found] == [25.0, 100.0]
    assert [run[6] for run in found] == [100.0, 25.0]
