"""The fields of a scenario that a sweep varies, their ranges and samples, and how a value is put into the scenario.

`Scenario.replace` writes a document and reads it again. This checks everything and takes longer than the optimum
itself. A sweep therefore checks only the corners of the box that its ranges span. Each rule of a scenario bounds a
number on one side by constants or by other numbers, so that a rule kept at all corners is kept between them. Inside the
box, values are put into copies of their tables, and all other tables are shared.

A row of a sample depends only on its number, the seed and the ranges. A grid has equal steps of each field. Random rows
are independent; Sobol' and Halton rows fill the box evenly, scrambled by the seed. For these three methods, a shorter
sample is the beginning of a longer one.

References: Sobol', USSR Computational Mathematics and Mathematical Physics 7, 1967; Halton, Numerische Mathematik 2,
1960; Owen, Journal of Complexity 14, 1998, for the scrambling; all by `scipy.stats.qmc`.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any, Literal, get_args

import numpy as np
from pydantic import BaseModel, TypeAdapter

from railjoule.core.arrays import FloatArray
from railjoule.core.errors import ScenarioError
from railjoule.core.scenario import Scenario
from railjoule.core.scenario._sentences import shorten, show, suggestion
from railjoule.core.scenario.document import EXCLUSIVE_KEYS

MAX_FIELDS = 10
"""Most fields of a sweep: each doubles the number of corners to check."""
Path = tuple[str, ...]


@dataclass(frozen=True)
class Field:
    """A number of a scenario and its range.

    Parameters
    ----------
    name : str
        Its path in the file, such as "vehicle.load_factor".
    path : tuple of str
        Its path in a `Scenario`.
    low, high : float
        The range, both ends included, in the unit of the field.
    whole : bool
        Whether it takes only whole numbers.
    """

    name: str
    path: Path
    low: float
    high: float
    whole: bool

    def value(self, number: float) -> float | int:
        """Return a number of a sample as the scenario takes it."""
        return round(number) if self.whole else number


def parse_fields(scenario: Scenario, over: Mapping[str, tuple[float, float]]) -> tuple[Field, ...]:
    """Return the fields that a sweep varies, in the order given.

    Parameters
    ----------
    scenario : Scenario
    over : mapping of str to (float, float)
        Lowest and highest value by the path of the field in the file.

    Raises
    ------
    ScenarioError
        If there are none or too many, a field is unknown or not a number, two of them exclude each other, or a range is
        invalid or exceeds the bounds of its field.
    """
    if not 1 <= len(over) <= MAX_FIELDS:
        raise ScenarioError(f"a sweep varies 1 to {MAX_FIELDS} fields, not {len(over)}.")
    fields = tuple(_field(scenario, name, ends) for name, ends in over.items())
    for field in fields:
        same = next((other.name for other in fields if other is not field and _exclude(field, other)), None)
        if same is not None:
            raise ScenarioError(f"{field.name} and {same} say the same thing: a sweep varies one of them.")
        for end in (field.low, field.high):
            # the other fields keep their values: an error is one of this field
            scenario.replace(**{field.name: field.value(end)})
    return fields


def _exclude(one: Field, other: Field) -> bool:
    """Return whether two fields are the same, or only one of them can have an effect."""
    pair = {one.path[-1], other.path[-1]}
    return one.path[:-1] == other.path[:-1] and (len(pair) == 1 or any(pair <= group for group in EXCLUSIVE_KEYS))


def _field(scenario: Scenario, name: str, ends: tuple[float, float]) -> Field:
    low, high = ends
    for end in ends:
        if isinstance(end, bool) or not isinstance(end, int | float) or not math.isfinite(end):
            raise ScenarioError(f"{shorten(name)}: {show(end)} is no end of a range, which is a finite number.")
    if low > high:
        raise ScenarioError(f"{shorten(name)}: the range {low:g} to {high:g} begins above its end.")
    parts = name.split(".")
    # the drive is a table of its own in a file
    path = ("vehicle", *parts) if parts[0] == "drive" else tuple(parts)
    schema = TypeAdapter(_annotation(scenario, path, name)).json_schema()
    kinds = {kind.get("type") for kind in schema.get("anyOf", [schema])}
    if not kinds & {"number", "integer"} or kinds - {"number", "integer", "null"}:
        raise ScenarioError(f"{shorten(name)} is no number: a sweep varies only numbers.")
    whole = "number" not in kinds
    if whole and not (float(low).is_integer() and float(high).is_integer()):
        raise ScenarioError(f"{name}: the ends of the range {low:g} to {high:g} must be whole numbers.")
    return Field(name, path, float(low), float(high), whole)


def _annotation(scenario: Scenario, path: Path, name: str) -> Any:
    """Return the declared type of the field at a path of a scenario."""
    table: Any = scenario
    for key, following in zip(path, (*path[1:], None), strict=True):
        known = set(type(table).model_fields)
        if key not in known:
            known |= {"drive"} if table is scenario else set()
            raise ScenarioError(f"unknown key {shorten(name)}, {suggestion(key, known)}.".replace("?.", "?"))
        if following is None:
            break
        table = getattr(table, key)
        if not isinstance(table, BaseModel):
            raise ScenarioError(f"{shorten(name)}: {shorten(key)} is no table with numbers in this scenario.")
    return type(table).model_fields[path[-1]].annotation


def corners_hold(scenario: Scenario, fields: Sequence[Field]) -> bool:
    """Return whether the scenario is valid at every corner of the box that the ranges span."""
    for ends in product(*(sorted({field.low, field.high}) for field in fields)):
        try:
            scenario.replace(**{field.name: field.value(end) for field, end in zip(fields, ends, strict=True)})
        except ScenarioError:
            return False
    return True


def patched(scenario: Scenario, fields: Sequence[Field], values: Sequence[float]) -> Scenario:
    """Return a scenario with values, one for each field, that the corners of their ranges were checked for.

    Unchanged tables are the same objects. Keys that a field excludes get their defaults.
    """
    updates: dict[str, Any] = {}
    for field, value in zip(fields, values, strict=True):
        *tables, key = field.path
        update: dict[str, Any] = updates
        table: Any = scenario
        for name in tables:
            update, table = update.setdefault(name, {}), getattr(table, name)
        for other in set().union(*(group for group in EXCLUSIVE_KEYS if key in group)) & set(type(table).model_fields):
            update[other] = type(table).model_fields[other].default
        update[key] = field.value(value)
    made: Scenario = _updated(scenario, updates)
    return made


def _updated(table: Any, updates: Mapping[str, Any]) -> Any:
    """Return a copy of a table with new values; a mapping has those of a table within it."""
    return table.model_copy(
        update={k: _updated(getattr(table, k), new) if isinstance(new, dict) else new for k, new in updates.items()}
    )


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
