"""Decisions whose switchings lie apart: against all decisions of a short line, and on the way to one price."""

import itertools

import numpy as np
import pytest
from builders import plain_scenario
from every_drive import train

from railjoule.core.dynamic_programming.backward import least_speeds, speed_grid, sweep_back, tabulate_steps
from railjoule.core.dynamic_programming.spaced import actions_of_steps, follow, spaced_decisions, sweep_back_spaced
from railjoule.core.physics.course_data import BRAKING, DRIVING, OFF
from railjoule.core.physics.stretches import ACTIONS, interruptions
from railjoule.core.strategies import prepare_task

PRICE_W = 20e3


@pytest.fixture(scope="module")
def short():
    """Eight cells, and the steps between few speeds at each node."""
    task = prepare_task(
        train(
            "loss polynomial",
            0.0,
            **{
                "line.sections": [{"length_m": 400.0}],
                "timetable.travel_time_s": 60.0,
                "solver.mesh_m": 50.0,
            },
        )
    )
    data = task.course.data
    greatest = task.greatest_speed2
    grid = speed_grid(greatest, least_speeds(data, greatest), data.fixed_speed2, 0.5 * np.sqrt(greatest), 99.0, 9)
    steps = tabulate_steps(data, grid)
    return task, grid, steps, actions_of_steps(data, grid, steps)


def swept(short, lasting):
    task, grid, steps, actions = short
    interrupted_by = interruptions(task.course.data)
    lasting = np.full(task.course.cell_count, lasting)
    policy = sweep_back_spaced(steps, actions.action, grid, PRICE_W, lasting, interrupted_by)
    return follow(steps, actions, grid, policy, lasting, interrupted_by)


def test_stretches_of_a_cell_are_the_recursion_itself(short):
    """With nothing bound, the modes along the recursion's own best steps."""
    _, grid, steps, actions = short
    _, best, _ = sweep_back(steps, grid, PRICE_W)
    k, modes = 0, []
    for i in range(len(best)):
        step = best[i, k]
        modes.append(actions.machines[step])
        k = int(np.argmin(np.abs(grid[i + 1] - steps.leaving_speed2[step])))
    assert swept(short, 1)[0][:2].tolist() == modes[:2]


@pytest.mark.parametrize("lasting", [1, 2, 3, 4])
def test_every_stretch_lasts(short, lasting):
    decision, time = swept(short, lasting)
    lengths = [len(list(stretch)) for _, stretch in itertools.groupby(decision)]
    assert np.isfinite(time)
    # the last one ends with the stop
    assert min(lengths[:-1], default=lasting) >= lasting


def test_actions_are_those_of_the_account(short):
    """A step that gains speed on the level drives; one that loses much of it brakes; coasting is off."""
    _, grid, steps, actions = short
    for i, k in itertools.product(range(2, 5), range(grid.shape[1])):
        for step in range(steps.first[i, k], steps.first[i, k + 1]):
            if np.isfinite(steps.energy_j[step]):
                gains = steps.leaving_speed2[step] >= grid[i, k]
                assert (actions.machines[step] == DRIVING) or not gains
    assert set(np.unique(actions.action)) == set(range(ACTIONS))
    assert set(np.unique(actions.machines)) == {DRIVING, OFF, BRAKING}


def test_two_decisions_bracket_the_timetable(short):
    task = short[0]
    centre = (0.7 * np.sqrt(task.greatest_speed2)) ** 2
    given = task.course.data, task.greatest_speed2, task.running_time_s, centre, PRICE_W, 6.0, 25
    decisions, sweeps = spaced_decisions(*given, 4.0)
    assert 1 <= len(decisions) <= 2
    assert sweeps <= 25
    for decision in decisions:
        assert decision[0] == DRIVING
        assert set(decision) <= {DRIVING, OFF, BRAKING}


def test_a_band_without_a_run_has_no_decision():
    """At a crawl nothing climbs a hill that needs momentum."""
    hill = [{"length_m": 300.0}, {"length_m": 200.0, "gradient_permille": 60.0}, {"length_m": 100.0}]
    task = prepare_task(plain_scenario({"line.sections": hill, "timetable.travel_time_s": 120.0}))
    crawl = np.minimum(task.greatest_speed2, 1.0)
    given = task.course.data, task.greatest_speed2, task.running_time_s, crawl, PRICE_W, 1e-3, 3
    decisions, _ = spaced_decisions(*given, 2.0)
    assert decisions == [] or all(decision[0] == DRIVING for decision in decisions)
