"""A bound that tightens: it never falls, ends where it is told to, and belongs to its own task alone."""

from dataclasses import replace
from importlib import import_module

import pytest

from railjoule.core import ScenarioError, compare, load_scenario, solve
from railjoule.core.bounds import can_tighten, run_to_prove, tightened, tightening, with_tighter_bound
from railjoule.core.interior_point.solver import minimise_energy
from railjoule.core.strategies import prepare_task, run_strategy

SOON_REACHED, HARD = "tram-950m-recuperating", "kharkiv-like-20kmh"
"""A tram whose proof over 20 m takes 0.8 million boxes, and a slow metro for which six millions are not enough."""


@pytest.fixture(scope="module")
def tram():
    task = prepare_task(load_scenario(SOON_REACHED, {"solver.mesh_m": 20.0}))
    return task, run_strategy(task, "optimal")


@pytest.fixture(scope="module")
def metro():
    task = prepare_task(load_scenario(HARD))
    return task, run_strategy(task, "optimal")


def test_each_step_has_a_bound_no_less_than_the_one_before(tram):
    task, run = tram
    steps = list(tightening(task, run.bound, run))
    energies = [step.bound.energy_j for step in steps]
    assert energies == sorted(energies)
    assert energies[0] == run.bound.energy_j < energies[-1] < run.energy.net_j
    assert [step.boxes for step in steps] == sorted({step.boxes for step in steps})
    assert [step.reached for step in steps] == [False] * (len(steps) - 1) + [True]
    assert steps[0].share == 0 < steps[-1].share < 1
    # what is proven of every driving stays the first bound
    assert steps[-1].bound.every_run_j == run.bound.every_run_j == run.bound.energy_j
    assert (run.bound.covers_every_run, steps[-1].bound.covers_every_run) == (True, False)


def test_a_proof_that_is_done_has_nothing_to_do(tram):
    task, run = tram
    bound = tightened(task, run.bound, run)
    assert [(step.reached, step.boxes) for step in tightening(task, bound, run)] == [(True, 0)]


def test_a_proof_ends_with_its_budget_or_its_time(metro):
    task, run = metro
    budget = 600_000
    *_, last = tightening(task, run.bound, run, budget)
    assert 0 < last.boxes <= budget
    assert not last.reached
    assert not last.exhausted
    assert [step.boxes for step in tightening(task, run.bound, run, budget, seconds=0.0)] == [0]
    # no level begins that would end later, as those before it tell
    *_, soon = tightening(task, run.bound, run, 10 * budget, seconds=1e-3)
    assert soon.boxes < budget


def test_a_proof_takes_the_relaxed_optimum_of_its_strategy(monkeypatch):
    """It was solved a second time."""
    is_relaxed = []

    def counted(mesh, *given):
        is_relaxed.append(mesh.mode.size == 0)
        return minimise_energy(mesh, *given)

    monkeypatch.setattr(import_module("railjoule.core.bounds.minimum"), "minimise_energy", counted)
    solve(load_scenario(SOON_REACHED, {"solver.mesh_m": 20.0}), "optimal")
    assert sum(is_relaxed) == 1


def test_a_bound_of_another_time_is_not_the_tasks_own(tram):
    task, run = tram
    assert can_tighten(task, run.bound, run)
    assert not can_tighten(task, replace(run.bound, travel_time_s=task.travel_time_s + 1.0), run)
    # a drive without idle losses is proven by its refined mesh already
    smooth = prepare_task(load_scenario("liashenko-ii"))
    best = run_strategy(smooth, "optimal")
    assert [(step.reached, step.boxes) for step in tightening(smooth, best.bound, best)] == [(True, 0)]


def test_a_looser_bound_and_one_of_other_runs_are_not_taken(tram):
    task, run = tram
    less, more = (replace(run.bound, energy_j=run.bound.energy_j + change) for change in (-1.0, 1.0))
    assert with_tighter_bound(run, less) is run
    assert with_tighter_bound(run, more).bound is more
    assert with_tighter_bound(run, replace(more, travel_time_s=task.travel_time_s - 1.0)) is run


def test_a_proof_starts_from_the_optimum_whatever_else_was_run(tram):
    task, run = tram
    other = run_strategy(task, "fastest")
    assert run_to_prove(run.bound, [other, run]) is run
    assert run_to_prove(run.bound, [other]) is other
    assert run_to_prove(run.bound, []) is None


def test_solve_and_compare_prove_alike_for_as_long_as_they_are_told():
    scenario = load_scenario(SOON_REACHED, {"solver.mesh_m": 20.0})
    first, usual, longer = (solve(scenario, "optimal", prove_seconds=seconds) for seconds in (0, None, 60))
    assert first.bound.energy_j < usual.bound.energy_j
    # what a proof aims at
    assert usual.gap == pytest.approx(scenario.solver.tolerance, rel=1e-4)
    assert usual.is_proven
    assert longer.bound.energy_j == usual.bound.energy_j
    assert compare(scenario).runs[0].bound.energy_j == usual.bound.energy_j
    assert compare(scenario, prove_seconds=0).runs[0].bound.energy_j == first.bound.energy_j


@pytest.mark.parametrize("seconds", [-1.0, float("nan"), float("inf"), 1e9])
def test_a_time_out_of_its_bounds_is_refused(seconds):
    with pytest.raises(ScenarioError, match=r"^prove_seconds = \S+ must be a number from 0 to 86400\.$"):
        solve(load_scenario(SOON_REACHED), prove_seconds=seconds)
