"""The quick rows of `python -m tests.trust`, each as a test."""

from collections.abc import Iterator

import pytest
from browser.server import Server, serving

from tests.trust import commands, floors, served, texts
from tests.trust.rows import Found, Row, outcome, table

PLAIN = [row for row in (*texts.ROWS, *commands.ROWS, *floors.ROWS) if row.quick]
SERVED = [row.name for row in served.rows(Server(None, 0)) if row.quick]  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def asked() -> Iterator[dict[str, Row]]:
    """The rows of a server of their own."""
    with serving(*served.COMMAND) as server:
        yield {row.name: row for row in served.rows(server)}


@pytest.mark.parametrize("row", PLAIN, ids=lambda row: row.name)
def test_a_row(row: Row) -> None:
    found = outcome(row)
    assert found.good, found.words


@pytest.mark.parametrize("name", SERVED)
def test_a_row_of_a_server(asked: dict[str, Row], name: str) -> None:
    found = outcome(asked[name])
    assert found.good, found.words


def test_the_table_tells_an_error_and_a_fault() -> None:
    def fail() -> Found:
        raise ValueError("no server")

    lines: list[str] = []
    rows = (Row("9", "a", "b", lambda: Found("c", True)), Row("9", "d", "e", fail))
    assert not table(rows, lines.append)
    assert lines[2].startswith("| 9 | a | b | c (")
    assert lines[2].endswith("| good |")
    assert "ValueError: no server" in lines[3]
    assert lines[3].endswith("| FAULT |")
    assert table(rows[:1], lines.append)


def test_a_floor_is_seen_where_it_is_not_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(floors, "FLOORS", (floors.Floor("tornado", "999.0", "CVE-1"),))
    assert [words.split(" is below")[0].split(":")[0] for words in floors.below()] == [
        "pyproject.toml",
        "constraints.txt",
    ]
    assert floors.parts("6.10.1") > floors.parts("6.9")
    assert floors.allowed()["tornado"] == "6.6.1"
