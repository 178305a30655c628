"""Runs a study: rows are drawn in order, solved in chunks by any executor, and kept by who handed them over."""

import os
import time
from collections.abc import Callable, Iterator
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    CancelledError,
    Executor,
    Future,
    ThreadPoolExecutor,
    wait,
)
from contextlib import nullcontext
from typing import Any, Protocol

from railjoule.core.arrays import FloatArray
from railjoule.core.errors import RailjouleError
from railjoule.core.studies.sweep.engine import Rows, solve_rows
from railjoule.core.studies.sweep.results import Chunk, Results

# the first tells what a row costs; slow strategies take a second for one
FIRST_CHUNK, LARGEST_CHUNK = 64, 2048
CHUNK_S = 1.0
"""A chunk is to take about so long [s]: short enough to show progress and to stop, long beside what handing it over
takes."""
SHORTEST_CHUNKS = 8
"""By which the last chunks are shorter at most."""
CHUNKS_A_WORKER = 2
"""Handed over at a time: one that is worked on, and one that waits."""
# of rows that are drawn only to come to those behind them
SKIPPED_AT_ONCE = 65_536


class InterruptedStudyError(RailjouleError):
    """A study whose workers are gone; what was done is kept."""


class Stop(Protocol):
    """Tells whether a study is to end early, as `threading.Event` does."""

    def is_set(self) -> bool:
        """Return whether it is."""


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
        Tells how many chunks it works on at a time, which may change; by default one a processor.
    progress : callable, optional
        Is told how many rows are done, from time to time.
    stop : Stop, optional
        No chunk is begun once it is set.

    Raises
    ------
    InterruptedStudyError
        If the executor has lost its workers; what was done is kept.
    """
    with ThreadPoolExecutor(worker_count(), "sweep") if executor is None else nullcontext(executor) as own:
        _Run(results, own, workers or worker_count, progress, stop).finish()


class _Run:
    """One run of a study, from what is done to its end or a stop."""

    def __init__(
        self,
        results: Results,
        executor: Executor,
        workers: Callable[[], int],
        progress: Callable[[int], None] | None,
        stop: Stop | None,
    ) -> None:
        self._results, self._executor, self._workers = results, executor, workers
        self._progress, self._stop = progress, stop
        self._waiting: dict[Future[Rows], tuple[int, FloatArray]] = {}
        self._kept_at = time.perf_counter()
        # of this run alone: who goes on may have other workers
        self._solved, self._solving_s = 0, 0.0

    def finish(self) -> None:
        """Hand over chunk after chunk until all are done or it is stopped."""
        chunks = self._chunks()
        try:
            while self._hand_over(chunks) or self._waiting:
                finished, _ = wait(self._waiting, return_when=FIRST_COMPLETED)
                for future in finished:
                    self._keep(future)
                if self._progress is not None and finished:
                    self._progress(self._results.done)
        except (BrokenExecutor, CancelledError) as error:
            raise InterruptedStudyError(
                f"the workers of the study are gone; {self._results.done:,} of {self._results.study.sample:,} rows "
                "are done and kept."
            ) from error
        finally:
            # whoever stops waits for no chunk that has not begun
            for future in self._waiting:
                future.cancel()

    def _chunks(self) -> Iterator[tuple[int, FloatArray]]:
        """Yield the first row and the samples of chunk after chunk, each as long as is right when it is asked for."""
        gaps, sampler, drawn = self._results.gaps(), self._results.study.sampler(), 0
        left = sum(end - first for first, end in gaps)
        for first, end in gaps:
            # a row hangs on its number, which those before it are drawn to reach
            while drawn < first:
                drawn += len(sampler.take(min(SKIPPED_AT_ONCE, first - drawn)))
            while drawn < end:
                samples = sampler.take(min(self._chunk_size(left), end - drawn))
                yield drawn, samples
                drawn, left = drawn + len(samples), left - len(samples)

    def _hand_over(self, chunks: Iterator[tuple[int, FloatArray]]) -> bool:
        """Give the workers what they have room for; return whether there was anything to give."""
        given = False
        while len(self._waiting) < CHUNKS_A_WORKER * max(1, self._workers()):
            if self._stop is not None and self._stop.is_set():
                self._cancel_waiting()
                return given
            chunk = next(chunks, None)
            if chunk is None:
                return given
            given = True
            self._waiting[self._executor.submit(solve_rows, self._results.study.plan, chunk[1])] = chunk
        return given

    def _cancel_waiting(self) -> None:
        for future in [future for future in self._waiting if future.cancel()]:
            del self._waiting[future]

    def _keep(self, future: Future[Rows]) -> None:
        first, samples = self._waiting.pop(future)
        rows, now = future.result(), time.perf_counter()
        self._results.append(Chunk(first, samples, rows), now - self._kept_at)
        self._kept_at = now
        self._solved, self._solving_s = self._solved + len(samples), self._solving_s + rows.seconds

    def _chunk_size(self, left: int) -> int:
        """Return how many rows the next chunk has, of those that are left."""
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
