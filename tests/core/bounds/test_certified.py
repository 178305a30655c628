"""Which runs a bound covers, and what becomes of a run that none covers."""

from dataclasses import replace

import numpy as np
import pytest
from builders import COPPER_LOSS, HILLS, plain_scenario
from proven_trains import IDLING

from railjoule.core import SolverError, load_scenario
from railjoule.core.bounds import bounded, certified, certify, find_bound, minimise, tightened, work_floor_j
from railjoule.core.motion import build_meshed_line
from railjoule.core.physics.between_nodes import follow_between_nodes
from railjoule.core.strategies import prepare_task, run_strategy
from railjoule.core.trajectory import make_trajectory
from railjoule.core.units import J_PER_KWH
from tests.every_drive import train

CHANGES = {
    "line.sections": HILLS,
    "vehicle.drive": COPPER_LOSS,
    "timetable.travel_time_s": 220.0,
    "vehicle.auxiliary_power_kw": 40.0,
    "line.stations": [{"position_m": 900.0, "dwell_s": 25.0}],
}


@pytest.fixture(scope="module")
def task():
    return prepare_task(plain_scenario(CHANGES))


def test_the_optimum_and_its_bound_are_in_si_with_dwells(task):
    solution = minimise(task)
    run = make_trajectory(task.scenario, task.mesh, "any", solution.optimum.speed2)
    # to the gap that was asked for: a barrier leaves a little of both efforts everywhere
    assert solution.energy_j == pytest.approx(run.energy.net_j, rel=1e-7)
    assert solution.optimum.energy_j == pytest.approx(run.energy.net_j - 25 * 40e3, rel=1e-7)
    assert solution.optimum.traction_n.max() == pytest.approx(run.tractive_effort_n.max(), rel=1e-6)
    bound = certify(task, solution.optimum)
    # within what a mesh of 10 m leaves out, on either side
    assert bound.energy_j == pytest.approx(solution.energy_j, rel=1e-3)
    assert (bound.travel_time_s, bound.every_run_j) == (task.travel_time_s, bound.energy_j)
    assert bound.covers_every_run


def test_the_price_of_time_is_what_a_second_saves(task):
    later = replace(task, running_time_s=task.running_time_s + 0.1)
    saved = minimise(task, 1e-9).energy_j - minimise(later, 1e-9).energy_j
    assert minimise(task).optimum.price_of_time_w == pytest.approx(10 * saved, rel=2e-3)


def test_a_known_bound_is_taken_where_it_covers(task):
    known = find_bound(task)
    assert bounded(task, run_strategy(task, "fastest"), known).bound is known
    other = replace(known, position_m=task.mesh.position_m[1:])
    assert bounded(task, run_strategy(task, "fastest"), other).bound.energy_j == pytest.approx(known.energy_j)


def test_a_run_keeps_its_own_bound(task):
    run = run_strategy(task, "optimal")
    assert bounded(task, run, find_bound(task)) is run


def test_a_late_run_gets_the_bound_of_its_own_time(task):
    slower = 0.9**2 * task.fastest_speed2
    late = replace(task, running_time_s=0.95 * task.shortest_time_s / 0.9)
    run = make_trajectory(task.scenario, task.mesh, "any", slower)
    bound = bounded(late, run, None).bound
    assert bound.travel_time_s == pytest.approx(run.travel_time_s)
    assert bound.energy_j <= run.energy.net_j


def test_there_is_no_bound_without_slack_or_without_an_optimum(task, monkeypatch):
    assert find_bound(replace(task, running_time_s=task.shortest_time_s)) is None

    def fails(*_):
        raise SolverError("the optimum was not found within 100 iterations.")

    monkeypatch.setattr(certified, "minimise", fails)
    assert find_bound(task) is None
    assert bounded(task, run_strategy(task, "fastest")).bound is None


def test_a_bound_covers_runs_over_any_nodes(task):
    """It is one of every driving: a run over halved cells takes that of the coarse mesh."""
    coarse, known = task.mesh.position_m, find_bound(task)
    fine = prepare_task(task.scenario, position_m=np.union1d(coarse, 0.5 * (coarse[1:] + coarse[:-1])))
    run = make_trajectory(fine.scenario, fine.mesh, "any", fine.fastest_speed2)
    assert bounded(task, run, known).bound is known


@pytest.fixture(scope="module")
def metro():
    # a time without hundredths: statements round it down
    return prepare_task(load_scenario("kharkiv-like-40kmh", {"timetable.travel_time_s": 216.0}))


def test_chains_prove_more_than_one_price_a_place_can(metro):
    run = run_strategy(metro, "optimal")
    bound = tightened(metro, run.bound, run)
    every_j = run.bound.energy_j
    assert run.bound.covers_every_run
    assert work_floor_j(metro) < every_j == bound.every_run_j < bound.energy_j
    # it aims at the tolerance, which the first stage does not quite reach here: 1.1e-3
    assert metro.scenario.solver.tolerance * (1 - 1e-4) < run.with_bound(bound).gap < 2e-3
    assert bound.energy_j < run_strategy(metro, "bellman").energy.net_j
    # it does not hold over other meshes
    assert np.array_equal(bound.position_m, metro.mesh.position_m)
    # both energies downwards
    proven, every = (np.floor(energy / J_PER_KWH * 1e4) / 1e4 for energy in (bound.energy_j, every_j))
    start = f"over this mesh of {metro.mesh.cell_count} cells of at most 10 m, with one effort in each, "
    assert bound.statement == (
        f"No run within {metro.travel_time_s:.1f} s {start}uses less than {proven:.4f} kWh; every way of driving this "
        f"train needs at least {every:.4f} kWh."
    )


def test_a_budget_of_no_boxes_leaves_the_first_bound(metro):
    run = run_strategy(metro, "optimal")
    assert tightened(metro, run.bound, run, 0) is run.bound


def test_only_the_own_bound_of_a_task_is_tightened(metro, task):
    run = run_strategy(metro, "optimal")
    later = replace(run.bound, travel_time_s=metro.travel_time_s + 1.0)
    assert tightened(metro, later, run) is later
    smooth = run_strategy(task, "optimal")
    assert tightened(task, smooth.bound, smooth) is smooth.bound


@pytest.mark.parametrize("drive", IDLING)
def test_dwells_and_auxiliaries_count_in_both_bounds(drive):
    """No run over cells of 2.5 m lies below the bound from cells of 10 m, by its exact motion between the nodes.

    The account of a cell next to a stop, by its mean speed, is optimistic by up to a thousandth, so that a run may lie
    below the bound by its own account.
    """
    stop = {"line.stations": [{"position_m": 600.0, "dwell_s": 30.0}], "timetable.travel_time_s": 190.0}
    first = find_bound(prepare_task(train(drive, 15.0, **stop)))
    fine = prepare_task(train(drive, 15.0, **stop, **{"solver.mesh_m": 2.5}))
    for name in ("optimal", "bellman"):
        run = run_strategy(fine, name)
        data = build_meshed_line(fine.scenario, position_m=run.nodes_m).data
        exact_j = follow_between_nodes(data, run.node_speed_ms**2).total_j + run.energy.auxiliary_j
        assert first.energy_j < exact_j < first.energy_j * 1.04
