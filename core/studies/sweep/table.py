"""The entry of a sweep: rows are drawn in order, solved in chunks by any executor, and put together as one table."""

import os
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ThreadPoolExecutor, wait
from contextlib import nullcontext
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.budget import current_budget
from railjoule.core.errors import ScenarioError
from railjoule.core.scenario import STRATEGY_NAMES, Scenario, StrategyName
from railjoule.core.scenario._sentences import show
from railjoule.core.studies.sweep.columns import DEFAULT_COLUMNS, require_columns
from railjoule.core.studies.sweep.engine import Plan, Rows, solve_rows
from railjoule.core.studies.sweep.fields import corners_hold, fields_of
from railjoule.core.studies.sweep.sampling import Method, Sampler

if TYPE_CHECKING:
    import pandas

# the first tells what a row costs; slow strategies take a second for one
FIRST_CHUNK, LARGEST_CHUNK = 64, 2048
CHUNK_S = 1.0
"""A chunk is to take about so long [s]: short enough to show progress and to stop, long beside what handing it over
takes."""
SHORTEST_CHUNKS = 8
"""By which the last chunks are shorter at most."""
CHUNKS_A_WORKER = 2
"""Handed over at a time: one that is worked on, and one that waits."""
LARGEST_TABLE_BYTES = 2**28
"""What the numbers of a table may take: with its copies on the way to a Parquet file a process takes about 1 GB."""
BYTES_A_NUMBER = 8


@dataclass(frozen=True, eq=False)
class SweepTable:
    """What was varied and what came out, row by row; NaN where there is no run.

    Parameters
    ----------
    scenario : Scenario
        Whose numbers vary.
    strategy : str
        Who made the runs.
    method : str
        How the samples were drawn.
    seed : int
    samples : mapping of str to array
        Values by field, each of shape (rows,).
    columns : mapping of str to array
        Results by name, each of shape (rows,).
    reasons : mapping of int to str
        Why there is no run, by the row.
    seconds : float
        How long the runs took together [s].
    """

    scenario: Scenario
    strategy: StrategyName
    method: Method
    seed: int
    samples: Mapping[str, FloatArray]
    columns: Mapping[str, FloatArray]
    reasons: Mapping[int, str]
    seconds: float

    @property
    def rows(self) -> int:
        """How many rows there are."""
        return len(next(iter(self.samples.values())))

    @property
    def runs_per_s(self) -> float:
        """Rows in one second [1/s]."""
        return self.rows / self.seconds

    def to_dataframe(self) -> "pandas.DataFrame":
        """Return the table, with the reason why there is no run, empty where there is one."""
        import pandas  # noqa: PLC0415  (slow to import, and seldom needed)

        reasons = [self.reasons.get(row, "") for row in range(self.rows)]
        return pandas.DataFrame({**self.samples, **self.columns, "reason": reasons})


def sweep(
    scenario: Scenario,
    over: Mapping[str, tuple[float, float]],
    sample: int,
    method: Method = "sobol",
    *,
    seed: int = 0,
    strategy: StrategyName | None = None,
    columns: Sequence[str] = DEFAULT_COLUMNS,
    executor: Executor | None = None,
    progress: Callable[[int], None] | None = None,
) -> SweepTable:
    """Return runs of a scenario whose numbers vary, as one table.

    A row is the same as that of `solve` for the scenario with its values, and does not depend on the executor.

    Parameters
    ----------
    scenario : Scenario
        Where all other numbers stand.
    over : mapping of str to (float, float)
        Lowest and highest value of each field, by its path in the file, such as "vehicle.load_factor".
    sample : int
        How many rows.
    method : str
        How they are drawn: "grid", "random", "sobol" or "halton".
    seed : int
        The same seed draws the same rows; a grid needs none.
    strategy : str, optional
        Overrides the scenario's own.
    columns : sequence of str
        What is told of each run, of `COLUMNS`.
    executor : Executor, optional
        What solves the rows; by default threads, one a processor.
    progress : callable, optional
        Is told how many rows are done, from time to time.

    Raises
    ------
    ScenarioError
        If a field is unknown or no number, its range leads out of its bounds, there is no such method, strategy or
        column, or the table would be too large. A row that cannot be driven stands in the table with its reason.
    """
    name = strategy or scenario.strategy
    if name not in STRATEGY_NAMES:
        raise ScenarioError(f"strategy = {show(name)} must be one of {', '.join(STRATEGY_NAMES)}.")
    require_columns(columns)
    fields = fields_of(scenario, over)
    sampler = Sampler(fields, sample, method, seed)
    _require_room(sample, len(fields) + len(columns))
    plan = Plan(scenario, fields, name, tuple(columns), corners_hold(scenario, fields), current_budget())
    started = time.perf_counter()
    samples, values, reasons = _solved(plan, sampler, sample, executor, progress)
    return SweepTable(
        scenario,
        name,
        method,
        seed,
        {field.name: frozen_array(samples[:, k]) for k, field in enumerate(fields)},
        {column: frozen_array(values[:, k]) for k, column in enumerate(columns)},
        dict(sorted(reasons.items())),
        time.perf_counter() - started,
    )


def _require_room(rows: int, width: int) -> None:
    needed, most = rows * width * BYTES_A_NUMBER, LARGEST_TABLE_BYTES // (width * BYTES_A_NUMBER)
    if needed > LARGEST_TABLE_BYTES:
        raise ScenarioError(
            f"sample = {rows:,}: a table of {width} columns takes at most {most:,} rows, which are "
            f"{LARGEST_TABLE_BYTES / 1e9:.1f} GB of numbers."
        )


def _solved(
    plan: Plan,
    sampler: Sampler,
    rows: int,
    executor: Executor | None,
    progress: Callable[[int], None] | None,
) -> tuple[FloatArray, FloatArray, dict[int, str]]:
    """Return samples of shape (rows, fields), what came out of shape (rows, columns), and reasons by the row."""
    samples, values = np.empty((rows, len(plan.fields))), np.full((rows, len(plan.columns)), np.nan)
    reasons: dict[int, str] = {}

    def keep(first: int, done: Rows) -> None:
        values[first : first + len(done.values)] = done.values
        reasons.update({first + row: reason for row, reason in done.reasons.items()})

    with ThreadPoolExecutor(worker_count(), "sweep") if executor is None else nullcontext(executor) as workers:
        _hand_over(plan, sampler, samples, workers, keep, progress)
    return samples, values, reasons


def _hand_over(
    plan: Plan,
    sampler: Sampler,
    samples: FloatArray,
    executor: Executor,
    keep: Callable[[int, Rows], None],
    progress: Callable[[int], None] | None,
) -> None:
    """Draw all samples in order, and let an executor solve them in chunks of about a second."""
    waiting: dict[Future[Rows], tuple[int, int]] = {}
    drawn = done = 0
    size, seconds = FIRST_CHUNK, 0.0
    try:
        while drawn < len(samples) or waiting:
            while drawn < len(samples) and len(waiting) < CHUNKS_A_WORKER * worker_count():
                chunk = sampler.take(size)
                samples[drawn : drawn + len(chunk)] = chunk
                waiting[executor.submit(solve_rows, plan, chunk)] = drawn, len(chunk)
                drawn += len(chunk)
            finished, _ = wait(waiting, return_when=FIRST_COMPLETED)
            for future in finished:
                first, count = waiting.pop(future)
                rows = future.result()
                keep(first, rows)
                done, seconds = done + count, seconds + rows.seconds
            size = _chunk_size(seconds / done, len(samples) - drawn)
            if progress is not None:
                progress(done)
    finally:
        # whoever stops waits for no chunk that has not begun
        for future in waiting:
            future.cancel()


def _chunk_size(row_s: float, left: int) -> int:
    """Return how many rows the next chunk has, of those that are left, where one takes `row_s` [s]."""
    most = max(1, min(int(CHUNK_S / row_s), LARGEST_CHUNK))
    # towards the end shorter ones, so that all workers end at about the same time
    return max(min(most, left // (CHUNKS_A_WORKER * worker_count())), most // SHORTEST_CHUNKS, 1)


def worker_count() -> int:
    """Return how many processors this process may use."""
    # containers and batch systems give a process fewer than the machine has
    affinity: Any = getattr(os, "sched_getaffinity", None)
    return len(affinity(0)) if affinity is not None else os.cpu_count() or 1
