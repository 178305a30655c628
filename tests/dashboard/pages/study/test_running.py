import threading
from concurrent.futures import BrokenExecutor
from typing import Any

import pytest
from builders import plain_scenario

from railjoule.core.studies.sweep import MemoryResults, make_study
from railjoule.dashboard.pages.study import running
from railjoule.dashboard.pages.study.model import Progress
from railjoule.dashboard.pages.study.running import LOST, WAITS, Running
from railjoule.dashboard.work.study_pool import RUNS, STUDY_THREADS

LOAD = {"vehicle.load_factor": (0.0, 1.0)}


class Page:
    """Takes its turns at once, and remembers what it has heard."""

    def __init__(self) -> None:
        self.heard: list[tuple[Progress, Any]] = []

    def hear(self, progress: Progress, table: Any) -> None:
        self.heard.append((progress, table))

    @property
    def last(self) -> Progress:
        return self.heard[-1][0]

    @property
    def states(self) -> list[str]:
        return [progress.state for progress, _ in self.heard]


def run_of(page: Page, runs: int = 40) -> tuple[Running, MemoryResults]:
    results = MemoryResults(make_study(plain_scenario(), LOAD, runs))
    return Running(results, page.hear, lambda turn: turn()), results


def test_a_study_is_told_from_its_first_to_its_last_run() -> None:
    page = Page()
    made, results = run_of(page)
    made.do(here=True)
    assert page.states[0] == "running"
    assert page.last.state == "done"
    assert page.last.done == page.last.runs == results.done == 40
    assert page.heard[-1][1].rows == 40


def test_a_study_that_was_stopped_goes_on_with_the_rest(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(running, "TOLD_EVERY_S", 0.0)
    page = Page()
    made, results = run_of(page, 1500)
    hear = page.hear

    def stop_soon(progress: Progress, table: Any) -> None:
        hear(progress, table)
        if progress.done:
            made.stop()

    page.hear = stop_soon  # type: ignore[method-assign]
    made._hear = stop_soon
    made.do(here=True)
    before = results.done
    assert page.last.state == "stopped"
    assert 0 < before < 1500
    again = Running(results, hear, lambda turn: turn())
    again.do(here=True)
    assert page.last.state == "done"
    assert results.done == 1500


def test_a_study_waits_for_the_one_before_and_may_be_stopped_meanwhile() -> None:
    go_on = threading.Event()
    STUDY_THREADS.submit(go_on.wait)
    page = Page()
    made, results = run_of(page)
    made.begin()
    try:
        assert page.last == Progress("waiting", 0, 40, None, WAITS)
        made.stop()
        assert page.last.state == "stopped"
    finally:
        go_on.set()
    assert results.done == 0


@pytest.mark.parametrize("error", [BrokenExecutor("gone"), MemoryError()])
def test_whatever_fails_is_told_in_a_sentence(monkeypatch: pytest.MonkeyPatch, error: Exception) -> None:
    def fail(*_: Any, **__: Any) -> None:
        raise error

    monkeypatch.setattr(running, "run_study", fail)
    page = Page()
    run_of(page)[0].do(here=True)
    assert page.last.state == "failed"
    assert page.last.told.endswith(".")
    if isinstance(error, BrokenExecutor):
        assert page.last.told == LOST


def test_a_dead_worker_loses_nothing_that_was_done() -> None:
    """Worker processes of the server: one of them is killed in the middle, and others do the rest."""
    page, killed = Page(), threading.Event()
    made, results = run_of(page, 2000)
    hear = page.hear

    def kill(progress: Progress, table: Any) -> None:
        hear(progress, table)
        if progress.done and not killed.is_set():
            killed.set()
            for process in list(RUNS.executor()._processes.values()):  # type: ignore[attr-defined]
                process.kill()

    made._hear = kill
    made.do()
    assert killed.is_set()
    assert page.last.state == "failed"
    assert page.last.told == LOST
    before = results.done
    assert 0 < before < 2000
    Running(results, hear, lambda turn: turn()).do()
    assert page.last.state == "done"
    assert results.done == 2000
    RUNS.renew()
