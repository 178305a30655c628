"""All strategies have the same call and the same result, and each run comes with its bound."""

from dataclasses import replace
from importlib import import_module

import numpy as np
import pytest
from builders import COPPER_LOSS, HILLS, plain_scenario

from railjoule.core import (
    SolverError,
    StrategyRefusedError,
    TimetableError,
    Trajectory,
    compare,
    load_scenario,
    solve,
)
from railjoule.core.errors import DriveRangeError, ScenarioError
from railjoule.core.strategies import STRATEGIES, prepare_task, run_strategy

SUBURBAN = load_scenario("ftorek-300s")


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_every_strategy_has_the_same_call_and_result(strategy):
    run = solve(SUBURBAN, strategy)
    assert isinstance(run, Trajectory)
    assert run.scenario is SUBURBAN
    assert (run.strategy, run.distance_m) == (strategy, 5000)
    assert run.speed_ms[[0, -1]].tolist() == [0, 0]
    assert run.solve_time_s > 0
    assert run.bound.energy_j <= run.energy.net_j


def test_the_scenario_names_the_strategy_unless_the_call_does():
    scenario = SUBURBAN.replace(strategy="enoc")
    assert solve(scenario).strategy == "enoc"
    assert solve(scenario, "fastest").strategy == "fastest"


@pytest.mark.parametrize(
    ("strategy", "words"),
    [
        ("magic", "is not a strategy; choose one of"),
    ],
)
def test_an_unknown_strategy_is_refused_with_those_that_there_are(strategy, words):
    with pytest.raises(StrategyRefusedError) as refusal:
        solve(SUBURBAN, strategy)
    assert str(refusal.value) == f"{words} {', '.join(STRATEGIES)}."


def test_the_bound_is_that_of_the_optimum():
    """A strategy that proves nothing itself gets the bound from `solve`, not from `run_strategy`."""
    bound = solve(SUBURBAN, "optimal").bound
    assert run_strategy(prepare_task(SUBURBAN), "eoc").bound is None
    other = solve(SUBURBAN, "eoc").bound
    assert (other.energy_j, other.statement) == (bound.energy_j, bound.statement)


@pytest.mark.parametrize("strategy", ["enoc", "phases"])
def test_a_run_over_other_nodes_has_the_bound_of_every_driving(strategy):
    run, best = solve(SUBURBAN, strategy), solve(SUBURBAN, "optimal")
    assert not np.array_equal(run.nodes_m, best.nodes_m)
    assert run.bound.covers_every_run
    assert run.bound.energy_j == best.bound.energy_j < run.energy.net_j


def test_compare_gives_all_runs_of_one_time_one_bound():
    found = compare(SUBURBAN)
    runs, refused = found.runs, found.refused
    assert [run.strategy for run in runs] == list(STRATEGIES)
    assert refused == {}
    # set speeds may be late
    assert len({run.bound.energy_j for run in runs if run.strategy != "speed_limits"}) == 1
    assert all(run.bound.covers_every_run for run in runs)
    gaps = {run.strategy: run.gap for run in runs}
    # EOC is Pontryagin's own optimum of this line
    assert [run.strategy for run in runs if run.is_proven] == ["optimal", "eoc"]
    # findings on Ftorek 2025: ENOC's best acceleration time costs 1.6 % more than the optimum
    assert gaps["enoc"] == pytest.approx(0.016, abs=1e-3)
    assert gaps["eoc"] < gaps["enoc"] < gaps["fastest"]


def test_compare_says_why_the_others_refuse():
    found = compare(plain_scenario({"vehicle.drive": COPPER_LOSS, "line.stations": [{"position_m": 1000.0}]}))
    runs, refused = found.runs, found.refused
    assert {run.strategy for run in runs} == set(STRATEGIES) - {"eoc", "enoc"}
    assert refused == dict.fromkeys(("eoc", "enoc"), "needs a line without stops between its ends.")


@pytest.mark.parametrize("call", [compare, solve])
def test_a_timetable_that_no_train_keeps_is_an_error_for_all(call):
    with pytest.raises(TimetableError):
        call(plain_scenario({"timetable.travel_time_s": 60.0}))


def test_speeds_at_the_ends():
    run = solve(plain_scenario({"line.sections": HILLS}), initial_speed_ms=5.0, final_speed_ms=3.0)
    assert run.speed_ms[[0, -1]] == pytest.approx([5, 3])
    assert run.gap >= 0
    assert run.is_proven


@pytest.mark.parametrize("error", [DriveRangeError("the map ends."), ScenarioError("no."), SolverError("none.")])
def test_one_strategy_that_fails_leaves_the_others(error, monkeypatch):
    def fails(_):
        raise error

    monkeypatch.setitem(STRATEGIES, "speed_limits", replace(STRATEGIES["speed_limits"], run=fails))
    found = compare(SUBURBAN)
    runs, refused = found.runs, found.refused
    assert {run.strategy for run in runs} == set(STRATEGIES) - {"speed_limits"}
    assert str(error) in refused["speed_limits"]


def test_a_run_beyond_the_map_of_its_drive_is_a_refusal(monkeypatch):
    def fails(_):
        raise DriveRangeError("the map of the drive ends at 303.2 kN to brake with, below 5880 kN.")

    monkeypatch.setitem(STRATEGIES, "phases", replace(STRATEGIES["phases"], run=fails))
    words = r"^finds no run that can be driven: the map of the drive ends at 303.2 kN to brake with, below 5880 kN\.$"
    with pytest.raises(StrategyRefusedError, match=words):
        solve(SUBURBAN, "phases")


def test_whatever_an_optimum_fails_with_leaves_the_run(monkeypatch):
    def fails(*_):
        raise DriveRangeError("the map ends.")

    monkeypatch.setattr(import_module("railjoule.core.continuous_bound.refinement"), "minimise", fails)
    assert solve(SUBURBAN, "fastest").energy_kwh > 0
