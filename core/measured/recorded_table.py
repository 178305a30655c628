"""A recorder's file as a table in our units: read as a recording is, but nothing in it is judged by what a train does.

What a `Recording` refuses, such as a negative speed, is kept here as it was measured, and told.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.errors import RecordingError
from railjoule.core.imports.cells import CellTable
from railjoule.core.imports.source_file import counted
from railjoule.core.line_current import power_of_line_current_w
from railjoule.core.measured.columns import GENERIC, PRESSURES, RecorderFormat
from railjoule.core.measured.line_power import sign_words
from railjoule.core.measured.position import FALLING, direction_of, require_rising
from railjoule.core.measured.recording import SHORTEST_RUN_S, effort_of, time_of_positions
from railjoule.core.measured.speed_error import LARGEST_CHANGE_MS2, impossible_change
from railjoule.core.measured.table import Table, read_table
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
"""What recorders mostly write: nothing of a vehicle is known here by which a unit could be doubted."""


@dataclass(frozen=True, eq=False)
class RunTable:
    """A recorder's file with n rows, in SI.

    Parameters
    ----------
    source : str
        The file.
    time_s, position_m : array of shape (n,)
        From the first row on; times rise.
    speed_ms : array of shape (n,)
        As measured.
    effort_n, line_power_w, line_energy_j : array of shape (n,) or None
        What else was measured; NaN where a cell is empty. Efforts of braking and what goes back to the line are
        negative, the energy is that since the first row.
    line_current_a, line_voltage_v, brake_pressure_pa : array of shape (n,) or None
    brake_applied : array of shape (n,) or None
        Of a brake without a pressure: above 0 where it is applied.
    notes : tuple of str
        What was assumed, left out or changed, in sentences.
    """

    source: str
    time_s: FloatArray
    position_m: FloatArray
    speed_ms: FloatArray
    effort_n: FloatArray | None
    line_power_w: FloatArray | None
    line_energy_j: FloatArray | None
    line_current_a: FloatArray | None
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
            "line_power_kw": (self.line_power_w, W_PER_KW),
            "line_energy_kwh": (self.line_energy_j, J_PER_KWH),
            "line_current_a": (self.line_current_a, 1.0),
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
    values, time = table.values, table.values["time"]
    _tell_negative_speeds(table, notes)
    _tell_strange_times(table, notes)
    is_pressure = "brake" in values and table.columns["brake"].unit in PRESSURES
    return RunTable(
        table.source,
        frozen_array(time - time[0]),
        frozen_array(position - position[0]),
        frozen_array(values["speed"]),
        effort_n=_frozen(effort_of(values)),
        line_power_w=_frozen(_power(values, notes)),
        line_energy_j=_frozen(_since_first(values.get("energy"))),
        line_current_a=_frozen(values.get("line_current")),
        line_voltage_v=_frozen(values.get("line_voltage")),
        brake_pressure_pa=_frozen(values.get("brake") if is_pressure else None),
        brake_applied=_frozen(None if is_pressure else values.get("brake")),
        notes=tuple(notes),
    )


def _with_time(table: Table, notes: list[str]) -> Table:
    """Return a table with a time that rises, made of positions and speeds where there is none."""
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
    """Return positions in the direction of the run [m], made of speeds and times where there are none."""
    time, speed = table.values["time"], table.values["speed"]
    if "position" not in table.values:
        notes.append("Positions follow from speeds and times.")
        return np.append(0.0, np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(time)))
    direction = direction_of(table)
    position = direction * table.values["position"]
    if direction < 0:
        notes.append(FALLING)
    back = np.flatnonzero(np.diff(position) < 0)
    if len(back):
        places = f"{counted(len(back), 'time')}, first at {time[back[0]] - time[0]:g} s"
        notes.append(f"The position goes back {places}; kept as measured.")
    return position


def _tell_negative_speeds(table: Table, notes: list[str]) -> None:
    negative = np.flatnonzero(table.values["speed"] < 0)
    if len(negative):
        first = table.told("speed", int(negative[0]))
        notes.append(f"The speed is negative in {counted(len(negative), 'row')}, first {first}; kept as measured.")


def _tell_strange_times(table: Table, notes: list[str]) -> None:
    """Add a sentence where times are too short for a train, as those in a wrong unit are."""
    time, speed = table.values["time"], table.values["speed"]
    duration = float(time[-1] - time[0])
    if duration < SHORTEST_RUN_S:
        notes.append(f"The rows cover {duration:.3g} s only: is the time in another unit?")
    elif (found := impossible_change(time, speed)) is not None:
        row, later = found
        before = table.told("speed", row).partition(" = ")[2]
        notes.append(
            f"{table.told('speed', later)} follows {before} after {time[later] - time[row]:.4g} s, but no train "
            f"changes its speed by more than {LARGEST_CHANGE_MS2:g} m/s2; kept as measured."
        )


def _power(values: Mapping[str, FloatArray], notes: list[str]) -> FloatArray | None:
    """Return the power, where nothing else tells the energy that of the line current."""
    current, voltage = values.get("line_current"), values.get("line_voltage")
    if "power" in values or "energy" in values or current is None or voltage is None:
        return values.get("power")
    notes.append(f"The electric power is the line current times the line voltage; {sign_words(current)}.")
    return power_of_line_current_w(current, voltage)


def _since_first(energy: FloatArray | None) -> FloatArray | None:
    if energy is None:
        return None
    finite = energy[np.isfinite(energy)]
    return energy - finite[0] if len(finite) else energy


def _frozen(values: FloatArray | None) -> FloatArray | None:
    return None if values is None else frozen_array(values)
