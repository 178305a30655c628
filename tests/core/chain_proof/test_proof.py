"""The proof by chains: below every run, as close as it says, continued and stopped at will."""

from functools import lru_cache

import numpy as np
import pytest
from proven_trains import CASES, name_of, proof_of, scenario_of

from railjoule.core import load_scenario
from railjoule.core.bounds import minimise
from railjoule.core.strategies import prepare_task, run_strategy

MANY = 250_000


def advance(proof, budget):
    """Return the bound of a proof that goes on until the target is proven or a budget of boxes is used."""
    while proof.may_advance(budget):
        proof.advance()
    return proof.bound_j


@lru_cache(maxsize=1)
def tram():
    task = prepare_task(load_scenario("tram-950m"))
    return task, minimise(task).optimum, run_strategy(task, "optimal").energy.net_j - task.dwell_energy_j


@pytest.mark.parametrize("case", CASES[::3] + CASES[-4:], ids=name_of)
def test_a_target_above_all_runs_is_never_proven(case):
    """Nothing of a run below the target may be dropped, so that the bound stays below each."""
    scenario = scenario_of(case)
    fastest = prepare_task(scenario)
    task = prepare_task(
        scenario.replace(**{"timetable.travel_time_s": 1.15 * fastest.shortest_time_s + fastest.dwell_s})
    )
    optimum = minimise(task).optimum
    best = min(run_strategy(task, name).energy.net_j for name in ("optimal", "bellman")) - task.dwell_energy_j
    proof = proof_of(task, optimum, best, -0.01)
    bound = advance(proof, MANY)
    assert not proof.proven
    assert bound <= best
    # and it says something: cells on their own, or with a mode left out, lie far below
    assert bound > best - 0.25 * abs(best)


def test_the_tram_is_proven_within_its_budget():
    task, optimum, best = tram()
    proof = proof_of(task, optimum, best, 1e-3)
    bounds = []
    while not proof.proven and proof.boxes < 2 * MANY:
        bounds.append(proof.advance())
    assert proof.proven
    assert proof.bound_j == proof.target_j
    assert np.all(np.diff(bounds) >= 0)


def test_it_stops_when_asked_and_goes_on():
    task, optimum, best = tram()
    proof = proof_of(task, optimum, best, 1e-3)
    proof.advance()
    assert proof.advance() < proof.target_j
    assert proof.levels == 2
    assert advance(proof, 10 * MANY) == proof.target_j
    assert advance(proof, 10 * MANY) == proof.target_j


def test_no_level_begins_beyond_the_budget():
    task, optimum, best = tram()
    proof = proof_of(task, optimum, best, 1e-3)
    advance(proof, proof.next_boxes - 1)
    assert (proof.boxes, proof.bound_j) == (0, -np.inf)
    advance(proof, proof.next_boxes)
    assert proof.levels == 1


def test_any_prices_prove_a_bound():
    task, optimum, best = tram()
    proof = proof_of(task, optimum._replace(price_of_time_w=0.0), best, -0.01)
    assert advance(proof, MANY) < best
