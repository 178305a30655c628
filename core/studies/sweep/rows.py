"""Deterministic rows: each depends only on its own sample. All studies are computed from them."""

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.budget import Budget, current_budget, within
from railjoule.core.errors import RailjouleError


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
