"""One line for each event, without anything that would let others speak for a session."""

import logging
import re
import threading
from concurrent.futures import ThreadPoolExecutor
from types import SimpleNamespace

import pytest
from bokeh.document import Document

from railjoule.core import RailjouleError
from railjoule.dashboard.work import events
from railjoule.dashboard.work.events import Tally

SECRET = "a-session-of-forty-letters-and-more-secret"
LINE = re.compile(r"(\w+) session=([0-9a-f]{8}) page=Speed-limits duration_s=\d+\.\d{3}( cells=460)? (ok|refused)")


class SessionDocument(Document):
    """One that a session has."""

    session_context = SimpleNamespace(id=SECRET)


def test_each_event_is_one_line(caplog: pytest.LogCaptureFixture) -> None:
    document, before = SessionDocument(), events.TALLY.sessions
    with caplog.at_level(logging.INFO, "railjoule"):
        events.begin(document, lambda: "Speed limits", 0.0)
        assert events.TALLY.sessions == before + 1
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
    assert events.TALLY.sessions == before


def test_the_percentile_is_of_the_last_pieces_alone() -> None:
    tally = Tally()
    for _ in range(events.MOST_REMEMBERED):
        tally.took("slow", "ok", 9.0)
    for number in range(events.MOST_REMEMBERED):
        tally.took("slow", "ok", number / events.MOST_REMEMBERED)
    assert tally.percentiles_s(0.95) == {"slow": 0.95}
    assert tally.counts["slow", "ok"] == 2 * events.MOST_REMEMBERED


def test_work_is_in_the_queue_until_it_is_done() -> None:
    tally, gate = Tally(), threading.Event()
    with ThreadPoolExecutor(1) as pool:
        for _ in range(3):
            tally.queue(pool.submit(gate.wait, 20))
        assert tally.queued == 3
        gate.set()
    assert tally.queued == 0


def test_who_has_waited_too_long_is_taken_for_gone(monkeypatch: pytest.MonkeyPatch) -> None:
    tally, page, now_s = Tally(), SimpleNamespace, [100.0]
    monkeypatch.setattr(events.time, "monotonic", lambda: now_s[0])
    tally.wait(page)
    now_s[0] += 0.4
    assert tally.someone_waits(0.5)
    now_s[0] += 0.2
    assert not tally.someone_waits(0.5)
    tally.wait(page)
    assert tally.someone_waits(0.5)
    tally.settle(page)
    tally.settle(page)
    assert not tally.someone_waits(0.5)
