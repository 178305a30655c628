"""Rows of studies: each depends only on its own sample. Any executor computes them, in chunks."""

import math
import os
import time
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, wait
from contextlib import closing
from dataclasses import dataclass, field
from threading import Event
from typing import Any

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.budget import Budget, current_budget, within
from railjoule.core.errors import RailjouleError

CHUNKS_PER_WORKER = 2
"""Submitted at a time: one in work and one that waits."""
LONGEST_WAIT_S = 1.0
"""A stop and lost workers are noticed after at most this time [s]."""


@dataclass(frozen=True, eq=False)
class Rows:
    """Computed rows of a study.

    Parameters
    ----------
    values : array of shape (rows, columns)
        NaN where a number is unknown or there is no run.
    reasons : dict of int to str
        Why a row has no run, by its number within these rows.
    seconds : float
        Computing time [s].
    """

    values: FloatArray
    reasons: dict[int, str]
    seconds: float


@dataclass(frozen=True, eq=False)
class Chunk:
    """Consecutive rows of a study with their samples.

    Parameters
    ----------
    first : int
        Number of the first row.
    samples : array of shape (rows, fields)
        Values of the fields.
    rows : Rows
        Results.
    """

    first: int
    samples: FloatArray
    rows: Rows

    @property
    def end(self) -> int:
        """Number of the row after the last one."""
        return self.first + len(self.samples)

    @property
    def reasons(self) -> dict[int, str]:
        """Why a row has no run, by its number in the study."""
        return {self.first + row: reason for row, reason in self.rows.reasons.items()}


@dataclass(frozen=True, eq=False)
class RowByRow:
    """Compute rows one by one; the object can be sent to other threads and processes.

    Parameters
    ----------
    run : callable
        Returns the numbers of a row for its sample, None where one is unknown.
    width : int
        Numbers in a row.
    refusals : type or tuple of types
        Errors that are results of the study: the row stays empty, with the message as its reason.
    budget : Budget
        Budget of each run; by default that of the calling thread, which other threads do not inherit.
    """

    run: Callable[[Sequence[float]], Sequence[float | None]]
    width: int
    refusals: type[RailjouleError] | tuple[type[RailjouleError], ...] = RailjouleError
    budget: Budget = field(default_factory=current_budget)

    def __call__(self, samples: FloatArray) -> Rows:
        """Return the rows of samples of shape (rows, fields)."""
        started = time.perf_counter()
        values, reasons = np.full((len(samples), self.width), np.nan), {}
        with within(self.budget):
            for row, sample in enumerate(samples.tolist()):
                try:
                    values[row] = [math.nan if number is None else number for number in self.run(sample)]
                except self.refusals as error:
                    reasons[row] = str(error)
        return Rows(values, reasons, time.perf_counter() - started)


Work = Callable[[FloatArray], Rows]
"""Computes the rows of samples of shape (rows, fields), such as `RowByRow`."""


def completed_chunks(
    work: Work,
    samples: Iterable[tuple[int, FloatArray]],
    executor: Executor,
    workers: Callable[[], int],
    stop: Event | None = None,
) -> Generator[Chunk, None, None]:
    """Yield chunks as an executor completes them, in any order.

    Parameters
    ----------
    work : callable
        Computes the rows of some samples.
    samples : iterable of (int, array)
        First row and samples of each chunk, taken when it is submitted.
    executor, workers, stop
        As in `run_study`.
    """
    waiting: dict[Any, tuple[int, FloatArray]] = {}
    left = iter(samples)
    try:
        while True:
            while len(waiting) < CHUNKS_PER_WORKER * max(1, workers()):
                if stop is not None and stop.is_set():
                    waiting = {future: chunk for future, chunk in waiting.items() if not future.cancel()}
                    break
                if (chunk := next(left, None)) is None:
                    break
                waiting[executor.submit(work, chunk[1])] = chunk
            if not waiting:
                return
            for future in wait(waiting, LONGEST_WAIT_S, FIRST_COMPLETED).done:
                yield Chunk(*waiting.pop(future), future.result())
    finally:
        for future in waiting:
            future.cancel()


def rows_in_order(work: Work, samples: FloatArray, executor: Executor | None, size: int = 1) -> Iterator[Rows]:
    """Yield the rows of samples of shape (rows, fields): none, then all from the first one on, after each step.

    Parameters
    ----------
    work : callable
        Computes the rows of some samples.
    samples : array of shape (rows, fields)
    executor : Executor or None
        Computes the rows; None for the calling thread.
    size : int
        Rows in a step.
    """
    parts = ((first, samples[first : first + size]) for first in range(0, len(samples), size))
    done = work(samples[:0])
    yield done
    # a chunk that is early waits, as a part of a table is read from its beginning
    early: dict[int, Chunk] = {}
    here = (Chunk(first, part, work(part)) for first, part in parts)
    with closing(here if executor is None else completed_chunks(work, parts, executor, worker_count)) as chunks:
        for completed in chunks:
            early[completed.first] = completed
            while (chunk := early.pop(len(done.values), None)) is not None:
                values = np.concatenate([done.values, chunk.rows.values])
                done = Rows(values, done.reasons | chunk.reasons, done.seconds + chunk.rows.seconds)
                yield done


def all_rows(work: Work, samples: FloatArray, executor: Executor | None = None) -> Rows:
    """Return the rows of samples of shape (rows, fields); by default computed in this thread."""
    if executor is None:
        return work(samples)
    *_, rows = rows_in_order(work, samples, executor)
    return rows


def worker_count() -> int:
    """Return the number of processors that this process may use."""
    # containers and batch systems give a process fewer than the machine has
    affinity: Any = getattr(os, "sched_getaffinity", None)
    return len(affinity(0)) if affinity is not None else os.cpu_count() or 1
