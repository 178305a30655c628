"""Dynamic programming against the interior-point optimum, which is another method and proven."""

import numpy as np
import pytest
from builders import HILLS, plain_scenario
from hard_scenarios import WEAK_BRAKES
from random_scenarios import random_run

from railjoule.core import SolverError, load_scenario, solve
from railjoule.core.bounds import minimise
from railjoule.core.dynamic_programming import search as search_module
from railjoule.core.scenario import scenario_from_document
from railjoule.core.strategies import prepare_task, run_strategy
from railjoule.core.strategies.bellman import bellman_with_law

CASES = [
    (name, reverse)
    for name in ("liashenko-0", "liashenko-i", "liashenko-ii", "liashenko-iii")
    for reverse in (False, True)
]


@pytest.mark.parametrize(("name", "reverse"), CASES)
def test_liashenkos_lines(name, reverse):
    scenario = load_scenario(name).replace(**{"line.reverse": reverse})
    run, optimum = solve(scenario, "bellman"), solve(scenario, "optimal")
    min_j = minimise(prepare_task(scenario)).energy_j
    assert min_j * (1 - 1e-6) <= run.energy.net_j <= min_j * 1.001
    assert optimum.lower_bound_kwh < run.energy_kwh
    assert run.travel_time_s == pytest.approx(scenario.travel_time_s, abs=1e-3)
    assert run.gap == pytest.approx(run.energy_kwh / optimum.lower_bound_kwh - 1, rel=1e-6)


@pytest.mark.parametrize(("name", "share"), [("metro-with-limit", 0.003), ("ftorek-300s", 0.001)])
def test_an_inner_limit_and_copper_loss(name, share):
    scenario = load_scenario(name)
    optimum = solve(scenario, "optimal").energy_kwh
    assert solve(scenario, "bellman").energy_kwh == pytest.approx(optimum, rel=share)


@pytest.mark.parametrize("seed", range(24))
def test_random_scenarios(seed):
    """Over one mesh: what the product calls optimal is over a finer one."""
    task = random_run(seed, stops=seed % 2 == 1).task
    run, min_j = run_strategy(task, "bellman"), minimise(task).energy_j
    kinetic = 0.5 * task.scenario.vehicle.total_inertia_kg * (run.distance_m / run.travel_time_s) ** 2
    above = (run.energy.net_j - min_j) / max(abs(min_j), 0.1 * kinetic)
    assert -1e-6 < above < 0.003


def test_the_control_law_drives_and_brakes_within_its_bounds():
    run, law = bellman_with_law(prepare_task(load_scenario("liashenko-ii")))
    assert law.control.shape == law.speed_ms[:-1].shape == law.cost_to_go_j[:-1].shape
    known = law.control[np.isfinite(law.control)]
    assert -1 - 1e-6 <= known.min() < -0.9
    assert 0.9 < known.max() <= 1 + 1e-6
    assert law.price_of_time_w == run.price_of_time_w
    # from the start: energy and price of time of the whole run, but for the width of its grid
    whole = run.energy.net_j + law.price_of_time_w * run.travel_time_s
    assert law.cost_to_go_j[0, 0] == pytest.approx(whole, rel=0.1)


def test_it_arrives_early_where_waiting_costs_more_than_it_saves():
    scenario = plain_scenario({"vehicle.auxiliary_power_kw": 400.0, "timetable.travel_time_s": 900.0})
    run, optimum = solve(scenario, "bellman", check=True), solve(scenario, "optimal")
    assert optimum.travel_time_s < 500
    assert run.energy_kwh == pytest.approx(optimum.energy_kwh, rel=1e-3)
    assert run.price_of_time_w == pytest.approx(0.0, abs=1.0)


def test_it_descends_with_brakes_that_hardly_hold():
    """Full braking before a stop is a fixed point that hardly converges: every step of the fastest run was refused."""
    run = solve(scenario_from_document(WEAK_BRAKES), "bellman", check=True)
    assert run.energy_kwh == pytest.approx(0.0, abs=1e-6)


def test_it_climbs_what_takes_a_run_up():
    sections = [{"length_m": 500.0}, {"length_m": 60.0, "gradient_permille": 150.0}, {"length_m": 500.0}]
    changes = {"line.sections": sections}
    shortest = prepare_task(plain_scenario(changes)).shortest_travel_time_s
    scenario = plain_scenario({**changes, "timetable.travel_time_s": 1.002 * shortest})
    run, optimum = solve(scenario, "bellman", check=True), solve(scenario, "optimal")
    assert run.energy_kwh == pytest.approx(optimum.energy_kwh, rel=2e-3)


@pytest.mark.parametrize("seed", range(6))
def test_the_best_of_all_its_runs_is_what_it_returns(seed, monkeypatch):
    task, seen = random_run(seed, stops=False).task, []

    def meet_time(*arguments):
        seen.append(met(*arguments))
        return seen[-1]

    met = search_module.meet_time
    monkeypatch.setattr(search_module, "meet_time", meet_time)
    found = search_module.search(task.mesh.data, task.fastest_speed2, task.running_time_s)
    assert len(seen) > 2
    energies = [search_module.supply_energy_j(task.mesh.data, speed2) for speed2 in seen]
    assert search_module.supply_energy_j(task.mesh.data, found.speed2) == min(energies)


def test_a_search_that_cannot_be_refined_says_so(monkeypatch):
    """All but the first grid hold no run."""
    level, grids = search_module.search_level, []

    def search_level(*arguments):
        grids.append(arguments)
        if len(grids) > 1:
            raise SolverError("no run")
        return level(*arguments)

    monkeypatch.setattr(search_module, "search_level", search_level)
    run = run_strategy(prepare_task(plain_scenario({"line.sections": HILLS})), "bellman")
    assert len(grids) == 1 + search_module.MAX_FAILURES
    assert run.notes[0].startswith("The search ended before its speeds were as fine as usual: no run was found within ")
