"""A recorder's file as a table in our units: read as a recording is, but nothing in it is judged by what a train does.

Values that a `Recording` refuses, such as a negative speed, stay here as measured, with a note.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.energy import power_of_supply_current_w
from railjoule.core.errors import RecordingError
from railjoule.core.imports.cells import CellTable
from railjoule.core.measured.columns import GENERIC, PRESSURES, RecorderFormat
from railjoule.core.measured.line_power import sign_words
from railjoule.core.measured.recording import (
    SHORTEST_RUN_S,
    distance_m,
    gap_words,
    missing_s,
    other_distance_words,
    time_of_positions,
    tractive_effort_n,
)
from railjoule.core.measured.table import (
    FALLING,
    Table,
    impossible_change_words,
    read_table,
    require_rising,
    running_direction,
)
from railjoule.core.scenario._sentences import counted
from railjoule.core.units import J_PER_KWH, MS_PER_KMH, N_PER_KN, W_PER_KW

ASSUMED_UNITS: Mapping[str, str] = {
    "speed": "km/h",
    **dict.fromkeys(("effort", "tractive_effort", "braking_effort"), "kN"),
    "power": "kW",
    "energy": "kWh",
    "line_current": "A",
    "line_voltage": "V",
}
"""Usual units of recorders: without a vehicle, no unit can be doubted here."""
COLUMNS: Mapping[str, tuple[str, float]] = {
    "position": ("position_m", 1.0),
    "time": ("time_s", 1.0),
    "speed": ("speed_kmh", MS_PER_KMH),
    "effort": ("effort_kn", N_PER_KN),
    "power": ("line_power_kw", W_PER_KW),
    "energy": ("line_energy_kwh", J_PER_KWH),
    "line_current": ("line_current_a", 1.0),
    "line_voltage": ("line_voltage_v", 1.0),
    "pressure": ("brake_pressure_kpa", 1e3),
    "brake": ("brake_applied", 1.0),
}
"""Columns of a trajectory's table by quantity, and the SI value of one of their unit."""


# long steps leave some 20 per cent of the distance open, mph taken as km/h 38
OTHER_UNIT_SHARE = 0.35
"""Distances by speeds and by positions that differ by more have another unit."""


@dataclass(frozen=True, eq=False)
class RunTable:
    """A recorder's file with n rows, by the columns of a trajectory's table; NaN if a cell is empty.

    Times and positions count from the first row, and times rise. Efforts of braking and what goes back to the line are
    negative. `brake_applied`, of a brake without a pressure, is above 0 where it is applied.
    """

    source: str
    columns: Mapping[str, FloatArray]
    notes: tuple[str, ...]


def run_table(cells: CellTable, form: RecorderFormat = GENERIC) -> RunTable:
    """Return the table of a run in the cells of a recorder's file.

    Parameters
    ----------
    cells : CellTable
        As `railjoule.core.measured.recorder_cells` returns it.
    form : RecorderFormat
        How the recorder writes; of `assumed`, `ASSUMED_UNITS` are the rest.

    Raises
    ------
    RecordingError
        If a column is missing, a cell holds no number, or times fall; the sentence names row, column and value.
    """
    table = read_table(cells, replace(form, assumed={**ASSUMED_UNITS, **form.assumed}))
    if len(table.rows) < 2:
        raise RecordingError(f"{table.source}: has fewer than 2 rows with numbers.")
    notes = list(table.notes)
    table = _with_time(table, notes)
    time = table.values["time"]
    values: dict[str, FloatArray | None] = {**table.values, "position": _positions(table, notes)}
    values["effort"] = tractive_effort_n(table.values)
    negative = np.flatnonzero(table.values["speed"] < 0)
    if len(negative):
        first = table.shown("speed", int(negative[0]))
        notes.append(f"The speed is negative in {counted(len(negative), 'row')}, first {first}; kept as measured.")
    duration = float(time[-1] - time[0])
    # times in a wrong unit are too short for a train
    if duration < SHORTEST_RUN_S:
        notes.append(f"The rows cover {duration:.3g} s only: is the time in another unit?")
    elif words := impossible_change_words(table, time):
        notes.append(f"{words}; kept as measured.")
    if "brake" in table.values and table.columns["brake"].unit in PRESSURES:
        values["pressure"] = values.pop("brake")
    current, voltage = values.get("line_current"), values.get("line_voltage")
    # a measured power or energy precedes that of the line current
    if current is not None and voltage is not None and not {"power", "energy"} & table.values.keys():
        notes.append(f"The electric power is the line current times the line voltage; {sign_words(current)}.")
        values["power"] = power_of_supply_current_w(current, voltage)
    for quantity in ("time", "position", "energy"):
        # counted from the first row that has one
        if (column := values.get(quantity)) is not None:
            values[quantity] = column - next(iter(column[np.isfinite(column)]), 0.0)
    found = ((name, values.get(quantity), unit) for quantity, (name, unit) in COLUMNS.items())
    columns = {name: frozen_array(column / unit) for name, column, unit in found if column is not None}
    return RunTable(table.source, columns, tuple(notes))


def _with_time(table: Table, notes: list[str]) -> Table:
    """Add a time made of positions and speeds if there is none, and drop rows in which it does not rise."""
    if "time" not in table.values:
        notes.append("Times follow from positions and speeds.")
        table = replace(table, values={**table.values, "time": time_of_positions(table)})
    else:
        require_rising(table, "time", may_stay=True)
    kept = np.append(True, np.diff(table.values["time"]) > 0)
    if left_out := int((~kept).sum()):
        notes.append(f"{counted(left_out, 'row')} at the time of the row above: left out.")
    return table.at(kept)


def _positions(table: Table, notes: list[str]) -> FloatArray:
    """Compute positions in the direction of the run [m], from speeds and times if there are none."""
    time, speed = table.values["time"], table.values["speed"]
    if "position" not in table.values:
        notes.append("Positions follow from speeds and times.")
        if words := gap_words(table, missing_s(table, time)):
            notes.append(f"{words}; the distance there is that of an even change of speed, if the clock is right.")
        return distance_m(time, speed)
    direction = running_direction(table)
    if direction < 0:
        notes.append(FALLING)
    position: FloatArray = direction * table.values["position"]
    back = np.flatnonzero(np.diff(position) < 0)
    if len(back):
        places = f"{counted(len(back), 'time')}, first at {time[back[0]] - time[0]:g} s"
        notes.append(f"The position goes back {places}; kept as measured.")
    elif "time" in table.columns and (words := _other_distance(table, time, position)):
        notes.append(f"{words}; kept as measured.")
    return position


def _other_distance(table: Table, time_s: FloatArray, position_m: FloatArray) -> str:
    covered = distance_m(time_s, np.maximum(table.values["speed"], 0.0))
    return other_distance_words(table, float(covered[-1]), float(position_m[-1] - position_m[0]), OTHER_UNIT_SHARE)
