"""Runs with one effort in each cell: what they reach, and that no limit is passed where phases meet within a cell."""

import numpy as np
import pytest
from builders import HILLS, plain_scenario
from hypothesis import given
from hypothesis import strategies as st

from railjoule.core import check_run
from railjoule.core.limit_search.problem import limit_problem
from railjoule.core.limit_search.whole_cells import followed, nearest_speed2, trip_over_cells
from railjoule.core.physics.course_data import cell_of, train_of
from railjoule.core.simulate.regulator import drive_under_limits
from railjoule.core.task import prepare_task

TASK = prepare_task(plain_scenario())
WEAK_BRAKES = plain_scenario(
    {
        "line.sections": HILLS,
        "vehicle.length_m": 80.0,
        "vehicle.car_count": 4,
        "vehicle.braking": {"max_effort_kn": 30.0, "max_power_kw": 300.0, "friction_effort_kn": 5.0},
        "vehicle.traction.max_acceleration_ms2": 0.6,
        "vehicle.braking.max_deceleration_ms2": 0.5,
        "search.boundaries_m": [900.0],
    }
)
"""Brakes, not the deceleration that the regulator asks for, decide; gradients change all along the train."""


def one_cell():
    data = TASK.course.data
    return cell_of(data, 50), train_of(data), data.traction, data.braking


def test_where_full_effort_slows_down_more_than_is_allowed_there_is_no_speed_to_reach():
    cell, train, traction, braking = one_cell()
    gentle, steep = train._replace(max_deceleration_ms2=0.5), cell._replace(constant_n=cell.constant_n + 200e3)
    # full effort of 100 kN against 200 kN more leaves -100 kN for 110 t, 0.9 m/s2
    assert nearest_speed2(steep, gentle, traction, braking, 400.0, 390.0) == np.inf
    assert 0.0 < nearest_speed2(steep, train, traction, braking, 400.0, 390.0) < 400.0


def test_what_is_wanted_within_reach_is_reached():
    assert nearest_speed2(*one_cell(), 100.0, 101.0) == 101.0


@pytest.mark.parametrize(("wanted2", "effort_n"), [(400.0, 100e3), (0.0, -80e3)])
def test_beyond_reach_the_nearest_is_taken(wanted2, effort_n):
    """100 kN and 1000 kW to drive with, 80 kN to brake with, 110 t; v^2 changes by 2 F h / m."""
    cell, *_ = one_cell()
    mean2 = 0.5 * (100.0 + (reached2 := nearest_speed2(*one_cell(), 100.0, wanted2)))
    effort = min(effort_n, 1e6 / (0.5 * (10 + np.sqrt(reached2))))
    resistance = cell.constant_n + cell.quadratic * mean2
    assert reached2 == pytest.approx(100 + 2 * (effort - resistance) * 10 / 110e3, rel=1e-9)


@pytest.mark.parametrize("regulator", ["brake", "coast"])
@given(pair=st.tuples(st.floats(20, 90), st.floats(20, 90)))
def test_every_rule_is_kept_where_phases_meet(regulator, pair):
    run = drive_under_limits(WEAK_BRAKES, pair, regulator)
    broken = [(check.name, check.largest) for check in check_run(run.scenario, run).checks if not check.ok]
    assert not broken
    assert run.position_m[-1] == WEAK_BRAKES.line.length_m


@pytest.mark.parametrize("border", [1000.0000001, 1000.0004, 999.9995])
def test_borders_beside_a_node_are_merged_with_it(border):
    """The mesh has a node at 1000 m: cells of less than a millimetre would hold rounding."""
    run = drive_under_limits(plain_scenario({"search.boundaries_m": [border]}), [60, 40], "coast")
    assert np.diff(run.nodes_m).min() > 1e-3
    there = drive_under_limits(plain_scenario({"search.boundaries_m": [1000.0]}), [60, 40], "coast")
    assert run.energy_kwh == pytest.approx(there.energy_kwh, rel=1e-5)


def test_a_train_too_fast_to_brake_fails_where_it_passes_the_limit():
    """From 20 m/s a stop at 0.5 m/s2 takes 400 m; the line has 300."""
    scenario = plain_scenario({"line.sections": [{"length_m": 300.0}], "vehicle.braking.max_deceleration_ms2": 0.5})
    course = prepare_task(scenario).course
    data = course.data._replace(
        fixed_speed2=np.where(np.arange(course.cell_count + 1) == 0, 400.0, course.data.fixed_speed2)
    )
    problem = limit_problem(course, 0.8, False, 1.0, 30.0, 100.0)
    position, speed2 = np.empty((2, course.cell_count + 1))
    nodes, seconds, _ = trip_over_cells(data, problem.regulation, np.empty(0), np.array([25.0]), position, speed2)
    assert seconds == np.inf
    assert position[nodes - 1] == 300
    assert speed2[nodes - 1] == pytest.approx(400 - 2 * 0.5 * 300)


def test_following_takes_no_more_than_there_is():
    wanted = np.full(TASK.course.cell_count + 1, 225.0)
    wanted[[0, -1]] = 0.0
    driven = followed(TASK.course.data, wanted, np.zeros(TASK.course.cell_count, dtype=np.bool_))
    force = TASK.course.net_force_n(np.maximum(driven, 0.0))
    # from rest to 15 m/s takes 110 m, to rest 150 m
    assert force.max() == pytest.approx(100e3)
    assert force.min() == pytest.approx(-80e3)
    assert driven[-1] > 0, "nobody brakes from 15 m/s within a cell"


def test_following_a_coasting_train_takes_no_effort():
    wanted = np.full(TASK.course.cell_count + 1, 225.0)
    driven = followed(TASK.course.data, wanted, np.ones(TASK.course.cell_count, dtype=np.bool_))
    assert np.abs(TASK.course.net_force_n(driven)[:-1]).max() < 1e-3
