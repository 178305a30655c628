"""A table of runs: the inputs that vary, the results, and how their numbers are written."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from railjoule.core.arrays import FloatArray, IntArray
from railjoule.dashboard.look import words

Ends = tuple[float, float]


@dataclass(frozen=True)
class Column:
    """A quantity of each run.

    Parameters
    ----------
    words : str
        Quantity and unit, as on an axis; a dash where it has no unit.
    show : callable
        Returns the text of a number, without its unit.
    range : tuple of float or None
        The ends between which an input varies; None for a result.
    """

    words: str
    show: Callable[[float], str]
    range: Ends | None = None

    @property
    def quantity(self) -> str:
        """The quantity without its unit."""
        return self.words.rpartition(", ")[0]

    @property
    def unit(self) -> str:
        """The unit; empty where there is none."""
        unit = self.words.rpartition(", ")[2]
        return "" if unit == words.UNKNOWN else unit

    @property
    def label(self) -> str:
        """Quantity and unit, without a dash."""
        return f"{self.quantity}, {self.unit}".rstrip(", ")

    @property
    def within_sentence(self) -> str:
        """The quantity as within a sentence."""
        name = self.quantity
        return name[:1].lower() + name[1:]

    def with_unit(self, number: float) -> str:
        """Return a number with its unit."""
        return f"{self.show(number)} {self.unit}".rstrip()


@dataclass(frozen=True, eq=False)
class RunTable:
    """The runs of a study, or random draws.

    Parameters
    ----------
    title : str
        The source of the runs.
    columns : mapping of str to Column
        The inputs, then the results.
    values : mapping of str to array
        By column, of the feasible runs in the unit of the column; shape (feasible,).
    rows : array of shape (feasible,)
        The numbers of the feasible runs.
    done : int
        Completed runs, the infeasible ones included.
    answer : str
        The column of the energy.
    reason : str
        Why the first infeasible run has no result.
    """

    title: str
    columns: Mapping[str, Column]
    values: Mapping[str, FloatArray]
    rows: IntArray
    done: int
    answer: str
    reason: str = ""

    @property
    def inputs(self) -> tuple[str, ...]:
        """The columns that vary on purpose."""
        return tuple(name for name, column in self.columns.items() if column.range is not None)


def digits_for(span: float) -> int:
    """Return the decimals that distinguish two hundredths of a span."""
    return int(np.clip(np.ceil(-np.log10(span / 200)), 0, 9)) if span > 0 else 2
