import asyncio
import threading
from collections.abc import Iterator

import pytest
from bokeh.document import Document
from panel.io.state import set_curdoc
from turns import PATIENCE_S, Page

from railjoule.core import RailjouleError
from railjoule.core.budget import LIBRARY, PAGE, current_budget
from railjoule.dashboard.work import events
from railjoule.dashboard.work.worker import Study, Worker


class Gate:
    """A computation that waits until the test lets it go on."""

    def __init__(self) -> None:
        self.done: list[int] = []
        self.open = threading.Event()

    def __call__(self, request: int) -> int:
        assert self.open.wait(PATIENCE_S)
        self.done.append(request)
        if request < 0:
            raise RailjouleError(f"{request} is negative")
        if request == 13:
            raise RuntimeError("a defect")
        return 10 * request


def work(*requests: int) -> tuple[Gate, Page, list[int], list[str]]:
    """Ask for all requests at once, then let the page take its turns."""
    gate, page = Gate(), Page()
    taken: list[int] = []
    failures: list[str] = []
    worker = Worker(gate, taken.append, lambda failure: failures.append(str(failure)))
    with set_curdoc(page.document):
        for request in requests:
            worker.ask(request)
    gate.open.set()
    for _ in range(min(len(requests), 2)):
        page.take_turn()
    return gate, page, taken, failures


def test_of_what_is_asked_meanwhile_only_the_last_is_done() -> None:
    gate, _, taken, _ = work(1, 2, 3, 4)
    assert gate.done == [1, 4]
    assert taken == [10, 40]


@pytest.mark.parametrize("requests", [(1, 2), (-1, 2)])
def test_what_belongs_to_a_scenario_that_has_gone_is_dropped(requests: tuple[int, int]) -> None:
    gate, page, about = Gate(), Page(), [object()]
    taken: list[int] = []
    worker = Worker(gate, taken.append, pytest.fail, about=lambda: about[0])
    with set_curdoc(page.document):
        worker.ask(requests[0])
        about[0] = object()
        worker.ask(requests[1])
    gate.open.set()
    page.take_turn()
    assert taken == []
    page.take_turn()
    assert taken == [10 * requests[1]]


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


def test_a_page_that_cannot_take_an_error_still_gets_results_in_order() -> None:
    """Asked 1, 2 and 3, it got 3, then 2 (dashboard.md, D5)."""
    gate, page, taken = Gate(), Page(), []

    def fail(_: RailjouleError) -> None:
        raise ValueError("a defect of who watches")

    worker = Worker(gate, taken.append, fail)
    gate.open.set()
    with set_curdoc(page.document):
        worker.ask(-1)
        worker.ask(2)
    with pytest.raises(ValueError, match="who watches"):
        page.take_turn()
    with set_curdoc(page.document):
        worker.ask(3)
    page.take_turn()
    page.take_turn()
    assert taken == [20, 30]


def test_what_is_asked_for_while_a_result_is_taken_replaces_what_waits() -> None:
    gate, page, taken = Gate(), Page(), []

    def take(result: int) -> None:
        taken.append(result)
        if result == 10:
            worker.ask(3)

    worker = Worker(gate, take, lambda _: None)
    with set_curdoc(page.document):
        worker.ask(1)
        worker.ask(2)
    gate.open.set()
    page.take_turn()
    page.take_turn()
    assert taken == [10, 30]
    assert gate.done == [1, 3]


@pytest.mark.parametrize("kind", ["worker", "study"])
def test_a_page_is_asked_for_its_turn_by_the_event_loop_alone(kind: str) -> None:
    # a thread that asks a document for a turn while that gives free what it held may not be heard
    document, asked_by = Document(), []

    async def ask() -> None:
        asked = asyncio.Event()

        def note(_: object) -> None:
            asked_by.append(threading.current_thread())
            asked.set()

        document.add_next_tick_callback = note  # type: ignore[method-assign,assignment]
        with set_curdoc(document):
            if kind == "worker":
                Worker(lambda request: request, pytest.fail, pytest.fail).ask(1)
            else:
                Study(lambda request: iter([request]), pytest.fail, pytest.fail).ask(1)
        await asyncio.wait_for(asked.wait(), PATIENCE_S)

    asyncio.run(ask())
    assert set(asked_by) == {threading.current_thread()}


class Counting:
    """A study that counts up to its request, each step when the test lets it."""

    def __init__(self) -> None:
        self.steps = threading.Semaphore(0)
        self.ended = threading.Event()

    def __call__(self, request: int) -> Iterator[int]:
        try:
            for number in range(request):
                assert self.steps.acquire(timeout=PATIENCE_S)
                yield number
            if request > 2:
                raise RailjouleError("too far")
        finally:
            self.ended.set()


def test_results_of_a_study_come_as_they_are_ready() -> None:
    counting, page = Counting(), Page()
    taken: list[tuple[int, bool]] = []
    study = Study(counting, lambda number, last: taken.append((number, last)), pytest.fail)
    with set_curdoc(page.document):
        study.ask(2)
    counting.steps.release()
    page.take_turn()
    assert taken == [(0, False)]
    assert study.busy
    counting.steps.release()
    assert counting.ended.wait(PATIENCE_S)
    while study.busy:
        page.take_turn()
    assert taken[-1] == (1, True)


def test_a_stopped_study_ends_and_says_no_more() -> None:
    counting, page = Counting(), Page()
    taken: list[int] = []
    study = Study(counting, lambda number, _: taken.append(number), pytest.fail)
    with set_curdoc(page.document):
        study.ask(2)
    counting.steps.release()
    page.take_turn()
    study.stop()
    counting.steps.release(5)
    assert counting.ended.wait(PATIENCE_S)
    assert taken == [0]
    assert not study.busy


def test_a_new_request_ends_the_study_before() -> None:
    taken: list[int] = []
    study = Study(lambda request: iter([request]), lambda number, _: taken.append(number), pytest.fail)
    first, page = Counting(), Page()
    study._steps = lambda request: first(request) if request == 2 else iter([request])  # type: ignore[assignment]
    with set_curdoc(page.document):
        study.ask(2)
        study.ask(7)
    first.steps.release(5)
    while study.busy:
        page.take_turn()
    assert set(taken) == {7}


def test_an_error_of_a_study_is_told() -> None:
    counting = Counting()
    counting.steps.release(9)
    taken: list[int] = []
    failures: list[str] = []
    study = Study(counting, lambda number, _: taken.append(number), lambda error: failures.append(str(error)))
    study.ask(3)
    assert taken == [0, 1, 2]
    assert failures == ["too far"]
    assert not study.busy


@pytest.mark.parametrize("error", [MemoryError, RecursionError])
def test_work_that_takes_too_much_is_told_even_without_a_page(error: type[Exception]) -> None:
    def compute(_: int) -> int:
        raise error

    failures: list[str] = []
    Worker(compute, pytest.fail, lambda failure: failures.append(str(failure))).ask(1)
    assert len(failures) == 1
    assert ("more memory than the server has" in failures[0]) == (error is MemoryError)


def test_pages_compute_within_their_own_budget() -> None:
    budgets = []
    Worker(lambda _: current_budget(), budgets.append, pytest.fail).ask(1)
    Study(lambda _: iter([current_budget()]), lambda budget, _: budgets.append(budget), pytest.fail).ask(1)
    assert set(map(id, budgets)) == {id(PAGE)}
    assert current_budget() is LIBRARY


def test_slow_work_keeps_no_short_work_waiting() -> None:
    gate, page = Gate(), Page()
    taken: list[int] = []
    slow = [Worker(gate, taken.append, pytest.fail, is_slow=lambda _: True) for _ in range(4)]
    with set_curdoc(page.document):
        for worker in slow:
            worker.ask(1)
        Worker(lambda request: request, taken.append, pytest.fail).ask(2)
    page.take_turn()
    assert taken == [2]
    gate.open.set()
    for _ in slow:
        page.take_turn()
    assert taken == [2, 10, 10, 10, 10]


@pytest.mark.parametrize("slow", [False, True])
def test_who_waits_for_short_work_is_known_until_it_is_taken(slow: bool) -> None:
    gate, page = Gate(), Page()
    worker = Worker(gate, lambda _: None, pytest.fail, is_slow=lambda _: slow)
    with set_curdoc(page.document):
        worker.ask(1)
    assert events.WAITS.someone_waits(PATIENCE_S) is not slow
    gate.open.set()
    page.take_turn()
    assert not events.WAITS.someone_waits(PATIENCE_S)
