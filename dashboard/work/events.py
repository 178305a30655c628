"""Events of the pages of this process: a line of the log for each, and the pages that wait for a result.

A message to a page that was closed in the meantime is no error, although the libraries log it as one.
"""

import hashlib
import logging
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TextIO
from weakref import WeakKeyDictionary

from bokeh.document import Document
from tornado.iostream import StreamClosedError
from tornado.websocket import WebSocketClosedError

from railjoule.dashboard.library_workarounds import session_document

LOG = logging.getLogger(__name__)
ID_DIGITS = 8


@dataclass(frozen=True)
class Visit:
    """One open page: what the log calls its session, which page is in sight, when it began [s]."""

    session: str
    page: Callable[[], str]
    began_s: float


class Waits:
    """Pages that wait for a short piece of work; used only on the event loop."""

    def __init__(self) -> None:
        self._waiting: WeakKeyDictionary[object, float] = WeakKeyDictionary()

    def wait(self, who: object) -> None:
        """Take note that a page waits for a short piece of work."""
        self._waiting[who] = time.monotonic()

    def settle(self, who: object) -> None:
        """Take note that it has what it waited for."""
        self._waiting.pop(who, None)

    def someone_waits(self, longest_s: float) -> bool:
        """Return whether a page waits that has not waited longer than this [s]: one that has may be gone."""
        since = time.monotonic() - longest_s
        return any(began_s > since for began_s in self._waiting.values())


WAITS = Waits()
VISITS: WeakKeyDictionary[Document, Visit] = WeakKeyDictionary()


def begin(document: Any, page: Callable[[], str], began_s: float) -> None:
    """Take note that a page has opened.

    Parameters
    ----------
    document : Document or None
        Its own; without one there is nothing to note.
    page : callable
        Returns the name of the page in sight.
    began_s : float
        When it began to open, of `time.monotonic` [s].
    """
    if document is None or document.session_context is None:
        return
    # anyone with the whole name of a session can act in its place, and logs are read by others
    name = hashlib.sha256(str(document.session_context.id).encode()).hexdigest()[:ID_DIGITS]
    visit = VISITS[document] = Visit(name, page, time.monotonic())
    write("opened", visit, time.monotonic() - began_s)


def end(document: Any) -> None:
    """Take note that a page was left."""
    visit = VISITS.pop(document, None) if document is not None else None
    if visit is not None:
        write("closed", visit, time.monotonic() - visit.began_s)


def worked(document: Any, work: str, duration_s: float, result: object) -> None:
    """Take note of a result or a refusal that a page has waited for."""
    visit = VISITS.get(session_document(document)) if document is not None else None
    if visit is not None:
        outcome = "refused" if isinstance(result, Exception) else "ok"
        write(work, visit, duration_s, getattr(result, "cell_count", None), outcome)


def write(event: str, visit: Visit, duration_s: float, cells: int | None = None, outcome: str = "ok") -> None:
    """Write the line of one event."""
    counted = "" if cells is None else f" cells={cells}"
    page = visit.page().replace(" ", "-")
    LOG.info("%s session=%s page=%s duration_s=%.3f%s %s", event, visit.session, page, duration_s, counted, outcome)


# ---- the log itself

GONE = (WebSocketClosedError, StreamClosedError)
"""Errors of writing to a page that has just been closed."""
WITH_TIME = logging.Formatter("%(asctime)s %(message)s", datefmt="%Y-%m-%d %H:%M:%S")
TOO_LATE = "Failed sending message as connection was closed"
# asyncio logs errors of writes that nobody awaits
LOGGERS = ("asyncio", "bokeh.server.views.ws", "panel.io.document")


def is_worth_a_line(record: logging.LogRecord) -> bool:
    """Return whether a record does not come from a page that has just been closed."""
    error = record.exc_info[1] if record.exc_info else None
    return not isinstance(error, GONE) and TOO_LATE not in record.getMessage()


def keep_quiet() -> None:
    """Log nothing of pages that have just been closed; a second call changes nothing."""
    for name in LOGGERS:
        logging.getLogger(name).addFilter(is_worth_a_line)


def write_down() -> None:
    """Write what this program and its libraries tell to standard error, each line once and with its time."""
    root = logging.getLogger()
    if any(isinstance(handler, Dated) for handler in root.handlers):
        return
    # libraries add one of their own, without a time, where there is none yet
    root.addHandler(Dated())
    # Bokeh brings its own
    for handler in logging.getLogger("bokeh").handlers:
        handler.setFormatter(WITH_TIME)
    logging.getLogger("railjoule").setLevel(logging.INFO)


class Dated(logging.StreamHandler[TextIO]):
    """Writes lines with their time."""

    def __init__(self) -> None:
        super().__init__()
        self.setFormatter(WITH_TIME)
