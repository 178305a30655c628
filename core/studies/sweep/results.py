"""Rows of a sweep that are done, as they come, and the table that they become."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np

from railjoule.core.arrays import FloatArray, IntArray, frozen_array
from railjoule.core.errors import ScenarioError
from railjoule.core.studies.sweep.rows import Rows
from railjoule.core.studies.sweep.study import Study

if TYPE_CHECKING:
    import pandas

LARGEST_TABLE_BYTES = 2**28
"""What the numbers of a table in memory may take: with its copies a process takes about 1 GB."""
BYTES_A_NUMBER = 8


@dataclass(frozen=True, eq=False)
class Chunk:
    """Rows of a sweep that stand one after another.

    Parameters
    ----------
    first : int
        The number of the first one.
    samples : array of shape (rows, fields)
        The fields' values.
    rows : Rows
        What came out.
    """

    first: int
    samples: FloatArray
    rows: Rows

    @property
    def end(self) -> int:
        """The number of the row after the last one."""
        return self.first + len(self.samples)

    @property
    def reasons(self) -> dict[int, str]:
        """Why there is no run, by the row's number."""
        return {self.first + row: reason for row, reason in self.rows.reasons.items()}


class Done(Protocol):
    """Rows of a sweep, all or some, to be read."""

    @property
    def study(self) -> Study:
        """What is being made."""

    @property
    def done(self) -> int:
        """How many rows are kept."""

    @property
    def seconds(self) -> float:
        """How long they took together [s]."""

    def chunks(self) -> Iterator[Chunk]:
        """Yield all that is kept in the order of the rows."""


class Results(Done, Protocol):
    """Where the rows of a sweep are kept while it runs; one thread appends, any may read."""

    def gaps(self) -> list[tuple[int, int]]:
        """Return the first row and the row after the last one of all stretches that are still to be done."""

    def append(self, chunk: Chunk, elapsed_s: float) -> None:
        """Keep a chunk that took so much longer than what is kept [s]."""


@dataclass(frozen=True, eq=False)
class SweepTable:
    """What was varied and what came out, row by row; NaN where there is no run.

    Parameters
    ----------
    study : Study
        What was asked for.
    index : array of shape (rows,)
        The numbers of the rows: all from 0 on, but for those that are not done.
    samples : mapping of str to array
        Values by field, each of shape (rows,).
    columns : mapping of str to array
        Results by name, each of shape (rows,).
    reasons : mapping of int to str
        Why there is no run, by the row's number.
    seconds : float
        How long the runs took together [s].
    """

    study: Study
    index: IntArray
    samples: Mapping[str, FloatArray]
    columns: Mapping[str, FloatArray]
    reasons: Mapping[int, str]
    seconds: float

    @property
    def rows(self) -> int:
        """How many rows there are."""
        return len(self.index)

    @property
    def done(self) -> int:
        """The same, as `Done` calls it."""
        return self.rows

    @property
    def runs_per_s(self) -> float:
        """Rows in one second [1/s]."""
        return self.rows / self.seconds

    def chunks(self) -> Iterator[Chunk]:
        """Yield all rows in stretches without gaps."""
        samples, values = (np.column_stack(list(of.values())) for of in (self.samples, self.columns))
        for part in np.split(np.arange(self.rows), np.flatnonzero(np.diff(self.index) != 1) + 1):
            if len(part):
                first, last = int(self.index[part[0]]), int(self.index[part[-1]])
                reasons = {row - first: reason for row, reason in self.reasons.items() if first <= row <= last}
                yield Chunk(first, samples[part], Rows(values[part], reasons, 0.0))

    def to_dataframe(self) -> "pandas.DataFrame":
        """Return the table, with the reason why there is no run, empty where there is one."""
        import pandas  # noqa: PLC0415  (slow to import, and seldom needed)

        reasons = [self.reasons.get(row, "") for row in self.index.tolist()]
        return pandas.DataFrame({**self.samples, **self.columns, "reason": reasons}, index=self.index)


class MemoryResults:
    """Rows that are kept as long as the process.

    Parameters
    ----------
    study : Study

    Raises
    ------
    ScenarioError
        If its table would be too large.
    """

    def __init__(self, study: Study) -> None:
        require_memory(study)
        self.study, self.seconds = study, 0.0
        self._samples = np.empty((study.sample, len(study.fields)))
        self._values = np.full((study.sample, len(study.columns)), np.nan)
        self._reasons: dict[int, str] = {}
        self._stretches: dict[int, int] = {}

    @property
    def done(self) -> int:
        """How many rows are kept."""
        return sum(end - first for first, end in list(self._stretches.items()))

    def gaps(self) -> list[tuple[int, int]]:
        """Return what is still to be done, as `Results.gaps`."""
        return gaps_between(sorted(self._stretches.items()), self.study.sample)

    def append(self, chunk: Chunk, elapsed_s: float) -> None:
        """Keep a chunk, as `Results.append`."""
        here = slice(chunk.first, chunk.end)
        self._samples[here], self._values[here] = chunk.samples, chunk.rows.values
        self._reasons |= chunk.reasons
        self.seconds += elapsed_s
        # last: a reader takes what is named here alone
        self._stretches[chunk.first] = chunk.end

    def chunks(self) -> Iterator[Chunk]:
        """Yield all that is kept, as `Results.chunks`."""
        for first, end in sorted(self._stretches.items()):
            reasons = {row - first: self._reasons[row] for row in range(first, end) if row in self._reasons}
            yield Chunk(first, self._samples[first:end], Rows(self._values[first:end], reasons, 0.0))


def table_of(results: Done) -> SweepTable:
    """Return all rows that are done as one table, in the order of their numbers.

    Raises
    ------
    ScenarioError
        If it would be too large for the memory.
    """
    require_memory(results.study)
    return chunk_table(results.study, list(results.chunks()), results.seconds)


def chunk_table(study: Study, chunks: Sequence[Chunk], seconds: float) -> SweepTable:
    """Return chunks of a study, in the order of their rows, as one table."""
    samples = np.concatenate([np.empty((0, len(study.fields))), *(chunk.samples for chunk in chunks)])
    values = np.concatenate([np.empty((0, len(study.columns))), *(chunk.rows.values for chunk in chunks)])
    index = np.concatenate([np.empty(0, dtype=np.int64), *(np.arange(chunk.first, chunk.end) for chunk in chunks)])
    return SweepTable(
        study,
        _frozen(index),
        {field.name: frozen_array(samples[:, k]) for k, field in enumerate(study.fields)},
        {column: frozen_array(values[:, k]) for k, column in enumerate(study.columns)},
        {row: reason for chunk in chunks for row, reason in sorted(chunk.reasons.items())},
        seconds,
    )


def _frozen(index: IntArray) -> IntArray:
    index.setflags(write=False)
    return index


def gaps_between(stretches: list[tuple[int, int]], rows: int) -> list[tuple[int, int]]:
    """Return what sorted stretches, each its first row and the one after its last, leave of so many rows."""
    gaps, reached = [], 0
    for first, end in [*stretches, (rows, rows)]:
        if first > reached:
            gaps.append((reached, first))
        reached = end
    return gaps


def require_memory(study: Study) -> None:
    """Raise ScenarioError if the table of a study is too large for the memory."""
    row_bytes = study.width * BYTES_A_NUMBER
    if study.sample * row_bytes > LARGEST_TABLE_BYTES:
        raise ScenarioError(
            f"sample = {study.sample:,}: a table of {study.width} columns takes at most "
            f"{LARGEST_TABLE_BYTES // row_bytes:,} rows in memory, which are {LARGEST_TABLE_BYTES / 1e9:.1f} GB of "
            "numbers."
        )
