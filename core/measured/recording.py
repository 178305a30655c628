"""A recording: what a train's recorder wrote of one run, checked row by row, in SI."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from railjoule.core.arrays import BoolArray, FloatArray, frozen_array
from railjoule.core.errors import RecordingError
from railjoule.core.imports.cells import CellTable
from railjoule.core.imports.source_file import SourceFile
from railjoule.core.measured.columns import GENERIC, UNITS, RecorderFormat
from railjoule.core.measured.speed import (
    noise_deviation,
    quantisation,
    standing_samples,
    standstill_ms,
)
from railjoule.core.measured.table import (
    FALLING,
    Table,
    impossible_change_words,
    read_table,
    readable_position,
    recorder_cells,
    require_rising,
    running_direction,
)
from railjoule.core.scenario._sentences import counted
from railjoule.core.units import MS_PER_KMH

FEWEST_SAMPLES = 10
"""Fewer show no course of a speed."""
SHORTEST_RUN_S = 1.0
"""Shorter runs are those whose times are in another unit."""
MAX_SPEED_MS = 600.0 * MS_PER_KMH
"""As of the vehicles of a scenario."""
MAX_VOLTAGE_V = 100_000.0
"""As of `vehicle.line_voltage_v`."""
GAP_STEPS = 3.0
"""Steps longer than so many usual ones are gaps."""
SAME_STEP = 0.002
"""By which share a step that is found from rounded values may be off."""
ROUNDING_MS = 1e-6
SAME_DISTANCE = 0.10
"""By which share distances by position and by speed may differ; wrong units make factors of 3.6 and more."""


@dataclass(frozen=True, eq=False)
class Recording:
    """One run as a recorder wrote it: n samples, from the last one at rest before it to the first one at rest after it.

    Parameters
    ----------
    name : str
        The file.
    time_s, speed_ms : array of shape (n,)
        Time from the first sample, samples at rest moved to where the motion begins or ends, and speed.
    clock_s : array of shape (n,)
        Time as written, on the same scale.
    position_m, effort_n, power_w, energy_j, supply_current_a, line_voltage_v : array of shape (n,) or None
        Odometer, effort at the wheels (braking negative), power and current taken from the line (negative if energy
        goes back), energy meter, line voltage; NaN if not known, None if not recorded.
    brake_applied : array of bool of shape (n,) or None
        Whether a brake works that the effort does not count.
    speed_step_ms : float
        Step in which the speed is given; 0 if it has none.
    speed_noise_ms : float
        Standard deviation of its errors beyond those of the steps.
    gap_s : array of shape (n - 1,)
        Time without samples after each sample; 0 if none are missing.
    notes : tuple of str
        Rows and values that were skipped, changed or missing, in sentences.
    """

    name: str
    time_s: FloatArray
    speed_ms: FloatArray
    clock_s: FloatArray
    position_m: FloatArray | None
    effort_n: FloatArray | None
    brake_applied: BoolArray | None
    power_w: FloatArray | None
    energy_j: FloatArray | None
    supply_current_a: FloatArray | None
    line_voltage_v: FloatArray | None
    speed_step_ms: float
    speed_noise_ms: float
    gap_s: FloatArray
    notes: tuple[str, ...]

    @property
    def covered_m(self) -> FloatArray:
        """Distance covered since the first sample by the speeds [m]; shape (n,)."""
        return distance_m(self.time_s, self.speed_ms)

    @property
    def rests(self) -> bool:
        """Whether the train begins and ends at rest, by its speed."""
        return bool(max(self.speed_ms[0], self.speed_ms[-1]) <= standstill_ms(self.speed_noise_ms))

    @property
    def duration_s(self) -> float:
        """Time of the run [s]."""
        return float(self.time_s[-1])


def load_recording(path: Path, form: RecorderFormat = GENERIC, sheet: str | None = None) -> Recording:
    """Return the run of a recorder's file, CSV or a sheet of a workbook.

    Raises
    ------
    RailjouleError
        As `to_recording`, or if there is no such file.
    """
    return to_recording(recorder_cells(SourceFile.read(path, form.encoding), form, sheet), form)


def read_recording(text: str, source: str, form: RecorderFormat = GENERIC) -> Recording:
    """Return the run of a text in CSV; errors as of `load_recording`."""
    return to_recording(recorder_cells(SourceFile(source, text.encode()), form), form)


def to_recording(cells: CellTable, form: RecorderFormat = GENERIC) -> Recording:
    """Return the run in the cells of a recorder's file.

    Parameters
    ----------
    cells : CellTable
        As `recorder_cells` returns it.
    form : RecorderFormat
        How the recorder writes.

    Raises
    ------
    RecordingError
        If a column or a unit is missing, times or positions fall, a speed is negative or none that a train has, samples
        are missing for too long, or the distances by speed and by position do not fit.
    """
    table = read_table(cells, form)
    source = table.source
    rows = len(table.rows)
    if rows < FEWEST_SAMPLES:
        raise RecordingError(f"{source}: {rows} rows, but a run needs at least {FEWEST_SAMPLES}.")
    notes = list(table.notes)
    factor = table.columns["speed"].factor
    step = quantisation(table.values["speed"] / factor) * factor
    noise = noise_deviation(table.values["speed"], step)
    # a sensor may show a speed below 0 at standstill
    _require_within(table, "speed", -standstill_ms(noise), MAX_SPEED_MS)
    _require_within(table, "line_voltage", 0.0, MAX_VOLTAGE_V)
    if not np.any(table.values["speed"] > 0):
        raise RecordingError(f"{source}: {table.columns['speed'].header} is 0 in all rows, so there is no run.")
    table = _without_repeats(table, notes)
    if has_time := "time" in table.values:
        require_rising(table, "time", may_stay=False)
    if "position" in table.values:
        if not has_time:
            require_rising(table, "position", may_stay=True)
        if running_direction(table) < 0:
            notes.append(FALLING)
    time = table.values["time"] - table.values["time"][0] if has_time else time_of_positions(table)
    if time[-1] < SHORTEST_RUN_S:
        raise RecordingError(
            f"{source}: the rows cover {time[-1]:.3g} s only; is the time in another unit (--unit time=...)?"
        )
    if words := impossible_change_words(table, time):
        raise RecordingError(
            f"{source}: {words}: the recorder was reset, or a unit (--unit time=..., speed=...) is another one."
        )
    table = _with_corrected_speeds(table, time if has_time else None, step, noise, notes)
    gaps = _gaps(table, time, form, notes)
    first, last = _moving_part(table, time, notes)
    clock, part = time, slice(first, last + 1)
    if has_time:
        time = between_samples(time, table.values["speed"])
    values = {quantity: column[part] for quantity, column in table.values.items()}
    brake, covered = values.get("brake"), distance_m(time[part], values["speed"])
    position = None
    if "position" in values:
        position = readable_position(replace(table, values=values, rows=table.rows[part]), covered, notes)
    recording = Recording(
        name=source,
        time_s=frozen_array(time[part] - time[first]),
        speed_ms=frozen_array(values["speed"]),
        clock_s=frozen_array(clock[part] - time[first]),
        position_m=None if position is None else frozen_array(position),
        effort_n=tractive_effort_n(values),
        brake_applied=None if brake is None else brake > 0,
        power_w=values.get("power"),
        energy_j=values.get("energy"),
        supply_current_a=values.get("line_current"),
        line_voltage_v=values.get("line_voltage"),
        speed_step_ms=step,
        speed_noise_ms=noise,
        gap_s=frozen_array(gaps[first:last]),
        notes=tuple(notes),
    )
    _require_same_distance(recording, table)
    return recording


def distance_m(time_s: FloatArray, speed_ms: FloatArray) -> FloatArray:
    """Return the distance that speeds cover since the first sample [m]; shape (n,)."""
    return np.append(0.0, np.cumsum(0.5 * (speed_ms[1:] + speed_ms[:-1]) * np.diff(time_s)))


def between_samples(time_s: FloatArray, speed_ms: FloatArray) -> FloatArray:
    """Return times in which the samples at rest beside a motion are moved to where it begins or ends.

    A train starts between two samples, and to count from the first of them would add half a second to each start and
    stop at 1 Hz: as much as a driver can save. The line through the two speeds beside it meets zero where it starts.

    Parameters
    ----------
    time_s, speed_ms : array of shape (n,)
        Samples.
    """
    moved = np.array(time_s)
    rest = speed_ms == 0
    for sample in np.flatnonzero(rest):
        for way in (1, -1):
            beside, beyond = sample + way, sample + 2 * way
            # a single sample at rest is the stop itself
            lone = 0 <= sample - way < len(rest) and not rest[sample - way]
            if not 0 <= beyond < len(rest) or rest[beside] or rest[beyond] or lone:
                continue
            rise = (speed_ms[beyond] - speed_ms[beside]) / abs(time_s[beyond] - time_s[beside])
            reach = abs(time_s[beside] - time_s[sample])
            if rise > 0 and speed_ms[beside] < rise * reach:
                moved[sample] = time_s[beside] - way * speed_ms[beside] / rise
    return moved


def tractive_effort_n(values: Mapping[str, FloatArray]) -> FloatArray | None:
    """Return the effort with its sign: one column, or driving less braking."""
    if "effort" in values:
        return values["effort"]
    driving, braking = values.get("tractive_effort"), values.get("braking_effort")
    if driving is None:
        return None
    # some write braking as negative numbers
    return driving if braking is None else driving - np.abs(braking)


def _with_corrected_speeds(
    table: Table, time_s: FloatArray | None, step_ms: float, noise_ms: float, notes: list[str]
) -> Table:
    """Return a table whose speeds are whole steps and, where times are known, 0 at standstill."""
    measured = table.values["speed"]
    speed = step_ms * np.round(measured / step_ms) if step_ms > 0 else measured
    if np.any(np.abs(speed - measured) > ROUNDING_MS):
        notes.append(
            f"The speed was rounded twice: all values are multiples of {step_words(step_ms)} within the file's last "
            "decimal, and are read as those."
        )
    speed = np.maximum(speed, 0.0)
    if time_s is not None:
        standing = standing_samples(time_s, speed, noise_ms)
        speed[standing] = 0.0
        changed = (measured != 0) & (speed == 0)
        if np.any(changed):
            largest = float(np.max(np.abs(measured[changed]))) / MS_PER_KMH
            rows = counted(int(changed.sum()), "row")
            if not np.any(speed > 0):
                name = table.columns["speed"].header
                raise RecordingError(
                    f"{table.source}: {name} is at most {largest:.2g} km/h, as at standstill, so there is no run."
                )
            notes.append(f"A speed of up to {largest:.2g} km/h at standstill, in {rows}, is read as 0.")
    return replace(table, values={**table.values, "speed": speed})


def step_words(step_ms: float) -> str:
    """Return a step of speeds in the unit in which it is a round number, else in m/s."""
    for unit, factor in UNITS["speed"].items():
        if abs(float(f"{step_ms / factor:.1g}") * factor / step_ms - 1) < SAME_STEP:
            return f"{step_ms / factor:.1g} {unit}"
    return f"{step_ms:.3g} m/s"


def _require_within(table: Table, quantity: str, lowest: float, largest: float) -> None:
    """Raise RecordingError if a value lies outside bounds; the sentence names 0 as the lower one."""
    values = table.values.get(quantity, np.zeros(0))
    for row in np.flatnonzero(values < lowest)[:1]:
        raise RecordingError(f"{table.source}: {table.shown(quantity, row)} must be at least 0.")
    for row in np.flatnonzero(values > largest)[:1]:
        column = table.columns[quantity]
        bound = f"{largest / column.factor:.5g} {column.unit}" if quantity == "speed" else f"{largest / 1e3:g} kV"
        raise RecordingError(
            f"{table.source}: {table.shown(quantity, row)} must be at most {bound}; is it in another unit (--unit "
            f"{quantity}=...)?"
        )


def _without_repeats(table: Table, notes: list[str]) -> Table:
    """Return a table without rows that say the same place at the same time again."""
    time, position = table.values.get("time"), table.values.get("position")
    if time is None or position is None:
        return table
    # programs that write a run add a row at each signal and station, with times rounded
    resolution = quantisation(time - time[0])
    reach = np.maximum(table.values["speed"][1:], 1.0) * resolution
    repeated = np.append(False, (np.diff(time) == 0) & (np.abs(np.diff(position)) <= reach))
    if not np.any(repeated):
        return table
    count = int(repeated.sum())
    repeat = "repeats the time of the row before and is" if count == 1 else "repeat the time of the row before and are"
    notes.append(f"{counted(count, 'row')} {repeat} left out.")
    return table.at(~repeated)


def time_of_positions(table: Table) -> FloatArray:
    """Return the times of samples over distance, with an even change of speed between two of them.

    Raises
    ------
    RecordingError
        If the train moves on without speed.
    """
    lengths, speed = np.abs(np.diff(table.values["position"])), table.values["speed"]
    both = speed[1:] + speed[:-1]
    for row in np.flatnonzero((both <= 0) & (lengths > 0))[:1]:
        raise RecordingError(
            f"{table.source}: {table.shown('speed', row + 1)} and in the row before, but the position changes: without "
            "a column of time it is not known how long that took."
        )
    steps = np.divide(2 * lengths, both, out=np.zeros(len(both)), where=both > 0)
    return np.append(0.0, np.cumsum(steps))


def missing_s(table: Table, time_s: FloatArray) -> FloatArray:
    """Return for how long samples are missing after each one while the train moves [s]; shape (n - 1,)."""
    steps = np.diff(time_s)
    usual = float(np.median(steps))
    moving = (table.values["speed"][1:] > 0) | (table.values["speed"][:-1] > 0)
    # a recorder may well sleep while the train stands
    return np.where((steps > GAP_STEPS * usual) & moving, steps, 0.0)


def gap_words(table: Table, gaps_s: FloatArray) -> str:
    """Say after which rows samples are missing, as the begin of a sentence; empty if nowhere."""
    if not np.any(gaps_s):
        return ""
    places = ", ".join(f"{gaps_s[row]:.4g} s after row {table.rows[row]}" for row in np.flatnonzero(gaps_s)[:5])
    return f"Samples are missing: {places}{' and others' if np.count_nonzero(gaps_s) > 5 else ''}"


def _gaps(table: Table, time_s: FloatArray, form: RecorderFormat, notes: list[str]) -> FloatArray:
    """Return `missing_s`, 0 without a column of time; RecordingError if it is longer than the user allows."""
    if "time" not in table.values:
        return np.zeros(len(time_s) - 1)
    gaps = missing_s(table, time_s)
    for row in np.flatnonzero(gaps > form.longest_gap_s)[:1]:
        raise RecordingError(
            f"{table.source}: after row {table.rows[row]} samples are missing for {gaps[row]:.4g} s while the train "
            f"moves; at most {form.longest_gap_s:g} s are interpolated (--longest-gap)."
        )
    if words := gap_words(table, gaps):
        notes.append(f"{words}; the speed there is interpolated.")
    return gaps


def _moving_part(table: Table, time_s: FloatArray, notes: list[str]) -> tuple[int, int]:
    """Return the last sample at rest before the run and the first one after it."""
    moving = np.flatnonzero(table.values["speed"] > 0)
    first, last = max(int(moving[0]) - 1, 0), min(int(moving[-1]) + 1, len(time_s) - 1)
    before, after = time_s[first] - time_s[0], time_s[-1] - time_s[last]
    if before > 0 or after > 0:
        notes.append(f"Standing for {before:.4g} s before the run and {after:.4g} s after it does not count.")
    return first, last


def other_distance_words(table: Table, by_speed_m: float, by_position_m: float, share: float = SAME_DISTANCE) -> str:
    """Describe speeds that cover another distance than the positions [m], as the begin of a sentence; else empty."""
    if abs(by_speed_m - by_position_m) <= share * max(by_speed_m, by_position_m):
        return ""
    column = table.columns["speed"]
    return (
        f"{column.header} in {column.unit} covers {by_speed_m:.5g} m, but {table.columns['position'].header} rises by "
        f"{by_position_m:.5g} m; they may differ by at most {100 * share:g} %: one of the units is another one "
        "(--unit), or samples are missing"
    )


def _require_same_distance(recording: Recording, table: Table) -> None:
    """Refuse a speed or a position in a wrong unit."""
    if recording.position_m is None or "time" not in table.values:
        return
    by_speed, by_position = float(recording.covered_m[-1]), float(recording.position_m[-1])
    if words := other_distance_words(table, by_speed, by_position):
        raise RecordingError(f"{recording.name}: {words}.")
