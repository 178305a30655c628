"""The script that drives many scenarios: some of its scenarios, and the counts that decide its exit status."""

import json
from dataclasses import replace

import pytest

from railjoule.core.kernel_cache import source_hash
from railjoule.core.strategies import STRATEGIES
from tests import check_many
from tests.any_scenarios import any_full_document
from tests.check_many import CALLS, calls, faults, kept_rows, table, verdict

GOOD = {"seed": 1, "strategy": "optimal", "status": "solved", "broken": [], "told": False, "energy_kwh": 1.0,
        "time_s": 100.0, "seconds": 0.1}  # fmt: skip


@pytest.mark.parametrize("seed", range(6))
def test_runs_over_the_whole_format_are_without_fault(seed):
    """A scenario of each drive, with windows of arrival, neutral sections, speeds at the ends."""
    rows = list(calls(seed))
    assert not any(faults(rows).values()), verdict(rows, range(1))
    assert [row["strategy"] for row in rows] in ([""], list(CALLS))
    json.dumps(rows, default=float)


def test_a_traceback_is_a_row(monkeypatch):
    monkeypatch.setitem(STRATEGIES, "optimal", replace(STRATEGIES["optimal"], run=lambda task: 1 / 0))
    row = next(row for row in calls(0) if row["strategy"] == "optimal")
    assert row["status"] == "traceback"
    assert "ZeroDivisionError: division by zero" in row["words"]


def test_a_run_that_is_switched_too_often_says_so(monkeypatch):
    """Seed 695 leaves 0.15 s over the shortest time, and a limit of half a metre for which the drive would brake."""
    monkeypatch.setattr(check_many, "any_placed_document", any_full_document)
    monkeypatch.setattr(check_many, "add_windows", lambda *given: None)
    monkeypatch.setattr(check_many, "CALLS", ("optimal",))
    (row,) = calls(695)
    assert [broken[0] for broken in row["broken"]] == ["stretches of the drive"]
    assert row["told"]


def test_rows_of_the_same_sources_are_kept(tmp_path):
    file = tmp_path / "rows.jsonl"
    assert kept_rows(file, range(9)) == []
    mine = {"sources": source_hash()}
    rows = [GOOD | mine, GOOD | {"sources": "others"}, GOOD | mine | {"seed": 70}]
    file.write_text("".join(json.dumps(row) + "\n" for row in rows) + '{"seed": 2, "strat', encoding="utf-8")
    assert kept_rows(file, range(9)) == rows[:1]


def test_faults_are_counted():
    bad = [
        GOOD | {"broken": [["finite numbers", 1.0, 0.0, 0.0]]},
        GOOD | {"broken": [["speed limits", 1.0, 0.0, 0.0]]},
        GOOD | {"status": "refused", "words": "SolverError: the optimum was not found."},
        GOOD | {"missed_s": 0.5},
        {"seed": 1, "strategy": "compare", "status": "compared", "missed_s": 0.0, "below": 0.01},
        GOOD | {"status": "traceback", "words": "x"},
        GOOD | {"status": "stopped"},
    ]
    good = [
        GOOD,
        GOOD | {"broken": [["stretches of the drive", 0.5, 0.0, 0.0]], "told": True},
        GOOD | {"missed_s": 1e-4, "below": 1e-7},
        GOOD | {"status": "refused", "words": "y"},
        GOOD | {"strategy": "bellman", "energy_kwh": 0.9},
    ]
    assert set(faults(bad + good).values()) == {1}
    assert len(faults(bad)) == len(bad)
    lines = table(bad + good).splitlines()
    assert "| optimal | 10 | 6 | 4 | 2 | finite numbers 1, speed limits 1 |" in lines
    assert lines[-1].startswith("optimal dearer by over 0.1% than another run without a fault: 6 (optimal 1")
