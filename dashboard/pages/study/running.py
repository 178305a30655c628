"""A study under way: it waits for its turn, is handed to the worker processes, and tells the page how far it is."""

import logging
import threading
import time
from collections.abc import Callable
from concurrent.futures import BrokenExecutor, Future

from railjoule.core import RailjouleError
from railjoule.core.studies.sweep import InterruptedStudyError, SweepFile, SweepTable, run_study
from railjoule.dashboard.pages.study.model import Progress, State
from railjoule.dashboard.work.study_pool import RUNS, STUDY_THREADS
from railjoule.dashboard.work.worker import told

LOG = logging.getLogger(__name__)
TOLD_EVERY_S, TABLE_EVERY_S = 0.5, 1.0
"""How often the page hears of the runs that are done, and gets the table of them."""
WAITS = "Another study runs on this server; this one begins after it."
LOST = "A worker process ended unexpectedly; the runs done so far are kept. Resume goes on with the rest."
Hear = Callable[[Progress, SweepTable | None], None]


class Running:
    """One study from its start, or from where it stopped, to its end.

    Parameters
    ----------
    results : SweepFile
        Where its rows go.
    hear : callable
        Takes how far it is, and the table where there is a new one; called in the page's own turns.
    turn : callable
        Lets the page take a turn; may be called in any thread.
    """

    def __init__(self, results: SweepFile, hear: Hear, turn: Callable[[Callable[[], None]], object]) -> None:
        self._results, self._hear, self._turn = results, hear, turn
        self._stop = threading.Event()
        self._lock = threading.Lock()
        self._news: tuple[Progress, SweepTable | None] | None = None
        self._began_s, self._done_before = 0.0, 0
        self._told_s = self._table_s = 0.0
        self._future: Future[None] | None = None

    def begin(self) -> None:
        """Begin in a thread, as soon as no other study runs."""
        self._tell("waiting", told=WAITS)
        self._future = STUDY_THREADS.submit(self.do)

    def stop(self) -> None:
        """Begin no further runs; those that are under way are still taken."""
        self._stop.set()
        if self._future is not None and self._future.cancel():
            self._end("stopped")

    def do(self, here: bool = False) -> None:
        """Do all runs; `here` without other processes."""
        try:
            if self._stop.is_set():
                self._end("stopped")
                return
            self._began_s, self._done_before = time.monotonic(), self._results.done
            self._tell("running")
            executor = None if here else RUNS.executor()
            run_study(self._results, executor=executor, progress=self._note, stop=self._stop)
            self._end("done" if self._results.done == self._results.study.sample else "stopped")
        except (InterruptedStudyError, BrokenExecutor) as error:
            LOG.warning("a worker process of a study has ended: %s", error)
            RUNS.renew()
            self._end("failed", LOST)
        except RailjouleError as error:
            self._end("failed", str(error))
        # nobody looks at the future: what is raised here would be lost in silence
        except Exception as error:
            self._end("failed", str(told(error)))

    def _note(self, done: int) -> None:
        now = time.monotonic()
        if now - self._told_s < TOLD_EVERY_S:
            return
        self._told_s = now
        table = None
        if now - self._table_s >= TABLE_EVERY_S:
            table = self._results.to_table()
            # a table of a million rows takes its time: then there are fewer of them
            self._table_s = now + 3 * (time.monotonic() - now)
        self._tell("stopping" if self._stop.is_set() else "running", table)

    def _end(self, state: State, sentence: str = "") -> None:
        table = None
        try:
            table = self._results.to_table()
        except RailjouleError as error:
            sentence = sentence or str(error)
        self._tell(state, table, sentence)

    def _tell(self, state: State, table: SweepTable | None = None, told: str = "") -> None:
        done = self._results.done
        passed_s = time.monotonic() - self._began_s
        per_s = (done - self._done_before) / passed_s if done > self._done_before and passed_s > 0 else None
        progress = Progress(state, done, self._results.study.sample, per_s, told)
        with self._lock:
            called = self._news is not None
            # a table that the page has not taken yet is not lost with newer numbers
            if table is None and self._news is not None:
                table = self._news[1]
            self._news = progress, table
        if not called:
            self._turn(self._give)

    def _give(self) -> None:
        with self._lock:
            news, self._news = self._news, None
        if news is not None:
            self._hear(*news)
