from dataclasses import replace

import numpy as np
import pytest

from railjoule.core import TimetableError, load_scenario
from railjoule.dashboard.work.runs import FirstRuns, RunsRequest, compute_runs, tightened_runs


def test_runs_bear_the_bound_of_the_optimum() -> None:
    runs = compute_runs(RunsRequest(load_scenario("ftorek-300s"), ("eoc", "enoc")))
    assert list(runs.runs) == ["optimal", "eoc", "enoc"]
    assert runs.runs["eoc"].bound is runs.runs["optimal"].bound
    # so has a run over the corners of its trapezoid
    assert runs.runs["enoc"].bound is runs.runs["optimal"].bound


def test_a_late_run_keeps_the_bound_of_its_own_time() -> None:
    """What needs less than the optimum of 144 s takes 145.44 s, in which less would do."""
    runs = compute_runs(RunsRequest(load_scenario("liashenko-fig-4"), ("speed_limits",))).runs
    assert runs["speed_limits"].energy_kwh < runs["optimal"].energy_kwh
    assert runs["speed_limits"].gap > 0
    assert runs["speed_limits"].above_share > 0


def test_runs_are_tightened_alike_whatever_is_run_beside_the_optimum() -> None:
    scenario = load_scenario("tram-950m-recuperating")
    few, more = (compute_runs(RunsRequest(scenario, names)) for names in ((), ("fastest", "phases")))
    assert few.to_prove is not None
    bounds = {tightened_runs(runs).best.lower_bound_kwh for runs in (few, more)}
    assert len(bounds) == 1
    assert bounds.pop() > few.best.lower_bound_kwh
    # over nodes of its own it keeps its own
    assert tightened_runs(more).runs["phases"].bound is more.runs["phases"].bound
    greater = replace(few.best.bound, energy_j=few.best.energy.net_j - 1.0)
    assert tightened_runs(more, greater).runs["fastest"].bound is greater
    assert tightened_runs(few, prove_seconds=0).best.bound is few.best.bound
    assert compute_runs(RunsRequest(load_scenario("liashenko-ii"), ())).to_prove is None


def test_a_loose_bound_of_a_smooth_drive_is_tightened_too():
    curve = [[0.0, 283.0], [25.0, 283.0], [40.0, 170.0], [70.0, 85.0], [120.0, 34.0]]
    changes = {"vehicle.traction": {"curve": curve}, "timetable.travel_time_s": 71.5}
    runs = compute_runs(RunsRequest(load_scenario("liashenko-i", changes), ()))
    assert runs.to_prove is runs.best
    # half a per cent is open, and chains close more than half of that
    assert runs.best.gap == pytest.approx(0.005, rel=0.1)
    best = tightened_runs(runs).best
    assert 0 < best.gap < 0.4 * runs.best.gap
    assert best.bound.every_run_j == runs.best.bound.energy_j
    # chains prove a bound over this mesh, which the sentence names
    assert best.bound.statement.startswith("No run within 71.5 s over this mesh of 296 cells of at most 5 m, ")


def test_a_strategy_that_refuses_says_why_and_the_others_run() -> None:
    runs = compute_runs(RunsRequest(load_scenario("liashenko-ii"), ("eoc", "fastest")))
    assert list(runs.runs) == ["optimal", "fastest"]
    assert "copper loss" in runs.refused["eoc"]


def test_a_timetable_that_cannot_be_kept_is_refused() -> None:
    scenario = load_scenario("ftorek-300s").replace(**{"timetable.travel_time_s": 100.0})
    with pytest.raises(TimetableError, match="shortest"):
        compute_runs(RunsRequest(scenario, ()))


def test_the_law_of_dynamic_programming_comes_if_asked_for() -> None:
    scenario = load_scenario("liashenko-i")
    with_law = compute_runs(RunsRequest(scenario, ("bellman",), with_law=True))
    without = compute_runs(RunsRequest(scenario, ("bellman",)))
    assert without.law is None
    assert with_law.law is not None
    assert with_law.runs["bellman"].solve_time_s > 0
    assert np.array_equal(with_law.runs["bellman"].speed_ms, without.runs["bellman"].speed_ms)


@pytest.mark.parametrize(
    ("changes", "strategies", "short", "slow"),
    [
        ({}, ("optimal", "fastest"), True, False),
        ({}, ("optimal", "bellman"), False, False),
        ({"solver.mesh_m": 0.5}, ("optimal", "bellman"), False, True),
        ({"solver.mesh_m": 2.0}, ("speed_limits",), False, True),
        ({"solver.mesh_m": 0.15}, ("optimal",), False, False),
        ({"vehicle.preset": "tram-105n", "solver.mesh_m": 0.5}, ("optimal",), False, True),
    ],
)
def test_long_work_is_known_before_it_begins(
    changes: dict[str, float], strategies: tuple[str, ...], short: bool, slow: bool
) -> None:
    request = RunsRequest(load_scenario("metro-with-limit", changes), strategies)
    assert (request.is_short, request.is_slow) == (short, slow)


def test_first_runs_are_computed_once_where_a_page_has_opened_with_them():
    first, request = FirstRuns(most=1), RunsRequest(load_scenario("liashenko-ii"), ("optimal",))
    # nobody has asked whether they are known: a slider moves through very many
    assert first.compute(request) is not first.compute(request)
    assert first.known(request) is None
    runs = first.compute(request)
    assert first.known(request) is first.compute(request) is runs
    other = RunsRequest(load_scenario("liashenko-i"), ("optimal",))
    assert first.known(other) is None
    first.compute(other)
    assert first.known(other) is None
