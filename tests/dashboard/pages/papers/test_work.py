from collections.abc import Iterator

import pytest
from panel.io.state import set_curdoc
from turns import Page

from railjoule.core import SolverError
from railjoule.core.validation import COMPARISONS, Comparison, Row, Table, Validation
from railjoule.dashboard.pages.papers.compute import PaperTables, ShippedTables
from railjoule.dashboard.pages.papers.work import Papers
from railjoule.dashboard.state.workbench import Workbench

TABLE = Table("One table", (Row("case", "W", "Wh", 2.0, 2.1, "Because."),), "Table 1")


@pytest.fixture
def state(monkeypatch: pytest.MonkeyPatch) -> Iterator[Workbench]:
    """A workbench with one paper of two tables that cost nothing, and one that fails."""

    def fail() -> Table:
        raise SolverError("It was not found.")

    monkeypatch.setitem(COMPARISONS, "ftorek", lambda: Comparison("ftorek", "F", (lambda: TABLE, lambda: TABLE), ()))
    monkeypatch.setitem(COMPARISONS, "rawicki", lambda: Comparison("rawicki", "R", (fail,), ()))
    state = Workbench()
    papers = Papers(state)
    yield state
    papers.end()


def test_a_paper_is_compared_on_request(state: Workbench) -> None:
    steps: list[int] = []
    state.papers.param.watch(lambda event: steps.append(len(event.new["ftorek"].validation.tables)), "results")
    assert state.papers.results == {}
    state.papers.compare = ["ftorek"]
    assert steps[:3] == [0, 1, 2]
    assert state.papers.results["ftorek"].complete
    assert state.papers.asked == []


def test_a_failure_is_told_and_what_is_done_stands(state: Workbench) -> None:
    state.papers.compare = ["ftorek", "rawicki"]
    assert str(state.papers.failure) == "It was not found."
    assert state.papers.results["ftorek"].complete
    assert state.papers.asked == []
    state.papers.compare = ["ftorek"]
    assert state.papers.failure is None


def test_the_page_begins_with_what_is_shipped(state: Workbench, monkeypatch: pytest.MonkeyPatch) -> None:
    paper = compute_shipped("ftorek", complete=True)
    for current in (True, False):
        monkeypatch.setattr(
            "railjoule.dashboard.pages.papers.work.shipped_tables", lambda c=current: ShippedTables(paper, c)
        )
        fresh = Workbench()
        papers = Papers(fresh)
        fresh.page = "Papers"
        assert fresh.papers.results["ftorek"].complete
        assert fresh.papers.is_current == current
        papers.end()


def compute_shipped(name: str, complete: bool) -> dict[str, PaperTables]:
    """Return a paper of one table."""
    validation = Validation(name, "", (TABLE,), ())
    return {name: PaperTables(name, validation, 1 if complete else 2)}


def test_a_paper_stands_until_it_is_whole_again(state: Workbench) -> None:
    state.papers.results = compute_shipped("ftorek", complete=True)
    counts: list[int] = []
    state.papers.param.watch(lambda event: counts.append(len(event.new["ftorek"].validation.tables)), "results")
    state.papers.compare = ["ftorek"]
    assert set(counts) <= {1, 2}
    assert len(state.papers.under_way["ftorek"].validation.tables) == 2
    assert state.papers.results["ftorek"].step_count == 2


def test_a_stopped_paper_takes_nothing_more(state: Workbench) -> None:
    page = Page()
    with set_curdoc(page.document):
        state.papers.compare = ["ftorek"]
        assert state.papers.asked == ["ftorek"]
        state.papers.param.trigger("stop")
    assert state.papers.asked == []
    while page.is_due:
        page.take_turn()
    assert state.papers.results == {}
