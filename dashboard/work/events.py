"""What happens on the pages of this process: a line of the log for each event, and the counts of /metrics."""

import hashlib
import logging
import threading
import time
from collections import Counter, deque
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass
from typing import Any
from weakref import WeakKeyDictionary

from bokeh.document import Document

from railjoule.dashboard.insides import session_document

LOG = logging.getLogger(__name__)
MOST_REMEMBERED = 500
"""So many of the last durations tell the 95th percentile."""
ID_DIGITS = 8


@dataclass(frozen=True)
class Visit:
    """One open page: what the log calls its session, which page is in sight, when it began [s]."""

    session: str
    page: Callable[[], str]
    began_s: float


class Tally:
    """Counts of events; threads of the pools and the event loop write to it."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self.sessions = 0
        self.queued = 0
        """Pieces of work that wait for a thread or are under way."""
        self.counts: Counter[tuple[str, str]] = Counter()
        """Pieces of work by what they are and how they ended: ok or refused."""
        self._last: dict[str, deque[float]] = {}
        self._waiting: WeakKeyDictionary[object, float] = WeakKeyDictionary()

    def opened(self, change: int) -> None:
        """Take note that so many sessions more, or fewer, are there."""
        with self._lock:
            self.sessions += change

    def queue(self, future: "Future[Any]") -> None:
        """Count a piece of work until it is done."""
        with self._lock:
            self.queued += 1
        future.add_done_callback(self._done)

    def _done(self, _: "Future[Any]") -> None:
        with self._lock:
            self.queued -= 1

    def wait(self, who: object) -> None:
        """Take note that a page waits for a short piece of work; called on the event loop alone."""
        self._waiting[who] = time.monotonic()

    def settle(self, who: object) -> None:
        """Take note that it has what it waited for."""
        self._waiting.pop(who, None)

    def someone_waits(self, longest_s: float) -> bool:
        """Return whether a page waits that has not waited longer than this [s]: one that has may be gone."""
        since = time.monotonic() - longest_s
        return any(began_s > since for began_s in self._waiting.values())

    def took(self, work: str, outcome: str, duration_s: float) -> None:
        """Take note of how long a piece of work kept a page waiting."""
        with self._lock:
            self.counts[work, outcome] += 1
            self._last.setdefault(work, deque(maxlen=MOST_REMEMBERED)).append(duration_s)

    def percentiles_s(self, share: float) -> dict[str, float]:
        """Return by the kind of work how long all but a share of the last pieces took at most [s]."""
        with self._lock:
            last = {work: sorted(durations) for work, durations in self._last.items()}
        return {
            work: durations[min(int(share * len(durations)), len(durations) - 1)] for work, durations in last.items()
        }


TALLY = Tally()
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
    # whoever knows the whole name of a session can speak in its place, and logs are read by others
    name = hashlib.sha256(str(document.session_context.id).encode()).hexdigest()[:ID_DIGITS]
    visit = VISITS[document] = Visit(name, page, time.monotonic())
    TALLY.opened(1)
    write("opened", visit, time.monotonic() - began_s)


def end(document: Any) -> None:
    """Take note that a page was left."""
    visit = VISITS.pop(document, None) if document is not None else None
    if visit is not None:
        TALLY.opened(-1)
        write("closed", visit, time.monotonic() - visit.began_s)


def worked(document: Any, work: str, duration_s: float, result: object) -> None:
    """Take note of a result or a refusal that a page has waited for."""
    outcome = "refused" if isinstance(result, Exception) else "ok"
    TALLY.took(work, outcome, duration_s)
    visit = VISITS.get(session_document(document)) if document is not None else None
    if visit is not None:
        write(work, visit, duration_s, getattr(result, "cell_count", None), outcome)


def write(event: str, visit: Visit, duration_s: float, cells: int | None = None, outcome: str = "ok") -> None:
    """Write the line of one event."""
    told = "" if cells is None else f" cells={cells}"
    page = visit.page().replace(" ", "-")
    LOG.info("%s session=%s page=%s duration_s=%.3f%s %s", event, visit.session, page, duration_s, told, outcome)
