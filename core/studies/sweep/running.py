"""Run sweeps: draw rows in order, compute them in chunks on any executor, and save them in the calling thread."""

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import BrokenExecutor, CancelledError, Executor, ThreadPoolExecutor
from contextlib import closing, nullcontext
from functools import partial
from pathlib import Path
from threading import Event

from railjoule.core.arrays import FloatArray
from railjoule.core.compilation import require_compiled
from railjoule.core.errors import RailjouleError
from railjoule.core.scenario import Scenario, as_scenario
from railjoule.core.studies.rows import CHUNKS_PER_WORKER, completed_chunks, worker_count
from railjoule.core.studies.sweep.engine import solve_rows
from railjoule.core.studies.sweep.fields import Method
from railjoule.core.studies.sweep.results import MemoryResults, SweepFile, SweepTable
from railjoule.core.studies.sweep.study import DEFAULT_COLUMNS, Study, make_study

FIRST_CHUNK, MAX_CHUNK = 64, 2048
"""Rows of the first chunks, whose duration is unknown, and of any chunk; slow strategies need a second for a row."""
CHUNK_S = 1.0
"""Duration of a chunk [s]: short enough for progress and a stop, long against the time to submit it."""
SHORTEST_CHUNKS = 8
"""The last chunks are shorter by at most this factor, so that all workers end at about the same time."""


class InterruptedStudyError(RailjouleError):
    """A study whose workers are lost; its completed rows are saved."""


def sweep(
    scenario: Scenario | str | Path,
    over: Mapping[str, tuple[float, float]],
    sample: int,
    method: Method = "sobol",
    *,
    seed: int = 0,
    strategy: str | None = None,
    columns: Sequence[str] = DEFAULT_COLUMNS,
    executor: Executor | None = None,
    workers: Callable[[], int] | None = None,
    progress: Callable[[int], None] | None = None,
) -> SweepTable:
    """Compute runs of a scenario whose numbers vary, as one table.

    A row equals the result of `solve` for the scenario with its values, and does not depend on the executor. For a
    study that outlives the process, use `make_study`, `SweepFile` and `run_study`.

    Parameters
    ----------
    scenario : Scenario, str or Path
        All other numbers.
    over : mapping of str to (float, float)
        Lowest and highest value of each field, by its path in the file, such as "vehicle.load_factor".
    sample : int
        Number of rows.
    method : str
        How rows are drawn: "grid", "random", "sobol" or "halton".
    seed : int
        The same seed draws the same rows; a grid needs none.
    strategy : str, optional
        Overrides the strategy of the scenario.
    columns : sequence of str
        Results of each run, of `COLUMNS`.
    executor, workers, progress
        As in `run_study`.

    Raises
    ------
    ScenarioError
        If a field is unknown or not a number, its range exceeds its bounds, method, strategy or column do not exist, or
        the table would be too large. A row that cannot be driven is in the table with its reason.
    InterruptedStudyError
        As in `run_study`.
    """
    study = make_study(as_scenario(scenario), over, sample, method, seed=seed, strategy=strategy, columns=columns)
    results = MemoryResults(study)
    run_study(results, executor=executor, workers=workers, progress=progress)
    return results.to_table()


def run_study(
    results: SweepFile,
    *,
    executor: Executor | None = None,
    workers: Callable[[], int] | None = None,
    progress: Callable[[int], None] | None = None,
    stop: Event | None = None,
) -> None:
    """Compute all missing rows of a study.

    Parameters
    ----------
    results : SweepFile
        The study and its completed rows; new rows are added from this thread only.
    executor : Executor, optional
        Computes the rows; by default threads, one per processor.
    workers : callable, optional
        Returns how many chunks the executor works on at a time, which may change; by default one per processor. Its
        exceptions end the study.
    progress : callable, optional
        Called with the number of completed rows after each chunk.
    stop : Event, optional
        No chunk begins once it is set.

    Raises
    ------
    InterruptedStudyError
        If the executor has lost its workers; the completed rows are saved.
    """
    require_compiled()
    study, workers = results.study, workers or worker_count
    saved_at, rows, seconds = time.perf_counter(), 0, 0.0

    def chunk_size(left: int) -> int:
        if not rows:
            return FIRST_CHUNK
        most = max(1, min(int(CHUNK_S * rows / seconds), MAX_CHUNK))
        return max(min(most, left // (CHUNKS_PER_WORKER * max(1, workers()))), most // SHORTEST_CHUNKS, 1)

    work, samples = partial(solve_rows, study), _samples(study, results.gaps(), chunk_size)
    with (
        ThreadPoolExecutor(worker_count(), "sweep") if executor is None else nullcontext(executor) as own,
        # closing cancels the chunks that no worker has begun
        closing(completed_chunks(work, samples, own, workers, stop)) as chunks,
    ):
        try:
            for chunk in chunks:
                rows, seconds = rows + len(chunk.samples), seconds + chunk.rows.seconds
                now = time.perf_counter()
                results.append(chunk, now - saved_at)
                saved_at = now
                if progress is not None:
                    progress(results.done)
        except (BrokenExecutor, CancelledError) as error:
            raise InterruptedStudyError(
                f"the workers of the study are gone; {results.done:,} of {study.sample:,} rows are done and kept."
            ) from error


def _samples(
    study: Study, gaps: Sequence[tuple[int, int]], chunk_size: Callable[[int], int]
) -> Iterator[tuple[int, FloatArray]]:
    """Yield first row and samples of each chunk in the gaps, of the size that is right when it is drawn."""
    left = sum(end - first for first, end in gaps)
    for reached, end in gaps:
        first = reached
        while first < end:
            count = min(chunk_size(left), end - first)
            yield first, study.draw(first, count)
            first, left = first + count, left - count
