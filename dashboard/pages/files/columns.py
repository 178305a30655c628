"""Meanings of the columns of a recorder's file: chosen by the user, or guessed from the names with open questions."""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from railjoule.core import RailjouleError
from railjoule.core.arrays import FloatArray
from railjoule.core.errors import ChoiceError
from railjoule.core.imports.cells import Cell, CellTable
from railjoule.core.imports.clock import EPOCH_UNITS, unit_of_times
from railjoule.core.imports.source_file import SourceFile
from railjoule.core.imports.units import CLOCK
from railjoule.core.measured import RecorderFormat, recorder_cells
from railjoule.core.measured.columns import NEEDED_UNITS, UNITS, USUAL_UNITS, recognised, unknown_unit
from railjoule.core.scenario import Vehicle
from railjoule.core.scenario._sentences import shown_list
from railjoule.core.units import MS_PER_KMH, N_PER_KN, W_PER_KW
from railjoule.dashboard.look import words

MAX_ROWS = 20_000
"""8,551 samples of a run of three minutes took 2.4 s to smooth and 3.5 s to fit, on a busy core."""
MOST_SHEETS = 12
"""As many runs as a page can have open."""
NOT_USED = ""
QUANTITY_WORDS: Mapping[str, str] = {
    NOT_USED: "Not used",
    "time": "Time",
    "position": "Position",
    "speed": "Speed",
    "effort": "Effort",
    "tractive_effort": "Tractive effort",
    "braking_effort": "Braking effort",
    "brake": "Brake",
    "power": "Power",
    "energy": "Energy meter",
    "line_current": "Line current",
    "line_voltage": "Line voltage",
}
"""Quantities that a column may hold, in the words of the page."""
UNIT_WORDS: Mapping[str, str] = {CLOCK: "hh:mm:ss"}
PARTS_OF_EFFORT = ("tractive_effort", "braking_effort")
SAMPLES = 5
"""Rows that are shown of a column: the first, and some in motion."""
PLAUSIBLE: Mapping[str, tuple[float, float]] = {
    "speed": (0.1, 1.3),
    "effort": (0.05, 3.0),
    "tractive_effort": (0.05, 3.0),
    "braking_effort": (0.05, 3.0),
    "power": (0.02, 4.0),
    "energy": (0.3, 150.0),
    # wide where the vehicle names no voltage: from 600 V to 25 kV, and less current the more of it
    "line_current": (0.015, 10.0),
    "line_voltage": (0.2, 20.0),
}
"""Between which shares of what the train has the largest value of a column lies where its unit is right: of its top
speed, of its largest effort and power, of its kinetic energy at top speed, of its line's voltage and of the current
that its power takes from it."""
USUAL_VOLTAGE_V = 1500.0
"""Assumed line voltage of a vehicle without one."""


@dataclass(frozen=True)
class Meaning:
    """Quantity and unit of a column; the unit is empty if the name of the column has none."""

    quantity: str
    unit: str = ""

    @classmethod
    def of(cls, text: str) -> "Meaning":
        """Return the meaning of a saved text such as 'effort kN'; an unknown text means that the column is not used."""
        quantity, _, unit = text.partition(" ")
        known = UNITS.get(quantity, {})
        return cls(quantity, unit) if unit in known else cls(NOT_USED)

    @property
    def text(self) -> str:
        """The text in which it is saved."""
        return f"{self.quantity} {self.unit}".strip()


@dataclass(frozen=True)
class Question:
    """Something in doubt of a file.

    Parameters
    ----------
    sentence : str
    key : str
        The choice or the number that it is about.
    answers : tuple of (str, str)
        The words of each and the value that it gives to the key, the likelier one first.
    """

    sentence: str
    key: str
    answers: tuple[tuple[str, str], ...]

    @property
    def header(self) -> str:
        """The column in question."""
        return self.key.partition(" ")[2]


@dataclass(frozen=True, eq=False)
class RunFile:
    """A recorded run as a table: a file, or a sheet of a workbook.

    Parameters
    ----------
    name : str
    cells : CellTable
    """

    name: str
    cells: CellTable

    def samples(self, header: str) -> list[str]:
        """Return some cells of a column: the first, and those after a third of the rows."""
        rows = self.cells.rows
        index, third = self.cells.header.index(header), len(rows) // 3
        shown = [rows[0], *rows[max(third, 1) : third + SAMPLES - 1]]
        return [_text(cells[index]) for _, cells in shown]


def find_quantities(header: Sequence[str]) -> set[str]:
    """Return the quantities of columns of these names."""
    return {column.quantity for column in recognised(header, RecorderFormat())}


def read_runs(source: SourceFile, sheet: str | None = None) -> tuple[RunFile, ...]:
    """Return a file as a table, or each sheet of a workbook that names a speed as one.

    Raises
    ------
    RailjouleError
        If it is none, or too large.
    """
    try:
        return (read_run_file(source, sheet),)
    except ChoiceError as several:
        return run_sheets(source, several.names)


def run_sheets(source: SourceFile, sheets: Sequence[str]) -> tuple[RunFile, ...]:
    """Return the sheets of a workbook that name a speed, each as a file of its own.

    Raises
    ------
    RailjouleError
        If none of them does.
    """
    found, others = [], list(sheets[MOST_SHEETS:])
    for sheet in sheets[:MOST_SHEETS]:
        # a sheet of notes is no table
        with suppress(RailjouleError):
            file = read_run_file(source, sheet)
            if "speed" in find_quantities(file.cells.header):
                found.append((sheet, file))
                continue
        others.append(sheet)
    name = source.name
    if not found:
        raise RailjouleError(f"{name}: none of its sheets is a table with a speed; it has {shown_list(list(sheets))}.")
    unread = (f"Sheets that are not read as a run: {shown_list(others)}.",) if others else ()
    return tuple(_sheet_as_file(file, f"{name}, {sheet}", unread) for sheet, file in found)


def _sheet_as_file(file: RunFile, name: str, unread: tuple[str, ...]) -> RunFile:
    """Return a sheet as a file of its own, without the note about the other sheets that are runs."""
    kept = [sentence for sentence in file.cells.unused if "sheets not read" not in sentence]
    return RunFile(name, replace(file.cells, source=name, unused=(*kept, *unread)))


def read_run_file(source: SourceFile, sheet: str | None = None) -> RunFile:
    """Return a file, of a workbook a sheet, as a table.

    Raises
    ------
    RailjouleError
        If it is no table with names above its columns, or one of too many rows.
    """
    cells, name = recorder_cells(source, sheet=sheet), source.name
    if not cells.has_header:
        raise RailjouleError(f"{name}: the first row must name the columns, such as time_s, position_m, speed_kmh.")
    if len(cells.rows) > MAX_ROWS:
        raise RailjouleError(
            f"{name}: {words.number(len(cells.rows), 0)} rows; at most {words.number(MAX_ROWS, 0)} can be read. Leave "
            "out some samples, or cut the file into its runs."
        )
    return RunFile(name, cells)


def read_meanings(file: RunFile, answers: Mapping[str, str]) -> dict[str, Meaning]:
    """Return the meaning of each column of a file.

    Parameters
    ----------
    file : RunFile
    answers : mapping of str to str
        Choices of the user by the column's name: a quantity and a unit, or an empty text if it is not used.
    """
    headers = file.cells.header
    meanings = dict.fromkeys(headers, Meaning(NOT_USED))
    said = {header: Meaning.of(answers[header]) for header in headers if header in answers}
    meanings.update(said)
    taken = {meaning.quantity for meaning in said.values()}
    for column in recognised(headers, RecorderFormat()):
        if column.header in said or column.quantity in taken:
            continue
        # of two columns that may hold one quantity the first is used
        taken.add(column.quantity)
        meanings[column.header] = Meaning(
            column.quantity, column.unit or _usual_unit(file, column.header, column.quantity)
        )
    if "effort" in taken:
        for header, meaning in meanings.items():
            if meaning.quantity in PARTS_OF_EFFORT and header not in said:
                meanings[header] = Meaning(NOT_USED)
    return meanings


def _usual_unit(file: RunFile, header: str, quantity: str) -> str:
    if unknown_unit(header, quantity):
        return ""
    shown = unit_of_times(file.cells, header) if quantity == "time" else ""
    return shown or USUAL_UNITS.get(quantity, "")


def settled(
    file: RunFile, answers: Mapping[str, str], vehicle: Vehicle
) -> tuple[dict[str, Meaning], tuple[Question, ...], tuple[str, ...]]:
    """Return the meanings of the columns, the open questions, and the assumptions in sentences.

    A column with an open question is not used; a choice of the user raises no question.
    """
    meanings, doubts, assumed = read_meanings(file, answers), [], []
    for header, meaning in meanings.items():
        if header in answers:
            continue
        unknown = unknown_unit(header, meaning.quantity) if meaning.quantity else ""
        if meaning.quantity == "time" and meaning.unit in EPOCH_UNITS and unit_of_times(file.cells, header):
            assumed.append(f"{header}: read in {meaning.unit}, as a time since 1970.")
        needed = meaning.quantity in NEEDED_UNITS
        fitting = fitting_units(file, header, meaning.quantity, vehicle) if needed else []
        if not unknown and (not needed or meaning.unit in fitting or (meaning.unit and not fitting)):
            continue
        if not unknown and not meaning.unit and len(fitting) == 1:
            meanings[header] = Meaning(meaning.quantity, fitting[0])
            assumed.append(f"{header}: no unit is named, taken as {fitting[0]}.")
            continue
        doubts.append(_question(file, header, meaning, fitting, vehicle, unknown))
    return meanings, tuple(doubts), tuple(assumed)


def fitting_units(file: RunFile, header: str, quantity: str, vehicle: Vehicle) -> list[str]:
    """Return the units in which the largest value of a column is one that such a train has."""
    size = _extent(file, header, quantity)
    low, high = PLAUSIBLE[quantity]
    whole = _sizes(vehicle)[quantity]
    return [unit for unit, factor in UNITS[quantity].items() if low * whole <= size * factor <= high * whole]


def _question(
    file: RunFile, header: str, meaning: Meaning, fitting: Sequence[str], vehicle: Vehicle, unknown: str
) -> Question:
    """Return the question about the unit of a column, the likelier units first."""
    known = [unit for unit in UNITS[meaning.quantity] if unit != CLOCK]
    others = [unit for unit in dict.fromkeys([*fitting, *known]) if unit != meaning.unit]
    first, second = others[0], meaning.unit or others[1]
    if unknown:
        sentence = f"The unit {unknown} is not known: is it {first} or {second}?"
    else:
        what = "Rises by" if meaning.quantity == "energy" else "At most"
        size = words.number(_extent(file, header, meaning.quantity), 1)
        train = f"in a train of {words.number(vehicle.total_mass_kg / 1000, 0)} t"
        sentence = (
            f"{what} {size} {second} {train}: was {first} meant?"
            if meaning.unit
            else f"{what} {size} {train}, and no unit is named: is it {first} or {second}?"
        )
    answers = tuple(
        (f"{'Keep' if unit == meaning.unit else 'Use'} {unit}", Meaning(meaning.quantity, unit).text)
        for unit in (first, second)
    )
    return Question(sentence, f"unit {header}", answers)


def _sizes(vehicle: Vehicle) -> dict[str, float]:
    """Return the maximum of each quantity for such a train, in SI units."""
    traction = vehicle.traction
    top = traction.max_speed_kmh * MS_PER_KMH
    kinetic = 0.5 * vehicle.total_mass_kg * top**2
    # a train whose effort is not named accelerates by about 1 m/s2
    effort = (traction.max_effort_kn or vehicle.total_mass_kg / 1e3) * N_PER_KN
    power = (traction.max_power_kw or effort * top / 2 / W_PER_KW) * W_PER_KW
    voltage = vehicle.line_voltage_v or USUAL_VOLTAGE_V
    return {
        "speed": top,
        **dict.fromkeys(("effort", *PARTS_OF_EFFORT), effort),
        "power": power,
        "energy": kinetic,
        "line_current": power / voltage,
        "line_voltage": voltage,
    }


def _extent(file: RunFile, header: str, quantity: str) -> float:
    """Return the largest size of the values of a column, of a meter by how much it rises; 0 where none is a number."""
    values = _numbers(file, header)
    if not len(values):
        return 0.0
    return float(np.ptp(values)) if quantity == "energy" else float(np.max(np.abs(values)))


def _numbers(file: RunFile, header: str) -> FloatArray:
    found = []
    for _, cell in file.cells.column(header):
        try:
            found.append(float(cell.replace(",", ".") if isinstance(cell, str) else cell))
        except ValueError:
            continue
    values = np.array(found)
    finite: FloatArray = values[np.isfinite(values)]
    return finite


def used_table(file: RunFile, used: Mapping[str, Meaning]) -> tuple[CellTable, RecorderFormat]:
    """Return the columns of a file that are used, without its rows that hold nothing in them, and their format."""
    headers = [header for header in file.cells.header if header in used]
    indices = [file.cells.header.index(header) for header in headers]
    chosen = ((number, tuple(cells[index] for index in indices)) for number, cells in file.cells.rows)
    form = RecorderFormat(
        columns={used[header].quantity: header for header in headers},
        units={used[header].quantity: used[header].unit for header in headers},
    )
    rows = tuple((number, cells) for number, cells in chosen if any(_text(cell) for cell in cells))
    return replace(file.cells, header=tuple(headers), rows=rows), form


def _text(cell: Cell) -> str:
    """Return a cell in one line."""
    return " ".join(cell.split()) if isinstance(cell, str) else f"{cell:.12g}"
