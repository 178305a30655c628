import threading
from concurrent.futures import BrokenExecutor
from typing import Any

import pytest
from builders import plain_scenario

from railjoule.core.studies.sweep import MemoryResults, make_study
from railjoule.dashboard.pages.explore import running
from railjoule.dashboard.pages.explore.running import LOST, Progress, Step, run_in_steps
from railjoule.dashboard.work.study_pool import RUNS

LOAD = {"vehicle.load_factor": (0.0, 1.0)}


def sweep_of(runs: int = 40) -> MemoryResults:
    return MemoryResults(make_study(plain_scenario({"solver.mesh_m": 50.0}), LOAD, runs))


def last_step(sweep: MemoryResults) -> Step:
    return list(run_in_steps(sweep, threading.Event(), here=True))[-1]


def test_the_progress_of_a_study_is_given_from_its_first_to_its_last_run() -> None:
    sweep = sweep_of()
    steps = list(run_in_steps(sweep, threading.Event(), here=True))
    assert steps[0].progress == Progress("running", 0, 40)
    assert steps[-1].progress.state == "done"
    assert steps[-1].progress.done == steps[-1].progress.runs == sweep.done == 40
    assert steps[-1].table.rows == 40


@pytest.mark.parametrize("by_page", [False, True])
def test_a_study_that_was_stopped_goes_on_with_the_rest(monkeypatch: pytest.MonkeyPatch, by_page: bool) -> None:
    monkeypatch.setattr(running, "STEP_S", 0.01)
    sweep, stop = sweep_of(600), threading.Event()
    steps = run_in_steps(sweep, stop, here=True)
    found = next(step for step in steps if step.progress.done)
    if by_page:
        # the page has gone: nobody asks for further steps
        steps.close()  # type: ignore[attr-defined]
    else:
        stop.set()
        found = list(steps)[-1]
        assert found.progress.state == "stopped"
    assert 0 < sweep.done < 600
    assert last_step(sweep).progress.state == "done"
    assert sweep.done == 600


def test_a_study_that_was_stopped_before_its_turn_has_no_step() -> None:
    stop = threading.Event()
    stop.set()
    assert list(run_in_steps(sweep_of(), stop, here=True)) == []


@pytest.mark.parametrize("error", [BrokenExecutor("gone"), MemoryError()])
def test_whatever_fails_is_said_in_a_sentence(monkeypatch: pytest.MonkeyPatch, error: Exception) -> None:
    def fail(*_: Any, **__: Any) -> None:
        raise error

    monkeypatch.setattr(running, "run_study", fail)
    found = last_step(sweep_of()).progress
    assert found.state == "failed"
    assert found.message.endswith(".")
    if isinstance(error, BrokenExecutor):
        assert found.message == LOST


@pytest.mark.nightly
def test_a_dead_worker_loses_nothing_that_was_done(monkeypatch: pytest.MonkeyPatch) -> None:
    """Worker processes of the server: one of them is killed in the middle, and others do the rest."""
    monkeypatch.setattr(running, "STEP_S", 0.05)
    sweep = sweep_of(2000)
    steps = run_in_steps(sweep, threading.Event())
    next(step for step in steps if step.progress.done)
    for process in list(RUNS.executor()._processes.values()):  # type: ignore[attr-defined]
        process.kill()
    found = list(steps)[-1].progress
    assert (found.state, found.message) == ("failed", LOST)
    assert 0 < sweep.done < 2000
    assert list(run_in_steps(sweep, threading.Event()))[-1].progress.state == "done"
    assert sweep.done == 2000
    RUNS.renew()


def test_the_rest_takes_as_long_as_the_rate_tells() -> None:
    assert Progress("running", 300, 1000, 70.0).left_s == 10.0
    assert Progress("running", 0, 1000, None).left_s is None
    assert Progress("stopping").is_under_way
    assert not Progress("failed").is_under_way
