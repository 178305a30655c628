import threading
from collections.abc import Callable

import numpy as np
import pytest
from bokeh.document import Document
from panel.io.state import set_curdoc

from railjoule.core import RailjouleError, StrategyRefusedError, TimetableError, load_scenario, solve
from railjoule.dashboard.store import RunsWish, TradeOffWish, Worker, compute_runs, compute_trade_off

PATIENCE_S = 20.0


def test_runs_bear_the_bound_of_the_optimum() -> None:
    runs = compute_runs(RunsWish(load_scenario("ftorek-300s"), ("eoc", "enoc")))
    assert list(runs.runs) == ["optimal", "eoc", "enoc"]
    assert all(run.bound is runs.runs["optimal"].bound for run in runs.runs.values())


def test_a_strategy_that_refuses_says_why_and_the_others_run() -> None:
    runs = compute_runs(RunsWish(load_scenario("liashenko-ii"), ("eoc", "fastest")))
    assert list(runs.runs) == ["optimal", "fastest"]
    assert "copper loss" in runs.refused["eoc"]


def test_a_timetable_that_cannot_be_kept_is_refused() -> None:
    scenario = load_scenario("ftorek-300s").with_(**{"timetable.travel_time_s": 100.0})
    with pytest.raises(TimetableError, match="shortest"):
        compute_runs(RunsWish(scenario, ()))


def test_the_trade_off_agrees_with_single_solutions() -> None:
    scenario = load_scenario("ftorek-300s")
    trade_off = compute_trade_off(TradeOffWish(scenario, 400.0, wide_map=False, copper_weight=1.0))
    assert trade_off.enoc is not None
    assert trade_off.enoc_map is not None
    time = trade_off.frontier.travel_time_s[30]
    single = scenario.with_(**{"timetable.travel_time_s": float(time)})
    assert trade_off.frontier.energy_kwh[30] == pytest.approx(solve(single).energy_kwh, rel=1e-4)
    assert trade_off.enoc.energy_kwh[30] == pytest.approx(solve(single, strategy="enoc").energy_kwh, rel=1e-3)
    taken = np.isfinite(trade_off.enoc.energy_kwh)
    assert np.all(trade_off.enoc.energy_kwh[taken] >= trade_off.frontier.energy_kwh[taken] * (1 - 1e-4))
    assert trade_off.enoc.refused
    for refused, _ in trade_off.enoc.refused:
        with pytest.raises(StrategyRefusedError):
            solve(scenario.with_(**{"timetable.travel_time_s": refused}), strategy="enoc")
    lowest = np.nanmin(trade_off.enoc_map.energy_kwh, axis=0)
    assert np.all(trade_off.enoc_map.best_energy_kwh <= lowest * (1 + 1e-9))


def test_without_enoc_there_is_a_frontier_but_no_map() -> None:
    trade_off = compute_trade_off(TradeOffWish(load_scenario("liashenko-i"), 200.0, wide_map=False, copper_weight=1.0))
    assert trade_off.enoc_map is None
    assert "copper loss" in trade_off.refusal
    assert np.all(np.diff(trade_off.frontier.energy_kwh) < 0)


class Page:
    """A document whose turns the test takes itself."""

    def __init__(self) -> None:
        self.document = Document()
        self._turns: list[Callable[[], None]] = []
        self._due = threading.Semaphore(0)
        self.document.add_next_tick_callback = self._note  # type: ignore[method-assign,assignment]

    def _note(self, callback: Callable[[], None]) -> None:
        self._turns.append(callback)
        self._due.release()

    def take_turn(self) -> None:
        assert self._due.acquire(timeout=PATIENCE_S)
        with set_curdoc(self.document):
            self._turns.pop(0)()


class Gate:
    """A computation that waits until the test lets it go on."""

    def __init__(self) -> None:
        self.done: list[int] = []
        self.open = threading.Event()

    def __call__(self, wish: int) -> int:
        assert self.open.wait(PATIENCE_S)
        self.done.append(wish)
        if wish < 0:
            raise RailjouleError(f"{wish} is negative")
        if wish == 13:
            raise RuntimeError("a defect")
        return 10 * wish


def work(*wishes: int) -> tuple[Gate, Page, list[int], list[str]]:
    """Ask for all wishes at once, then let the page take its turns."""
    gate, page = Gate(), Page()
    taken: list[int] = []
    failures: list[str] = []
    worker = Worker(gate, taken.append, lambda failure: failures.append(str(failure)))
    with set_curdoc(page.document):
        for wish in wishes:
            worker.ask(wish)
    gate.open.set()
    for _ in range(min(len(wishes), 2)):
        page.take_turn()
    return gate, page, taken, failures


def test_of_what_is_asked_meanwhile_only_the_last_is_done() -> None:
    gate, _, taken, _ = work(1, 2, 3, 4)
    assert gate.done == [1, 4]
    assert taken == [10, 40]


def test_an_error_that_the_user_can_mend_is_told_and_work_goes_on() -> None:
    _, _, taken, failures = work(-1, 2)
    assert failures == ["-1 is negative"]
    assert taken == [20]


def test_a_defect_is_logged_not_shown(caplog: pytest.LogCaptureFixture) -> None:
    _, _, taken, failures = work(13, 2)
    assert "a defect" in caplog.text
    assert len(failures) == 1
    assert "a defect" not in failures[0]
    assert taken == [20]


def test_without_a_page_work_is_done_at_once() -> None:
    gate = Gate()
    gate.open.set()
    taken: list[int] = []
    Worker(gate, taken.append, pytest.fail).ask(5)
    assert taken == [50]
