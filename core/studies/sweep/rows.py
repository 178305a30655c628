"""Rows of numbers that hang on nothing but their own samples: what all studies are made of."""

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
    """Rows of a study that are done.

    Parameters
    ----------
    values : array of shape (rows, columns)
        NaN where a number is not known, or there is no run.
    reasons : dict of int to str
        Why there is no run, by the row.
    seconds : float
        How long they took [s].
    """

    values: FloatArray
    reasons: dict[int, str]
    seconds: float


@dataclass(frozen=True, eq=False)
class RowByRow:
    """Makes rows of samples, one by one; other threads and processes take it whole.

    Parameters
    ----------
    run : callable
        Returns a row's numbers for its sample, None where one is not known.
    width : int
        How many numbers.
    refusals : type or tuple of types
        Errors that are a result of the study: the row stays empty, and keeps the sentence.
    budget : Budget
        What each run may take: that of who asks, as a thread does not inherit it.
    """

    run: Callable[[Sequence[float]], Sequence[float | None]]
    width: int
    refusals: type[RailjouleError] | tuple[type[RailjouleError], ...] = RailjouleError
    budget: Budget = field(default_factory=current_budget)

    def __call__(self, samples: FloatArray) -> Rows:
        """Return what comes out for samples of shape (rows, fields)."""
        started = time.perf_counter()
        values, reasons = np.full((len(samples), self.width), np.nan), {}
        with within(self.budget):
            for row, sample in enumerate(samples.tolist()):
                try:
                    numbers = self.run(sample)
                except self.refusals as error:
                    # what cannot be is a result of a study, too
                    reasons[row] = str(error)
                    continue
                values[row] = [math.nan if number is None else number for number in numbers]
        return Rows(values, reasons, time.perf_counter() - started)
