"""The script that drives many scenarios: its rows, what it keeps of them, and its table."""

import json
from dataclasses import replace

import pytest
from builders import plain_scenario

from railjoule.core import RailjouleError, solve
from railjoule.core.strategies import STRATEGIES, run_strategy
from tests import check_many
from tests.any_scenarios import any_full_document, any_time, any_wide_document
from tests.check_many import CALLS, arrival_s, calls, kept_rows, missed_s, promises, sources, table, timed_task

BAD = [["tractive power", 0.01, 2e-6, 40.0]]


def solved(seed, strategy, energy_kwh, broken=(), **more):
    return {"seed": seed, "model": "m", "strategy": strategy, "status": "solved", "seconds": 0.1, "cells": 9,
            "energy_kwh": energy_kwh, "time_s": 100.0, "broken": list(broken), "told": False, **more}  # fmt: skip


def test_every_strategy_is_called_once():
    rows = list(calls(0, {"bellman", "speed_limits"}, None, None))
    begun = [row["strategy"] for row in rows if row.get("begins")]
    ended = [row["strategy"] for row in rows if "status" in row]
    assert begun == ["", *ended]
    assert ended == [name for name in CALLS if name not in {"bellman", "speed_limits"}]
    assert {row["status"] for row in rows if "status" in row} == {"solved", "refused", "compared"}
    json.dumps(rows, default=float)


def test_what_a_strategy_raises_is_written_down(monkeypatch):
    def fail(task):
        raise ZeroDivisionError("by zero")

    monkeypatch.setitem(STRATEGIES, "optimal", fail)
    (row,) = (row for row in calls(0, set(CALLS) - {"optimal"}, None, None) if "status" in row)
    assert row["status"] == "traceback"
    assert "ZeroDivisionError: by zero" in row["words"]


def test_a_run_that_says_that_it_is_switched_too_often_has_told_it(monkeypatch):
    """Seed 695 leaves 0.15 s over the shortest time, and a limit of half a metre for which the drive would brake."""
    monkeypatch.setattr(check_many, "any_wide_document", any_full_document)
    monkeypatch.setattr(check_many, "add_windows", lambda *given: None)
    (row,) = (row for row in calls(695, set(CALLS) - {"optimal"}, None, None) if "status" in row)
    assert [broken[0] for broken in row["broken"]] == ["stretches of the drive"]
    assert row["told"]


def test_rows_of_the_same_sources_are_kept(tmp_path):
    file = tmp_path / "rows.jsonl"
    assert kept_rows(file, range(9)) == []
    mine = {"sources": sources(), "review": False}
    rows = [solved(1, "optimal", 1.0) | mine | other for other in ({}, {"sources": "others"}, {"review": True})]
    rows.append(solved(70, "optimal", 1.0) | mine)
    file.write_text("".join(json.dumps(row) + "\n" for row in rows) + '{"seed": 2, "strat', encoding="utf-8")
    assert kept_rows(file, range(9)) == rows[:1]


def test_what_is_done_is_not_done_again(tmp_path, monkeypatch):
    class Idle:
        def __init__(self, limit_s, is_review):
            pass

        def rows(self, seed, done):
            yield from (solved(seed, name, 1.0) for name in CALLS if name not in done)

        def close(self):
            pass

    monkeypatch.setattr(check_many, "Worker", Idle)
    file = tmp_path / "rows.jsonl"
    first = check_many.drive_all(file, range(2), 1, 1.0)
    assert len(first) == 2 * len(CALLS)
    again = check_many.drive_all(file, range(3), 2, 1.0)
    assert len(again) == 3 * len(CALLS)
    assert len(file.read_text().splitlines()) == 3 * len(CALLS)


@pytest.mark.parametrize("dies", [False, True])
def test_a_call_that_takes_too_long_is_stopped_and_the_next_one_made(monkeypatch, dies):
    """A worker whose `bellman` never answers, or kills its process."""
    worker, asked = check_many.Worker(limit_s=5.0, is_review=False), []

    def answers(seed, done):
        asked.append(set(done))
        for name in STRATEGIES:
            if name in done:
                continue
            yield {"seed": seed, "strategy": name, "begins": True}
            if name == "bellman":
                yield {"died": True}
                return
            yield solved(seed, name, 1.0)
        yield {"ready": True}

    monkeypatch.setattr(worker, "_answers", answers)
    rows = list(worker.rows(3, {"optimal"} if dies else set()))
    assert [row["strategy"] for row in rows] == [name for name in STRATEGIES if not (dies and name == "optimal")]
    assert [row["strategy"] for row in rows if row["status"] == "stopped"] == ["bellman"]
    assert asked[-1] >= {"optimal", "bellman"}


def test_the_table_counts():
    rows = [
        solved(0, "optimal", 1.0, reference=[["early", 1.0]]),
        solved(0, "bellman", 0.9, reference=[]),
        solved(1, "optimal", 1.0, BAD, reference=[["effort", 0.1]]),
        solved(1, "bellman", 0.5, BAD),
        {"seed": 2, "model": "m", "strategy": "", "status": "refused", "words": "x"},
        {"seed": 1, "model": "m", "strategy": "phases", "status": "refused", "words": "x", "seconds": 0.0},
        {"seed": 1, "model": "m", "strategy": "fastest", "status": "stopped", "seconds": 60.0},
        {"seed": 0, "model": "m", "strategy": "fastest", "status": "traceback", "seconds": 0.2, "words": "x"},
    ]
    lines = table(rows).splitlines()
    assert lines[0] == "scenarios: 3, of them refused before any strategy: 1; calls: 7"
    assert "| optimal | 2 | 2 | 1 | 0 | tractive power 1 |" in lines
    assert "| phases | 1 | 0 | 0 | 1 | none |" in lines
    assert "not finite: none" in lines
    assert "tracebacks: 1 (fastest 0)" in lines
    assert "stopped after the limit of time: 1 (fastest 1)" in lines
    assert "longest: 60.0 s (fastest 1), 0.2 s (fastest 0), 0.1 s (optimal 0)" in lines
    # the cheaper run of seed 1 breaks a rule
    assert "optimal dearer by over 0.1% than another run without a fault: 1 (optimal 0)" in lines
    assert lines[-1].endswith("both find a fault in 1 runs, ours alone in 0, the review's alone in 0")


def test_what_is_not_as_it_must_be_is_counted() -> None:
    good = {"seed": 1, "strategy": "optimal", "status": "solved", "broken": [], "told": False}
    rows = [
        good,
        good | {"broken": [["finite numbers", 1.0, 0.0, 0.0]]},
        good | {"broken": [["speed limits", 1.0, 0.0, 0.0]]},
        good | {"broken": [["stretches of the drive", 0.5, 0.0, 0.0]], "told": True},
        good | {"missed_s": 0.5},
        good | {"missed_s": 1e-4, "below": 1e-7},
        {"seed": 1, "strategy": "compare", "status": "compared", "missed_s": 0.0, "below": 0.01},
        good | {"status": "traceback", "words": "x"},
        good | {"status": "stopped"},
        good | {"status": "refused", "words": "y"},
        good | {"status": "refused", "words": "SolverError: the optimum was not found."},
    ]
    assert check_many.faults(rows) == {
        "not finite": 1,
        "a broken rule": 1,
        "an optimum not found": 1,
        "a window missed by an optimum": 1,
        "a bound above a run beside it": 1,
        "a traceback": 1,
        "over the limit of time": 1,
    }
    assert check_many.verdict(rows, range(3)).startswith("verdict: 1 of 3 scenarios, 11 calls: 1 not finite, ")


def test_no_scenario_is_begun_after_its_time(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(check_many, "Worker", lambda *given: pytest.fail("a worker was asked"))
    assert check_many.drive_all(tmp_path / "rows", range(3), 0, 1.0, until_s=0.0) == []


WIDE_SEEDS = range(60)


def test_the_wide_generator_draws_all_of_the_format() -> None:
    """Each part is drawn in some of 60 scenarios, and nearly all of them can be prepared."""
    found, prepared = set(), 0
    for seed in WIDE_SEEDS:
        document = any_wide_document(seed)
        try:
            task = timed_task(document, any_time(seed), seed)
        except RailjouleError:
            continue
        prepared += 1
        line, vehicle = document["line"], document["vehicle"]
        found |= set(line) | set(document["timetable"]) | set(vehicle) | set(vehicle["braking"])
        found |= set(vehicle["traction"]) | set(vehicle["drive"])
        found |= {key for station in line.get("stations", ()) for key in station}
        # the runs that the windows were drawn around keep the latest arrivals
        fastest = run_strategy(task, "fastest")
        for station in task.scenario.line.stations:
            assert arrival_s(fastest, station.position_m) <= station.window_s[1] + 1e-6
    assert prepared > 45
    assert found >= {"stations", "passing_points", "neutral_sections", "head_wind_kmh", "gradient_at", "curve"}
    assert found >= {"entry_speed_kmh", "exit_speed_kmh", "earliest_arrival_s", "latest_arrival_s", "least_switching_s"}
    assert found >= {"permitted_deceleration", "breakdown_speed_kmh", "friction_effort_kn"}


def test_a_missed_window_and_a_bound_above_a_run_are_found() -> None:
    """A run that is late by 4 s at its stop, and one whose bound is twice its energy."""
    run = load_run()
    stop_m = run.scenario.line.stations[0].position_m
    arrival = arrival_s(run, stop_m)
    assert 0 < arrival < run.travel_time_s
    early = [{"position_m": stop_m, "latest_arrival_s": arrival - 4.0}]
    late = replace(run, scenario=run.scenario.with_(**{"line.stations": early}))
    assert missed_s(run) == 0.0
    assert missed_s(late) == pytest.approx(4.0)
    assert promises(late)["missed_s"] == pytest.approx(4.0)
    # of a run that is not called optimal nothing is promised
    other = replace(late, strategy="fastest", bound=None)
    assert promises(other)["missed_s"] == 0.0
    above = replace(run, bound=replace(run.bound, energy_j=2 * run.energy.net_j))
    assert promises(above)["below"] == pytest.approx(0.5)
    assert promises(run)["below"] < 1e-6


def load_run():
    stations = [{"position_m": 1000.0}]
    return solve(plain_scenario({"line.stations": stations, "timetable.travel_time_s": 200.0}))
