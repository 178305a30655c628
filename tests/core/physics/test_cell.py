"""The motion through a cell: time and force by hand, derivatives against differences, and the force's inverse."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from railjoule.core.physics.cell import (
    Cell,
    duration,
    force_slopes,
    mean_speed,
    mean_speed_curvature,
    mean_speed_slope,
    needed_force,
    reached_speed2,
)
from railjoule.core.physics.course_data import part_of_cell

cells = st.builds(
    Cell,
    st.floats(1, 100),
    st.floats(100, 1e4),
    st.floats(-2e4, 2e4),
    st.floats(0, 500),
    st.floats(0, 50),
    st.just(1.0),
)
squares = st.floats(1.0, 900.0)


def force_between(cell, start_speed2, end_speed2):
    v = mean_speed(math.sqrt(start_speed2), math.sqrt(end_speed2))
    return needed_force(cell, start_speed2, end_speed2, v)


def by_differences(function, at, step):
    return (function(at + step) - function(at - step)) / (2 * step)


def test_a_cell_by_hand():
    """From 10 to 14 m/s over 60 m in 5 s; 50 t: 50e3 * 96 / 120 = 40 kN, and 1000 + 20 * 12 + 3 * 148 N resist."""
    cell = Cell(60.0, 0.5 * 50e3 / 60, 1000.0, 20.0, 3.0, 1.0)
    assert mean_speed(10.0, 14.0) == 12
    assert duration(60.0, 12.0) == 5
    assert force_between(cell, 100.0, 196.0) == pytest.approx(40e3 + 1684)


def test_the_time_is_that_of_an_even_acceleration():
    """1.2 m/s2 from 3 m/s: 15 m/s after 10 s and 90 m."""
    assert duration(90.0, mean_speed(3.0, 15.0)) == pytest.approx(10.0)


@given(squares, squares)
def test_derivatives_of_the_mean_speed(w0, w1):
    def v(w):
        return mean_speed(math.sqrt(w), math.sqrt(w1))

    step = 1e-4 * w0
    slope = mean_speed_slope(math.sqrt(w0))
    assert slope == pytest.approx(by_differences(v, w0, step), rel=1e-6)
    curvature = by_differences(lambda w: mean_speed_slope(math.sqrt(w)), w0, step)
    assert mean_speed_curvature(slope, w0) == pytest.approx(curvature, rel=1e-6)


@given(cells, squares, squares)
def test_derivatives_of_the_force(cell, w0, w1):
    slopes = force_slopes(cell, mean_speed_slope(math.sqrt(w0)), mean_speed_slope(math.sqrt(w1)))
    scale = cell.inertia + cell.linear + cell.quadratic
    start = by_differences(lambda w: force_between(cell, w, w1), w0, 1e-3 * w0)
    end = by_differences(lambda w: force_between(cell, w0, w), w1, 1e-3 * w1)
    assert slopes == pytest.approx((start, end), abs=1e-6 * scale)


@given(cells, squares, squares)
def test_a_force_leads_where_it_is_needed_for(cell, w0, w1):
    v = mean_speed(math.sqrt(w0), math.sqrt(w1))
    assert reached_speed2(cell, w0, v, needed_force(cell, w0, w1, v)) == pytest.approx(w1, rel=1e-9)


@given(cells, squares, squares, st.floats(0.1, 0.9))
def test_the_parts_of_a_cell_need_the_force_of_the_whole_but_for_resistance(cell, w0, w1, share):
    """Without resistance that varies with speed, a constant force does both parts."""
    plain = cell._replace(linear=0.0, quadratic=0.0)
    middle = w0 + share * (w1 - w0)
    first = part_of_cell(plain, share * plain.length_m)
    second = part_of_cell(plain, (1 - share) * plain.length_m)
    whole = force_between(plain, w0, w1)
    tolerance = 1e-9 * (abs(whole) + plain.inertia * (w0 + w1))
    assert force_between(first, w0, middle) == pytest.approx(whole, abs=tolerance)
    assert force_between(second, middle, w1) == pytest.approx(whole, abs=tolerance)


def test_arrays_of_cells():
    cells_of_two = Cell(
        np.array([10.0, 20.0]), np.array([5e3, 2.5e3]), np.array([1e3, -1e3]), 20.0, np.array([3.0, 4.0]), 1.0
    )
    w0, w1 = np.array([100.0, 144.0]), np.array([144.0, 121.0])
    force = needed_force(cells_of_two, w0, w1, mean_speed(np.sqrt(w0), np.sqrt(w1)))
    for i in range(2):
        cell = Cell(10.0 * (i + 1), 5e3 / (i + 1), 1e3 * (-1) ** i, 20.0, 3.0 + i, 1.0)
        assert force[i] == force_between(cell, w0[i], w1[i])
