"""The lower bound: above no feasible run, and at the optimum but for a millionth."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from random_scenarios import random_run, random_speeds

from railjoule.core import StrategyRefusedError, load_scenario, solve
from railjoule.core.bounds import certify, minimise
from railjoule.core.interior_point.proof import prove
from railjoule.core.interior_point.solver import minimise_energy
from railjoule.core.physics.reference import reference_energy
from railjoule.core.strategies import prepare_task
from railjoule.core.strategies.plain_line import check_feasible
from railjoule.core.trajectory import make_trajectory

TOLERANCE = 1e-7
ALL_BOXES = 2_000_000
seeds = st.integers(0, 10**6)


def bound_of(task, optimum, budget=ALL_BOXES):
    return prove(task.course.data, optimum, task.greatest_speed2, task.running_time_s, TOLERANCE, budget).bound_j


def after(task, iterations):
    """Return where the interior-point method stands after so many iterations."""
    times = task.shortest_time_s, task.running_time_s
    return minimise_energy(task.course.data, task.greatest_speed2, *times, TOLERANCE, iterations, 1e-6, False, False)


def size(task, energy):
    return reference_energy(task.course.data, energy, task.running_time_s)


@given(seeds)
def test_no_feasible_run_needs_less(seed):
    """Neither random ones in the same time nor those between them and the optimum, which come as near as one likes."""
    task = random_run(seed, stops=seed % 2 == 1).task
    optimum = minimise(task).optimum
    bound, other = certify(task, optimum).energy_j, random_speeds(task, seed)
    energies = []
    for share in (1.0, 0.3, 0.1, 0.01, 0.001):
        speed2 = share * other + (1 - share) * optimum.speed2
        try:
            # between two runs a limit of power may be broken
            check_feasible(task.course, speed2)
        except StrategyRefusedError:
            continue
        energies.append(make_trajectory(task.scenario, task.course, "between", speed2).energy.net_j)
    assert len(energies) > 0
    assert bound <= min(energies)


@pytest.mark.parametrize("strategy", ["optimal", "eoc", "enoc", "fastest"])
@pytest.mark.parametrize("recuperation", [0.0, 0.4, 1.0])
def test_no_strategy_needs_less(strategy, recuperation):
    run = solve(load_scenario("ftorek-300s", {"drive.recuperation_factor": recuperation}), strategy)
    assert run.bound.energy_j <= run.energy.net_j


@given(seeds, st.integers(1, 9))
def test_the_bound_holds_for_the_multipliers_of_any_point(seed, iterations):
    task = random_run(seed, stops=seed % 2 == 1).task
    least = minimise(task).optimum.energy_j
    assert bound_of(task, after(task, iterations), 20_000) <= least + TOLERANCE * size(task, least)


@given(seeds)
def test_the_bound_holds_for_random_multipliers(seed):
    task, rng = random_run(seed, stops=seed % 2 == 1).task, np.random.default_rng(seed)
    optimum = minimise(task).optimum
    disturbed = optimum._replace(
        multiplier=optimum.multiplier * np.exp(rng.normal(0, 0.5, optimum.multiplier.shape)),
        force_price=optimum.force_price * np.exp(rng.normal(0, 0.3, optimum.force_price.shape)),
        price_of_time_w=optimum.price_of_time_w * np.exp(rng.normal(0, 0.3)),
    )
    assert bound_of(task, disturbed, 20_000) <= optimum.energy_j + TOLERANCE * size(task, optimum.energy_j)


@given(seeds)
def test_more_than_the_optimum_is_not_proven(seed):
    """Whatever energy a point claims to need: the intervals that are dropped are not those of a better run."""
    task = random_run(seed, stops=seed % 2 == 1).task
    optimum = minimise(task).optimum
    claimed = optimum._replace(energy_j=optimum.energy_j + 0.01 * size(task, optimum.energy_j))
    assert bound_of(task, claimed, 50_000) <= optimum.energy_j


def test_the_bound_rises_to_the_optimum():
    task = prepare_task(load_scenario("liashenko-ii"))
    bounds = [bound_of(task, after(task, iterations), 0) for iterations in range(1, 11)]
    assert np.all(np.diff(bounds) > 0)
    assert bounds[-1] == pytest.approx(minimise(task).optimum.energy_j, rel=1e-6)


@pytest.mark.parametrize("seed", [21, 24])
def test_intervals_of_speed_close_what_loose_cells_leave(seed):
    """Seeds with a gap above a thousandth before intervals are cut, found among the first hundred."""
    task = random_run(seed, stops=seed % 2 == 1).task
    optimum = minimise(task).optimum
    uncut, cut = (optimum.energy_j - bound_of(task, optimum, budget) for budget in (0, ALL_BOXES))
    assert uncut > 1e-3 * size(task, optimum.energy_j)
    assert 0 <= cut <= TOLERANCE * size(task, optimum.energy_j)


def test_a_proof_keeps_its_budget():
    task = random_run(24, stops=False).task
    optimum, limits = minimise(task).optimum, (task.greatest_speed2, task.running_time_s, TOLERANCE)
    whole, short = (prove(task.course.data, optimum, *limits, budget) for budget in (ALL_BOXES, 2000))
    assert short.evaluations < whole.evaluations
    assert short.bound_j < whole.bound_j
    assert short.loose_cells == whole.loose_cells > 0
