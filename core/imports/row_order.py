"""The rows of a table of intervals in order: in rising chainage, each with an end, and with one value at each place."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from railjoule.core.errors import ScenarioError
from railjoule.core.imports.continuity import LEAST_STRETCH_M, WHOLE, place
from railjoule.core.imports.findings import Finding, Notes
from railjoule.core.imports.source_file import shown_list
from railjoule.core.imports.table import Interval
from railjoule.core.imports.unit_choice import NOTHING, ColumnUnit
from railjoule.core.imports.units import IntervalKind

ONE_VALUE = ("gradients", "tunnels")
"""Kinds of which a stretch has one value, and no rule says which of two counts."""


@dataclass
class TableNotes(Notes):
    """What is noticed while a table is read; each sentence begins with the file."""

    source: str = ""

    def add(self, finding: Finding) -> None:
        """Add a finding, with the file before its sentence."""
        self.findings.append(replace(finding, sentence=f"{self.source}: {finding.sentence}"))


@dataclass(frozen=True)
class TableRows:
    """The rows of a table as they stand in it.

    Parameters
    ----------
    intervals : list of Interval
        Row by row; an end is infinite where the row has none.
    blank : frozenset of int
        Rows with a place and without a value, where the table has values.
    has_ends : bool
        Whether the table has a column of ends.
    position, value : ColumnUnit
        The units of both.
    """

    intervals: list[Interval]
    blank: frozenset[int] = frozenset()
    has_ends: bool = False
    position: ColumnUnit = NOTHING
    value: ColumnUnit = NOTHING


def in_order(rows: TableRows, kind: IntervalKind, notes: TableNotes) -> list[Interval]:
    """Return intervals of some length in rising chainage, and tell what was turned round, moved or left out.

    Raises
    ------
    ScenarioError
        If no row has a length, or two rows give one place two values.
    """
    intervals = _against_chainage(rows, notes)
    turned = [interval.row for interval in intervals if interval.to_m < interval.from_m]
    if turned:
        signs = ", with the signs of their gradients changed" if kind == "gradients" else ""
        notes.add(
            Finding(
                "order",
                f"{rows_words(turned, 'runs', 'run')} against rising chainage; turned round{signs}.",
                tuple(turned),
            )
        )
        intervals = [_turned(one, kind) if one.to_m < one.from_m else one for one in intervals]
    unsorted = [later.row for earlier, later in pairwise(intervals) if later.from_m < earlier.from_m]
    # a table in falling chainage is in order all the same
    if unsorted and len(unsorted) < len(intervals) - 1:
        notes.add(
            Finding(
                "order", f"{rows_words(unsorted, 'lies', 'lie')} before the row above; put in order.", tuple(unsorted)
            )
        )
    ordered = _with_ends(sorted(intervals, key=lambda one: (one.from_m, one.row)))
    if not rows.has_ends:
        _require_one_value_at_a_place(ordered, notes.source)
    empty = [one.row for one in ordered if one.to_m <= one.from_m and one.row not in rows.blank]
    if empty:
        notes.unused.append(f"{notes.source}: {rows_words(empty, 'has', 'have')} no length.")
    kept = [one for one in ordered if one.to_m > one.from_m]
    if all(one.row in rows.blank for one in kept):
        raise ScenarioError(f"{notes.source}: no row has a length: all begin where they end.")
    if kind in ONE_VALUE:
        _require_one_value_of_a_stretch([one for one in kept if one.row not in rows.blank], notes.source)
    return kept


def _require_one_value_at_a_place(intervals: Sequence[Interval], source: str) -> None:
    """Raise ScenarioError if of two rows that begin at one place the first says something new.

    It may repeat the row before it: some tables give both ends of each stretch.
    """
    before: Interval | None = None
    for one, beside in pairwise(intervals):
        same_place = one.from_m == one.to_m == beside.from_m
        if same_place and one.value not in {None, beside.value} and (before is None or one.value != before.value):
            raise _two_values(one, beside, f"begin at {place(one.from_m)} m", source)
        before = one


def _require_one_value_of_a_stretch(intervals: Sequence[Interval], source: str) -> None:
    """Raise ScenarioError if two rows begin at one place with two values."""
    for one, beside in pairwise(intervals):
        if beside.from_m - one.from_m <= LEAST_STRETCH_M and one.value != beside.value:
            end = place(min(one.to_m, beside.to_m))
            raise _two_values(one, beside, f"give two values from {place(beside.from_m)} to {end} m", source)


def _two_values(one: Interval, beside: Interval, told: str, source: str) -> ScenarioError:
    return ScenarioError(
        f"{source}: rows {one.row} and {beside.row} {told}: {one.value:g} and {beside.value:g}; leave one of them out."
    )


def without_blank(
    intervals: Sequence[Interval], rows: TableRows, kind: IntervalKind, notes: TableNotes
) -> list[Interval]:
    """Return the intervals with a value.

    Raises
    ------
    ScenarioError
        If those without one lie at an end of the line, which would be shorter without them.
    """
    kept = [one for one in intervals if one.row not in rows.blank]
    begin_m, end_m = kept[0].from_m, max(one.to_m for one in kept)
    for one in intervals:
        if one.row not in rows.blank or kind not in WHOLE:
            continue
        if one.from_m < begin_m:
            raise _shortened(one, f"begin at {place(begin_m)} m", notes.source)
        if one.to_m > end_m and math.isfinite(one.to_m):
            raise _shortened(one, f"end at {place(end_m)} m", notes.source)
        if math.isinf(one.to_m):
            sentence = f"row {one.row} has no value: the line ends there, at {place(one.from_m)} m."
            notes.add(Finding("reading", sentence, (one.row,), one.from_m))
    return kept


def _shortened(one: Interval, told: str, source: str) -> ScenarioError:
    where = f"from {place(one.from_m)}" + (f" to {place(one.to_m)}" if math.isfinite(one.to_m) else "")
    return ScenarioError(
        f"{source}: row {one.row}, {where} m, has no value, and without it the line would {told}; write its value, or "
        "delete the row."
    )


def _against_chainage(rows: TableRows, notes: TableNotes) -> list[Interval]:
    """End the rows of a table in falling chainage, which only tells where they begin, at the row beneath."""
    intervals = rows.intervals
    begins = [one.from_m for one in intervals]
    falls = len(begins) > 1 and all(later <= earlier for earlier, later in pairwise(begins)) and begins[-1] < begins[0]
    if not falls or any(math.isfinite(one.to_m) for one in intervals):
        return intervals
    last = intervals[-1].row
    if last not in rows.blank:
        notes.unused.append(f"{notes.source}: row {last}, the last in falling chainage: no row says where it ends.")
    ended = [replace(one, to_m=below.from_m) for one, below in pairwise(intervals)]
    _require_one_value_at_a_place([*ended, intervals[-1]], notes.source)
    # a place of which two rows tell is judged here, in the direction of the table
    return [one for one in ended if one.to_m != one.from_m]


def _with_ends(ordered: list[Interval]) -> list[Interval]:
    """End each interval without an end of its own where the next begins."""
    following = [*(later.from_m for later in ordered[1:]), math.inf]
    return [
        replace(one, to_m=begin) if math.isinf(one.to_m) else one for one, begin in zip(ordered, following, strict=True)
    ]


def _turned(interval: Interval, kind: IntervalKind) -> Interval:
    value = interval.value
    if kind == "gradients" and value is not None:
        value = -value + 0.0  # no negative zero
    return replace(interval, from_m=interval.to_m, to_m=interval.from_m, value=value)


def rows_words(rows: list[int], one: str, many: str) -> str:
    """Return 'row 3 lies' or 'rows 3, 5, 8 lie'."""
    return f"row {rows[0]} {one}" if len(rows) == 1 else f"rows {shown_list([str(row) for row in rows])} {many}"
