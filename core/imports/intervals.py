"""Tables of intervals over chainage: gradients, speed limits, curves, tunnels, neutral sections."""

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import cast

from railjoule.core.errors import ScenarioError
from railjoule.core.imports.cells import Cell, CellTable, read_cells
from railjoule.core.imports.columns import (
    FALLS,
    IS_LEVEL,
    RISES,
    VALUE_UNITS,
    ColumnMap,
    IntervalKind,
    ResolvedColumns,
    direction_word,
    resolve,
    same_name,
    selectors_of,
)
from railjoule.core.imports.continuity import continuity_findings
from railjoule.core.imports.findings import Finding, Notes
from railjoule.core.imports.numbers import (
    M_PER_KM,
    Decimal,
    decimal_of,
    gradient_of,
    number_of,
    position_of,
    radius_of,
    text_of_cell,
)
from railjoule.core.imports.source_file import SourceFile, counted, shown_list
from railjoule.core.imports.table import DIGITS_M, ImportedTable, Interval, bounded
from railjoule.core.scenario._sentences import shorten, show
from railjoule.core.units import MS_PER_KMH

KMH_PER_MPH = 1.609344
SPEED_UNITS = {"km/h": 1.0, "m/s": 1 / MS_PER_KMH, "mph": KMH_PER_MPH}
RINF_STRING = re.compile(r"([+-]?\d{1,9}(?:[.,]\d{1,9})?) ?\( ?([+-]?\d{1,9}(?:[.,]\d{1,9})?) ?\)")
"""A gradient and where it begins, 'g(km)', as the register of infrastructure has it."""
# of a run that a train can be driven over; below it the unit was another
SHORTEST_LINE_M = 50.0


@dataclass
class _TableNotes(Notes):
    """What is noticed while a table is read; each sentence begins with the file."""

    source: str = ""

    def add(self, finding: Finding) -> None:
        self.findings.append(replace(finding, sentence=f"{self.source}: {finding.sentence}"))


def read_intervals(source: SourceFile, kind: IntervalKind, columns: ColumnMap | None = None) -> ImportedTable:
    """Read a table of intervals from CSV or a workbook.

    Parameters
    ----------
    source : SourceFile
        The file.
    kind : str
        What it tells of.
    columns : ColumnMap, optional
        Its columns and units, as far as they are not to be guessed.

    Raises
    ------
    ScenarioError
        If it is no such table; the sentence names row, column, value and bound.
    """
    wanted = columns or ColumnMap()
    cells = read_cells(source, wanted.sheet)
    notes = _TableNotes(list(cells.findings), list(cells.unused), source.name)
    if columns_of_strings := _string_columns(cells, wanted) if kind == "gradients" else []:
        cells = _chosen_rows(cells, kind, columns_of_strings, wanted, notes)
        intervals, unit = _intervals_of_strings(cells, columns_of_strings, notes), ""
    else:
        found = resolve(cells, kind, wanted)
        named = (found.begin, found.end, found.value, found.direction)
        cells = _chosen_rows(cells, kind, [column for column in named if column], wanted, notes)
        intervals, unit = _intervals_of_rows(cells, kind, found, wanted, notes)
    if not intervals:
        raise ScenarioError(f"{source.name}: no row has both a position and a value.")
    intervals = _in_order(intervals, kind, notes)
    for finding in continuity_findings(kind, intervals):
        notes.add(finding)
    table = ImportedTable(kind, source.name, tuple(intervals), unit)
    length = table.end_m - table.begin_m
    if 0 < length < SHORTEST_LINE_M:
        notes.add(Finding("question", f"covers {length:g} m in all: are the positions in km?"))
    return replace(table, findings=tuple(notes.findings), unused=tuple(notes.unused))


def _chosen_rows(
    cells: CellTable, kind: IntervalKind, used: Sequence[str], wanted: ColumnMap, notes: _TableNotes
) -> CellTable:
    """Return the table with the rows of one line and one track, and tell which columns are not `used`.

    Raises
    ------
    ScenarioError
        If no row has the values asked for, or rows of several lines or tracks are left.
    """
    rows = cells.rows
    chosen = []
    for name, value in wanted.rows.items():
        column = next((column for column in cells.header if same_name(column, name)), None)
        if column is None:
            raise ScenarioError(f"{cells.source}: {show(name)} is not a column of it, so no rows can be chosen by it.")
        chosen.append(column)
        index = cells.header.index(column)
        values = [text_of_cell(row[index]) for _, row in rows]
        rows = tuple(row for row, text in zip(rows, values, strict=True) if text == value)
        if not rows:
            raise ScenarioError(
                f"{cells.source}: no row has {column} = {show(value)}; there are {shown_list(sorted(set(values)))}."
            )
    selectors = selectors_of(cells, used)
    for column in selectors:
        index = cells.header.index(column)
        values = sorted({text_of_cell(row[index]) for _, row in rows})
        if len(values) > 1 and column not in chosen:
            raise ScenarioError(
                f"{cells.source}: its rows are of several {column}: {shown_list(values)}; choose one, as "
                f"{kind}.{column}={shorten(values[0])}."
            )
    left = len(cells.rows) - len(rows)
    if left:
        told = ", ".join(f"{column} = {value}" for column, value in wanted.rows.items())
        notes.unused.append(f"{cells.source}: {counted(left, 'row')} not of {told}.")
    others = [column for column in cells.header if column not in {*used, *selectors, *chosen}]
    if others:
        notes.unused.append(f"{cells.source}: columns not used: {shown_list(others)}.")
    return replace(cells, rows=rows)


def _intervals_of_rows(
    cells: CellTable, kind: IntervalKind, found: ResolvedColumns, wanted: ColumnMap, notes: _TableNotes
) -> tuple[list[Interval], str]:
    """Return the intervals of a table's rows, and the unit of their values."""
    decimal = _decimal(cells, found, wanted, notes)
    position_unit = found.position_unit or "m"
    begins = dict(cells.column(found.begin))
    ends = dict(cells.column(found.end)) if found.end else {}
    values = dict(cells.column(found.value)) if found.value else {}
    directions = dict(cells.column(found.direction)) if found.direction else {}
    value_unit, convert = _value_reader(kind, found, decimal)
    _tell_units(cells, kind, found, begins, notes)
    intervals, empty = [], []
    for number, begin in begins.items():
        end, value = ends.get(number, ""), values.get(number, "")
        if text_of_cell(begin) == "" or (found.value and text_of_cell(value) == ""):
            empty.append(number)
            continue
        place = f"{cells.source}, row {number}"
        from_m = _read(place, found.begin, begin, lambda cell: position_of(cell, position_unit, decimal))
        to_m = math.inf
        if found.end and text_of_cell(end) != "":
            to_m = _read(place, found.end, end, lambda cell: position_of(cell, position_unit, decimal))
        amount = None
        if found.value:
            amount = _read(place, found.value, value, convert)
            amount = _directed(amount, directions.get(number, ""), number, notes)
            amount = bounded(place, found.value, value, amount, kind, value_unit)
        intervals.append(Interval(round(from_m, DIGITS_M), round(to_m, DIGITS_M), amount, number))
    if empty:
        missing = f"without {found.begin}" + (f" or {found.value}" if found.value else "")
        notes.unused.append(f"{cells.source}: {_rows_words(empty, 'is', 'are')} {missing}.")
    return intervals, value_unit


def _decimal(cells: CellTable, found: ResolvedColumns, wanted: ColumnMap, notes: _TableNotes) -> Decimal:
    if wanted.decimal is not None:
        return cast("Decimal", wanted.decimal)
    names = [name for name in (found.begin, found.end, found.value) if name]
    with_numbers = [pair for name in names for pair in cells.column(name)]
    decimal, in_doubt = decimal_of(with_numbers, cells.separator, cells.source)
    if in_doubt is not None:
        told = "parts thousands" if decimal == "." else "is a decimal comma"
        notes.add(Finding("reading", f"row {in_doubt} may be read in two ways; its comma {told} here.", (in_doubt,)))
    return decimal


def _value_reader(kind: IntervalKind, found: ResolvedColumns, decimal: Decimal) -> tuple[str, Callable[[Cell], float]]:
    """Return the unit of a table's values, and what reads them from cells."""
    unit = found.value_unit or (VALUE_UNITS[kind] or ("",))[0]
    if kind == "gradients":
        return unit, lambda cell: gradient_of(cell, unit, decimal)
    if kind == "limits":
        return unit, lambda cell: number_of(cell, decimal) * SPEED_UNITS[unit]
    if kind == "curves":
        return unit, lambda cell: radius_of(cell, decimal)
    return (unit if found.value else ""), lambda cell: number_of(cell, decimal)


def _tell_units(
    cells: CellTable, kind: IntervalKind, found: ResolvedColumns, begins: Mapping[int, Cell], notes: _TableNotes
) -> None:
    """Say which units were taken where neither a column's name nor the user says it."""
    first = next((text_of_cell(cell) for cell in begins.values() if text_of_cell(cell)), "")
    names_its_unit = "+" in first[1:] or any(letter.isalpha() for letter in first)
    if found.position_unit is None and not names_its_unit:
        notes.add(Finding("assumption", f"no unit is named for {found.begin!r}: taken as m."))
    if found.value and found.value_unit is None and kind in {"gradients", "limits", "tunnels"}:
        texts = [text_of_cell(cell) for _, cell in cells.column(found.value)]
        if kind == "gradients" and all(re.search(r"[:/]|in|^$", text) for text in texts):
            return
        unit = VALUE_UNITS[kind][0].replace("permille", "per mille")
        notes.add(Finding("assumption", f"no unit is named for {found.value!r}: taken as {unit}."))


def _read(place: str, column: str, cell: Cell, convert: Callable[[Cell], float]) -> float:
    try:
        return convert(cell)
    except ValueError as error:
        raise ScenarioError(f"{place}: {column} = {show(cell)} {error}.") from None


def _directed(amount: float, direction: Cell, number: int, notes: _TableNotes) -> float:
    """Return a gradient with the sign that a text beside it says, such as 'pente' for falling."""
    word = direction_word(direction)
    if word.startswith(FALLS):
        return -abs(amount)
    if word.startswith(RISES):
        return abs(amount)
    if word.startswith(IS_LEVEL) and amount:
        notes.add(Finding("question", f"row {number} says {show(word)} and {amount:g} per mille.", (number,)))
    return amount


def _string_columns(cells: CellTable, wanted: ColumnMap) -> list[str]:
    """Return the columns of which most cells hold gradients with their km, 'g(km)'."""
    name = wanted.columns.get("value")
    found = []
    for column in cells.header:
        if name is None or same_name(column, name):
            texts = [text for _, cell in cells.column(column) if (text := text_of_cell(cell))]
            strings = [text for text in texts if RINF_STRING.search(text) and not _beside_strings(text)]
            if 2 * len(strings) > len(texts):
                found.append(column)
    return found


def _beside_strings(text: str) -> bool:
    """Return whether a cell holds something beside gradients with their km."""
    return re.search(r"\w", RINF_STRING.sub("", text)) is not None


def _intervals_of_strings(cells: CellTable, columns: Sequence[str], notes: _TableNotes) -> list[Interval]:
    """Return the intervals of gradients 'g(km)', each of which reaches to where the next begins."""
    # semicolons between them are taken for those between cells: those of a row belong together
    indices = [cells.header.index(column) for column in columns]
    strings = [(number, " ".join(text_of_cell(row[index]) for index in indices)) for number, row in cells.rows]
    empty = [number for number, text in strings if not text.strip()]
    if empty:
        notes.unused.append(f"{cells.source}: {_rows_words(empty, 'is', 'are')} without {' or '.join(columns)}.")
    points = []
    for number, text in strings:
        place = f"{cells.source}, row {number}"
        if _beside_strings(text):
            raise ScenarioError(f"{place}: {show(text)} must be a gradient and its km, as 2.5(12.340).")
        for gradient, kilometre in RINF_STRING.findall(text):
            value = float(gradient.replace(",", "."))
            amount = bounded(place, "gradient", gradient, value, "gradients", "")
            begin_m = round(M_PER_KM * float(kilometre.replace(",", ".")), DIGITS_M)
            points.append(Interval(begin_m, math.inf, amount, number))
    return points


def _in_order(intervals: list[Interval], kind: IntervalKind, notes: _TableNotes) -> list[Interval]:
    """Return intervals of some length in rising chainage, and tell what was turned round, moved or left out."""
    intervals = _against_chainage(intervals, notes)
    turned = [interval.row for interval in intervals if interval.to_m < interval.from_m]
    if turned:
        signs = ", with the signs of their gradients changed" if kind == "gradients" else ""
        notes.add(
            Finding(
                "order",
                f"{_rows_words(turned, 'runs', 'run')} against rising chainage; turned round{signs}.",
                tuple(turned),
            )
        )
        intervals = [_turned(one, kind) if one.to_m < one.from_m else one for one in intervals]
    unsorted = [later.row for earlier, later in pairwise(intervals) if later.from_m < earlier.from_m]
    # a table in falling chainage is in order all the same
    if unsorted and len(unsorted) < len(intervals) - 1:
        notes.add(
            Finding(
                "order", f"{_rows_words(unsorted, 'lies', 'lie')} before the row above; put in order.", tuple(unsorted)
            )
        )
    ordered = _with_ends(sorted(intervals, key=lambda one: (one.from_m, one.row)))
    empty = [one.row for one in ordered if one.to_m <= one.from_m]
    if empty:
        notes.unused.append(f"{notes.source}: {_rows_words(empty, 'has', 'have')} no length.")
    kept = [one for one in ordered if one.to_m > one.from_m]
    if not kept:
        raise ScenarioError(f"{notes.source}: no row has a length: all begin where they end.")
    return kept


def _against_chainage(intervals: list[Interval], notes: _TableNotes) -> list[Interval]:
    """End the rows of a table in falling chainage, which only tells where they begin, at the row beneath."""
    begins = [one.from_m for one in intervals]
    falls = len(begins) > 1 and all(later <= earlier for earlier, later in pairwise(begins)) and begins[-1] < begins[0]
    if not falls or any(math.isfinite(one.to_m) for one in intervals):
        return intervals
    last = intervals[-1].row
    notes.unused.append(f"{notes.source}: row {last}, the last in falling chainage: no row says where it ends.")
    return [replace(one, to_m=below.from_m) for one, below in pairwise(intervals)]


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


def _rows_words(rows: list[int], one: str, many: str) -> str:
    """Return 'row 3 lies' or 'rows 3, 5, 8 lie'."""
    return f"row {rows[0]} {one}" if len(rows) == 1 else f"rows {shown_list([str(row) for row in rows])} {many}"
