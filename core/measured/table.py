"""A recorder's file as columns of numbers: header row, decimal comma, clock times, rows without values, positions."""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import chain

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.errors import RecordingError, ScenarioError
from railjoule.core.imports.cells import CellTable, read_cells
from railjoule.core.imports.clock import parse_clock, past_midnight, unit_of_times
from railjoule.core.imports.columns import has_name
from railjoule.core.imports.findings import without_name
from railjoule.core.imports.numbers import Decimal, decimal_mark, parse_cell, parse_position, text_of_cell
from railjoule.core.imports.source_file import SourceFile, encoding_mentioned
from railjoule.core.imports.units import CLOCK
from railjoule.core.measured.columns import (
    GENERIC,
    TRAINS,
    Column,
    RecorderFormat,
    find_columns,
    has_plain_name,
    recognised,
)
from railjoule.core.measured.speed import MAX_CHANGE_MS2, impossible_change
from railjoule.core.scenario._sentences import counted, show, shown_list
from railjoule.core.units import plain_number

NO_VALUES = ("", "nan", "null", "na", "n/a", "-")
"""Texts of a cell without a value."""
NEVER_EMPTY = ("time", "position", "speed")
"""A row without these is no sample; a row without an effort or a power is one without that."""
MAX_ROWS_SHOWN = 5


@dataclass(frozen=True, eq=False)
class Table:
    """The known columns of a file with n rows by quantity, in SI; NaN if a cell is empty.

    `rows` are the numbers of the rows in the file, as a spreadsheet counts.
    """

    source: str
    columns: Mapping[str, Column]
    values: Mapping[str, FloatArray]
    rows: tuple[int, ...]
    notes: tuple[str, ...]

    def shown(self, quantity: str, row: int) -> str:
        """Format a value as the file has it, such as 'speed = 41.5 km/h in row 12'."""
        column = self.columns[quantity]
        # seconds since 1970 differ in their last digits
        digits = 12 if quantity == "time" else 6
        value = plain_number(float(self.values[quantity][row]) / column.factor, digits)
        unit = "s" if column.unit == CLOCK else column.unit
        return f"{column.header} = {value} {unit} in row {self.rows[row]}"

    def shown_value(self, quantity: str, row: int) -> str:
        """Format a value without its name, such as '41.5 km/h in row 12'."""
        return self.shown(quantity, row).partition(" = ")[2]

    def at(self, kept: Sequence[bool] | np.ndarray) -> "Table":
        """Select rows."""
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
    notes = [without_name(words, source) for words in (*(one.sentence for one in cells.findings), *cells.unused)]
    notes += [
        f"No unit is named for {column.header!r}: taken as {column.unit}."
        for column in columns
        if column.is_assumed and column.unit != CLOCK and column.quantity != "brake"
    ]
    notes += [f"{column.header} is taken as that of the line." for column in columns if has_plain_name(column)]
    if unused := [name for name in cells.header if name not in [column.header for column in columns]]:
        _require_one_train(cells, unused)
        notes.append(f"Columns not used: {shown_list(unused)}.")
    decimals = _decimals([one for one in columns if one.unit != CLOCK], cells)
    values = {one.quantity: _column(one, cells, decimals.get(one.quantity, ".")) for one in columns}
    table = Table(source, {one.quantity: one for one in columns}, values, tuple(number for number, _ in cells.rows), ())
    table = _whole_rows(table, notes)
    if table.columns.get("time", Column("", "", "")).unit == CLOCK and len(table.rows):
        time = past_midnight(table.values["time"])
        if time[-1] > table.values["time"][-1]:
            notes.append("The clock passes midnight.")
            table = replace(table, values={**table.values, "time": time})
    return replace(table, notes=tuple(notes))


def _require_one_train(cells: CellTable, names: Sequence[str]) -> None:
    """Raise RecordingError if one of some columns names several trains, as in a simulated timetable."""
    for name in names:
        if has_name(name, TRAINS):
            trains = list(dict.fromkeys(text_of_cell(cell) for _, cell in cells.column(name)))
            if len(trains) > 1:
                raise RecordingError(
                    f"{cells.source}: its rows are of several trains, {name} = {shown_list(trains, MAX_ROWS_SHOWN)}; "
                    "keep the rows of one."
                )


def _with_clock(column: Column, cells: CellTable, form: RecorderFormat) -> Column:
    """Give a column of times the unit that its cells show, unless the user or its name states one."""
    if column.quantity != "time" or "time" in form.units:
        return column
    unit = unit_of_times(cells, column.header)
    return replace(column, unit=unit) if unit == CLOCK or (unit and column.is_assumed) else column


def _decimals(columns: Sequence[Column], cells: CellTable) -> dict[str, Decimal]:
    """Find the decimal sign of each quantity: one for the file, or if it mixes them one for each column."""
    pairs = {one.quantity: cells.column(one.header) for one in columns}
    with suppress(ScenarioError):
        return dict.fromkeys(pairs, decimal_mark(chain.from_iterable(pairs.values()), cells.separator, cells.source)[0])
    return {quantity: decimal_mark(some, cells.separator, cells.source)[0] for quantity, some in pairs.items()}


def _column(column: Column, cells: CellTable, decimal: Decimal) -> FloatArray:
    """Convert a column to SI; NaN if a cell is empty."""
    values = np.full(len(cells.rows), np.nan)
    for index, (row, cell) in enumerate(cells.column(column.header)):
        if text_of_cell(cell).lower() in NO_VALUES:
            continue
        try:
            if column.unit == CLOCK:
                values[index] = parse_clock(text_of_cell(cell))
            elif column.quantity == "position":
                values[index] = parse_position(cell, column.unit, decimal)
            else:
                values[index] = parse_cell(cell, decimal) * column.factor
        except ValueError as error:
            raise RecordingError(f"{cells.source}, row {row}: {column.header} = {show(cell)} {error}.") from None
    return values


def _whole_rows(table: Table, notes: list[str]) -> Table:
    """Return a table without rows that lack a time, a position or a speed, and tell what else is empty."""
    needed = [quantity for quantity in NEVER_EMPTY if quantity in table.values]
    whole = np.all([np.isfinite(table.values[quantity]) for quantity in needed], axis=0)
    if empty := np.flatnonzero(~whole).tolist():
        names = " or ".join(table.columns[quantity].header for quantity in needed)
        rows = shown_list([str(table.rows[row]) for row in empty], MAX_ROWS_SHOWN)
        are = "is" if len(empty) == 1 else "are"
        notes.append(f"{counted(len(empty), 'row')} without {names} {are} left out: {rows}.")
        table = table.at(whole)
    for quantity, values in table.values.items():
        if missing := int(np.isnan(values).sum()):
            notes.append(f"{table.columns[quantity].header} has no value in {missing} of {len(values)} rows.")
    return table


FALLING = "Positions fall: the train runs in falling chainage, counted from the first row."
MAX_NOISE_SHARE = 0.02
"""Of the distance: positions that leave the speeds by more, as a root mean square, were reset."""


def running_direction(table: Table) -> int:
    """Return -1 for a train that runs in falling chainage, else 1: in falling chainage most steps fall."""
    steps = np.sign(np.diff(table.values["position"]))
    return -1 if float(np.sum(steps)) < 0 and table.values["position"][-1] < table.values["position"][0] else 1


def require_rising(table: Table, quantity: str, may_stay: bool) -> None:
    """Raise RecordingError if a time, or a position in the direction of the run, goes back."""
    direction = running_direction(table) if quantity == "position" else 1
    difference = direction * np.diff(table.values[quantity])
    for row in np.flatnonzero(difference < 0 if may_stay else difference <= 0)[:1]:
        bound = ("at least" if direction > 0 else "at most") if may_stay else "above"
        raise RecordingError(
            f"{table.source}: {table.shown(quantity, row + 1)} must be {bound} that of the row before, "
            f"{table.shown_value(quantity, row)}: the rows are not in order, or the recorder was reset."
        )


def impossible_change_words(table: Table, time_s: FloatArray) -> str:
    """Describe a change of speed that no train can do, as the begin of a sentence; empty if there is none."""
    if (found := impossible_change(time_s, table.values["speed"])) is None:
        return ""
    row, later = found
    return (
        f"{table.shown('speed', later)} follows {table.shown_value('speed', row)} after "
        f"{time_s[later] - time_s[row]:.4g} s, but no train changes its speed by more than {MAX_CHANGE_MS2:g} m/s2"
    )


def readable_position(table: Table, covered_m: FloatArray, notes: list[str]) -> FloatArray | None:
    """Return the distance by the odometer since the first row [m], without steps back; None where it cannot be read.

    Parameters
    ----------
    table : Table
        The rows of the run, with a position.
    covered_m : array of shape (n,)
        Distance by the speeds [m].
    notes : list of str
        Receives a sentence where the position goes back.
    """
    position: FloatArray = running_direction(table) * (table.values["position"] - table.values["position"][0])
    steps = np.diff(position)
    back = np.flatnonzero(steps < 0)
    if not len(back):
        return position
    name, worst = table.columns["position"].header, int(np.argmin(steps))
    # the speeds have the shape of the distance, the positions its size
    basis = np.column_stack([np.ones(len(covered_m)), covered_m])
    (offset, factor), *_ = np.linalg.lstsq(basis, position, rcond=None)
    noise = float(np.sqrt(np.mean((position - offset - factor * covered_m) ** 2)))
    if noise > MAX_NOISE_SHARE * covered_m[-1]:
        notes.append(
            f"{name} is not used: it goes back by {-steps[worst]:.4g} m in row {table.rows[worst + 1]}. Distances "
            "follow from speed and time."
        )
        return None
    notes.append(
        f"{name} goes back in {counted(len(back), 'row')}, by up to {-steps[worst]:.3g} m: its noise of {noise:.2g} m "
        "is averaged out with the speeds."
    )
    return np.asarray(factor * covered_m)
