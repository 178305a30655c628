"""The search for limits: its points, its end, and what it costs."""

import numpy as np
import pytest

from railjoule.core import load_scenario, solve
from railjoule.core.limit_search.search import weyl_points
from railjoule.core.strategies.set_speed_run import build_limit_problem
from railjoule.core.strategies.speed_limits import speed_limits_with_search
from railjoule.core.task import prepare_task


def test_weyl_points_fill_the_square_evenly():
    points = weyl_points(256, 2)
    counts, _, _ = np.histogram2d(points[:, 0], points[:, 1], bins=4, range=[[0, 1], [0, 1]])
    # 16 in each of 16 fields
    assert counts.min() >= 12
    assert counts.max() <= 20


@pytest.fixture(scope="module", params=[pytest.param(20, marks=pytest.mark.nightly), 40])
def speed(request):
    return request.param


@pytest.fixture(scope="module")
def scenario(speed):
    return load_scenario(f"kharkiv-like-{speed}kmh")


@pytest.fixture(scope="module")
def optimum(scenario):
    late = 1.01 * scenario.travel_time_s
    return solve(scenario.replace(**{"timetable.travel_time_s": late}), "bellman").energy_kwh


def test_two_sections_with_a_regulator_that_coasts(scenario, optimum):
    """findings.md, another assumed line: 6 and 4 % above the optimum; here 8 and 8 %."""
    run, search = speed_limits_with_search(prepare_task(scenario))
    assert 1.0 < run.energy_kwh / optimum < 1.10
    assert run.travel_time_s == pytest.approx(1.01 * scenario.travel_time_s, rel=1e-6)
    stages = [one.stage for one in search.evaluations]
    assert stages[:128] == ["sample"] * 128
    assert set(stages[128:]) == {"refine"}
    feasible = [one for one in search.evaluations if np.isfinite(one.energy_j)]
    assert all(one.running_time_s == pytest.approx(1.01 * scenario.travel_time_s) for one in feasible)
    assert search.best.energy_j == min(one.energy_j for one in search.evaluations)


def test_no_pair_of_limits_on_a_fine_grid_is_better(scenario):
    """All ratios of the two limits, scaled to the time: the search is within 0.05 % of the best of 200."""
    problem = build_limit_problem(prepare_task(scenario))
    best = speed_limits_with_search(prepare_task(scenario))[1].best
    ratios = np.exp(np.linspace(-3, 3, 200))
    grid = [problem.evaluate("sample", np.array([10.0, 10.0 * ratio]), best.boundaries_m) for ratio in ratios]
    assert best.energy_j <= min(one.energy_j for one in grid) * 1.0005


def test_free_borders_come_near_the_optimum(scenario, speed, optimum):
    """The issue asks for 2 % at 40 km/h."""
    run = solve(scenario.replace(**{"search.boundaries_m": [800, 1600], "search.free_boundaries": True}))
    assert 1.0 <= run.energy_kwh / optimum < {20: 1.04, 40: 1.02}[speed]


def test_the_best_braked_limits_are_one_limit(scenario):
    """Within 0.1 %, as findings.md says: a regulator that brakes has no use for more sections."""
    braked = scenario.replace(**{"search.regulator": "brake"})
    best = speed_limits_with_search(prepare_task(braked))[1].best
    uniform = build_limit_problem(prepare_task(braked)).evaluate("given", np.array([10.0, 10.0]), best.boundaries_m)
    assert best.energy_j == pytest.approx(uniform.energy_j, rel=1e-3)


def test_braking_for_limits_costs_a_fifth_more(scenario, optimum):
    """findings.md: 16 to 22 % on another assumed line; here 26 and 23 %."""
    assert 1.15 < solve(scenario.replace(**{"search.regulator": "brake"})).energy_kwh / optimum < 1.30
