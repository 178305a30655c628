from collections.abc import Iterator

import pytest

from railjoule.core import SolverError
from railjoule.core.validation import COMPARISONS, Comparison, Row, Table
from railjoule.dashboard.models.workbench import Workbench
from railjoule.dashboard.papers import Papers

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
