"""The part of measured runs that a fit can use: steps between two samples of which the effort is known."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from railjoule.core.arrays import BoolArray, FloatArray
from railjoule.core.errors import RecordingError
from railjoule.core.measured import MeasuredRun, Recording
from railjoule.core.measured.speed import quantisation, true_runs
from railjoule.core.motion import build_meshed_line
from railjoule.core.scenario import Line, Scenario

FEWEST_STEPS = 20
"""Fewer samples of known effort hold no parameters."""
# power over speed is an effort only where both are well known
SLOWEST_BY_POWER_MS = 3.0
"""Below this no effort is taken from a power [m/s]."""
SAME_PLACE_M = 0.01
"""Places closer together are one [m]: a run that ends in a station has just its place."""
SHORTEST_SECTION = 5
"""Steps that a section has at least: a shorter one shows no change of speed beyond the steps of the recorder."""


@dataclass(frozen=True, eq=False)
class Steps:
    """n steps of one or more runs, section after section.

    Parameters
    ----------
    step_s : array of shape (n,)
        Their times [s].
    start_speed_ms, end_speed_ms : array of shape (n,)
        Measured speeds, not smoothed [m/s].
    begins : array of bool of shape (n,)
        Start of a section.
    effort_n : array of shape (n,)
        Mean effort at the wheels [N]; NaN where it is to follow from the power.
    pulled_share : array of shape (n,)
        Share of each step with an effort that is not zero.
    end_effort_n, effort_jump_n : array of shape (n,)
        Effort at the sample that ends the step, and by how much it jumps within it [N].
    line_force_n : array of shape (n,)
        Gradient and curve at the scenario's mass [N].
    tunnel_factor : array of shape (n,)
        Factor on the quadratic resistance.
    power_w : array of shape (n,)
        Mean power taken from the line [W]; NaN where it is not known.
    read_power_w, read_effort_n, read_speed_ms : array of shape (n,)
        Power, effort and speed to compare: of the sample that ends the step, or means where a meter counts energy.
    read_variance : array of shape (n,)
        Of that power, by the steps of the meter [W2].
    speed_variance : array of shape (n,)
        Of the steps of the recorder's speed [m2/s2].
    is_between_stations : array of bool of shape (n,)
        Whether the run begins and ends at rest in a station, so that the line gives the scale of its speeds.
    max_effort_n, max_power_w : array of shape (n,)
        Largest magnitudes of the run's readings [N, W]; 0 where there are none.
    """

    step_s: FloatArray
    start_speed_ms: FloatArray
    end_speed_ms: FloatArray
    begins: BoolArray
    effort_n: FloatArray
    pulled_share: FloatArray
    end_effort_n: FloatArray
    effort_jump_n: FloatArray
    line_force_n: FloatArray
    tunnel_factor: FloatArray
    power_w: FloatArray
    read_power_w: FloatArray
    read_effort_n: FloatArray
    read_speed_ms: FloatArray
    read_variance: FloatArray
    speed_variance: FloatArray
    is_between_stations: BoolArray
    max_effort_n: FloatArray
    max_power_w: FloatArray

    @property
    def mean_speed_ms(self) -> FloatArray:
        """Mean of the measured speeds of each step [m/s]."""
        return 0.5 * (self.start_speed_ms + self.end_speed_ms)

    @property
    def count(self) -> int:
        """Number of steps."""
        return len(self.step_s)


def usable_steps(runs: Sequence[MeasuredRun], scenario: Scenario, coasting_only: bool = False) -> Steps:
    """Return the steps of measured runs whose effort is known.

    Parameters
    ----------
    runs : sequence of MeasuredRun
        The runs, over one line and with one vehicle.
    scenario : Scenario
        The line and the vehicle.
    coasting_only : bool
        Whether only steps without any effort count, for recorders whose efforts are not to be trusted.

    Raises
    ------
    RecordingError
        If a run has no efforts, or all runs too few usable steps.
    """
    line = scenario.line.in_running_order()
    parts = [_build_steps(run, line, coasting_only) for run in runs]
    columns = {name: np.concatenate([getattr(part, name) for part in parts]) for name in Steps.__dataclass_fields__}
    steps = Steps(**columns)
    if steps.count < FEWEST_STEPS:
        names = ", ".join(run.recording.name for run in runs)
        raise RecordingError(
            f"{names}: {steps.count} samples have a known effort while the train moves, but a fit needs at least "
            f"{FEWEST_STEPS}."
        )
    return steps


def _build_steps(run: MeasuredRun, line: Line, coasting_only: bool) -> Steps:
    recording = run.recording
    by_power = recording.effort_n is None
    if by_power and (recording.power_w is None or recording.brake_applied is None):
        raise RecordingError(
            f"{recording.name}: a fit needs a column of the effort, or of power and of the brake; the speed only "
            "does not tell what drove the train."
        )
    speed = run.placement.scale * recording.speed_ms
    known = (speed[1:] > 0) & (speed[:-1] > 0) & (recording.gap_s == 0)
    if recording.brake_applied is not None:
        known &= ~(recording.brake_applied[1:] | recording.brake_applied[:-1])
    effort = np.full(len(speed), np.nan) if recording.effort_n is None else recording.effort_n
    power = _mean_power(recording)
    read = _read(recording, effort, speed, power)
    if by_power:
        known &= ~np.isnan(power) & (0.5 * (speed[1:] + speed[:-1]) > SLOWEST_BY_POWER_MS)
    else:
        known &= ~np.isnan(effort[1:] + effort[:-1])
    if coasting_only:
        known &= (effort[1:] == 0) & (effort[:-1] == 0)
    for first, beyond in true_runs(known):
        known[first:beyond] = beyond - first >= SHORTEST_SECTION
    moves = np.diff(run.position_m) > 0
    line_force, tunnel = np.zeros(len(known)), np.ones(len(known))
    # stands are steps without length, of which no cell can be made
    mesh = build_meshed_line(run.scenario, position_m=run.position_m[np.append(moves, True)])
    line_force[moves], tunnel[moves] = mesh.gradient_force_n + mesh.curve_force_n, mesh.tunnel_factor
    step = run.placement.scale * recording.speed_step_ms
    pulled = np.nan_to_num(effort) != 0
    count = int(known.sum())
    return Steps(
        step_s=np.diff(recording.time_s)[known],
        start_speed_ms=speed[:-1][known],
        end_speed_ms=speed[1:][known],
        begins=(known & ~np.append(False, known[:-1]))[known],
        effort_n=_mean_effort(recording.time_s, effort)[known],
        pulled_share=0.5 * (pulled[1:] + 1.0 * pulled[:-1])[known],
        end_effort_n=effort[1:][known],
        effort_jump_n=_jumps(effort)[known],
        line_force_n=line_force[known],
        tunnel_factor=tunnel[known],
        power_w=power[known],
        read_power_w=read[0][known],
        read_effort_n=read[1][known],
        read_speed_ms=read[2][known],
        read_variance=read[3][known],
        # an error spread evenly over a step of q has the variance q^2 / 12
        speed_variance=np.full(count, step**2 / 12),
        is_between_stations=np.full(count, _is_between_stations(run, line)),
        max_effort_n=np.full(count, _largest(effort)),
        max_power_w=np.full(count, _largest(power)),
    )


def _largest(values: FloatArray) -> float:
    return float(np.max(np.abs(np.nan_to_num(values)), initial=0.0))


def _is_between_stations(run: MeasuredRun, line: Line) -> bool:
    """Return whether a run begins and ends at rest in a station or at an end of a line."""
    speed, placement = run.recording.speed_ms, run.placement
    stations = np.array([0.0, *(station.position_m for station in line.stations), line.length_m])
    ends = np.array([placement.start_m, placement.end_m])
    away = np.abs(stations - ends[:, None]).min(axis=1)
    return bool(speed[0] == speed[-1] == 0 and np.all(away < SAME_PLACE_M))


def _jumps(effort_n: FloatArray) -> FloatArray:
    """Return the change of effort in each step beyond that of its neighbours [N], which no curve explains."""
    change = np.nan_to_num(np.diff(effort_n))
    beside = 0.5 * (np.append(change[1:], change[-1]) + np.append(change[0], change[:-1]))
    return np.asarray(np.minimum(np.abs(change), np.abs(change - beside)))


def _mean_effort(time_s: FloatArray, effort_n: FloatArray) -> FloatArray:
    """Return mean efforts between samples [N] of a curve through them; NaN where they are not known.

    A limit of power bends the effort: the trapezoidal rule takes it for 0.1 % too large, which is 2 or 3 % of the
    running resistance. The curve does not overshoot where the effort jumps.
    """
    known = ~np.isnan(effort_n)
    if known.sum() < 2:
        return np.full(len(time_s) - 1, np.nan)
    curve = scipy.interpolate.PchipInterpolator(time_s[known], effort_n[known]).antiderivative()
    means: FloatArray = np.diff(curve(time_s)) / np.diff(time_s)
    return np.where(known[1:] & known[:-1], means, np.nan)


def _mean_power(recording: Recording) -> FloatArray:
    """Return mean powers between samples [W]; NaN where they are not known."""
    steps = np.diff(recording.time_s)
    if recording.power_w is not None:
        return 0.5 * (recording.power_w[1:] + recording.power_w[:-1])
    if recording.energy_j is None:
        return np.full(len(steps), np.nan)
    return np.diff(recording.energy_j) / steps


def _read(
    recording: Recording, effort_n: FloatArray, speed_ms: FloatArray, power_w: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return power, effort and speed to compare, and the variance of the power."""
    if recording.power_w is not None:
        # of one sample each: means of two would share the errors of a sample with their neighbours
        return recording.power_w[1:], effort_n[1:], speed_ms[1:], np.zeros(len(power_w))
    # The readings at both ends of a step are off by up to half a step of the meter; twice, as means share the errors of
    # the effort with their neighbours, which would else count as independent.
    step = 0.0 if recording.energy_j is None else quantisation(recording.energy_j)
    variance = 2 * step**2 / 6 / np.diff(recording.time_s) ** 2
    return power_w, 0.5 * (effort_n[1:] + effort_n[:-1]), 0.5 * (speed_ms[1:] + speed_ms[:-1]), variance
