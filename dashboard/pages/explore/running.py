"""A study under way: its rows are computed in worker processes, and the page gets its progress."""

import logging
import threading
import time
from collections.abc import Iterator
from concurrent.futures import BrokenExecutor, ThreadPoolExecutor, wait
from dataclasses import dataclass
from typing import Literal

from railjoule.core import RailjouleError
from railjoule.core.studies.sweep import InterruptedStudyError, SweepFile, SweepTable, run_study
from railjoule.dashboard.work.study_pool import RUNS
from railjoule.dashboard.work.worker import unexpected_error

LOG = logging.getLogger(__name__)
STEP_S, TABLE_EVERY_S = 0.5, 1.0
"""Intervals at which the page gets the number of completed runs, and their table [s]."""
WAITS = "Another study runs on this server; this one begins after it."
LOST = "A worker process ended unexpectedly; the runs done so far are kept. Resume goes on with the rest."
State = Literal["none", "waiting", "running", "stopping", "stopped", "failed", "done"]


@dataclass(frozen=True)
class Progress:
    """Progress of a study.

    Parameters
    ----------
    state : str
    done, runs : int
        Completed runs, and all of them.
    per_s : float or None
        Runs in a second [1/s], once that is known.
    message : str
        Why it waits or has ended.
    """

    state: State = "none"
    done: int = 0
    runs: int = 0
    per_s: float | None = None
    message: str = ""

    @property
    def left_s(self) -> float | None:
        """The time that the rest takes [s], if that is known."""
        return (self.runs - self.done) / self.per_s if self.per_s else None

    @property
    def is_under_way(self) -> bool:
        """Whether it runs, or waits to."""
        return self.state in {"waiting", "running", "stopping"}


@dataclass(frozen=True, eq=False)
class Step:
    """Progress of a study, and its table where there is a newer one."""

    sweep: SweepFile
    progress: Progress
    table: SweepTable | None = None


def run_in_steps(sweep: SweepFile, stop: threading.Event, here: bool = False) -> Iterator[Step]:
    """Yield the progress of a study until all rows are computed or `stop` is set.

    Parameters
    ----------
    sweep : SweepFile
        The study; its missing rows are computed.
    stop : Event
        No further rows begin once it is set; those under way are still taken.
    here : bool
        Whether it is computed without other processes.
    """
    began_s, before, runs = time.monotonic(), sweep.done, sweep.study.sample
    table_s = began_s

    def step(state: State, table: SweepTable | None = None, sentence: str = "") -> Step:
        done, passed_s = sweep.done, time.monotonic() - began_s
        per_s = (done - before) / passed_s if done > before and passed_s > 0 else None
        return Step(sweep, Progress(state, done, runs, per_s, sentence), table)

    if stop.is_set():
        # while it waited for its turn
        return
    yield step("running")
    with ThreadPoolExecutor(1, "railjoule-study-rows") as thread:
        try:
            executor = None if here else RUNS.executor()
            future = thread.submit(run_study, sweep, executor=executor, stop=stop)
            while not wait([future], STEP_S).done:
                now, table = time.monotonic(), None
                if now - table_s >= TABLE_EVERY_S:
                    table = sweep.to_table()
                    # a table of a million rows takes its time: then there are fewer of them
                    table_s = now + 3 * (time.monotonic() - now)
                yield step("stopping" if stop.is_set() else "running", table)
        finally:
            # also where the page has gone: the thread ends with the rows that are under way
            stop.set()
    state: State = "done" if sweep.done == runs else "stopped"
    sentence = ""
    error = future.exception()
    if error is not None:
        state, sentence = "failed", str(unexpected_error(error))
    if isinstance(error, InterruptedStudyError | BrokenExecutor):
        LOG.warning("a worker process of a study has ended: %s", error)
        RUNS.renew()
        sentence = LOST
    elif isinstance(error, RailjouleError):
        sentence = str(error)
    yield step(state, sweep.to_table(), sentence)
