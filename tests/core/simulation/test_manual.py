"""Manual driving by commands and drawings: train protection, limits, and bounds that cover the runs."""

import numpy as np
import pytest

from railjoule.core import Scenario, ScenarioError, solve
from railjoule.core.motion import MeshedLine
from railjoule.core.motion.cell_step import COAST, FULL_BRAKE, FULL_TRACTION
from railjoule.core.simulation.manual import PARTED_MS, WALKING_PACE_MS, drive_drawn, drive_manually, parting_node
from railjoule.core.units import MS_PER_KMH


def test_power_all_the_way_is_the_fastest_run(scenario: Scenario, mesh: MeshedLine) -> None:
    run = drive_manually(scenario, mesh, np.full(mesh.cell_count, FULL_TRACTION))
    fastest = solve(scenario, strategy="fastest")
    np.testing.assert_allclose(run.node_speed_ms, fastest.node_speed_ms, atol=1e-6)
    assert run.energy_kwh == pytest.approx(fastest.energy_kwh, rel=1e-6)


def test_coasting_takes_no_energy_and_braking_slows_to_walking_pace(scenario: Scenario, mesh: MeshedLine) -> None:
    commands = np.full(mesh.cell_count, FULL_TRACTION)
    commands[40:80], commands[80:] = COAST, FULL_BRAKE
    run = drive_manually(scenario, mesh, commands)
    assert np.all(run.tractive_effort_n[40:80] <= 1e-6)
    assert np.all(run.electric_braking_n[40:80] <= 1e-6)
    # not at the ends, where the train starts and stops
    assert run.node_speed_ms[80:-10].min() == pytest.approx(WALKING_PACE_MS, rel=1e-9)


def test_any_commands_keep_limits_and_no_less_than_the_bound(scenario: Scenario, mesh: MeshedLine) -> None:
    best = solve(scenario)
    assert best.bound is not None
    random, covered = np.random.default_rng(7), 0
    for _ in range(20):
        changes = random.integers(0, 3, 12)
        changes[:2] = FULL_TRACTION
        run = drive_manually(scenario, mesh, np.resize(np.repeat(changes, mesh.cell_count // 12 + 1), mesh.cell_count))
        assert np.all(run.node_speed_ms**2 <= mesh.data.limit_speed2 * (1 + 1e-9))
        assert run.speed_ms[-1] == 0
        assert abs(run.energy.imbalance) < 1e-9
        covered += best.bound.covers(run)
        assert not best.bound.covers(run) or run.energy.net_j >= best.bound.energy_j
    fastest = drive_manually(scenario, mesh, np.full(mesh.cell_count, FULL_TRACTION))
    assert best.bound.covers(fastest)
    assert fastest.energy.net_j > best.bound.energy_j


def test_commands_are_checked(scenario: Scenario, mesh: MeshedLine) -> None:
    for wrong in (np.zeros(3), np.full(mesh.cell_count, 3)):
        with pytest.raises(ScenarioError, match="entries of 0, 1 or 2"):
            drive_manually(scenario, mesh, wrong)


def test_runs_part_where_one_of_them_lets_go_of_power(scenario: Scenario, mesh: MeshedLine) -> None:
    power = np.full(mesh.cell_count, FULL_TRACTION)
    coasts = power.copy()
    coasts[30:] = COAST
    one, other = (drive_manually(scenario, mesh, commands) for commands in (power, coasts))
    node = parting_node(one, other)
    # alike within a tenth of the speed that counts, so a cell or two behind the change at most
    assert node is not None
    assert 30 <= node <= 32
    assert parting_node(one, one) is None
    assert abs(one.node_speed_ms[node] - other.node_speed_ms[node]) < PARTED_MS


def test_a_drawing_above_all_limits_is_the_fastest_run(scenario: Scenario, mesh: MeshedLine) -> None:
    run = drive_drawn(scenario, mesh, np.full(mesh.cell_count + 1, 100.0))
    np.testing.assert_allclose(run.node_speed_ms, solve(scenario, strategy="fastest").node_speed_ms, atol=1e-6)


def test_what_the_train_can_do_is_driven_as_drawn(scenario: Scenario, mesh: MeshedLine) -> None:
    best = solve(scenario)
    run = drive_drawn(scenario, mesh, best.node_speed_ms)
    # but for the walking pace at both ends
    inside = best.node_speed_ms > 2 * WALKING_PACE_MS
    np.testing.assert_allclose(run.node_speed_ms[inside], best.node_speed_ms[inside], atol=1e-3)
    assert run.energy_kwh == pytest.approx(best.energy_kwh, rel=1e-3)


def test_any_drawing_becomes_a_run_that_keeps_its_bound(scenario: Scenario, mesh: MeshedLine) -> None:
    random = np.random.default_rng(3)
    for _ in range(10):
        drawn = np.interp(mesh.position_m, np.linspace(0, 2300, 24), random.uniform(0, 90, 24)) * MS_PER_KMH
        run = drive_drawn(scenario, mesh, drawn)
        assert np.all(run.node_speed_ms <= np.maximum(drawn, WALKING_PACE_MS) + 1e-9)
        assert np.all(run.node_speed_ms**2 <= mesh.data.limit_speed2 * (1 + 1e-9))
        assert run.node_speed_ms[-1] == 0
        assert abs(run.energy.imbalance) < 1e-9
        best = solve(scenario.replace(**{"timetable.travel_time_s": run.travel_time_s}))
        assert run.energy.net_j >= best.bound.energy_j


def test_a_drawing_is_checked(scenario: Scenario, mesh: MeshedLine) -> None:
    speeds = np.full(mesh.cell_count + 1, 10.0)
    for wrong in (speeds[1:], np.where(mesh.position_m > 50, np.nan, speeds), -speeds):
        with pytest.raises(ScenarioError, match="finite entries of at least 0"):
            drive_drawn(scenario, mesh, wrong)
