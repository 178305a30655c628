"""Tables of intervals over chainage: gradients, speed limits, curves, tunnels, neutral sections."""

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import cast

from railjoule.core.errors import ScenarioError
from railjoule.core.imports.cells import Cell, CellTable, read_cells
from railjoule.core.imports.columns import (
    FALLS,
    IS_LEVEL,
    RISES,
    ColumnMap,
    ResolvedColumns,
    direction_word,
    resolve,
    same_name,
    selectors_of,
)
from railjoule.core.imports.continuity import continuity_findings
from railjoule.core.imports.encoding import encoding_mentioned
from railjoule.core.imports.findings import Finding
from railjoule.core.imports.numbers import M_PER_KM, Decimal, decimal_of, position_of, text_of_cell, value_of
from railjoule.core.imports.row_order import TableNotes, TableRows, in_order, rows_words, without_blank
from railjoule.core.imports.source_file import SourceFile, counted, shown_list
from railjoule.core.imports.table import DIGITS_M, ImportedTable, Interval, bounded
from railjoule.core.imports.unit_choice import ColumnUnit, TableUnits
from railjoule.core.imports.units import IntervalKind, unit_words
from railjoule.core.scenario._sentences import shorten, show

RINF_STRING = re.compile(r"([+-]?\d{1,9}(?:[.,]\d{1,9})?) ?\( ?([+-]?\d{1,9}(?:[.,]\d{1,9})?) ?\)")
"""A gradient and where it begins, 'g(km)', as the register of infrastructure has it."""
SIGN_WORDS: dict[Decimal, str] = {".": "point", ",": "comma"}


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
    with encoding_mentioned(cells.findings):
        return _table_of(cells, kind, wanted)


def _table_of(cells: CellTable, kind: IntervalKind, wanted: ColumnMap) -> ImportedTable:
    notes = TableNotes(list(cells.findings), list(cells.unused), cells.source)
    units = None
    if columns_of_strings := _string_columns(cells, wanted) if kind == "gradients" else []:
        cells = _chosen_rows(cells, kind, columns_of_strings, wanted, notes)
        rows = TableRows(_intervals_of_strings(cells, columns_of_strings, notes))
    else:
        found = resolve(cells, kind, wanted)
        named = (found.begin, found.end, found.value, found.direction)
        cells = _chosen_rows(cells, kind, [column for column in named if column], wanted, notes)
        units = TableUnits(cells.source, kind, found, wanted)
        rows = _intervals_of_rows(cells, units, notes)
    if len(rows.intervals) == len(rows.blank):
        raise ScenarioError(f"{cells.source}: no row has both a position and a value.")
    intervals = without_blank(in_order(rows, kind, notes), rows, kind, notes)
    for doubt in units.size_doubts(intervals, rows.position, rows.value) if units else []:
        notes.add(Finding("question", doubt))
    for finding in continuity_findings(kind, intervals):
        notes.add(finding)
    return ImportedTable(
        kind,
        cells.source,
        tuple(intervals),
        rows.value.unit,
        findings=tuple(notes.findings),
        unused=tuple(notes.unused),
    )


def _chosen_rows(
    cells: CellTable, kind: IntervalKind, used: Sequence[str], wanted: ColumnMap, notes: TableNotes
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


def _intervals_of_rows(cells: CellTable, units: TableUnits, notes: TableNotes) -> TableRows:
    """Return the intervals of a table's rows."""
    found, kind = units.found, units.kind
    begins = dict(cells.column(found.begin))
    ends = dict(cells.column(found.end)) if found.end else {}
    values = dict(cells.column(found.value)) if found.value else {}
    directions = dict(cells.column(found.direction)) if found.direction else {}
    position, value = units.position(begins), units.value(values)
    decimal = _decimal(cells, found, units.wanted, notes)
    _tell_units(found, position, value, notes)

    def position_in(cell: Cell) -> float:
        return position_of(cell, position.unit, decimal)

    def value_in(cell: Cell) -> float:
        return value_of(cell, kind, value.unit, decimal, value.stated)

    intervals, blank, without_begin = [], [], []
    for number, begin in begins.items():
        end, cell = ends.get(number, ""), values.get(number, "")
        if text_of_cell(begin) == "":
            without_begin.append(number)
            continue
        where = f"{cells.source}, row {number}"
        from_m = _read(where, found.begin, begin, position_in)
        to_m = math.inf
        if found.end and text_of_cell(end) != "":
            to_m = _read(where, found.end, end, position_in)
        amount = None
        if found.value and text_of_cell(cell) == "":
            blank.append(number)
        elif found.value:
            amount = _read(where, found.value, cell, value_in)
            amount = _directed(amount, directions.get(number, ""), number, notes)
            amount = bounded(where, found.value, cell, amount, kind, value.unit)
        intervals.append(Interval(round(from_m, DIGITS_M), round(to_m, DIGITS_M), amount, number))
    for column, empty in ((found.begin, without_begin), (found.value, blank)):
        if empty:
            notes.unused.append(f"{cells.source}: {rows_words(empty, 'is', 'are')} without {column}.")
    return TableRows(intervals, frozenset(blank), found.end is not None, position, value)


def _decimal(cells: CellTable, found: ResolvedColumns, wanted: ColumnMap, notes: TableNotes) -> Decimal:
    if wanted.decimal is not None:
        return cast("Decimal", wanted.decimal)
    names = [name for name in (found.begin, found.end, found.value) if name]
    with_numbers = [pair for name in names for pair in cells.column(name)]
    decimal, in_doubt = decimal_of(with_numbers, cells.separator, cells.source)
    if in_doubt is not None:
        told = "comma parts thousands" if cells.separator == "," else f"{SIGN_WORDS[decimal]} is for decimals"
        notes.add(Finding("reading", f"row {in_doubt} may be read in two ways; its {told} here.", (in_doubt,)))
    return decimal


def _tell_units(found: ResolvedColumns, position: ColumnUnit, value: ColumnUnit, notes: TableNotes) -> None:
    """Say which units were taken where neither a column's name nor its cells nor the user says it."""
    for column, unit in ((found.begin, position), (found.value, value)):
        if unit.is_assumed:
            told = f"no unit is named for {column!r}: taken as {unit_words(unit.unit)}."
            notes.add(Finding("assumption", told))


def _read(place: str, column: str, cell: Cell, convert: Callable[[Cell], float]) -> float:
    try:
        return convert(cell)
    except ValueError as error:
        raise ScenarioError(f"{place}: {column} = {show(cell)} {error}.") from None


def _directed(amount: float, direction: Cell, number: int, notes: TableNotes) -> float:
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


def _intervals_of_strings(cells: CellTable, columns: Sequence[str], notes: TableNotes) -> list[Interval]:
    """Return the intervals of gradients 'g(km)', each of which reaches to where the next begins."""
    # semicolons between them are taken for those between cells: those of a row belong together
    indices = [cells.header.index(column) for column in columns]
    strings = [(number, " ".join(text_of_cell(row[index]) for index in indices)) for number, row in cells.rows]
    empty = [number for number, text in strings if not text.strip()]
    if empty:
        notes.unused.append(f"{cells.source}: {rows_words(empty, 'is', 'are')} without {' or '.join(columns)}.")
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
