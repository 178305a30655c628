"""The motion through a cell: time and force by hand, derivatives against differences, and the force's inverse."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from railjoule.core.physics.cell import (
    Cell,
    duration,
    mean_speed,
    needed_force,
    reached_speed2,
)
from railjoule.core.physics.mesh_data import part_of_cell

NUMBERS = st.floats(0, 2e4), st.floats(0.5, 30)
cells = st.builds(
    Cell,
    st.floats(1, 100),
    st.floats(100, 1e4),
    st.floats(-2e4, 2e4),
    st.floats(0, 500),
    st.floats(0, 50),
    st.just(1.0),
    st.just(0.0),
    st.just(1.0),
)
starting = st.builds(lambda cell, force, ends: cell._replace(starting_n=force, starting_ends_ms=ends), cells, *NUMBERS)
squares = st.floats(1.0, 900.0)


def force_between(cell, start_speed2, end_speed2):
    v = mean_speed(math.sqrt(start_speed2), math.sqrt(end_speed2))
    return needed_force(cell, start_speed2, end_speed2, v)


def test_a_cell_by_hand():
    """From 10 to 14 m/s over 60 m in 5 s; 50 t: 50e3 * 96 / 120 = 40 kN, and 1000 + 20 * 12 + 3 * 148 N resist."""
    cell = Cell(60.0, 0.5 * 50e3 / 60, 1000.0, 20.0, 3.0, 1.0)
    assert mean_speed(10.0, 14.0) == 12
    assert duration(60.0, 12.0) == 5
    assert force_between(cell, 100.0, 196.0) == pytest.approx(40e3 + 1684)


@given(cells | starting, squares, squares)
def test_a_force_leads_where_it_is_needed_for(cell, w0, w1):
    v = mean_speed(math.sqrt(w0), math.sqrt(w1))
    assert reached_speed2(cell, w0, w1, v, needed_force(cell, w0, w1, v)) == pytest.approx(w1, rel=1e-9)


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
