"""What an optimum says on driving, braking and coasting, and the decisions made from it."""

import numpy as np
import pytest
from every_drive import train

from railjoule.core.bounds import minimise, minimise_decided
from railjoule.core.interior_point.duty import (
    NEXT_TO_NOTHING,
    Duty,
    coasting_exactly,
    duty,
    forbidden_energy_j,
    mended_modes,
    modes_of,
    safest_modes,
)
from railjoule.core.physics.course_data import BRAKING, DRIVING, OFF
from railjoule.core.strategies import prepare_task


def task_of(drive, friction_kn=0.0, factor=0.37):
    return prepare_task(train(drive, friction_kn, factor, **{"timetable.travel_time_s": 150.0}))


def test_a_cell_that_is_driven_is_not_braked():
    driven, braked = np.array([True, True, False, False]), np.array([True, False, True, False])
    assert modes_of(driven, braked).tolist() == [DRIVING, DRIVING, BRAKING, OFF]


def test_the_safest_decision_allows_what_is_used_at_all():
    shares = Duty(np.array([0.03, 0.01, 0.0]), np.array([0.5, 0.03, 0.01]))
    assert safest_modes(shares).tolist() == [DRIVING, BRAKING, OFF]


@pytest.mark.parametrize("friction_kn", [15.0, 120.0])
def test_what_gains_nothing_is_left_to_friction_as_far_as_it_goes(friction_kn):
    """Where the supply takes nothing back, the electric brake is on where friction brakes do not suffice alone."""
    task = task_of("synchronous", friction_kn, factor=0.0)
    optimum = minimise(task).optimum
    shares, needed = duty(task.course.data, optimum), -task.course.net_force_n(optimum.speed2)
    assert np.array_equal(shares.braking > 1e-3, (needed > 1e3 * friction_kn) & (optimum.braking_n > 10.0))
    assert np.any(shares.braking > 1e-3)


@pytest.mark.parametrize("drive", ["induction", "synchronous"])
def test_shares_are_the_effort_over_that_of_least_power_per_effort(drive):
    task = task_of(drive)
    optimum = minimise(task).optimum
    shares = duty(task.course.data, optimum)
    for share, effort in ((shares.driving, optimum.traction_n), (shares.braking, optimum.braking_n)):
        between = (share > 0) & (share < 1)
        # that effort is the same at about the same speed: few newtons of tens of thousands lie between cells
        assert np.all(effort[between] / share[between] > effort[between])
        assert share.max() == 1.0


@pytest.mark.parametrize("drive", ["induction", "loss polynomial"])
def test_a_run_coasts_exactly_where_its_optimum_all_but_does(drive):
    task = task_of(drive)
    data, optimum = task.course.data, minimise(task).optimum
    force = np.abs(task.course.net_force_n(coasting_exactly(data, optimum)))
    least = NEXT_TO_NOTHING * data.traction.constant_n
    # between the rounding of a fixed point and what is an effort there is nothing
    assert not np.any((force > 1e-3 * least) & (force < 0.1 * least))
    assert np.sum(force < 1e-3 * least) > 10


def test_a_decision_that_no_run_can_follow_shows_by_what_it_buys():
    """Without driving at all a train from rest gets nowhere: its optimum buys all its work ten times over."""
    task = task_of("loss polynomial", 120.0)
    data = task.course.data
    nowhere = np.full(task.course.cell_count, OFF)
    found = minimise_decided(task, nowhere)
    work = float((found.traction_n * data.cell_length_m).sum())
    assert forbidden_energy_j(data, nowhere, found) >= 10 * work * (1 - 1e-12) > found.energy_j * 0.5
    mended = mended_modes(data, nowhere, found)
    assert np.array_equal(mended == DRIVING, found.traction_n > NEXT_TO_NOTHING * data.traction.constant_n)
    assert np.count_nonzero(mended == DRIVING) > 5


def test_a_decision_that_a_run_can_follow_buys_nothing():
    task = task_of("loss polynomial", 120.0)
    modes = safest_modes(duty(task.course.data, minimise(task).optimum))
    found = minimise_decided(task, modes)
    assert forbidden_energy_j(task.course.data, modes, found) < 1e-5 * found.energy_j
    assert np.array_equal(mended_modes(task.course.data, modes, found), modes)
