import math

import numpy as np
import pytest
from builders import HILLS, plain_scenario
from hypothesis import given
from hypothesis import strategies as st

from railjoule.core.dynamic_programming.backward import (
    cost_between,
    least_speeds,
    place_in_row,
    speed_grid,
    sweep_back,
    tabulate_steps,
)
from railjoule.core.strategies import prepare_task


@given(st.floats(0.01, 20), st.floats(0.1, 20), st.integers(2, 40), st.floats(0, 1))
def test_a_speed_lies_where_its_row_says(low, width, points, share):
    row = np.linspace(low, low + width, points) ** 2
    speed2 = row[0] + share * (row[-1] - row[0])
    lower, between = place_in_row(row, speed2)
    assert row[lower] + between * (row[lower + 1] - row[lower]) == pytest.approx(speed2, rel=1e-9)


def test_a_speed_beyond_its_row_has_no_place():
    row = np.array([4.0, 9.0, 16.0])
    assert place_in_row(row, 3.9)[0] == place_in_row(row, 16.1)[0] == -1


def test_nothing_lies_between_what_can_and_what_cannot_be_reached():
    row = np.array([math.inf, 2.0, 4.0])
    assert cost_between(row, 0, 0.5) == math.inf
    assert cost_between(row, 0, 1.0) == 2.0
    assert cost_between(row, 1, 0.25) == 2.5


def test_the_cost_to_go_falls_with_speed_where_time_is_all_that_counts():
    """At a price of time beyond all energy, being faster anywhere can only help, until the stop is near."""
    task = prepare_task(plain_scenario({"line.sections": HILLS}))
    data, greatest = task.course.data, np.sqrt(task.greatest_speed2)
    least = least_speeds(data, task.greatest_speed2)
    grid = speed_grid(task.greatest_speed2, least, data.fixed_speed2, 0.5 * greatest, float(greatest.max()), 16)
    price = 1e9
    cost, best, time_s = sweep_back(tabulate_steps(data, grid), grid, price)
    finite = np.isfinite(cost[1:-1]).all(axis=1)
    assert finite.mean() > 0.5
    assert np.all(np.diff(cost[1:-1][finite], axis=1) <= 1e-6 * cost[1:-1][finite][:, :1])
    assert cost[0, 0] / price == pytest.approx(task.shortest_time_s, rel=1e-3)
    assert time_s[0, 0] == pytest.approx(cost[0, 0] / price, rel=1e-3)
    assert np.all(best[np.isfinite(cost[:-1])] >= 0)
