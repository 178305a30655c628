"""A recorder's file as a table in our units: read as a recording is, but nothing in it is judged by what a train does.

Values that a `Recording` refuses, such as a negative speed, stay here as measured, with a note.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.energy import power_of_supply_current_w
from railjoule.core.errors import RecordingError
from railjoule.core.imports.cells import CellTable
from railjoule.core.measured.columns import GENERIC, PRESSURES, RecorderFormat
from railjoule.core.measured.line_power import sign_words
from railjoule.core.measured.recording import SHORTEST_RUN_S, distance_m, effort_of, time_of_positions
from railjoule.core.measured.table import (
    FALLING,
    Table,
    direction_of,
    impossible_change_words,
    read_table,
    require_rising,
)
from railjoule.core.scenario._sentences import counted
from railjoule.core.units import J_PER_KWH, MS_PER_KMH, N_PER_KN, W_PER_KW

PA_PER_KPA = 1e3
ASSUMED_UNITS: Mapping[str, str] = MappingProxyType(
    {
        "speed": "km/h",
        **dict.fromkeys(("effort", "tractive_effort", "braking_effort"), "kN"),
        "power": "kW",
        "energy": "kWh",
        "line_current": "A",
        "line_voltage": "V",
    }
)
"""Usual units of recorders: without a vehicle, no unit can be doubted here."""


@dataclass(frozen=True, eq=False)
class RunTable:
    """A recorder's file with n rows, in SI; arrays have the shape (n,), with NaN if a cell is empty.

    Times and positions count from the first row, and times rise. Efforts of braking and what goes back to the line are
    negative. `brake_applied`, of a brake without a pressure, is above 0 where it is applied.
    """

    source: str
    time_s: FloatArray
    position_m: FloatArray
    speed_ms: FloatArray
    effort_n: FloatArray | None
    supply_power_w: FloatArray | None
    supply_energy_j: FloatArray | None
    supply_current_a: FloatArray | None
    line_voltage_v: FloatArray | None
    brake_pressure_pa: FloatArray | None
    brake_applied: FloatArray | None
    notes: tuple[str, ...]

    def to_columns(self) -> dict[str, FloatArray]:
        """Return the run by columns, as a trajectory's table has them."""
        columns = {
            "position_m": (self.position_m, 1.0),
            "time_s": (self.time_s, 1.0),
            "speed_kmh": (self.speed_ms, MS_PER_KMH),
            "effort_kn": (self.effort_n, N_PER_KN),
            "line_power_kw": (self.supply_power_w, W_PER_KW),
            "line_energy_kwh": (self.supply_energy_j, J_PER_KWH),
            "line_current_a": (self.supply_current_a, 1.0),
            "line_voltage_v": (self.line_voltage_v, 1.0),
            "brake_pressure_kpa": (self.brake_pressure_pa, PA_PER_KPA),
            "brake_applied": (self.brake_applied, 1.0),
        }
        return {name: values / unit for name, (values, unit) in columns.items() if values is not None}


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
    position = _positions(table, notes)
    values, time = dict(table.values), table.values["time"]
    negative = np.flatnonzero(values["speed"] < 0)
    if len(negative):
        first = table.shown("speed", int(negative[0]))
        notes.append(f"The speed is negative in {counted(len(negative), 'row')}, first {first}; kept as measured.")
    duration = float(time[-1] - time[0])
    # times in a wrong unit are too short for a train
    if duration < SHORTEST_RUN_S:
        notes.append(f"The rows cover {duration:.3g} s only: is the time in another unit?")
    elif words := impossible_change_words(table, time):
        notes.append(f"{words}; kept as measured.")
    brake = "pressure" if "brake" in values and table.columns["brake"].unit in PRESSURES else "applied"
    current, voltage = values.get("line_current"), values.get("line_voltage")
    # a measured power or energy precedes that of the line current
    if current is not None and voltage is not None and not {"power", "energy"} & values.keys():
        notes.append(f"The electric power is the line current times the line voltage; {sign_words(current)}.")
        values["power"] = power_of_supply_current_w(current, voltage)
    if "energy" in values:
        finite = values["energy"][np.isfinite(values["energy"])]
        values["energy"] = values["energy"] - (finite[0] if len(finite) else 0.0)

    def frozen(column: FloatArray | None) -> FloatArray | None:
        return None if column is None else frozen_array(column)

    return RunTable(
        table.source,
        frozen_array(time - time[0]),
        frozen_array(position - position[0]),
        frozen_array(values["speed"]),
        effort_n=frozen(effort_of(values)),
        supply_power_w=frozen(values.get("power")),
        supply_energy_j=frozen(values.get("energy")),
        supply_current_a=frozen(current),
        line_voltage_v=frozen(values.get("line_voltage")),
        brake_pressure_pa=frozen(values.get("brake") if brake == "pressure" else None),
        brake_applied=frozen(values.get("brake") if brake == "applied" else None),
        notes=tuple(notes),
    )


def _with_time(table: Table, notes: list[str]) -> Table:
    """Add a time made of positions and speeds if there is none, and drop rows in which it does not rise."""
    if "time" not in table.values:
        notes.append("Times follow from positions and speeds.")
        table = replace(table, values={**table.values, "time": time_of_positions(table)})
    else:
        require_rising(table, "time", may_stay=True)
    kept = np.append(True, np.diff(table.values["time"]) > 0)
    left_out = int((~kept).sum())
    if left_out:
        notes.append(f"{counted(left_out, 'row')} at the time of the row above: left out.")
    return table.at(kept)


def _positions(table: Table, notes: list[str]) -> FloatArray:
    """Compute positions in the direction of the run [m], from speeds and times if there are none."""
    time, speed = table.values["time"], table.values["speed"]
    if "position" not in table.values:
        notes.append("Positions follow from speeds and times.")
        return distance_m(time, speed)
    direction = direction_of(table)
    if direction < 0:
        notes.append(FALLING)
    position: FloatArray = direction * table.values["position"]
    back = np.flatnonzero(np.diff(position) < 0)
    if len(back):
        places = f"{counted(len(back), 'time')}, first at {time[back[0]] - time[0]:g} s"
        notes.append(f"The position goes back {places}; kept as measured.")
    return position
