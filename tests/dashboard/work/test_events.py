"""One line for each event, without anything that would let others speak for a session."""

import logging
import re
import sys
from collections.abc import Iterator
from types import SimpleNamespace

import pytest
from bokeh.document import Document

from railjoule.core import RailjouleError
from railjoule.dashboard.work import events
from railjoule.dashboard.work.events import Dated, Waits, write_down

SECRET = "a-session-of-forty-letters-and-more-secret"
LINE = re.compile(r"(\w+) session=([0-9a-f]{8}) page=Set-speeds duration_s=\d+\.\d{3}( cells=460)? (ok|refused)")


class SessionDocument(Document):
    """One that a session has."""

    session_context = SimpleNamespace(id=SECRET)


def test_each_event_is_one_line(caplog: pytest.LogCaptureFixture) -> None:
    document = SessionDocument()
    with caplog.at_level(logging.INFO, "railjoule"):
        events.begin(document, lambda: "Set speeds", 0.0)
        events.worked(document, "compute_runs", 0.04, SimpleNamespace(cell_count=460))
        events.worked(document, "compute_runs", 0.01, RailjouleError("too slow\nnext line"))
        events.end(document)
        # a second end of the same page, or a page that never began, is no event
        events.end(document)
        events.end(None)
    found = [LINE.fullmatch(record.getMessage()) for record in caplog.records]
    assert all(found)
    assert [(one[1], one[3], one[4]) for one in found if one] == [
        ("opened", None, "ok"),
        ("compute_runs", " cells=460", "ok"),
        ("compute_runs", None, "refused"),
        ("closed", None, "ok"),
    ]
    assert SECRET not in caplog.text


def test_who_has_waited_too_long_is_taken_for_gone(monkeypatch: pytest.MonkeyPatch) -> None:
    waits, page, now_s = Waits(), SimpleNamespace, [100.0]
    monkeypatch.setattr(events.time, "monotonic", lambda: now_s[0])
    waits.wait(page)
    now_s[0] += 0.4
    assert waits.someone_waits(0.5)
    now_s[0] += 0.2
    assert not waits.someone_waits(0.5)
    waits.wait(page)
    assert waits.someone_waits(0.5)
    waits.settle(page)
    waits.settle(page)
    assert not waits.someone_waits(0.5)


@pytest.fixture
def _as_before() -> Iterator[None]:
    """Give the loggers back what they had."""
    root, own = logging.getLogger(), logging.getLogger("railjoule")
    handlers, level = list(root.handlers), own.level
    # one that another test has left writes to a stream that is closed
    root.handlers[:] = [handler for handler in handlers if not isinstance(handler, Dated)]
    yield
    root.handlers[:] = handlers
    own.setLevel(level)


@pytest.mark.usefixtures("_as_before")
def test_each_line_is_written_once_with_its_time(capsys: pytest.CaptureFixture[str]) -> None:
    write_down()
    write_down()
    for handler in logging.getLogger().handlers:
        if isinstance(handler, Dated):
            handler.setStream(sys.stderr)
    logging.getLogger("railjoule.dashboard.work.events").info("closed page=Drive")
    # a library whose logger no other test has changed
    logging.getLogger("a_library").warning("404 GET /nope")
    lines = capsys.readouterr().err.splitlines()
    date = r"\d{4}-\d\d-\d\d \d\d:\d\d:\d\d"
    assert [bool(re.fullmatch(f"{date} (closed page=Drive|404 GET /nope)", line)) for line in lines] == [True, True]
