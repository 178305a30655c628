"""The samples of a sweep: a row depends only on its number, the seed and the ranges.

A grid has equal steps of each field. Random rows are independent; Sobol' and Halton rows fill the box evenly, scrambled
by the seed. For these three methods, a shorter sample is the beginning of a longer one.

References: Sobol', USSR Computational Mathematics and Mathematical Physics 7, 1967; Halton, Numerische Mathematik 2,
1960; Owen, Journal of Complexity 14, 1998, for the scrambling; all by `scipy.stats.qmc`.
"""

from collections.abc import Sequence
from typing import Literal, get_args

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


def require_sample(fields: Sequence[Field], rows: int, method: str, seed: int) -> None:
    """Check that rows can be drawn; arguments as in `draw_rows`.

    Raises
    ------
    ScenarioError
        If the method does not exist, a number is out of its bounds, or no grid has this number of rows.
    """
    for name, number, least, most in (("sample", rows, 1, MAX_ROWS), ("seed", seed, 0, MAX_SEED)):
        if isinstance(number, bool) or not isinstance(number, int) or not least <= number <= most:
            raise ScenarioError(f"{name} = {show(number)} must be a whole number from {least} to {most:,}.")
    if method not in METHODS:
        raise ScenarioError(f"method = {show(method)} must be one of {', '.join(METHODS)}.")
    if method == "grid":
        _levels(fields, rows)


def draw_rows(fields: Sequence[Field], rows: int, method: str, seed: int, first: int, count: int) -> FloatArray:
    """Return consecutive rows of a sample; shape (count, fields).

    Parameters
    ----------
    fields : sequence of Field
    rows : int
        Number of all rows.
    method : str
        One of `METHODS`.
    seed : int
        Not used by a grid.
    first, count : int
        Number of the first row, and how many.
    """
    if method == "grid":
        levels = _levels(fields, rows)
        # the last field changes fastest, as in a nested loop
        places = np.unravel_index(np.arange(first, first + count), [len(values) for values in levels])
        return np.column_stack([values[place] for values, place in zip(levels, places, strict=True)])
    low, high, whole = np.array([(field.low, field.high, field.whole) for field in fields]).T
    shares = _shares(len(fields), method, seed, first, count)
    # each whole number has an equal share; low + (high - low) may round to a value above high
    values = np.where(whole > 0, low + np.floor(shares * (high - low + 1)), low + shares * (high - low))
    within: FloatArray = np.minimum(values, high)
    return within


def _shares(width: int, method: str, seed: int, first: int, count: int) -> FloatArray:
    """Return consecutive points of the unit cube; shape (count, width)."""
    bits = np.random.PCG64(seed)
    if method == "random":
        # one state of the generator for each number
        return np.random.Generator(bits.advance(first * width)).random((count, width))
    from scipy.stats import qmc  # noqa: PLC0415  (slow to import, and rarely needed)

    # a generator, as the one that SciPy makes of a number differs between its versions
    engine = (qmc.Sobol if method == "sobol" else qmc.Halton)(width, scramble=True, seed=np.random.Generator(bits))
    if first:
        return np.asarray(engine.fast_forward(first).random(count))
    # SciPy warns of a first draw of Sobol' points that is not a power of two; 1 is one
    return np.concatenate([engine.random(part) for part in (1, count - 1)])


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
