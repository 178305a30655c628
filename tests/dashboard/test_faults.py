"""Errors of this program in a session's log."""

import gc
import logging
import weakref
from functools import partial

import pytest
from bokeh.document import Document
from panel.io.state import set_curdoc

from railjoule.dashboard import faults
from railjoule.dashboard.browser import Browser
from railjoule.dashboard.day import Day
from railjoule.dashboard.faults import MOST_KNOWN, Faults
from railjoule.dashboard.state.scenario import ScenarioModel


def failure(field: str, value: object) -> Exception:
    """Return what param raises, from one line of its own for all fields."""
    try:
        setattr(Day(ScenarioModel()), field, value)
    except ValueError as error:
        return error
    raise AssertionError


def test_two_errors_of_one_line_of_a_library_are_both_logged(caplog: pytest.LogCaptureFixture) -> None:
    """The second was lost (dashboard.md, D4)."""
    known = Faults(lambda _: None)
    with caplog.at_level(logging.ERROR):
        for field in ("seed", "coordinate_error_m", "seed"):
            known.note(failure(field, "much"), "a change failed")
    told = [str(record.exc_info[1]) for record in caplog.records if record.exc_info]
    assert len(told) == 2
    assert "seed" in told[0]
    assert "coordinate_error_m" in told[1]


def test_a_message_that_always_changes_does_not_fill_the_log(caplog: pytest.LogCaptureFixture) -> None:
    known = Faults(lambda _: None)
    with caplog.at_level(logging.ERROR):
        for number in range(2 * MOST_KNOWN):
            known.note(ValueError(str(number)), "a change failed")
    assert len(caplog.records) == MOST_KNOWN


def test_who_waits_for_an_idle_browser_is_called_after_one_that_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    """Charts below stayed sketches for ever (dashboard.md, D11)."""
    called: list[str] = []
    monkeypatch.setattr(Browser, "_send_msg", lambda *_: None)
    monkeypatch.setattr(faults.LOG, "error", lambda *_, **details: called.append(str(details["exc_info"])))

    def fail() -> None:
        raise ValueError("a defect")

    browser = Browser()
    browser.when_idle(fail)
    browser.when_idle(lambda: called.append("next"))
    browser._handle_msg({"kind": "idle"})
    assert called == ["a defect", "next"]


def test_a_session_that_reaches_its_document_is_freed_with_it() -> None:
    """Every page that was closed stayed in memory, 5 MB each."""
    document = Document()
    with set_curdoc(document):
        known = Faults(partial(setattr, document, "title"))
        faults.handle(ValueError("much"))
    assert document.title == faults.SENTENCE
    freed = weakref.ref(document)
    del document, known
    gc.collect()
    assert freed() is None
