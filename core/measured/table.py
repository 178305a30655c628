"""A recorder's file as columns of numbers: which row has the names, decimal comma, clock times, rows without values."""

import re
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from types import MappingProxyType

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.errors import RecordingError, ScenarioError
from railjoule.core.imports.cells import Cell, CellTable, read_cells
from railjoule.core.imports.encoding import encoding_mentioned
from railjoule.core.imports.findings import without_name
from railjoule.core.imports.numbers import Decimal, decimal_of, number_of, position_of, text_of_cell
from railjoule.core.imports.source_file import SourceFile, counted, shown_list
from railjoule.core.measured.columns import (
    CLOCK,
    GENERIC,
    Column,
    RecorderFormat,
    find_columns,
    has_plain_name,
    recognised,
)
from railjoule.core.scenario._sentences import show
from railjoule.core.units import plain_number

S_PER_DAY = 86_400.0
EPOCH = datetime(1970, 1, 1, tzinfo=UTC)
NO_VALUES = ("", "nan", "null", "na", "n/a", "-")
"""What stands in a cell without a value."""
NEVER_EMPTY = ("time", "position", "speed")
"""A row without these is no sample; a row without an effort or a power is one without that."""
TIME_OF_DAY = r"(\d{1,2}):(\d{2})(?::(\d{2}(?:[.,]\d{1,9})?))?(?: ?([AaPp])\.?[Mm]\.?)?"
NOON_H = 12
EPOCH_UNITS: Mapping[str, tuple[float, float]] = MappingProxyType(
    {"ms": (1e11, 1e14), "us": (1e14, 1e17), "ns": (1e17, 1e20)}
)
"""Between which numbers a time since 1970 lies in such units, from 1973 to 5138; below the first it is one in s."""
DAY_FIRST = re.compile(rf"(\d{{1,2}})[./](\d{{1,2}})[./](\d{{4}})[ T]+({TIME_OF_DAY})")
MOST_ROWS_TOLD = 5


@dataclass(frozen=True, eq=False)
class Table:
    """The known columns of a file with n rows, in SI.

    Parameters
    ----------
    source : str
        The file.
    columns : mapping of str to Column
        Those that are used, by quantity.
    values : mapping of str to array of shape (n,)
        Their values in SI, by quantity; NaN where a cell is empty.
    rows : tuple of int
        The row of the file where each of them stands, as a spreadsheet counts.
    notes : tuple of str
        What was skipped, assumed or changed, in sentences.
    """

    source: str
    columns: Mapping[str, Column]
    values: Mapping[str, FloatArray]
    rows: tuple[int, ...]
    notes: tuple[str, ...]

    def told(self, quantity: str, row: int) -> str:
        """Return a value as the file has it, such as 'speed = 41.5 km/h in row 12'."""
        column = self.columns[quantity]
        value = plain_number(float(self.values[quantity][row]) / column.factor, 6)
        unit = "s" if column.unit == CLOCK else column.unit
        return f"{column.header} = {value} {unit} in row {self.rows[row]}"

    def at(self, kept: Sequence[bool] | np.ndarray) -> "Table":
        """Return the rows that are kept."""
        chosen = np.flatnonzero(kept)
        return replace(
            self,
            values={quantity: column[chosen] for quantity, column in self.values.items()},
            rows=tuple(self.rows[row] for row in chosen.tolist()),
        )


def recorder_cells(source: SourceFile, form: RecorderFormat = GENERIC, sheet: str | None = None) -> CellTable:
    """Return the cells of a recorder's file, CSV or a workbook, under the row that names a speed.

    Parameters
    ----------
    source : SourceFile
        The file.
    form : RecorderFormat
        Which columns hold what.
    sheet : str, optional
        Of a workbook; by default its only one.

    Raises
    ------
    RailjouleError
        If it is no table, or larger than allowed.
    """
    form.require_known()

    def is_header(names: Sequence[str]) -> bool:
        return any(column.quantity == "speed" for column in recognised(names, form))

    return read_cells(source, sheet, is_header)


def read_table(cells: CellTable, form: RecorderFormat = GENERIC) -> Table:
    """Return the known columns of a table.

    Parameters
    ----------
    cells : CellTable
        As `recorder_cells` returns it.
    form : RecorderFormat
        Which columns hold what.

    Raises
    ------
    RecordingError
        If a column or a unit is missing, or a cell holds no number; the sentence names row, column and value.
    """
    form.require_known()
    source = cells.source
    if len(cells.header) < 2:
        raise RecordingError(f"{source} is no table: no row has columns with a semicolon, tab or comma between them.")
    with encoding_mentioned(cells.findings):
        found = find_columns(cells.header, form, source)
    columns = [_with_clock(column, cells, form) for column in found]
    notes = [without_name(told, source) for told in (*(one.sentence for one in cells.findings), *cells.unused)]
    notes += [
        f"No unit is named for {column.header!r}: taken as {column.unit}."
        for column in columns
        if column.is_assumed and column.unit != CLOCK and column.quantity != "brake"
    ]
    notes += [f"{column.header} is taken as that of the line." for column in columns if has_plain_name(column)]
    unused = [name for name in cells.header if name not in [column.header for column in columns]]
    if unused:
        notes.append(f"Columns not used: {shown_list(unused)}.")
    values = _numbers(cells, columns)
    table = Table(source, {one.quantity: one for one in columns}, values, tuple(number for number, _ in cells.rows), ())
    table = _whole_rows(table, notes)
    return replace(table, values=_past_midnight(table, notes), notes=tuple(notes))


def _with_clock(column: Column, cells: CellTable, form: RecorderFormat) -> Column:
    """Return a column of times with the unit that its cells show, where nobody says otherwise."""
    if column.quantity != "time" or "time" in form.units:
        return column
    unit = unit_of_times(cells, column.header)
    return replace(column, unit=unit) if unit == CLOCK or (unit and column.is_assumed) else column


def unit_of_times(cells: CellTable, header: str) -> str:
    """Return the unit that the cells of a column of times show: times of day, or a time since 1970; else an empty one.

    Parameters
    ----------
    cells : CellTable
        The table.
    header : str
        Its column.
    """
    first = next((text for _, cell in cells.column(header) if (text := text_of_cell(cell))), "")
    if ":" in first:
        return CLOCK
    with suppress(ValueError):
        return next((unit for unit, (low, high) in EPOCH_UNITS.items() if low <= float(first) < high), "")
    return ""


def _numbers(cells: CellTable, columns: Sequence[Column]) -> dict[str, FloatArray]:
    """Return all columns as numbers in SI; NaN where a cell is empty."""
    decimals = _decimals({one.quantity: cells.column(one.header) for one in columns if one.unit != CLOCK}, cells)
    return {column.quantity: _column(column, cells, decimals.get(column.quantity, ".")) for column in columns}


def _decimals(columns: Mapping[str, Sequence[tuple[int, Cell]]], cells: CellTable) -> dict[str, Decimal]:
    """Return the decimal sign of each quantity: one for the file, or where it mixes them one for each column."""

    def sign_of(some: Iterable[tuple[int, Cell]]) -> Decimal:
        return decimal_of(some, cells.separator, cells.source)[0]

    with suppress(ScenarioError):
        return dict.fromkeys(columns, sign_of(pair for pairs in columns.values() for pair in pairs))
    return {quantity: sign_of(pairs) for quantity, pairs in columns.items()}


def _column(column: Column, cells: CellTable, decimal: Decimal) -> FloatArray:
    values = np.full(len(cells.rows), np.nan)
    for index, (row, cell) in enumerate(cells.column(column.header)):
        if text_of_cell(cell).lower() in NO_VALUES:
            continue
        try:
            values[index] = _number(cell, column, decimal)
        except ValueError as error:
            raise RecordingError(f"{cells.source}, row {row}: {column.header} = {show(cell)} {error}.") from None
    return values


def _number(cell: Cell, column: Column, decimal: Decimal) -> float:
    """Return the value of a cell in SI; raises ValueError, with the end of a sentence, if it holds none."""
    if column.unit == CLOCK:
        return _clock(text_of_cell(cell))
    if column.quantity == "position":
        return position_of(cell, column.unit, decimal)
    return number_of(cell, decimal) * column.factor


def _whole_rows(table: Table, notes: list[str]) -> Table:
    """Return a table without rows that lack a time, a position or a speed, and tell what else is empty."""
    needed = [quantity for quantity in NEVER_EMPTY if quantity in table.values]
    whole = np.all([np.isfinite(table.values[quantity]) for quantity in needed], axis=0)
    empty = np.flatnonzero(~whole).tolist()
    if empty:
        names = " or ".join(table.columns[quantity].header for quantity in needed)
        rows = shown_list([str(table.rows[row]) for row in empty], MOST_ROWS_TOLD)
        are = "is" if len(empty) == 1 else "are"
        notes.append(f"{counted(len(empty), 'row')} without {names} {are} left out: {rows}.")
        table = table.at(whole)
    for quantity, values in table.values.items():
        missing = int(np.isnan(values).sum())
        if missing:
            notes.append(f"{table.columns[quantity].header} has no value in {missing} of {len(values)} rows.")
    return table


def _past_midnight(table: Table, notes: list[str]) -> dict[str, FloatArray]:
    """Return the values with times of day that rise beyond midnight."""
    values = dict(table.values)
    if len(table.rows) and table.columns.get("time", Column("", "", "")).unit == CLOCK:
        time = values["time"]
        midnights = np.cumsum(np.diff(time, prepend=time[0]) < -0.5 * S_PER_DAY)
        # a date makes times of its own, which never fall by half a day
        if midnights[-1]:
            notes.append("The clock passes midnight.")
            values["time"] = time + S_PER_DAY * midnights
    return values


def _clock(text: str) -> float:
    """Return a time of day, or a date with one, in s; raises ValueError where it is neither."""
    if match := re.fullmatch(TIME_OF_DAY, text):
        return _seconds(*match.groups())
    if match := DAY_FIRST.fullmatch(text):
        first, second, year, _, *clock = match.groups()
        # differences alone count: which of the two is the day matters at midnight alone
        day, month = (int(first), int(second)) if int(second) <= 12 else (int(second), int(first))
        with suppress(ValueError):
            return (datetime(int(year), month, day, tzinfo=UTC) - EPOCH).total_seconds() + _seconds(*clock)
    with suppress(ValueError, OverflowError):
        moment = datetime.fromisoformat(text)
        # differences alone count, and every zone has the same
        return (moment.replace(tzinfo=moment.tzinfo or UTC) - EPOCH).total_seconds()
    raise ValueError("must be a time, as 10:15:30, 10:15:30 PM or 2026-01-31T10:15:30")


def _seconds(hours: str, minutes: str, seconds: str | None, half: str | None) -> float:
    hour = int(hours)
    if half:
        if not 1 <= hour <= NOON_H:
            raise ValueError("must have an hour from 1 to 12 before AM or PM")
        # 12 AM is midnight, 12 PM is noon
        hour = hour % NOON_H + (NOON_H if half.lower() == "p" else 0)
    return 3600.0 * hour + 60.0 * int(minutes) + float((seconds or "0").replace(",", "."))
