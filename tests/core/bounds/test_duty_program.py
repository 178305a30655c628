import numpy as np
import pytest
from every_drive import train

from railjoule.core import load_scenario
from railjoule.core.bounds import certify, minimise
from railjoule.core.strategies import prepare_task
from tests.core.bounds.duty_program import DutyProgram, Problem, even_run

COARSE = {"solver.mesh_m": 50.0, "line.speed_limits": [{"from_m": 500.0, "to_m": 700.0, "limit_kmh": 50.0}]}


def task_of(drive, **changes):
    first = prepare_task(train(drive, 60.0, 0.5, **COARSE, **{"timetable.travel_time_s": 900.0, **changes}))
    time = 1.25 * first.shortest_time_s
    return prepare_task(train(drive, 60.0, 0.5, **COARSE, **{"timetable.travel_time_s": time, **changes}))


@pytest.mark.parametrize("drive", ["loss polynomial", "induction"])
def test_the_problem_is_ours_by_formulas_written_apart(drive):
    task = task_of(drive)
    problem, data = Problem(task.scenario, task.mesh.position_m), task.mesh.data
    fixed = data.fixed_speed2 >= 0
    assert np.array_equal(problem.stands, fixed)
    np.testing.assert_allclose(problem.limit_ms[~fixed] ** 2, data.limit_speed2[~fixed], rtol=1e-12)
    np.testing.assert_allclose(problem.constant_n, data.line_force_n + data.resistance_constant_n, rtol=1e-9)
    np.testing.assert_allclose(problem.quadratic, data.resistance_quadratic, rtol=1e-9)


# With voltage to spare: where rated flux and voltage both bind, ours rounds the corner between them, to the cheap side
@pytest.mark.parametrize(
    ("drive", "changes"), [("loss polynomial", {}), ("induction", {"vehicle.drive.max_phase_voltage_v": 800.0})]
)
def test_ipopt_finds_our_relaxed_value(drive, changes):
    task = task_of(drive, **changes)
    problem = Problem(task.scenario, task.mesh.position_m)
    found = DutyProgram(problem).solve(even_run(problem, np.sqrt(task.fastest_speed2)))
    assert found.converged
    assert minimise(task).energy_j == pytest.approx(found.energy_j, rel=1e-5)


# The brake does the last cell over 10 m, where the limits' corner costs 1e-5; none over 40 m, where a referee that let
# machines take more than they have, while the brake takes over for the rest of the cell, would find 6e-4 less
@pytest.mark.parametrize(("mesh_m", "agreement", "loose"), [(40.0, 1e-6, 1e-2), (10.0, 2e-5, 4e-3)])
def test_cells_that_machines_may_share_with_a_standstill_brake_are_bounded(mesh_m, agreement, loose):
    task = prepare_task(load_scenario("tram-950m-recuperating").replace(**{"solver.mesh_m": mesh_m}))
    problem = Problem(task.scenario, task.mesh.position_m)
    assert problem.scenario.vehicle.drive.standstill_brake
    found = DutyProgram(problem).solve(even_run(problem, np.sqrt(task.fastest_speed2)))
    assert found.converged
    ours = minimise(task)
    assert ours.energy_j == pytest.approx(found.energy_j, rel=agreement)
    # of every driving, which may change its effort within a cell: the less, the shorter the cells
    assert found.energy_j * (1 - loose) < certify(task, ours.optimum).energy_j < found.energy_j
