"""A mesh that is refined until its run is within the tolerance of what no driving undercuts."""

import numpy as np
import pytest

from railjoule.core import check_run, load_scenario
from railjoule.core.continuous_bound.refinement import STEEPEST, refined_optimum
from railjoule.core.lower_bound import LATE_SHARE
from railjoule.core.motion import running_time
from railjoule.core.physics.between_nodes import follow_between_nodes
from railjoule.core.strategies import prepare_task
from railjoule.core.strategies.optimal import optimal
from tests.any_scenarios import any_time, any_wide_document
from tests.builders import plain_scenario
from tests.check_many import timed_task
from tests.core.test_limits_by_place import INERTIA_KG, resistance_n, shortest_time_s
from tests.every_drive import train

SHIPPED = ("liashenko-0", "liashenko-i", "liashenko-ii", "liashenko-iii", "metro-with-limit", "ftorek-300s")
"""Those whose drive has no idle losses."""
FINE = 1e-4


def steepest(length_m):
    return np.exp(np.abs(np.diff(np.log(length_m))).max())


@pytest.mark.parametrize("name", SHIPPED)
def test_a_shipped_scenario_is_solved_within_its_tolerance(name):
    task = prepare_task(load_scenario(name, {"solver.mesh_m": 20.0}))
    found = refined_optimum(task)
    data, speed2 = found.task.mesh.data, found.solution.optimum.speed2
    assert 0 < found.gap <= task.scenario.solver.tolerance
    assert np.isin(task.mesh.position_m, found.task.mesh.position_m).all()
    assert steepest(data.cell_length_m) <= max(STEEPEST, steepest(task.mesh.data.cell_length_m)) * (1 + 1e-6)
    assert follow_between_nodes(data, speed2).excess_share.max() <= 1e-3
    assert running_time(data.cell_length_m, speed2) <= task.running_time_s * (1 + LATE_SHARE)


def test_a_tighter_tolerance_takes_more_cells_and_leaves_a_smaller_gap():
    usual, fine = (
        refined_optimum(prepare_task(load_scenario("liashenko-ii", {"solver.tolerance": tolerance})))
        for tolerance in (5e-4, FINE)
    )
    assert fine.gap <= FINE < usual.gap
    assert fine.task.mesh.cell_count > usual.task.mesh.cell_count
    assert fine.bound.energy_j > usual.bound.energy_j
    # the same run of the same train: both energies lie between both bounds and one another's gap
    assert abs(fine.solution.energy_j - usual.solution.energy_j) < 5e-4 * usual.solution.energy_j


def random_task(seed):
    return timed_task(any_wide_document(seed), any_time(seed), seed)


@pytest.mark.parametrize("seed", [108, 277, 889])
def test_the_mesh_of_a_smooth_drive_is_refined_until_its_account_is_not_below_the_bound(seed):
    task = random_task(seed)
    run = optimal(task)
    assert len(run.nodes_m) - 1 > task.mesh.cell_count
    assert run.gap > -task.scenario.solver.tolerance
    assert check_run(run.scenario, run).broken == ()


@pytest.mark.parametrize("seed", [71, 83])
def test_cells_of_a_drive_with_idle_losses_are_halved_whose_run_is_below_the_bound(seed):
    task = random_task(seed)
    run = optimal(task)
    assert len(run.nodes_m) - 1 >= 2 * task.mesh.cell_count
    assert not run.is_below_bound
    assert run.all_notes == run.notes


def test_the_energy_of_an_electric_brake_that_draws_before_the_stop_is_that_of_the_closed_form():
    """Below v* = R f (r / g)^2 / (n k^2) a brake of f takes f (v* - v): over the time v* / a that is f v*^2 / 2 a."""
    changes = {"solver.mesh_m": 10.0, "timetable.travel_time_s": 79.3}
    run = optimal(prepare_task(train("copper loss", 120.0, 0.0, **changes)))
    last_m = run.position_m[-1] - run.position_m[-2]
    effort_n, deceleration_ms2 = 60e3, run.speed_ms[-2] ** 2 / (2 * last_m)
    assert run.electric_braking_n[-1] == pytest.approx(effort_n)
    draws_below_ms = 0.3 * effort_n * (0.4 / 5.0) ** 2 / (4 * 5.0**2)
    taken_j = run.supply_energy_j[-1] - run.supply_energy_j[-20] - 25e3 * (run.time_s[-1] - run.time_s[-20])
    # over the mesh as set the last cell begins at 2.6 m/s, and at its mean speed the brake takes nothing
    assert taken_j == pytest.approx(effort_n * draws_below_ms**2 / (2 * deceleration_ms2), rel=0.03)
    assert 0 < run.gap <= run.scenario.solver.tolerance


@pytest.mark.parametrize("drive", ["copper loss", "loss polynomial", "efficiency map"])
@pytest.mark.parametrize("factor", [0.0, 0.37])
def test_no_optimum_of_a_coarse_mesh_is_below_its_bound(drive, factor):
    run = optimal(prepare_task(train(drive, 0.0, factor, **{"solver.mesh_m": 10.0, "timetable.travel_time_s": 120.0})))
    assert not run.is_below_bound
    assert "too coarse" not in " ".join(run.all_notes)


def reached_ms(power_w, start_ms, length_m):
    """Return the speeds [m/s] of the plain train after full effort over cells, in 1,000 steps; without the package."""
    speed, step = start_ms, length_m / 1000
    for _ in range(1000):
        effort = np.minimum(100e3, power_w / np.maximum(speed, 1e-3)) - resistance_n(speed)
        speed = np.sqrt(speed**2 + 2 * effort * step / INERTIA_KG)
    return speed


@pytest.mark.parametrize("mesh_m", [5.0, 10.0])
def test_the_mesh_is_refined_until_the_train_reaches_the_speeds_of_its_nodes(mesh_m):
    """A run may be close to its bound and ask for more power than the train has between its nodes."""
    changes = {"vehicle.traction.max_power_kw": 400, "solver.mesh_m": mesh_m, "timetable.travel_time_s": 131.1}
    run = optimal(prepare_task(plain_scenario(changes)))
    most = reached_ms(400e3, run.speed_ms[:-1], np.diff(run.position_m))
    # the cube of the speed rises with the power, of which a thousandth is tolerated
    assert np.max(run.speed_ms[1:] / most) < 1 + 5e-4
    assert run.notes == ()


def test_a_run_that_the_train_cannot_drive_between_the_nodes_has_a_note():
    """Over cells of 20 m the timetable is possible, over shorter ones it is not, nor in steps of 0.25 m."""
    changes = {"vehicle.traction.max_power_kw": 250, "solver.mesh_m": 20.0, "timetable.travel_time_s": 148.09}
    run = optimal(prepare_task(plain_scenario(changes)))
    assert shortest_time_s(lambda _place, speed: min(100e3, 250e3 / speed)) > 148.09
    assert run.notes == (
        "Between two nodes of the mesh, from 2 m on, the run needs 4 % more than the largest traction. With a smaller "
        "solver.mesh_m it does not, or the timetable is too short.",
    )


def test_a_run_of_a_mesh_that_stays_too_coarse_has_a_note():
    # over finer meshes, the timetable of this one cannot be kept
    run = optimal(random_task(604))
    assert run.is_below_bound
    assert run.all_notes[-1] == (
        "The mesh, with cells of up to 46.1 m, is too coarse for this run: by its account it needs 1.6 % less than "
        "any driving of this train does. Make solver.mesh_m smaller."
    )


@pytest.mark.parametrize("seed", [234, 283, 1158])
def test_a_run_that_is_slowed_down_coasts_in_neutral_sections_and_arrives_in_time(seed):
    run = optimal(random_task(seed))
    assert check_run(run.scenario, run).broken == ()
