"""A recorder's file as columns of numbers: separator, decimal comma, lines before the header, clock times."""

import csv
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.errors import RecordingError
from railjoule.core.measured.columns import CLOCK, GENERIC, Column, RecorderFormat, find_columns, recognised
from railjoule.core.units import plain_number

# programs write who made the file, when and with which settings above the header
MOST_LINES_ABOVE = 30
"""In so many lines the header is looked for."""
S_PER_DAY = 86_400.0
EPOCH = datetime(1970, 1, 1, tzinfo=UTC)
LONGEST_SHOWN = 30
NO_VALUES = ("", "nan", "null", "na", "n/a", "-")
"""What stands in a cell without a value."""
NEVER_EMPTY = ("time", "position", "speed")
"""A row without these is no sample; a row without an effort or a power is one without that."""


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
    lines : tuple of int
        The line of the file where each row stands.
    notes : tuple of str
        What was skipped or changed, in sentences.
    """

    source: str
    columns: Mapping[str, Column]
    values: Mapping[str, FloatArray]
    lines: tuple[int, ...]
    notes: tuple[str, ...]

    def told(self, quantity: str, row: int) -> str:
        """Return a value as the file has it, such as 'speed = 41.5 km/h in line 12'."""
        column = self.columns[quantity]
        value = plain_number(float(self.values[quantity][row]) / column.factor, 6)
        unit = "s" if column.unit == CLOCK else column.unit
        return f"{column.header} = {value} {unit} in line {self.lines[row]}"


def read_table(text: str, source: str, form: RecorderFormat = GENERIC) -> Table:
    """Return the known columns of a text in CSV.

    Parameters
    ----------
    text, source : str
        The text, and the file that it comes from.
    form : RecorderFormat
        Which columns hold what.

    Raises
    ------
    RecordingError
        If it is no such table, or a cell that is needed is empty or no number.
    """
    form.require_known()
    lines = text.splitlines()
    place = _header(lines, form)
    if place is None:
        raise RecordingError(f"{source} is no table: no line has columns with a semicolon, tab or comma between them.")
    header, separator = place
    headers = _cells(lines[header], separator)
    columns = find_columns(headers, form, source)
    rows = [
        (number, cells)
        for number, line in enumerate(lines[header + 1 :], header + 2)
        if any(cells := _cells(line, separator))
    ]
    for number, cells in rows:
        if len(cells) != len(headers):
            raise RecordingError(f"{source}, line {number}: {len(cells)} cells under {len(headers)} columns.")
    notes = [f"{header} lines above the header are not read."] if header else []
    unused = [name for name in headers if name and name not in [column.header for column in columns]]
    if unused:
        notes.append(f"Columns not used: {', '.join(unused)}.")
    numbers = tuple(number for number, _ in rows)
    comma = separator != ","
    used, values = {}, {}
    for column in columns:
        index = headers.index(column.header)
        cells_of = [cells[index] for _, cells in rows]
        is_clock = column.quantity == "time" and "time" not in form.units and ":" in (cells_of or [""])[0]
        used[column.quantity] = replace(column, unit=CLOCK) if is_clock else column
        values[column.quantity] = _column(used[column.quantity], cells_of, numbers, source, comma, notes)
    return Table(source, used, values, numbers, tuple(notes))


def _header(lines: Sequence[str], form: RecorderFormat) -> tuple[int, str] | None:
    """Return the line of the header and the separator; None where no line has columns.

    The first line that names a speed, or else the first line with columns, of which a sentence can then tell what it
    lacks.
    """
    first = None
    for index, line in enumerate(lines[:MOST_LINES_ABOVE]):
        separator = next((sign for sign in (";", "\t", ",") if sign in line), None)
        if separator is None:
            continue
        first = first or (index, separator)
        columns = recognised(_cells(line, separator), form)
        if any(column.quantity == "speed" for column in columns):
            return index, separator
    return first


def _cells(line: str, separator: str) -> list[str]:
    return [cell.strip() for cell in next(csv.reader([line], delimiter=separator), [])]


def _column(
    column: Column, cells: Sequence[str], lines: Sequence[int], source: str, comma: bool, notes: list[str]
) -> FloatArray:
    values = np.full(len(cells), np.nan)
    for row, cell in enumerate(cells):
        if cell.lower() not in NO_VALUES:
            value = _clock(cell) if column.unit == CLOCK else _number(cell, comma)
            if value is None:
                what = "a time of day" if column.unit == CLOCK else "a number"
                raise RecordingError(
                    f"{source}, line {lines[row]}: {column.header} = {cell[:LONGEST_SHOWN]!r} must be {what}."
                )
            values[row] = value
        elif column.quantity in NEVER_EMPTY:
            raise RecordingError(f"{source}, line {lines[row]}: {column.header} has no value.")
    empty = int(np.isnan(values).sum())
    if empty:
        notes.append(f"{column.header} has no value in {empty} of {len(values)} rows.")
    values *= column.factor
    if column.unit == CLOCK and len(values):
        midnights = np.cumsum(np.diff(values, prepend=values[0]) < -0.5 * S_PER_DAY)
        # a date makes times of its own, which never fall by half a day
        if midnights[-1]:
            notes.append("The clock passes midnight.")
            values = values + S_PER_DAY * midnights
    return values


def _number(cell: str, comma: bool) -> float | None:
    """Return the number of a cell; None where it is none, or not a finite one."""
    try:
        value = float(cell.replace(",", ".") if comma else cell)
    except ValueError:
        return None
    return value if np.isfinite(value) else None


def _clock(cell: str) -> float | None:
    """Return a time of day, or a date with one, in s; None where it is neither."""
    match = re.fullmatch(r"(\d{1,2}):(\d{2})(?::(\d{2}(?:[.,]\d+)?))?", cell)
    if match:
        hours, minutes, seconds = int(match[1]), int(match[2]), float((match[3] or "0").replace(",", "."))
        return 3600.0 * hours + 60.0 * minutes + seconds
    try:
        moment = datetime.fromisoformat(cell)
    except ValueError:
        return None
    # differences alone count, and every zone has the same
    return (moment.replace(tzinfo=moment.tzinfo or UTC) - EPOCH).total_seconds()
