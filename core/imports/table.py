"""A table of intervals over chainage: its values within bounds, its rows in order, its gaps and overlaps."""

import math
import operator
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from railjoule.core.errors import ScenarioError
from railjoule.core.imports.cells import Cell
from railjoule.core.imports.findings import FromFile, Notes
from railjoule.core.imports.numbers import text_of_cell
from railjoule.core.imports.units import NOTHING, ColumnUnit, IntervalKind, TableKind
from railjoule.core.scenario import Section
from railjoule.core.scenario._sentences import show, shown_list

KEYS: Mapping[TableKind, str] = {
    "gradients": "gradient_permille",
    "limits": "speed_limit_kmh",
    "curves": "curve_radius_m",
    "tunnels": "tunnel_factor",
}
"""Keys of the values of each kind in a section of a scenario's line."""
BOUNDS = (("ge", "at least", operator.ge), ("gt", "above", operator.gt), ("le", "at most", operator.le))
# a millimetre less or more is how positions were rounded
MIN_STRETCH_M = 0.001
WHOLE = {"gradients": "level", "limits": "without a limit"}
"""Kinds of tables that tell of the whole line, and what a stretch without a row is taken to be."""
RULES = {
    "gradients": "that which begins later counts",
    "limits": "the lower counts",
    "curves": "the smaller radius counts",
    "tunnels": "that which begins later counts",
    "neutral": "both count",
}
"""Which of two rows over one stretch counts."""
ONE_VALUE = ("gradients", "tunnels")
"""Kinds of which a stretch has one value, and no rule chooses between two."""
DIGITS_M = 6
"""Positions are kept to the micrometre, so that the sum of two lengths has no tail of digits."""


@dataclass(frozen=True)
class Interval:
    """A stretch with one value; `to_m` is infinite where only the end of the line ends it."""

    from_m: float
    to_m: float
    value: float | None
    row: int


@dataclass(frozen=True)
class ImportedTable(FromFile):
    """A table of intervals in rising chainage.

    Positions are in m; gradients [per mille], limits [km/h], radii [m], tunnels as `value_unit`: 'factor', 'm2' (cross
    section), or empty.
    """

    kind: IntervalKind
    intervals: tuple[Interval, ...]
    value_unit: str = ""

    @property
    def begin_m(self) -> float:
        """Begin of the first row [m]."""
        return self.intervals[0].from_m

    @property
    def end_m(self) -> float:
        """The last known end [m]."""
        known = [interval.to_m for interval in self.intervals if math.isfinite(interval.to_m)]
        return max([*known, self.intervals[-1].from_m])


def stepwise(
    kind: IntervalKind, source: str, begins: Sequence[float], values: Sequence[float], end_m: float = math.inf
) -> ImportedTable:
    """Make a table of values each of which holds until the next begins, the last to an end [m]."""
    rows = enumerate(zip(begins, [*begins[1:], end_m], values, strict=True), 1)
    return ImportedTable(source, kind, tuple(Interval(*row, number) for number, row in rows))


def require_rising(positions: Sequence[float], where: str) -> None:
    """Raise ScenarioError if a position does not lie beyond the one before it."""
    for index, (earlier, later) in enumerate(pairwise(positions), 1):
        if later <= earlier:
            raise ScenarioError(
                f"{where}[{index}].position = {later:g} must lie beyond {earlier:g}, the one before it."
            )


def bounded(place: str, column: str, cell: Cell, amount: float, kind: TableKind, value_unit: str = "") -> float:
    """Round a value that a section of a line can have; ScenarioError if none can."""
    if kind not in KEYS or (kind == "tunnels" and value_unit != "factor"):
        return amount
    unit = {"gradients": " per mille", "limits": " km/h", "curves": " m"}.get(kind, "")
    for bound in Section.model_fields[KEYS[kind]].metadata:
        for name, words, is_within in BOUNDS:
            limit = getattr(bound, name, None)
            if limit is not None and not is_within(amount, limit):
                value = "" if text_of_cell(cell) == f"{amount:g}" else f", which is {amount:g}{unit},"
                raise ScenarioError(f"{place}: {column} = {show(cell)}{value} must be {words} {limit:g}{unit}.")
    return float(f"{amount:.10g}")


def add_continuity(kind: IntervalKind, ordered: Sequence[Interval], notes: Notes) -> None:
    """Note gaps (of gradients and limits only), overlaps and repetitions among rows in rising chainage."""
    furthest = ordered[0]
    for one in ordered[1:]:
        rows = (furthest.row, one.row)
        gap = one.from_m - furthest.to_m
        if gap > MIN_STRETCH_M and kind in WHOLE:
            sentence = (
                f"nothing from {place(furthest.to_m)} to {place(one.from_m)} m, between rows {rows[0]} and {rows[1]}: "
                f"a gap of the table, taken as {WHOLE[kind]}, or a jump of the chainage."
            )
            notes.add("gap", sentence, (furthest.to_m, one.from_m))
        elif gap < -MIN_STRETCH_M:
            end = min(furthest.to_m, one.to_m)
            rule = "they agree" if furthest.value == one.value else RULES[kind]
            sentence = f"rows {rows[0]} and {rows[1]} overlap from {place(one.from_m)} to {place(end)} m; {rule}."
            if replace(one, row=furthest.row) == furthest:
                sentence = f"row {rows[1]} repeats row {rows[0]}."
            notes.add("overlap", sentence)
        if one.to_m >= furthest.to_m:
            furthest = one


def place(position_m: float) -> str:
    """Format a position [m] with at most millimetres."""
    return f"{position_m:,.3f}".rstrip("0").rstrip(".")


@dataclass(frozen=True)
class TableRows:
    """The intervals of a table row by row, infinite if they have no end of their own; `blank` rows have no value."""

    intervals: list[Interval]
    blank: frozenset[int] = frozenset()
    has_ends: bool = False
    position: ColumnUnit = NOTHING
    value: ColumnUnit = NOTHING


def in_order(rows: TableRows, kind: IntervalKind, notes: Notes) -> list[Interval]:
    """Order intervals of some length with a value by chainage, and note which were turned round, moved or left out.

    Raises
    ------
    ScenarioError
        If no row has a length, two rows give one place two values, or the line would be shorter without rows that have
        no value.
    """
    intervals = _against_chainage(rows, notes)
    if turned := [one.row for one in intervals if one.to_m < one.from_m]:
        signs = ", with the signs of their gradients changed" if kind == "gradients" else ""
        notes.add("order", f"{rows_words(turned, 'runs', 'run')} against rising chainage; turned round{signs}.")
        # + 0.0: no negative zero
        sign = -1.0 if kind == "gradients" else 1.0
        intervals = [
            replace(one, from_m=one.to_m, to_m=one.from_m, value=None if one.value is None else sign * one.value + 0.0)
            if one.to_m < one.from_m
            else one
            for one in intervals
        ]
    unsorted = [later.row for earlier, later in pairwise(intervals) if later.from_m < earlier.from_m]
    # a table in falling chainage is in order all the same
    if unsorted and len(unsorted) < len(intervals) - 1:
        notes.add("order", f"{rows_words(unsorted, 'lies', 'lie')} before the row above; put in order.")
    ordered = sorted(intervals, key=lambda one: (one.from_m, one.row))
    following = [*(later.from_m for later in ordered[1:]), math.inf]
    # an interval without an end of its own ends where the next begins
    ordered = [
        replace(one, to_m=begin) if math.isinf(one.to_m) else one for one, begin in zip(ordered, following, strict=True)
    ]
    if not rows.has_ends:
        _require_one_value_at_a_place(ordered, notes.source)
    if empty := [one.row for one in ordered if one.to_m <= one.from_m and one.row not in rows.blank]:
        notes.add_unused(f"{rows_words(empty, 'has', 'have')} no length.")
    long = [one for one in ordered if one.to_m > one.from_m]
    with_value = [one for one in long if one.row not in rows.blank]
    if not with_value:
        raise ScenarioError(f"{notes.source}: no row has a length: all begin where they end.")
    for one, beside in pairwise(with_value if kind in ONE_VALUE else ()):
        if beside.from_m - one.from_m <= MIN_STRETCH_M and one.value != beside.value:
            end = place(min(one.to_m, beside.to_m))
            raise _two_values(one, beside, f"give two values from {place(beside.from_m)} to {end} m", notes.source)
    if kind in WHOLE:
        _require_ends([one for one in long if one.row in rows.blank], with_value, notes)
    return with_value


def _require_one_value_at_a_place(intervals: Sequence[Interval], source: str) -> None:
    """Raise ScenarioError if of two rows that begin at one place the first has a new value.

    It may repeat the row before it: some tables give both ends of each stretch.
    """
    before: Interval | None = None
    for one, beside in pairwise(intervals):
        same_place = one.from_m == one.to_m == beside.from_m
        if same_place and one.value not in {None, beside.value} and (before is None or one.value != before.value):
            raise _two_values(one, beside, f"begin at {place(one.from_m)} m", source)
        before = one


def _two_values(one: Interval, beside: Interval, words: str, source: str) -> ScenarioError:
    return ScenarioError(
        f"{source}: rows {one.row} and {beside.row} {words}: {one.value:g} and {beside.value:g}; leave one of them out."
    )


def _require_ends(blank: Sequence[Interval], with_value: Sequence[Interval], notes: Notes) -> None:
    """Raise ScenarioError if a row without a value lies at an end of the line, which would be shorter without it."""
    begin_m, end_m = with_value[0].from_m, max(one.to_m for one in with_value)
    for one in blank:
        if math.isinf(one.to_m) and one.from_m >= begin_m:
            sentence = f"row {one.row} has no value: the line ends there, at {place(one.from_m)} m."
            notes.add("reading", sentence)
        elif one.from_m < begin_m or one.to_m > end_m:
            where = f"from {place(one.from_m)}" + (f" to {place(one.to_m)}" if math.isfinite(one.to_m) else "")
            line = f"begin at {place(begin_m)} m" if one.from_m < begin_m else f"end at {place(end_m)} m"
            raise ScenarioError(
                f"{notes.source}: row {one.row}, {where} m, has no value, and without it the line would {line}; write "
                "its value, or delete the row."
            )


def _against_chainage(rows: TableRows, notes: Notes) -> list[Interval]:
    """End the rows of a table in falling chainage, which contains only their begins, at the row below."""
    intervals = rows.intervals
    begins = [one.from_m for one in intervals]
    falls = len(begins) > 1 and all(later <= earlier for earlier, later in pairwise(begins)) and begins[-1] < begins[0]
    if not falls or any(math.isfinite(one.to_m) for one in intervals):
        return intervals
    last = intervals[-1].row
    if last not in rows.blank:
        notes.add_unused(f"row {last}, the last in falling chainage: no row has its end.")
    ended = [replace(one, to_m=below.from_m) for one, below in pairwise(intervals)]
    _require_one_value_at_a_place([*ended, intervals[-1]], notes.source)
    # two rows at one place are judged here, in the direction of the table
    return [one for one in ended if one.to_m != one.from_m]


def rows_words(rows: Sequence[int], one: str, many: str) -> str:
    """Format 'row 3 lies' or 'rows 3, 5, 8 lie'."""
    return f"row {rows[0]} {one}" if len(rows) == 1 else f"rows {shown_list([str(row) for row in rows])} {many}"
