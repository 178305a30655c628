"""Runs driven by hand: what commands do, what train protection keeps, and that the bound covers them."""

import numpy as np
import pytest

from railjoule.core import Scenario, ScenarioError, solve
from railjoule.core.motion import Course
from railjoule.core.motion.cell_step import COAST, FULL_BRAKE, FULL_TRACTION
from railjoule.core.simulation.by_hand import PARTED_MS, WALKING_PACE_MS, drive_by_hand, parting_node


def test_power_all_the_way_is_the_fastest_run(scenario: Scenario, course: Course) -> None:
    run = drive_by_hand(scenario, course, np.full(course.cell_count, FULL_TRACTION))
    fastest = solve(scenario, strategy="fastest")
    np.testing.assert_allclose(run.node_speed_ms, fastest.node_speed_ms, atol=1e-6)
    assert run.energy_kwh == pytest.approx(fastest.energy_kwh, rel=1e-6)


def test_coasting_takes_no_energy_and_braking_slows_to_walking_pace(scenario: Scenario, course: Course) -> None:
    commands = np.full(course.cell_count, FULL_TRACTION)
    commands[40:80], commands[80:] = COAST, FULL_BRAKE
    run = drive_by_hand(scenario, course, commands)
    assert np.all(run.tractive_effort_n[40:80] <= 1e-6)
    assert np.all(run.electric_braking_n[40:80] <= 1e-6)
    # not at the ends, where the train starts and stops
    slowest = run.node_speed_ms[80:-10].min()
    assert slowest == pytest.approx(WALKING_PACE_MS, rel=1e-9)


def test_any_commands_keep_limits_and_no_less_than_the_bound(scenario: Scenario, course: Course) -> None:
    best = solve(scenario)
    assert best.bound is not None
    random, covered = np.random.default_rng(7), 0
    for _ in range(20):
        changes = random.integers(0, 3, 12)
        changes[:2] = FULL_TRACTION
        run = drive_by_hand(
            scenario, course, np.resize(np.repeat(changes, course.cell_count // 12 + 1), course.cell_count)
        )
        assert np.all(run.node_speed_ms**2 <= course.data.largest_speed2 * (1 + 1e-9))
        assert run.speed_ms[-1] == 0
        assert abs(run.energy.imbalance) < 1e-9
        covered += best.bound.covers(run)
        assert not best.bound.covers(run) or run.energy.net_j >= best.bound.energy_j
    fastest = drive_by_hand(scenario, course, np.full(course.cell_count, FULL_TRACTION))
    assert best.bound.covers(fastest)
    assert fastest.energy.net_j > best.bound.energy_j


def test_commands_are_checked(scenario: Scenario, course: Course) -> None:
    for wrong in (np.zeros(3), np.full(course.cell_count, 3)):
        with pytest.raises(ScenarioError, match="entries of 0, 1 or 2"):
            drive_by_hand(scenario, course, wrong)


def test_runs_part_where_one_of_them_lets_go_of_power(scenario: Scenario, course: Course) -> None:
    power = np.full(course.cell_count, FULL_TRACTION)
    coasts = power.copy()
    coasts[30:] = COAST
    one, other = (drive_by_hand(scenario, course, commands) for commands in (power, coasts))
    node = parting_node(one, other)
    # alike within a tenth of the speed that counts, so a cell or two behind the change at most
    assert node is not None
    assert 30 <= node <= 32
    assert parting_node(one, one) is None
    assert abs(one.node_speed_ms[node] - other.node_speed_ms[node]) < PARTED_MS
