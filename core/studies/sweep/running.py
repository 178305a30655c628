"""Runs studies: rows are drawn in order, made in chunks by any executor, and kept by who handed them over."""

import os
import time
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    CancelledError,
    Executor,
    Future,
    ThreadPoolExecutor,
    wait,
)
from contextlib import closing, nullcontext
from functools import partial
from typing import Any, Protocol, TypeVar

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.compilation import require_compiled
from railjoule.core.errors import RailjouleError
from railjoule.core.studies.sweep.engine import solve_rows
from railjoule.core.studies.sweep.results import Chunk, Results
from railjoule.core.studies.sweep.rows import Rows

Answer = TypeVar("Answer")
Work = Callable[[FloatArray], Rows]
"""What makes rows of samples of shape (rows, fields), such as `RowByRow`."""
# the first tells what a row costs; slow strategies take a second for one
FIRST_CHUNK, LARGEST_CHUNK = 64, 2048
CHUNK_S = 1.0
"""A chunk is to take about so long [s]: short enough to show progress and to stop, long beside what handing it over
takes."""
SHORTEST_CHUNKS = 8
"""By which the last chunks are shorter at most."""
CHUNKS_A_WORKER = 2
"""Handed over at a time: one that is worked on, and one that waits."""
# a stop, and workers that are gone for good, are noticed after this
LONGEST_WAIT_S = 1.0
# of rows that are drawn only to come to those behind them
SKIPPED_AT_ONCE = 65_536


class InterruptedStudyError(RailjouleError):
    """A study whose workers are gone; what was done is kept."""


class Stop(Protocol):
    """Tells whether a study is to end early, as `threading.Event` does."""

    def is_set(self) -> bool:
        """Return whether it is."""


class InTurn(Executor):
    """Does what it is given at once, in the thread that gives it."""

    def submit(self, function: Callable[..., Answer], /, *arguments: Any, **named: Any) -> Future[Answer]:
        """Return what has been done."""
        future: Future[Answer] = Future()
        # an error goes to who asks for the result, as with any other executor
        try:
            future.set_result(function(*arguments, **named))
        except Exception as error:
            future.set_exception(error)
        return future


def run_study(
    results: Results,
    *,
    executor: Executor | None = None,
    workers: Callable[[], int] | None = None,
    progress: Callable[[int], None] | None = None,
    stop: Stop | None = None,
) -> None:
    """Do all rows of a study that are not done yet.

    Parameters
    ----------
    results : Results
        What is to be done, and where its rows go, from this thread alone.
    executor : Executor, optional
        What solves the rows; by default threads, one a processor.
    workers : callable, optional
        Tells how many chunks it works on at a time, which may change; by default one a processor. What it raises ends
        the study.
    progress : callable, optional
        Is told how many rows are done, from time to time.
    stop : Stop, optional
        No chunk is begun once it is set.

    Raises
    ------
    InterruptedStudyError
        If the executor has lost its workers; what was done is kept.
    """
    require_compiled()
    study, kept_at = results.study, time.perf_counter()
    work = partial(solve_rows, study.plan)
    with ThreadPoolExecutor(worker_count(), "sweep") if executor is None else nullcontext(executor) as own:
        chunks = worked(work, study.sampler().take, results.gaps(), own, workers or worker_count, stop)
        try:
            for chunk in chunks:
                now = time.perf_counter()
                results.append(chunk, now - kept_at)
                kept_at = now
                if progress is not None:
                    progress(results.done)
        except (BrokenExecutor, CancelledError) as error:
            raise InterruptedStudyError(
                f"the workers of the study are gone; {results.done:,} of {study.sample:,} rows are done and kept."
            ) from error
        finally:
            # at once, and not when it is collected: its end takes back what no worker has begun
            chunks.close()


def all_rows(work: Work, samples: FloatArray, executor: Executor | None = None) -> Rows:
    """Return what work makes of samples of shape (rows, fields); by default in this thread."""
    if executor is None:
        return work(samples)
    rows = work(samples[:0])
    for rows in rows_in_order(work, samples, executor):  # noqa: B007  (the last has all)
        pass
    return rows


def rows_in_order(work: Work, samples: FloatArray, executor: Executor | None, rows: int = 1) -> Iterator[Rows]:
    """Yield what work makes of samples of shape (rows, fields), all rows done so far after each step.

    Parameters
    ----------
    work : callable
        Returns the rows of some samples.
    samples : array of shape (rows, fields)
    executor : Executor or None
        What does the work; None for the thread that asks, which then gets the rows one after the other.
    rows : int
        How many make a step.
    """
    taken = iter(range(0, len(samples), rows))
    values: FloatArray | None = None
    reasons: dict[int, str] = {}
    waiting: dict[int, Chunk] = {}
    reached, seconds = 0, 0.0
    chunks = worked(
        work,
        lambda count: samples[(first := next(taken)) : first + count],
        [(0, len(samples))],
        InTurn() if executor is None else executor,
        worker_count if executor is not None else lambda: 1,
        size=rows,
    )
    with closing(chunks):
        for done in chunks:
            waiting[done.first] = done
            # what comes early waits: who reads a part of a table takes it from its beginning
            while (chunk := waiting.pop(reached, None)) is not None:
                values = chunk.rows.values if values is None else np.concatenate([values, chunk.rows.values])
                reasons |= chunk.reasons
                reached, seconds = chunk.end, seconds + chunk.rows.seconds
                yield Rows(values, dict(reasons), seconds)


def worked(
    work: Work,
    take: Callable[[int], FloatArray],
    gaps: Sequence[tuple[int, int]],
    executor: Executor,
    workers: Callable[[], int],
    stop: Stop | None = None,
    size: int | None = None,
) -> Generator[Chunk, None, None]:
    """Yield chunk after chunk as an executor gets done with them, in any order.

    Parameters
    ----------
    work : callable
        Returns the rows of some samples.
    take : callable
        Returns the next samples, at most so many.
    gaps : sequence of (int, int)
        First row and the row after the last one of each stretch that is to be done.
    executor, workers, stop
        As in `run_study`.
    size : int, optional
        How many rows a chunk has; by default as many as take about a second.
    """
    return _Hands(work, take, gaps, executor, workers, stop, size).chunks()


class _Hands:
    """Hands chunks over to an executor, each as long as is right when it is handed over."""

    def __init__(
        self,
        work: Work,
        take: Callable[[int], FloatArray],
        gaps: Sequence[tuple[int, int]],
        executor: Executor,
        workers: Callable[[], int],
        stop: Stop | None,
        size: int | None,
    ) -> None:
        self._work, self._take, self._gaps, self._executor = work, take, gaps, executor
        self._workers, self._stop, self._size = workers, stop, size
        self._waiting: dict[Future[Rows], tuple[int, FloatArray]] = {}
        # of this run alone: who goes on may have other workers
        self._solved, self._solving_s = 0, 0.0

    def chunks(self) -> Generator[Chunk, None, None]:
        """Yield all chunks, or those that were begun before a stop."""
        samples = self._samples()
        try:
            while self._hand_over(samples) or self._waiting:
                finished, _ = wait(self._waiting, LONGEST_WAIT_S, FIRST_COMPLETED)
                for future in finished:
                    yield self._done(future)
        finally:
            # whoever stops waits for no chunk that has not begun
            for future in self._waiting:
                future.cancel()

    def _samples(self) -> Iterator[tuple[int, FloatArray]]:
        """Yield the first row and the samples of chunk after chunk."""
        drawn, left = 0, sum(end - first for first, end in self._gaps)
        for first, end in self._gaps:
            # a row hangs on its number, which those before it are drawn to reach
            while drawn < first:
                drawn += len(self._take(min(SKIPPED_AT_ONCE, first - drawn)))
            while drawn < end:
                samples = self._take(min(self._chunk_size(left), end - drawn))
                yield drawn, samples
                drawn, left = drawn + len(samples), left - len(samples)

    def _hand_over(self, samples: Iterator[tuple[int, FloatArray]]) -> bool:
        """Give the workers what they have room for; return whether there was anything to give."""
        given = False
        while len(self._waiting) < CHUNKS_A_WORKER * max(1, self._workers()):
            if self._stop is not None and self._stop.is_set():
                self._take_back()
                return given
            chunk = next(samples, None)
            if chunk is None:
                return given
            given = True
            self._waiting[self._executor.submit(self._work, chunk[1])] = chunk
        return given

    def _take_back(self) -> None:
        for future in [future for future in self._waiting if future.cancel()]:
            del self._waiting[future]

    def _done(self, future: Future[Rows]) -> Chunk:
        first, samples = self._waiting.pop(future)
        rows = future.result()
        self._solved, self._solving_s = self._solved + len(samples), self._solving_s + rows.seconds
        return Chunk(first, samples, rows)

    def _chunk_size(self, left: int) -> int:
        """Return how many rows the next chunk has, of those that are left."""
        if self._size is not None:
            return self._size
        if not self._solved:
            return FIRST_CHUNK
        most = max(1, min(int(CHUNK_S * self._solved / self._solving_s), LARGEST_CHUNK))
        # towards the end shorter ones, so that all workers end at about the same time
        return max(min(most, left // (CHUNKS_A_WORKER * max(1, self._workers()))), most // SHORTEST_CHUNKS, 1)


def worker_count() -> int:
    """Return how many processors this process may use."""
    # containers and batch systems give a process fewer than the machine has
    affinity: Any = getattr(os, "sched_getaffinity", None)
    return len(affinity(0)) if affinity is not None else os.cpu_count() or 1
