"""The samples of a sweep: a row depends only on its number, the seed and the ranges.

A grid has equal steps of each field. Random rows are independent; Sobol' and Halton rows fill the box evenly, scrambled
by the seed. For these three methods, a shorter sample is the beginning of a longer one.

References: Sobol', USSR Computational Mathematics and Mathematical Physics 7, 1967; Halton, Numerische Mathematik 2,
1960; Owen, Journal of Complexity 14, 1998, for the scrambling; all by `scipy.stats.qmc`.
"""

from collections.abc import Sequence
from typing import Any, Literal, get_args

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.errors import ScenarioError
from railjoule.core.scenario._sentences import show
from railjoule.core.studies.sweep.fields import Field

Method = Literal["grid", "random", "sobol", "halton"]
METHODS: tuple[Method, ...] = get_args(Method)
MAX_ROWS = 2**30
"""SciPy's Sobol' points have 30 bits."""
MAX_SEED = 2**63


class Sampler:
    """Draw the rows of a sweep in their order.

    Parameters
    ----------
    fields : sequence of Field
    rows : int
        Number of all rows.
    method : str
        One of `METHODS`.
    seed : int
        Not used by a grid.

    Raises
    ------
    ScenarioError
        If the method does not exist, a number is out of its bounds, or no grid has this number of rows.
    """

    def __init__(self, fields: Sequence[Field], rows: int, method: str, seed: int) -> None:
        for name, number, least, most in (("sample", rows, 1, MAX_ROWS), ("seed", seed, 0, MAX_SEED)):
            if isinstance(number, bool) or not isinstance(number, int) or not least <= number <= most:
                raise ScenarioError(f"{name} = {show(number)} must be a whole number from {least} to {most:,}.")
        if method not in METHODS:
            raise ScenarioError(f"method = {show(method)} must be one of {', '.join(METHODS)}.")
        self._fields, self._rows, self._drawn = tuple(fields), rows, 0
        self._levels = _levels(fields, rows) if method == "grid" else None
        self._generator: Any = np.random.default_rng(seed)
        if method in {"sobol", "halton"}:
            from scipy.stats import qmc  # noqa: PLC0415  (slow to import, and rarely needed)

            # a generator, as the one that SciPy makes of a number differs between its versions
            engine = qmc.Sobol if method == "sobol" else qmc.Halton
            self._generator = engine(len(fields), scramble=True, seed=self._generator)

    def take(self, count: int) -> FloatArray:
        """Return at most `count` further rows; shape (rows, fields)."""
        count = min(count, self._rows - self._drawn)
        first, self._drawn = self._drawn, self._drawn + count
        if self._levels is not None:
            # the last field changes fastest, as in a nested loop
            places = np.unravel_index(np.arange(first, first + count), [len(levels) for levels in self._levels])
            return np.column_stack([levels[place] for levels, place in zip(self._levels, places, strict=True)])
        low, high, whole = np.array([(field.low, field.high, field.whole) for field in self._fields]).T
        shares = self._shares(first, count)
        # each whole number has an equal share; low + (high - low) may round to a value above high
        values = np.where(whole > 0, low + np.floor(shares * (high - low + 1)), low + shares * (high - low))
        within: FloatArray = np.minimum(values, high)
        return within

    def _shares(self, first: int, count: int) -> FloatArray:
        """Return the next points of the unit cube; shape (count, fields)."""
        if isinstance(self._generator, np.random.Generator):
            return self._generator.random((count, len(self._fields)))
        # SciPy warns of a first draw of Sobol' points that is not a power of two; 1 is one
        counts = (1, count - 1) if first == 0 and count > 1 else (count,)
        return np.concatenate([self._generator.random(part) for part in counts])


def levels_per_field(rows: int, fields: int) -> int:
    """Return the number of values of each field of a grid."""
    count: int = round(rows ** (1 / fields))
    return count


def _levels(fields: Sequence[Field], rows: int) -> list[FloatArray]:
    """Return the values of each field of a grid.

    Raises
    ------
    ScenarioError
        If no grid with the same number of values for each field has this number of rows, or a field has fewer whole
        numbers.
    """
    count = levels_per_field(rows, len(fields))
    if count ** len(fields) != rows:
        below = count if count ** len(fields) < rows else count - 1
        near = " or ".join(f"{number ** len(fields):,}" for number in (below, below + 1) if number)
        raise ScenarioError(
            f"sample = {rows:,}: a grid over {len(fields)} fields has as many values of each, such as {near} rows."
        )
    levels = [np.linspace(field.low, field.high, count) for field in fields]
    for number, field in enumerate(fields):
        if field.whole:
            levels[number] = np.rint(levels[number])
            if len(np.unique(levels[number])) < count:
                there = int(field.high - field.low) + 1
                raise ScenarioError(f"{field.name} has {there} whole numbers, fewer than the {count} of the grid.")
    return levels
