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
from tests.check_many import timed_task

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
    assert len(run.nodes_m) - 1 == 2 * task.mesh.cell_count
    assert not run.is_below_bound
    assert run.all_notes == run.notes


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
