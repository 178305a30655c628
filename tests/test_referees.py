"""The referees of the benchmarks, each on one small scenario; their tables are printed by hand."""

import numpy as np
import pytest
from every_drive import train

from railjoule.core import load_scenario
from railjoule.core.bounds import certify, minimise
from railjoule.core.physics.stretches import BRAKES, DRIVES, IS_OFF, NOTHING, STOP, RunActions
from railjoule.core.strategies import prepare_task, run_strategy
from tests.benchmarks.duty import DutyProgram, even_run
from tests.benchmarks.mesh import dwells_of
from tests.benchmarks.referee import Problem
from tests.benchmarks.speed_grid import BANDS, Referee

COARSE = {"solver.mesh_m": 50.0, "line.speed_limits": [{"from_m": 500.0, "to_m": 700.0, "limit_kmh": 50.0}]}


def task_of(drive, **changes):
    first = prepare_task(train(drive, 60.0, 0.5, **COARSE, **{"timetable.travel_time_s": 900.0, **changes}))
    time = 1.25 * first.shortest_time_s
    return prepare_task(train(drive, 60.0, 0.5, **COARSE, **{"timetable.travel_time_s": time, **changes}))


@pytest.mark.parametrize("drive", ["loss polynomial", "induction"])
def test_the_problem_is_ours_by_formulas_written_apart(drive):
    task = task_of(drive)
    problem, data = Problem(task.scenario, task.course.position_m), task.course.data
    fixed = data.fixed_speed2 >= 0
    assert np.array_equal(problem.stands, fixed)
    np.testing.assert_allclose(problem.limit_ms[~fixed] ** 2, data.largest_speed2[~fixed], rtol=1e-12)
    np.testing.assert_allclose(problem.constant_n, data.line_force_n + data.resistance_constant_n, rtol=1e-9)
    np.testing.assert_allclose(problem.quadratic, data.resistance_quadratic, rtol=1e-9)


# With voltage to spare: where rated flux and voltage both bind, ours rounds the corner between them, to the cheap side
@pytest.mark.parametrize(
    ("drive", "changes"), [("loss polynomial", {}), ("induction", {"vehicle.drive.max_phase_voltage_v": 800.0})]
)
def test_ipopt_finds_our_relaxed_value(drive, changes):
    task = task_of(drive, **changes)
    problem = Problem(task.scenario, task.course.position_m)
    found = DutyProgram(problem).solve(even_run(problem, np.sqrt(task.greatest_speed2)))
    assert found.converged
    assert minimise(task).energy_j == pytest.approx(found.energy_j, rel=1e-6)


# The brake does the last cell over 10 m, where the limits' corner costs 1e-5; none over 40 m, where a referee that let
# machines take more than they have, while the brake takes over for the rest of the cell, would find 6e-4 less
@pytest.mark.parametrize(("mesh_m", "agreement"), [(40.0, 1e-6), (10.0, 2e-5)])
def test_cells_that_machines_may_share_with_a_standstill_brake_are_bounded(mesh_m, agreement):
    task = prepare_task(load_scenario("tram-950m-recuperating").with_(**{"solver.mesh_m": mesh_m}))
    problem = Problem(task.scenario, task.course.position_m)
    assert problem.scenario.vehicle.drive.standstill_brake
    found = DutyProgram(problem).solve(even_run(problem, np.sqrt(task.greatest_speed2)))
    assert found.converged
    ours = minimise(task)
    assert ours.energy_j == pytest.approx(found.energy_j, rel=agreement)
    assert found.energy_j * (1 - 2e-3) < certify(task, ours.optimum).energy_j < found.energy_j


def test_the_speed_grid_finds_a_run_as_good_as_ours_and_none_below_the_bound():
    task = task_of("loss polynomial")
    run = run_strategy(task, "optimal")
    referee = Referee(Problem(task.scenario, run.nodes_m))
    assert referee.energy_j(run.node_speed_ms) == pytest.approx(run.energy.net_j, rel=1e-9)
    # not all bands: each of the last ones gains less than a ten-thousandth
    found = referee.search(bands=BANDS[:4])
    energy = referee.energy_j(found.speed_ms)
    assert found.time_s <= task.running_time_s * (1 + 1e-8)
    assert minimise(task).energy_j * (1 - 1e-6) <= energy <= run.energy.net_j * (1 + 1e-3)


def test_stretches_of_one_mode_are_counted_and_timed():
    # 10 s a cell: driven for two, off for one, driven for one, off for the rest but the last, which brakes
    action = np.array([DRIVES, DRIVES, IS_OFF, DRIVES, IS_OFF, IS_OFF, BRAKES])
    found = dwells_of(RunActions(action, np.zeros(7), np.full(7, 10.0), np.array([STOP] + 6 * [NOTHING])))
    assert found.blocks == 5
    assert found.shortest_on_s == 10.0
    assert found.shortest_off_s == 10.0
