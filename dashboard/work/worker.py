"""Work in threads, as the core's kernels release the interpreter.

Each page has at most one piece of each kind of work under way; of the requests that arrive in the meantime, only the
last is computed.
"""

import logging
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from functools import partial
from typing import Generic, TypeVar

import panel as pn
from bokeh.document import Document

from railjoule.core import RailjouleError
from railjoule.core.budget import PAGE, within
from railjoule.dashboard.library_workarounds import make_turns
from railjoule.dashboard.work import events

LOG = logging.getLogger(__name__)
# all pools are those of the process: open pages share them
THREADS = ThreadPoolExecutor(max_workers=2, thread_name_prefix="railjoule")
LONG_THREADS = ThreadPoolExecutor(max_workers=2, thread_name_prefix="railjoule-long")
"""For studies of seconds, so that sliders need not wait for them."""
SLOW_THREADS = ThreadPoolExecutor(max_workers=2, thread_name_prefix="railjoule-slow")
"""For single runs of seconds, which need not wait for studies of minutes."""
PROOF_THREADS = ThreadPoolExecutor(max_workers=1, thread_name_prefix="railjoule-proof")
"""For proofs that are asked for by hand, one at a time: each may take a gigabyte."""
LATE_MS = 250
"""After this long without a result the page marks its results as older than the last change."""
PAUSE_S = 0.002
"""A study sleeps this long after each step: the page's own turns come first."""
UNKNOWN = "Something went wrong in the computation; the server's log has the details."
NO_MEMORY = "This takes more memory than the server has; a mesh with longer cells needs less."

Turns = Callable[[Callable[[], None]], object]
Request = TypeVar("Request")
Result = TypeVar("Result")


def unexpected_error(error: BaseException) -> RailjouleError:
    """Log an unexpected error, and return a sentence on it for the page."""
    LOG.error("a computation failed", exc_info=error)
    return RailjouleError(NO_MEMORY if isinstance(error, MemoryError) else UNKNOWN)


class Lateness:
    """Reports to a page when a result keeps it waiting, and when it has come.

    Parameters
    ----------
    mark : callable
        Called with True when what is shown is from before the last change, with False when it no longer is.
    """

    def __init__(self, mark: Callable[[bool], None]) -> None:
        self._mark, self._asked_s, self._marked, self._timed = mark, 0.0, False, False
        self._document: Document | None = None

    def asked(self, document: Document) -> None:
        """Take note that a result is asked for."""
        self._document = document
        if not self._asked_s:
            self._asked_s = time.monotonic()
            self._time()

    def answered(self, more: bool = False) -> None:
        """Take note that a result has come, perhaps with a newer request."""
        # the wait begins again: a moving slider is answered all the time, and the page follows it
        self._asked_s = time.monotonic() if more else 0.0
        self._tell(False)
        if more:
            self._time()

    def _time(self) -> None:
        if self._document is not None and not self._timed:
            # one timer for all requests: a slider would start one at each move
            self._timed = True
            self._document.add_timeout_callback(self._look, LATE_MS)

    def _look(self) -> None:
        self._timed = False
        if not self._asked_s:
            return
        if time.monotonic() - self._asked_s >= LATE_MS / 1000:
            self._tell(True)
        else:
            self._time()

    def _tell(self, late: bool) -> None:
        if late != self._marked:
            self._marked = late
            self._mark(late)


def name_of(work: Callable[..., object]) -> str:
    """Return the name of a piece of work in the log: the function that does it."""
    return str(getattr(work, "__name__", type(work).__name__)).strip("_")


def nobody(_: bool) -> None:
    """Tell nobody: a page that is not marked as late."""


def without_page(turn: Callable[[], None]) -> None:
    """Take a turn immediately, as there is no page around it."""
    turn()


def nothing() -> None:
    """Return the subject of a page whose results always belong to it."""


# not `pn.state.execute`, which leaves out no request that a later one has made useless
class Worker(Generic[Request, Result]):
    """Works on the last request of one page in a thread, and delivers results in the order in which they were asked.

    Parameters
    ----------
    compute : callable
        Turns a request into a result; runs in a thread.
    deliver : callable
        Takes a result into the page; runs in the page's own turn.
    fail : callable
        Called with an error that user input causes.
    mark : callable
        Called with True when the page's results are older than the last change, False when they no longer are.
    is_slow : callable
        Whether a request takes seconds: then it does not keep the short ones of other pages waiting.
    about : callable
        Returns what the page is about, such as its scenario without edits. A result, or an error, is dropped where that
        is another object than when it was asked for; who asks for nothing twice has to forget that it asked.
    threads : executor, optional
        Executor of all requests, slow or not.
    """

    def __init__(
        self,
        compute: Callable[[Request], Result],
        deliver: Callable[[Result], None],
        fail: Callable[[RailjouleError], None],
        mark: Callable[[bool], None] = nobody,
        is_slow: Callable[[Request], bool] = lambda _: False,
        about: Callable[[], object] = nothing,
        threads: ThreadPoolExecutor | None = None,
    ) -> None:
        self._threads = threads
        self._compute, self._deliver, self._fail, self._is_slow = compute, deliver, fail, is_slow
        self._about = about
        self._late = Lateness(mark)
        self._document: Document | None = None
        self._turn: Turns = without_page
        self._request: Request | None = None
        self._requested_s = 0.0
        self._running = False
        self.last_duration_s = 0.0

    def ask(self, request: Request) -> None:
        """Ask for a result; a request that waits is forgotten."""
        self._document = pn.state.curdoc
        # no session is around it, as in a script: nobody else waits, and no event loop would bring the result
        if self._document is None:
            self.do(request)
            return
        self._turn = make_turns(self._document)
        self._late.asked(self._document)
        self._requested_s = time.monotonic()
        if self._running:
            self._request = request
        else:
            self._start(request)

    def do(self, request: Request) -> None:
        """Compute and deliver in the caller's own turn."""
        settle(self._timed(request), self._deliver, self._fail)

    def _start(self, request: Request) -> None:
        self._running = True
        slow = self._is_slow(request)
        threads = self._threads or (SLOW_THREADS if slow else THREADS)
        if not slow:
            events.WAITS.wait(self)
        # asked now: by the time the result comes, the page may be about another scenario
        finish = partial(self._finish, self._about(), self._requested_s)
        future = threads.submit(self._timed, request)
        # called in the thread of the pool: a turn may be asked for in any
        future.add_done_callback(lambda done: self._turn(partial(finish, done)))

    def _timed(self, request: Request) -> Result | RailjouleError:
        started = time.perf_counter()
        try:
            with within(PAGE):
                return self._compute(request)
        except RailjouleError as error:
            return error
        # a hostile scenario may cause these: without a page, there is no future that brings them to `_finish`
        except (MemoryError, RecursionError) as error:
            return unexpected_error(error)
        finally:
            self.last_duration_s = time.perf_counter() - started

    def _finish(self, about: object, requested_s: float, future: "Future[Result | RailjouleError]") -> None:
        events.WAITS.settle(self)
        error = future.exception()
        self._late.answered(more=self._request is not None)
        outcome = future.result() if error is None else unexpected_error(error)
        try:
            # still running: a newer request replaces the one that waits, which is older
            if about is self._about():
                settle(outcome, self._deliver, self._fail)
        finally:
            self._running = False
            events.worked(self._document, name_of(self._compute), time.monotonic() - requested_s, outcome)
            request, self._request = self._request, None
            if request is not None:
                self._start(request)


def settle(
    outcome: Result | RailjouleError, deliver: Callable[[Result], None], fail: Callable[[RailjouleError], None]
) -> None:
    """Take a result or an error into the page, as one message; an error in doing so reaches the log and the page."""
    with pn.io.hold():
        if isinstance(outcome, RailjouleError):
            fail(outcome)
            return
        try:
            deliver(outcome)
        except Exception:
            LOG.exception("a result could not be taken into the page")
            fail(RailjouleError(UNKNOWN))


class Study(Generic[Request, Result]):
    """Does a long piece of work of one page step by step; each new request, and `stop`, ends the one before.

    Parameters
    ----------
    steps : callable
        Turns a request into results that become more complete; runs in a thread.
    deliver : callable
        Takes a result and whether it is the last into the page, in the page's own turn; steps that come faster than
        the page takes them are left out.
    fail : callable
        Called with an error that user input causes.
    mark : callable
        As for a worker; the first step of a request is what is waited for.
    threads : executor
        Executor of the steps.
    """

    def __init__(
        self,
        steps: Callable[[Request], Iterator[Result]],
        deliver: Callable[[Result, bool], None],
        fail: Callable[[RailjouleError], None],
        mark: Callable[[bool], None] = nobody,
        threads: ThreadPoolExecutor = LONG_THREADS,
    ) -> None:
        self._threads = threads
        self._steps, self._deliver, self._fail = steps, deliver, fail
        self._late = Lateness(mark)
        self._job: _Job[Result] | None = None

    def ask(self, request: Request) -> None:
        """Begin again; without a page around it, in the caller's own turn."""
        self.stop()
        document = pn.state.curdoc
        job: _Job[Result] = _Job(document)
        self._job = job
        if document is None:
            self._work(request, job)
        else:
            self._late.asked(document)
            self._threads.submit(self._work, request, job)

    @property
    def busy(self) -> bool:
        """Whether work is under way."""
        return self._job is not None

    def stop(self) -> None:
        """End the work under way; what came so far stands."""
        if self._job is not None:
            self._job.ended.set()
            self._job = None
            self._late.answered()

    def _work(self, request: Request, job: "_Job[Result]") -> None:
        result: Result | RailjouleError | None = None
        try:
            with within(PAGE):
                for result in self._steps(request):
                    if job.ended.is_set():
                        return
                    job.offer(result, False, self._take)
                    # while it sleeps, the event loop gets the interpreter's lock, which kernels release but Python
                    # between them does not
                    time.sleep(PAUSE_S if job.document is not None else 0)
        except RailjouleError as error:
            result = error
        # all of them: nobody looks at the future of a study, so that what is raised here would be lost in silence
        except Exception as error:
            result = unexpected_error(error)
        if result is not None:
            job.offer(result, True, self._take)

    def _take(self, job: "_Job[Result]") -> None:
        result, last = job.take()
        # a step of a job that was ended may still be on its way here
        if job is not self._job or result is None:
            return
        if last:
            self._job = None
            events.worked(job.document, name_of(self._steps), time.monotonic() - job.asked_s, result)
        self._late.answered()
        settle(result, lambda taken: self._deliver(taken, last), self._fail)


class _Job(Generic[Result]):
    """One piece of long work: its newest result waits here until the page takes it."""

    def __init__(self, document: Document | None) -> None:
        self.document, self.ended, self.asked_s = document, threading.Event(), time.monotonic()
        self._turn = without_page if document is None else make_turns(document)
        # the pool's thread offers, the event loop takes
        self._lock = threading.Lock()
        self._result: Result | RailjouleError | None = None
        self._last = False
        self._called = False

    def offer(self, result: Result | RailjouleError, last: bool, take: Callable[["_Job[Result]"], None]) -> None:
        """Leave a result, and call the page unless it is already called."""
        with self._lock:
            self._result, self._last = result, last
            called, self._called = self._called, True
        if called:
            return
        # outside the lock: without a page the turn is taken immediately, and `take` needs the lock itself
        self._turn(partial(take, self))

    def take(self) -> tuple[Result | RailjouleError | None, bool]:
        """Return the newest result and whether it is the last."""
        with self._lock:
            result, self._result, self._called = self._result, None, False
            return result, self._last
