"""The samples of a sweep: a row depends on its number, the seed and the ranges alone.

A grid takes equal steps of each field. Random rows are independent; those of Sobol' and Halton fill the box evenly,
scrambled by the seed. Of a longer sample of one of these three a shorter one is the beginning.

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
# of SciPy's Sobol' points, which have 30 bits
MOST_ROWS = 2**30
LARGEST_SEED = 2**63


class Sampler:
    """Draws the rows of a sweep one after another.

    Parameters
    ----------
    fields : sequence of Field
    rows : int
        How many there are.
    method : str
        One of `METHODS`.
    seed : int
        Of all but the grid.

    Raises
    ------
    ScenarioError
        If there is no such method, a number is none, or a grid does not have just so many rows.
    """

    def __init__(self, fields: Sequence[Field], rows: int, method: str, seed: int) -> None:
        for name, number, least, most in (("sample", rows, 1, MOST_ROWS), ("seed", seed, 0, LARGEST_SEED)):
            if isinstance(number, bool) or not isinstance(number, int) or not least <= number <= most:
                raise ScenarioError(f"{name} = {show(number)} must be a whole number from {least} to {most:,}.")
        if method not in METHODS:
            raise ScenarioError(f"method = {show(method)} must be one of {', '.join(METHODS)}.")
        self._fields, self._rows, self._drawn = tuple(fields), rows, 0
        self._levels = _levels(fields, rows) if method == "grid" else None
        self._generator: Any = None if method == "grid" else _generator(method, len(fields), seed)

    def take(self, count: int) -> FloatArray:
        """Return the next rows, at most so many; shape (rows, fields)."""
        count = min(count, self._rows - self._drawn)
        first, self._drawn = self._drawn, self._drawn + count
        if self._levels is not None:
            # the last field changes fastest, as in a nested loop
            places = np.unravel_index(np.arange(first, first + count), [len(levels) for levels in self._levels])
            return np.column_stack([levels[place] for levels, place in zip(self._levels, places, strict=True)])
        low, high = (np.array([getattr(field, end) for field in self._fields]) for end in ("low", "high"))
        whole = np.array([field.whole for field in self._fields])
        shares = self._shares(first, count)
        # each whole number has an equal share; low + (high - low) may end a rounding above high
        values = np.where(whole, low + np.floor(shares * (high - low + 1)), low + shares * (high - low))
        within: FloatArray = np.minimum(values, high)
        return within

    def _shares(self, first: int, count: int) -> FloatArray:
        """Return the next points of the unit cube; shape (count, fields)."""
        generator = self._generator
        if isinstance(generator, np.random.Generator):
            drawn: FloatArray = generator.random((count, len(self._fields)))
            return drawn
        if first > 0 or count < 2:
            shares: FloatArray = generator.random(count)
            return shares
        # SciPy warns of a first draw of Sobol' points that is no power of two; 1 is one
        return np.concatenate([generator.random(1), generator.random(count - 1)])


def level_count(field: Field, rows: int, fields: int, method: str) -> int | None:
    """Return how many values a field takes in so many rows over so many fields; None if any of its range."""
    if method == "grid":
        return _grid_levels(rows, fields)
    return int(field.high - field.low) + 1 if field.whole else None


def _grid_levels(rows: int, fields: int) -> int:
    levels: int = round(rows ** (1 / fields))
    return levels


def _generator(method: str, dimensions: int, seed: int) -> Any:
    generator = np.random.default_rng(seed)
    if method == "random":
        return generator
    from scipy.stats import qmc  # noqa: PLC0415  (slow to import, and seldom needed)

    # a generator and no number: of which one SciPy makes of a number, its versions differ
    return (qmc.Sobol if method == "sobol" else qmc.Halton)(dimensions, scramble=True, seed=generator)


def _levels(fields: Sequence[Field], rows: int) -> list[FloatArray]:
    """Return the values of each field of a grid.

    Raises
    ------
    ScenarioError
        If no grid with as many values of each field has so many rows, or a field has not as many whole numbers.
    """
    count = _grid_levels(rows, len(fields))
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
