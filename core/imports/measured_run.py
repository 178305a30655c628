"""Measured runs: the tables that a train's recorder writes, with columns by any names and units."""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from typing import cast

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.errors import ScenarioError
from railjoule.core.imports.cells import Cell, CellTable, read_cells
from railjoule.core.imports.columns import same_name
from railjoule.core.imports.findings import Finding, Notes
from railjoule.core.imports.numbers import Decimal, decimal_of, number_of, text_of_cell
from railjoule.core.imports.source_file import SourceFile, counted, shown_list
from railjoule.core.scenario._sentences import show
from railjoule.core.units import J_PER_KWH, J_PER_WH, MS_PER_KMH, N_PER_KN, W_PER_KW

S_PER_DAY = 86_400.0
PA_PER_KPA = 1e3


@dataclass(frozen=True)
class Channel:
    """What a column of a run can hold.

    Parameters
    ----------
    names : tuple of str
        Words by which it is known, the likeliest first.
    units : mapping of str to float
        What one of each unit is in ours, which is the first.
    default : str
        The unit where none is named.
    """

    names: tuple[str, ...]
    units: Mapping[str, float]
    default: str


CHANNELS: Mapping[str, Channel] = {
    "time": Channel(
        ("time", "seconds", "timestamp", "t", "zeit"), {"s": 1.0, "ms": 1e-3, "min": 60.0, "h": 3600.0}, "s"
    ),
    "position": Channel(
        ("position", "distance", "chainage", "odometer", "weg", "s", "x"), {"m": 1.0, "km": 1e3, "mi": 1609.344}, "m"
    ),
    "speed": Channel(
        ("speed", "velocity", "v", "geschwindigkeit", "vitesse"),
        {"ms": 1.0, "kmh": MS_PER_KMH, "mph": 0.44704},
        "kmh",
    ),
    "effort": Channel(("effort", "tractive effort", "force", "zugkraft"), {"n": 1.0, "kn": N_PER_KN}, "kn"),
    "power": Channel(
        ("line power", "power", "power demand", "leistung"), {"w": 1.0, "kw": W_PER_KW, "mw": 1e3 * W_PER_KW}, "kw"
    ),
    "energy": Channel(
        ("line energy", "energy", "counter", "energie"),
        {"j": 1.0, "wh": J_PER_WH, "kwh": J_PER_KWH, "mwh": 1e3 * J_PER_KWH},
        "kwh",
    ),
    "brake_pressure": Channel(
        ("brake pressure", "cylinder pressure", "pressure"), {"pa": 1.0, "kpa": PA_PER_KPA, "bar": 1e5}, "bar"
    ),
}
"""What is read of a run; energies, powers and efforts are positive where the train drives."""
UNITS_IN_WORDS = {"kmh": "km/h", "kn": "kN", "kw": "kW", "kwh": "kWh"}
"""Units as people write them, of those in small letters without signs."""
NEEDED = ("time", "position", "speed")
RUN_PRESETS: Mapping[str, Mapping[str, tuple[str, str]]] = {
    # columns and units of a published set of 1,400 runs of trolleybuses, doi 10.1038/s41597-023-02600-6
    "ztbus": {
        "time": ("time_unix", "s"),
        "speed": ("odometry_vehicleSpeed", "ms"),
        "effort": ("traction_tractionForce", "n"),
        "power": ("electric_powerDemand", "w"),
        "brake_pressure": ("traction_brakePressure", "pa"),
    },
}
"""Tables that are published: the column and the unit of each channel; found by their columns."""


@dataclass(frozen=True, eq=False)
class MeasuredRun:
    """A run as it was measured.

    Parameters
    ----------
    source : str
        The file.
    time_s, position_m, speed_ms : array of shape (n,)
        From its first row on; times rise.
    effort_n, line_power_w, line_energy_j, brake_pressure_pa : array of shape (n,) or None
        What else was measured; NaN where a cell is empty. The energy is that since the first row.
    findings, unused
        See `Imported`.
    """

    source: str
    time_s: FloatArray
    position_m: FloatArray
    speed_ms: FloatArray
    effort_n: FloatArray | None = None
    line_power_w: FloatArray | None = None
    line_energy_j: FloatArray | None = None
    brake_pressure_pa: FloatArray | None = None
    findings: tuple[Finding, ...] = field(default=(), kw_only=True)
    unused: tuple[str, ...] = field(default=(), kw_only=True)

    def to_columns(self) -> dict[str, FloatArray]:
        """Return the run by columns, as a trajectory's table has them."""
        columns = {
            "position_m": (self.position_m, 1.0),
            "time_s": (self.time_s, 1.0),
            "speed_kmh": (self.speed_ms, MS_PER_KMH),
            "effort_kn": (self.effort_n, N_PER_KN),
            "line_power_kw": (self.line_power_w, W_PER_KW),
            "line_energy_kwh": (self.line_energy_j, J_PER_KWH),
            "brake_pressure_kpa": (self.brake_pressure_pa, PA_PER_KPA),
        }
        return {name: values / unit for name, (values, unit) in columns.items() if values is not None}


def read_run(source: SourceFile, columns: Mapping[str, str] | None = None) -> MeasuredRun:
    """Return the run that a table of a recorder holds.

    Parameters
    ----------
    source : SourceFile
        CSV or a workbook with a column of speed, and one of time or position.
    columns : mapping, optional
        The columns of `CHANNELS`, as far as they are not to be guessed; a unit may stand behind each in brackets.

    Raises
    ------
    ScenarioError
        If it is no such table; the sentence names row, column and value.
    """
    cells = read_cells(source)
    notes = Notes(list(cells.findings), list(cells.unused))
    found = _channels(cells, columns or {}, notes)
    others = [column for column in cells.header if column not in {name for name, _ in found.values()}]
    if others:
        notes.unused.append(f"{cells.source}: columns not used: {shown_list(others)}.")
    return run_of_cells(cells, found, notes)


def run_of_cells(cells: CellTable, found: Mapping[str, tuple[str, float]], notes: Notes) -> MeasuredRun:
    """Return the run in a table of which the columns are known.

    Parameters
    ----------
    cells : CellTable
        The table.
    found : mapping
        The column of each channel, and what one of its unit is in ours.
    notes : Notes
        What was noticed so far; what is noticed here is added.

    Raises
    ------
    ScenarioError
        If a cell holds no number, or times fall.
    """
    rows = np.array([number for number, _ in cells.rows])
    values = _numbers(cells, found)
    needed = [values[name] for name in NEEDED if name in values]
    whole = np.all(np.isfinite(needed), axis=0)
    if not whole.all():
        what = " or ".join(name for name in NEEDED if name in values)
        notes.unused.append(f"{cells.source}: {counted(int((~whole).sum()), 'row')} without {what}.")
    values, rows = {name: column[whole] for name, column in values.items()}, rows[whole]
    if len(rows) < 2:
        raise ScenarioError(f"{cells.source}: has fewer than 2 rows with numbers.")
    values = _with_rising_time(cells.source, values, rows, notes)
    position = values["position"]
    if position[-1] < position[0]:
        notes.findings.append(Finding("order", f"{cells.source}: positions fall; they are counted from the first row."))
        position = -position
    back = np.flatnonzero(np.diff(position) < 0)
    if len(back):
        places = f"{counted(len(back), 'time')}, first at {values['time'][back[0]] - values['time'][0]:g} s"
        notes.findings.append(Finding("order", f"{cells.source}: the position goes back {places}; kept as measured."))
    energy = values.get("energy")
    return MeasuredRun(
        cells.source,
        frozen_array(values["time"] - values["time"][0]),
        frozen_array(position - position[0]),
        frozen_array(values["speed"]),
        effort_n=_frozen(values.get("effort")),
        line_power_w=_frozen(values.get("power")),
        line_energy_j=_frozen(None if energy is None else energy - _first_finite(energy)),
        brake_pressure_pa=_frozen(values.get("brake_pressure")),
        findings=tuple(notes.findings),
        unused=tuple(notes.unused),
    )


def _frozen(values: FloatArray | None) -> FloatArray | None:
    return None if values is None else frozen_array(values)


def _channels(cells: CellTable, columns: Mapping[str, str], notes: Notes) -> dict[str, tuple[str, float]]:
    """Return the column of each channel, and what one of its unit is in ours."""
    preset = next(
        (preset for preset in RUN_PRESETS.values() if all(name in cells.header for name, _ in preset.values())), {}
    )
    found: dict[str, tuple[str, float]] = {
        name: (column, CHANNELS[name].units[unit]) for name, (column, unit) in preset.items()
    }
    for name in columns:
        if name not in CHANNELS:
            raise ScenarioError(f"{cells.source}: {show(name)} must be one of {', '.join(CHANNELS)}.")
    for name, channel in CHANNELS.items():
        if name in columns:
            found[name] = _named(cells, name, columns[name], channel)
        elif name not in found and not preset:
            taken = {column for column, _ in found.values()}
            column = _guessed(channel, [column for column in cells.header if column not in taken])
            if column is not None:
                found[name] = (column, _unit_of(cells, name, column, channel, notes))
    for needed in (("speed",), ("time", "position")):
        if not found.keys() & set(needed):
            raise ScenarioError(
                f"{cells.source}: no column of {' or '.join(needed)} was found; name it, as {needed[0]}=COLUMN, of "
                f"{shown_list(list(cells.header))}."
            )
    return found


def _named(cells: CellTable, name: str, told: str, channel: Channel) -> tuple[str, float]:
    """Return a column by what a user says of it: its name, and behind it in brackets its unit."""
    bare, unit = told, ""
    if told not in cells.header and (match := re.fullmatch(r"(.*?)\s*\[([^\]]*)\]", told)):
        bare, unit = match[1], _unit_words(match[2])
        if unit not in channel.units:
            raise ScenarioError(f"{cells.source}: {name} = {show(told)} must have one of {', '.join(channel.units)}.")
    column = next((column for column in cells.header if column == bare or same_name(column, bare)), None)
    if column is None:
        raise ScenarioError(
            f"{cells.source}: {name} = {show(bare)} is not a column of it: {shown_list(list(cells.header))}."
        )
    return column, channel.units[unit or _unit_in(column, channel) or channel.default]


def _guessed(channel: Channel, free: Sequence[str]) -> str | None:
    for name in channel.names:
        for column in free:
            if _without_unit(column, channel) == name:
                return column
    return None


def _unit_of(cells: CellTable, name: str, column: str, channel: Channel, notes: Notes) -> float:
    unit = _unit_in(column, channel)
    if unit is None and not (name == "time" and ":" in str(cells.column(column)[0][1])):
        unit = channel.default
        words = UNITS_IN_WORDS.get(unit, unit)
        notes.findings.append(
            Finding("assumption", f"{cells.source}: no unit is named for {column!r}: taken as {words}.")
        )
    return channel.units[unit or channel.default]


def _unit_in(column: str, channel: Channel) -> str | None:
    words = _unit_words(column).split()
    return next((word for word in reversed(words[1:]) if word in channel.units), None)


def _without_unit(column: str, channel: Channel) -> str:
    words = _unit_words(column).split()
    return " ".join(words[:-1] if len(words) > 1 and words[-1] in channel.units else words)


def _unit_words(text: str) -> str:
    lower = text.lower().replace("km/h", "kmh").replace("m/s", "ms")
    return " ".join(re.sub(r"[^a-z0-9]+", " ", lower).split())


def _numbers(cells: CellTable, found: Mapping[str, tuple[str, float]]) -> dict[str, FloatArray]:
    """Return all columns as numbers in our units; NaN where a cell is empty."""
    named = [pair for column, _ in found.values() for pair in cells.column(column)]
    decimal, _ = decimal_of(((row, cell) for row, cell in named if ":" not in str(cell)), cells.separator, cells.source)
    values = {}
    for name, (column, unit) in found.items():
        read = _seconds if name == "time" else number_of
        numbers = []
        for row, cell in cells.column(column):
            try:
                numbers.append(math.nan if cell == "" or not text_of_cell(cell) else read(cell, decimal))
            except ValueError as error:
                raise ScenarioError(f"{cells.source}, row {row}: {column} = {show(cell)} {error}.") from None
        values[name] = np.array(numbers)
        if not (name == "time" and any(":" in str(cell) for _, cell in cells.column(column))):
            values[name] *= unit
    return values


def _seconds(cell: Cell, decimal: Decimal) -> float:
    """Return a time: a number, 10:15:30, or a date with a time."""
    text = text_of_cell(cell)
    if clock := re.fullmatch(r"(\d{1,2}):(\d{2})(?::(\d{2}(?:[.,]\d{1,9})?))?", text):
        return 3600.0 * int(clock[1]) + 60.0 * int(clock[2]) + float((clock[3] or "0").replace(",", "."))
    if ":" in text:
        try:
            return datetime.fromisoformat(text).timestamp()
        except (ValueError, OverflowError, OSError):
            raise ValueError("must be a time, as 10:15:30 or 2026-01-31T10:15:30") from None
    return number_of(cell, decimal)


def _with_rising_time(
    source: str, values: dict[str, FloatArray], rows: np.ndarray, notes: Notes
) -> dict[str, FloatArray]:
    """Return the columns with time and position, each made from the other where it is missing, and no time twice.

    Raises
    ------
    ScenarioError
        If times fall, or the train moves on without speed and time.
    """
    if "time" not in values:
        values = {**values, "time": _time_of(source, values["position"], values["speed"], rows)}
        notes.findings.append(Finding("assumption", f"{source}: times follow from positions and speeds."))
    time = values["time"]
    # a clock without a date begins anew at midnight
    time = time + S_PER_DAY * np.cumsum(np.append(0, np.diff(time) < -0.5 * S_PER_DAY))
    falls = np.flatnonzero(np.diff(time) < 0)
    if len(falls):
        row = int(rows[falls[0] + 1])
        raise ScenarioError(f"{source}, row {row}: its time lies before that of the row above.")
    kept = np.append(True, np.diff(time) > 0)
    if not kept.all():
        notes.unused.append(f"{source}: {counted(int((~kept).sum()), 'row')} at the time of the row above.")
    values = {name: column[kept] for name, column in {**values, "time": time}.items()}
    if "position" not in values:
        speed, time = values["speed"], values["time"]
        steps = 0.5 * (speed[1:] + speed[:-1]) * np.diff(time)
        values["position"] = np.append(0.0, np.cumsum(steps))
        notes.findings.append(Finding("assumption", f"{source}: positions follow from speeds and times."))
    return values


def _time_of(source: str, position: FloatArray, speed: FloatArray, rows: np.ndarray) -> FloatArray:
    lengths, means = np.abs(np.diff(position)), 0.5 * (speed[1:] + speed[:-1])
    stuck = np.flatnonzero((lengths > 0) & (means <= 0))
    if len(stuck):
        raise ScenarioError(f"{source}, row {rows[stuck[0] + 1]}: moves on from the row above without speed.")
    steps = np.divide(lengths, means, out=np.zeros(len(lengths)), where=lengths > 0)
    return np.append(0.0, np.cumsum(steps))


def _first_finite(values: FloatArray) -> float:
    finite = values[np.isfinite(values)]
    return cast("float", finite[0]) if len(finite) else 0.0
