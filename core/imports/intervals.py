"""Tables of intervals over chainage: gradients or heights, speed limits, curves, tunnels, neutral sections."""

import math
import re
from collections.abc import Sequence
from dataclasses import replace
from typing import cast

from railjoule.core.errors import ScenarioError
from railjoule.core.imports.cells import Cell, CellTable, Row, read_cells
from railjoule.core.imports.columns import (
    FALLS,
    IS_LEVEL,
    RISES,
    ColumnMap,
    direction_word,
    line_selectors,
    one_way_column,
    resolve,
    same_name,
)
from railjoule.core.imports.findings import Notes
from railjoule.core.imports.heights import intervals_of_heights
from railjoule.core.imports.numbers import Decimal, decimal_mark, parse_position, parse_value, text_of_cell
from railjoule.core.imports.source_file import SourceFile, encoding_mentioned
from railjoule.core.imports.table import (
    DIGITS_M,
    ImportedTable,
    Interval,
    TableRows,
    add_continuity,
    bounded,
    in_order,
    rows_words,
)
from railjoule.core.imports.table_units import TableUnits
from railjoule.core.imports.units import IntervalKind, TableKind, unit_words
from railjoule.core.scenario._sentences import counted, shorten, show, shown_list
from railjoule.core.units import M_PER_KM

RINF_STRING = re.compile(r"([+-]?\d{1,9}(?:[.,]\d{1,9})?) ?\( ?([+-]?\d{1,9}(?:[.,]\d{1,9})?) ?\)")
"""A gradient and where it begins, 'g(km)', as the register of infrastructure has it."""


def read_intervals(source: SourceFile, kind: IntervalKind, columns: ColumnMap | None = None) -> ImportedTable:
    """Read a table of intervals from CSV or a workbook.

    Parameters
    ----------
    source : SourceFile
        The file.
    kind : str
        Its content.
    columns : ColumnMap, optional
        Its columns and units, as far as they are not to be guessed.

    Returns
    -------
    table : ImportedTable
        Of the kind; heights become gradients.

    Raises
    ------
    ScenarioError
        If it is no such table; the sentence names row, column, value and bound.
    """
    wanted = columns or ColumnMap()
    cells = read_cells(source, wanted.sheet)
    with encoding_mentioned(cells.findings):
        return _read_table(cells, kind, wanted)


def _read_table(cells: CellTable, kind: IntervalKind, wanted: ColumnMap) -> ImportedTable:
    notes = Notes(cells.source, list(cells.findings), list(cells.unused))
    units = None
    if columns_of_strings := _string_columns(cells, wanted) if kind == "gradients" else []:
        cells = chosen_rows(cells, kind, columns_of_strings, wanted, notes)
        rows = TableRows(_intervals_of_strings(cells, columns_of_strings, notes))
    else:
        if one_way := one_way_column(cells, kind, wanted):
            notes.add("reading", f"{one_way!r} is taken as that of the run's direction.")
        found = resolve(cells, kind, wanted)
        named = (found.begin, found.end, found.value, found.direction)
        cells = chosen_rows(cells, kind, [column for column in named if column], wanted, notes)
        units = TableUnits(cells.source, kind, found, wanted)
        rows = _intervals_of_rows(cells, units, notes)
    if len(rows.intervals) == len(rows.blank):
        raise ScenarioError(f"{cells.source}: no row has both a position and a value.")
    intervals = rows.intervals if kind == "heights" else in_order(rows, kind, notes)
    for doubt in units.size_doubts(intervals, rows.position, rows.value) if units else []:
        notes.add("question", doubt)
    if kind == "heights":
        intervals = intervals_of_heights(intervals, wanted.tolerance_m, notes)
    else:
        add_continuity(kind, intervals, notes)
    return ImportedTable(
        cells.source,
        "gradients" if kind == "heights" else kind,
        tuple(intervals),
        rows.value.unit,
        findings=tuple(notes.findings),
        unused=tuple(notes.unused),
    )


def chosen_rows(cells: CellTable, kind: TableKind, used: Sequence[str], wanted: ColumnMap, notes: Notes) -> CellTable:
    """Select the rows of one line and one track, and list the columns that are not `used`.

    Raises
    ------
    ScenarioError
        If no row has the wanted values, or rows of several lines or tracks are left.
    """
    rows, source = cells.rows, cells.source
    chosen = []
    for name, value in wanted.rows.items():
        if (column := next((column for column in cells.header if same_name(column, name)), None)) is None:
            raise ScenarioError(f"{source}: {show(name)} is not a column of it, so no rows can be chosen by it.")
        chosen.append(column)
        texts = _texts(cells, rows, column)
        rows = tuple(row for row, text in zip(rows, texts, strict=True) if text == value)
        if not rows:
            known = shown_list(sorted(set(texts)))
            raise ScenarioError(f"{source}: no row has {column} = {show(value)}; there are {known}.")
    selectors = line_selectors(cells, kind, used)
    for column in selectors:
        values = sorted(set(_texts(cells, rows, column)))
        if len(values) > 1 and column not in chosen:
            raise ScenarioError(
                f"{source}: its rows are of several {column}: {shown_list(values)}; choose one, as "
                f"{kind}.{column}={shorten(values[0])}."
            )
    if left := len(cells.rows) - len(rows):
        choice = ", ".join(f"{column} = {value}" for column, value in wanted.rows.items())
        notes.add_unused(f"{counted(left, 'row')} not of {choice}.")
    if others := [column for column in cells.header if column not in {*used, *selectors, *chosen}]:
        notes.add_unused(f"columns not used: {shown_list(others)}.")
    return replace(cells, rows=rows)


def _texts(cells: CellTable, rows: Sequence[Row], column: str) -> list[str]:
    index = cells.header.index(column)
    return [text_of_cell(row[index]) for _, row in rows]


def _intervals_of_rows(cells: CellTable, units: TableUnits, notes: Notes) -> TableRows:
    """Read the intervals of a table's rows."""
    found, kind = units.found, units.kind
    begins, ends, values, directions = (
        dict(cells.column(column)) if column else {}
        for column in (found.begin, found.end, found.value, found.direction)
    )
    position, value = units.unit("position_unit", begins), units.unit("value_unit", values)
    decimal = find_decimal(cells, (found.begin, found.end, found.value), units.wanted, notes)
    for column, unit in ((found.begin, position), (found.value, value)):
        if unit.is_assumed:
            notes.add("assumption", f"no unit is named for {column!r}: taken as {unit_words(unit.unit)}.")

    def read(number: int, column: str | None, cell: Cell, is_value: bool = False) -> float:
        try:
            if is_value:
                return parse_value(cell, kind, value.unit, decimal, value.stated)
            return parse_position(cell, position.unit, decimal)
        except ValueError as error:
            raise ScenarioError(f"{cells.source}, row {number}: {column} = {show(cell)} {error}.") from None

    intervals, blank, without_begin = [], [], []
    for number, begin in begins.items():
        end, cell = ends.get(number, ""), values.get(number, "")
        if text_of_cell(begin) == "":
            without_begin.append(number)
            continue
        from_m = read(number, found.begin, begin)
        to_m = math.inf if text_of_cell(end) == "" else read(number, found.end, end)
        amount = None
        if found.value and text_of_cell(cell) == "":
            blank.append(number)
        elif found.value:
            amount = _directed(
                read(number, found.value, cell, is_value=True), directions.get(number, ""), number, notes
            )
            amount = bounded(f"{cells.source}, row {number}", found.value, cell, amount, kind, value.unit)
        intervals.append(Interval(round(from_m, DIGITS_M), round(to_m, DIGITS_M), amount, number))
    for column, empty in ((found.begin, without_begin), (found.value, blank)):
        if empty:
            notes.add_unused(f"{rows_words(empty, 'is', 'are')} without {column}.")
    return TableRows(intervals, frozenset(blank), found.end is not None, position, value)


def find_decimal(cells: CellTable, columns: Sequence[str | None], wanted: ColumnMap, notes: Notes) -> Decimal:
    """Return the decimal sign of columns as the user names it, or find it, and note if it is in doubt."""
    if wanted.decimal is not None:
        return cast("Decimal", wanted.decimal)
    with_numbers = [pair for name in columns if name for pair in cells.column(name)]
    decimal, in_doubt = decimal_mark(with_numbers, cells.separator, cells.source)
    if in_doubt is not None:
        sign = {".": "point", ",": "comma"}[decimal]
        use = "comma parts thousands" if cells.separator == "," else f"{sign} is for decimals"
        notes.add("reading", f"row {in_doubt} may be read in two ways; its {use} here.")
    return decimal


def _directed(amount: float, direction: Cell, number: int, notes: Notes) -> float:
    """Sign a gradient by the text beside it, such as 'pente' for falling."""
    word = direction_word(direction)
    if word.startswith(FALLS):
        return -abs(amount)
    if word.startswith(RISES):
        return abs(amount)
    if word.startswith(IS_LEVEL) and amount:
        notes.add("question", f"row {number} has {show(word)} and {amount:g} per mille.")
    return amount


def _string_columns(cells: CellTable, wanted: ColumnMap) -> list[str]:
    """List the columns of which most cells are gradients with their km, 'g(km)'."""
    name = wanted.columns.get("value")
    found = []
    for column in cells.header:
        if name is None or same_name(column, name):
            texts = [text for text in _texts(cells, cells.rows, column) if text]
            strings = [text for text in texts if RINF_STRING.search(text) and not _has_other_text(text)]
            if 2 * len(strings) > len(texts):
                found.append(column)
    return found


def _has_other_text(text: str) -> bool:
    """Tell whether a cell contains anything beside gradients with their km."""
    return re.search(r"\w", RINF_STRING.sub("", text)) is not None


def _intervals_of_strings(cells: CellTable, columns: Sequence[str], notes: Notes) -> list[Interval]:
    """Read the intervals of gradients 'g(km)', each of which reaches to the begin of the next."""
    # semicolons between them are taken for those between cells: those of a row belong together
    indices = [cells.header.index(column) for column in columns]
    strings = [(number, " ".join(text_of_cell(row[index]) for index in indices)) for number, row in cells.rows]
    if empty := [number for number, text in strings if not text.strip()]:
        notes.add_unused(f"{rows_words(empty, 'is', 'are')} without {' or '.join(columns)}.")
    points = []
    for number, text in strings:
        where = f"{cells.source}, row {number}"
        if _has_other_text(text):
            raise ScenarioError(f"{where}: {show(text)} must be a gradient and its km, as 2.5(12.340).")
        for gradient, kilometre in RINF_STRING.findall(text):
            amount = bounded(where, "gradient", gradient, float(gradient.replace(",", ".")), "gradients")
            begin_m = round(M_PER_KM * float(kilometre.replace(",", ".")), DIGITS_M)
            points.append(Interval(begin_m, math.inf, amount, number))
    return points
