"""A measured run as trajectories: by the scenario's model at the measured speeds, and with what was measured itself."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from railjoule.core.arrays import BoolArray, FloatArray, IntArray, frozen_array
from railjoule.core.energy import Energy
from railjoule.core.errors import RecordingError
from railjoule.core.measured.columns import GENERIC, RecorderFormat
from railjoule.core.measured.line_power import UNIT_FACTOR, with_supply_power
from railjoule.core.measured.place import Placement, part_of_line, place_on_line
from railjoule.core.measured.recording import Recording, distance_m, load_recording, step_words
from railjoule.core.measured.speed import MIN_STEP_MS, smoothed_speed
from railjoule.core.motion import MeshedLine, build_meshed_line
from railjoule.core.motion.cell_step import COAST, exit_speed2
from railjoule.core.physics.mesh_data import cell_at, electric_limit_n, friction_limits_n, tractive_limit_n, train_data
from railjoule.core.scenario import Line, Scenario, Station, Timetable
from railjoule.core.scenario.line import SHORTEST_DISTANCE_M
from railjoule.core.trajectory import MEASURED, Trajectory, drive_by_place, make_trajectory
from railjoule.core.units import J_PER_KWH, MS_PER_KMH, N_PER_KN

NEAR_STATION_M = 60.0
"""A stop at most so far from a station has its name."""
PASSES = 3
"""How often a speed is smoothed: the pull on the train needs smoothed speeds."""
COASTING_SHARE = 0.25
"""A coasting train may leave the smoothed speed by this share of a step."""


@dataclass(frozen=True, eq=False)
class MeasuredRun:
    """A recording on its line: n samples.

    `recording` has the power of a line current. `scenario` is the covered part of the line, in its time, with its stops
    and the speeds at its ends. `modelled` has efforts and energies by the scenario's model at the measured
    speeds; its energy balance closes. `measured` has the measured effort and power where they are known, with the rest
    of its balance as a loss named 'unexplained'; None if neither was measured. `speed_ms` (smoothed and to the line's
    scale) and `position_m` (on the part of the line) have the shape (n,). `contradictions` are sentences on measured
    speeds that need more effort than the scenario's vehicle has; `notes` contain them and all changes on the way.
    """

    recording: Recording
    placement: Placement
    scenario: Scenario
    modelled: Trajectory
    measured: Trajectory | None
    speed_ms: FloatArray
    position_m: FloatArray
    contradictions: tuple[str, ...]
    notes: tuple[str, ...]

    @property
    def trajectory(self) -> Trajectory:
        """The run with what was measured of it, or else by the model."""
        return self.modelled if self.measured is None else self.measured

    @property
    def measured_kwh(self) -> float | None:
        """Energy at the line by the meter, or else by the power over time [kWh]; None where neither is there."""
        recording = self.recording
        if recording.energy_j is not None and not np.any(np.isnan(recording.energy_j[[0, -1]])):
            return float(recording.energy_j[-1] - recording.energy_j[0]) / J_PER_KWH
        power = recording.power_w
        if power is None or np.any(np.isnan(power)):
            return None
        return float(np.sum(0.5 * (power[1:] + power[:-1]) * np.diff(recording.time_s))) / J_PER_KWH

    @property
    def model_error_kwh(self) -> float | None:
        """By how much modelled and measured energy differ [kWh]; None where no energy was measured."""
        measured = self.measured_kwh
        return None if measured is None else abs(self.modelled.energy_kwh - measured)


def load_run(
    path: Path,
    scenario: Scenario,
    form: RecorderFormat = GENERIC,
    start_m: float | None = None,
    sheet: str | None = None,
) -> MeasuredRun:
    """Return the measured run of a recorder's file.

    Raises
    ------
    RailjouleError
        As `railjoule.core.measured.load_recording` and `measured_run`.
    """
    return measured_run(load_recording(path, form, sheet), scenario, start_m)


def measured_run(recording: Recording, scenario: Scenario, start_m: float | None = None) -> MeasuredRun:
    """Return a recording as a run over the line of a scenario.

    Parameters
    ----------
    recording : Recording
        The recording.
    scenario : Scenario
        Vehicle and line.
    start_m : float, optional
        Its begin on the line [m], in running order; by default it is found.

    Raises
    ------
    RecordingError
        If its place cannot be found, or an effort or an energy is none that this train has.
    """
    recording = with_supply_power(recording, scenario.vehicle.line_voltage_v)
    return run_at(recording, scenario, place_on_line(recording, scenario, start_m))


def run_at(recording: Recording, scenario: Scenario, placement: Placement, passes: int = PASSES) -> MeasuredRun:
    """Return a recording as a run over a known part of the line; errors as of `measured_run`.

    Parameters
    ----------
    recording, scenario
        As in `measured_run`.
    placement : Placement
        The part of the line.
    passes : int
        How often the speed is smoothed.
    """
    speed, position = _to_scale(recording, placement, placement.scale * recording.speed_ms)
    raw, step = speed, max(placement.scale * recording.speed_step_ms, MIN_STEP_MS)
    noise = placement.scale * recording.speed_noise_ms
    for _ in range(passes):
        # the pull needs speeds and places, which are better known after each pass
        pull = _pull_ms2(_own_scenario(recording, scenario, placement, speed, position), speed, position)
        smooth, coasts = smoothed_speed(recording.time_s, raw, step, noise, pull)
        speed, position = _to_scale(recording, placement, smooth)
    own = _own_scenario(recording, scenario, placement, speed, position)
    kept, dwell = _nodes(recording, speed)
    mesh = replace(build_meshed_line(own, position_m=position[kept]), dwell_s=dwell)
    node_speed2 = _with_coasting(mesh, speed[kept] ** 2, coasts[kept[:-1]], COASTING_SHARE * step)
    _require_units(recording, mesh)
    beyond = tuple(_beyond(mesh, node_speed2))
    notes = (*recording.notes, placement.how, *_smoothing_notes(recording, placement, smooth - raw), *beyond)
    modelled = make_trajectory(own, mesh, MEASURED, node_speed2, notes=notes)
    measured = _with_measured(modelled, recording, mesh)
    return MeasuredRun(
        recording,
        placement,
        own,
        modelled,
        measured,
        frozen_array(speed),
        frozen_array(position),
        contradictions=beyond,
        notes=modelled.notes,
    )


def _to_scale(recording: Recording, placement: Placement, speed_ms: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return speeds [m/s] that cover just the part of the line, and the places that they reach [m]."""
    covered = distance_m(recording.time_s, speed_ms)
    scale = (placement.end_m - placement.start_m) / float(covered[-1])
    return scale * speed_ms, scale * covered


def _pull_ms2(own: Scenario, speed_ms: FloatArray, position_m: FloatArray) -> FloatArray:
    """Return resistance, gradient and curve between samples over inertia [m/s2]; 0 where the train stands."""
    moves = np.diff(position_m) > 0
    mesh = build_meshed_line(own, position_m=position_m[np.append(True, moves)])
    # a cell begins at the last of the samples at its place, whose speed is that of all of them
    starts, ends = speed_ms[:-1][moves] ** 2, speed_ms[1:][moves] ** 2
    inertia = 2 * mesh.data.half_inertia_kg
    acceleration = 0.5 * (ends - starts) / mesh.data.cell_length_m
    pull = np.zeros(len(moves))
    pull[moves] = mesh.force_between_n(starts, ends) / inertia - acceleration
    return pull


def _with_coasting(mesh: MeshedLine, speed2: FloatArray, coasts: BoolArray, within_ms: float) -> FloatArray:
    """Return squares of speed at the nodes that coast exactly where the train coasts, as far as that stays close."""
    data, exact = mesh.data, np.array(speed2)
    train = train_data(data)
    for cell in np.flatnonzero(coasts).tolist():
        after = exit_speed2(cell_at(data, cell), train, data.traction, data.braking, exact[cell], COAST)
        if after > 0 and speed2[cell + 1] > 0 and abs(np.sqrt(after) - np.sqrt(speed2[cell + 1])) <= within_ms:
            exact[cell + 1] = after
    return exact


def _smoothing_notes(recording: Recording, placement: Placement, change_ms: FloatArray) -> list[str]:
    notes, smoothed = [], f"smoothed by {float(np.sqrt(np.mean(change_ms**2))):.2g} m/s in the mean"
    if recording.speed_noise_ms > 0:
        noise_kmh = recording.speed_noise_ms / MS_PER_KMH
        notes.append(f"The speed has a noise of {noise_kmh:.2g} km/h (standard deviation): {smoothed}.")
    elif recording.speed_step_ms > 0:
        notes.append(
            f"The speed has steps of {step_words(recording.speed_step_ms)}: {smoothed}, by at most half a step."
        )
    if abs(placement.scale - 1) > 1e-4:
        notes.append(
            f"Speeds and distances are multiplied by {placement.scale:.4f}, so that they cover the line's "
            f"{placement.end_m - placement.start_m:.0f} m."
        )
    return notes


def _own_scenario(
    recording: Recording, scenario: Scenario, placement: Placement, speed_ms: FloatArray, position_m: FloatArray
) -> Scenario:
    """Make the scenario of the run: its part of the line, its time, its stops."""
    line = scenario.line.in_running_order()
    length = placement.end_m - placement.start_m
    stops = [
        Station(name=_station_name(line, placement.start_m + place), position_m=place, dwell_s=dwell)
        for place, dwell in _stops(recording, speed_ms, position_m)
        if SHORTEST_DISTANCE_M <= place <= length - SHORTEST_DISTANCE_M
    ]
    timetable = Timetable(
        travel_time_s=recording.duration_s,
        entry_speed_kmh=float(speed_ms[0]) / MS_PER_KMH,
        exit_speed_kmh=float(speed_ms[-1]) / MS_PER_KMH,
    )
    part = part_of_line(line, placement.start_m, placement.end_m, stops)
    return scenario.model_copy(update={"line": part, "timetable": timetable})


def _station_name(line: Line, place_m: float) -> str:
    near = [(abs(station.position_m - place_m), station.name) for station in line.stations]
    return min([one for one in near if one[0] <= NEAR_STATION_M], default=(0.0, ""))[1]


def _stops(recording: Recording, speed_ms: FloatArray, position_m: FloatArray) -> list[tuple[float, float]]:
    """Return places and times of all stands on the way."""
    stands: dict[float, float] = {}
    for cell in np.flatnonzero(_standing(speed_ms)):
        place = float(position_m[cell])
        stands[place] = stands.get(place, 0.0) + float(recording.time_s[cell + 1] - recording.time_s[cell])
    # a single sample at rest is a stop without a dwell
    for sample in np.flatnonzero(speed_ms == 0):
        stands.setdefault(float(position_m[sample]), 0.0)
    return sorted(stands.items())


def _standing(speed_ms: FloatArray) -> BoolArray:
    return np.asarray((speed_ms[1:] == 0) & (speed_ms[:-1] == 0))


def _nodes(recording: Recording, speed_ms: FloatArray) -> tuple[BoolArray, FloatArray]:
    """Return which samples are nodes of a mesh, of a stand the last, and how long the train stands at each node [s]."""
    standing = _standing(speed_ms)
    kept: BoolArray = np.append(~standing, True)
    node = np.cumsum(np.append(0, kept[:-1]))
    steps = np.diff(recording.time_s)
    dwell = np.bincount(node[:-1][standing], weights=steps[standing], minlength=int(kept.sum()))
    return kept, dwell.astype(float)


def _require_units(recording: Recording, mesh: MeshedLine) -> None:
    """Refuse efforts and energies that this train cannot have."""
    data = mesh.data
    largest = max(data.traction.constant_n, data.braking.constant_n + data.friction_effort_n)
    if recording.effort_n is not None:
        reached = float(np.nanmax(np.abs(recording.effort_n), initial=0.0))
        if reached > UNIT_FACTOR * largest:
            raise RecordingError(
                f"{recording.name}: the effort reaches {reached / N_PER_KN:.5g} kN, but the vehicle has at most "
                f"{largest / N_PER_KN:.5g} kN; is it in another unit (--unit effort=...), or another vehicle?"
            )
    if recording.energy_j is not None:
        falls = -np.diff(recording.energy_j)
        # no brake gives back more than its whole effort at the highest speed
        allowed = data.braking.constant_n * float(np.max(recording.speed_ms)) * np.diff(recording.time_s)
        for row in np.flatnonzero(falls > np.maximum(allowed, 0.01 * J_PER_KWH))[:1]:
            raise RecordingError(
                f"{recording.name}: the energy falls by {falls[row] / J_PER_KWH:.4g} kWh at "
                f"{recording.time_s[row + 1]:.4g} s, more than the {allowed[row] / J_PER_KWH:.4g} kWh that the "
                "brakes can give back: the meter was reset."
            )


def _beyond(mesh: MeshedLine, speed2: FloatArray) -> list[str]:
    """Return a sentence if the model's train could not have driven so."""
    force, speed = mesh.net_force_n(speed2), np.sqrt(speed2)
    mean = 0.5 * (speed[1:] + speed[:-1])
    over = force - tractive_limit_n(mesh.data, mean)
    under = -force - electric_limit_n(mesh.data, mean) - friction_limits_n(mesh.data)
    sentences = []
    for excess, what in ((over, "tractive effort"), (under, "braking effort")):
        worst = int(np.argmax(excess))
        # a few per cent are noise of the speed
        if excess[worst] > 0.1 * mesh.data.traction.constant_n:
            sentences.append(
                f"At {mesh.position_m[worst]:.0f} m the measured speed takes {excess[worst] / N_PER_KN:.3g} kN more "
                f"{what} than the scenario's vehicle has."
            )
    return sentences


def _with_measured(modelled: Trajectory, recording: Recording, mesh: MeshedLine) -> Trajectory | None:
    """Return a run with measured efforts and powers in place of the modelled ones, where there are any."""
    if recording.effort_n is None and recording.power_w is None:
        return None
    # a stand of several samples is one cell, without length
    standing = _standing(recording.speed_ms)
    cell = np.cumsum(~standing | ~np.append(False, standing[:-1])) - 1
    effort = _mean_by_cell(recording.effort_n, cell, recording, modelled.effort_n)
    power = _mean_by_cell(recording.power_w, cell, recording, np.full(len(modelled.effort_n), np.nan))
    mean_speed = 0.5 * (modelled.speed_ms[1:] + modelled.speed_ms[:-1])
    effort = np.where(mean_speed > 0, effort, 0.0)
    driven, braked = np.maximum(effort, 0.0), np.maximum(-effort, 0.0)
    friction_limit = np.insert(friction_limits_n(mesh.data), np.flatnonzero(mesh.dwell_s > 0), 0.0)
    electric = np.minimum(braked, modelled.max_braking_n - friction_limit)
    # a recorder of a brake beside the effort leaves open how strong it was: the model fills it in
    unmeasured = 0.0 if recording.brake_applied is None else modelled.friction_braking_n
    friction = np.maximum(braked - electric, unmeasured)
    auxiliary = mesh.data.auxiliary_power_w
    by_drive = drive_by_place(mesh, True).supply_power_w(driven - electric, np.maximum(mean_speed, 1e-9))
    by_model = by_drive * (mean_speed > 0) + auxiliary
    line_power = np.where(np.isnan(power), by_model, power)
    duration = np.diff(modelled.time_s)
    return replace(
        modelled,
        tractive_effort_n=frozen_array(driven),
        electric_braking_n=frozen_array(electric),
        friction_braking_n=frozen_array(friction),
        supply_power_w=frozen_array(line_power),
        supply_energy_j=frozen_array(np.append(0.0, np.cumsum(line_power * duration))),
        current_a=None,
        supply_current_a=None,
        energy=_measured_energy(modelled, mesh, driven, electric, friction, line_power - auxiliary),
    )


def _mean_by_cell(
    samples: FloatArray | None, cell: IntArray, recording: Recording, otherwise: FloatArray
) -> FloatArray:
    """Return means of samples over the cells of a trajectory; what is not known is the other value."""
    if samples is None:
        return otherwise
    count, values = len(otherwise), 0.5 * (samples[1:] + samples[:-1])
    known = ~np.isnan(values)
    steps = np.diff(recording.time_s)[known]
    weights = np.bincount(cell[known], weights=steps, minlength=count)
    sums = np.bincount(cell[known], weights=steps * values[known], minlength=count)
    return np.where(weights > 0, np.divide(sums, weights, out=np.zeros(count), where=weights > 0), otherwise)


def _measured_energy(
    modelled: Trajectory,
    mesh: MeshedLine,
    driven: FloatArray,
    electric: FloatArray,
    friction: FloatArray,
    supply_power_w: FloatArray,
) -> Energy:
    """Return the account of measured efforts and powers; what no model explains is a part of its own."""
    duration, account = np.diff(modelled.time_s), modelled.energy
    mean_speed = 0.5 * (modelled.speed_ms[1:] + modelled.speed_ms[:-1])
    moving = mean_speed > 0
    losses = {
        kind: float(np.where(moving, power, 0.0) @ duration)
        for kind, power in drive_by_place(mesh, True).losses_w(driven - electric, np.maximum(mean_speed, 1e-9)).items()
    }
    losses["friction_brakes"] = float(friction @ np.diff(modelled.position_m))
    traction = float(np.maximum(supply_power_w, 0.0) @ duration)
    recuperated = float(np.maximum(-supply_power_w, 0.0) @ duration)
    known = account.running_resistance_j + account.curve_resistance_j + account.kinetic_j + account.potential_j
    losses["unexplained"] = traction - recuperated - known - sum(losses.values())
    return replace(account, traction_j=traction, recuperated_j=recuperated, losses_j=losses)
