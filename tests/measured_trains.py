"""Recordings of random trains by a simulator of its own, with the calibration errors that real gauges have.

It shares no code with the solvers: explicit midpoint steps of 10 ms over time, all runs side by side. A train differs
from that of `liashenko-ii` in resistance, rotating mass, efficiency and auxiliaries. Its driver pulls, coasts and
brakes to a stop at the line's end, each run at other levels. The recorder writes at 1 Hz, in steps of 0.1 m/s, with 1 %
of noise on effort and power.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from railjoule.core import Scenario, load_scenario
from railjoule.core.arrays import FloatArray
from railjoule.core.identification.parameters import AUXILIARY, EFFICIENCY, MASS_FACTOR, RESISTANCE
from railjoule.core.measured import MeasuredRun, measured_run, read_recording

SCENARIO = "liashenko-ii"
STEP_S, LONGEST_S = 0.01, 200.0
RUNS = 4
"""Of each train."""
GUST_S, ERROR_S = 10.0, 5.0
"""Times over which gusts and correlated errors of the effort are forgotten."""
GRAVITY_MS2 = 9.80665
LARGEST_EFFORT_N, LARGEST_POWER_W = 285e3, 2.9e6
"""Of the driven wheels."""


@dataclass(frozen=True)
class Errors:
    """Errors of measurement and what else the model of a train does not know.

    Parameters
    ----------
    effort_gain, power_gain : float
        Standard deviations of a factor on all readings of a train.
    speed_gain : float
        By which share all speeds are too high.
    effort_offset_n, power_offset_w : float
        Added to all readings; to those of the effort only where they are not zero.
    are_offsets_random : bool
        Whether these two are standard deviations over the trains.
    effort_noise, power_noise : float
        Independent, as a share of the reading.
    slow_effort_noise : float
        The same, correlated over `ERROR_S`.
    gust_ms : float
        Standard deviation of a wind along the line, correlated over `GUST_S` [m/s].
    gaps : int
        Stretches of 2 to 6 s without samples in each run.
    """

    effort_gain: float = 0.0
    power_gain: float = 0.0
    speed_gain: float = 0.0
    effort_offset_n: float = 0.0
    power_offset_w: float = 0.0
    are_offsets_random: bool = False
    effort_noise: float = 0.01
    power_noise: float = 0.01
    slow_effort_noise: float = 0.0
    gust_ms: float = 0.0
    gaps: int = 0


REVIEW_CASES: Mapping[str, Errors] = {
    "clean, gain 0.5 %": Errors(effort_gain=0.005),
    "gaps of 2 to 6 s": Errors(effort_gain=0.005, gaps=3),
    "speeds 1 % too high": Errors(effort_gain=0.005, speed_gain=0.01),
    "effort gauge 2 % off": Errors(effort_gain=0.02),
    "effort offset 2 kN": Errors(effort_gain=0.005, effort_offset_n=2e3),
    "gusts of 5 m/s": Errors(effort_gain=0.005, gust_ms=5.0),
    "correlated effort noise 3 %": Errors(effort_gain=0.005, effort_noise=0.0, slow_effort_noise=0.03),
    "power offset 10 kW": Errors(effort_gain=0.005, power_offset_w=10e3),
}
"""Those of the third review (24 November 2026), section 3."""
CASES: Mapping[str, Errors] = {
    **REVIEW_CASES,
    # 0.7 % of 235 kN and 0.2 % of 3.3 MW
    "all gauges as assumed": Errors(0.02, 0.01, effort_offset_n=1.65e3, power_offset_w=6.6e3, are_offsets_random=True),
}
"""And one of trains whose gauges are off by what `GaugeErrors` assumes."""


@dataclass(frozen=True, eq=False)
class MeasuredTrain:
    """A train and its recorded runs: the true parameters by their names, and each run as a text in CSV."""

    truth: Mapping[str, float]
    texts: tuple[str, ...]

    def runs(self, scenario: Scenario) -> list[MeasuredRun]:
        """Return the runs on the line of a scenario."""
        return [measured_run(read_recording(text, f"run {i}"), scenario) for i, text in enumerate(self.texts)]


def measured_trains(errors: Errors, trains: int, seed: int = 0) -> list[MeasuredTrain]:
    """Return random trains, each with `RUNS` recorded runs."""
    random = np.random.default_rng(seed)
    truths = [_random_train(random) for _ in range(trains)]
    motion = _drive(truths, errors.gust_ms, random)
    recorded = []
    for train, truth in enumerate(truths):
        gains = 1 + np.array([errors.effort_gain, errors.power_gain]) * random.standard_normal(2)
        offsets = np.array([errors.effort_offset_n, errors.power_offset_w])
        if errors.are_offsets_random:
            offsets = offsets * random.standard_normal(2)
        texts = [_record(motion, RUNS * train + run, errors, gains, offsets, random) for run in range(RUNS)]
        recorded.append(MeasuredTrain(truth, tuple(texts)))
    return recorded


def _random_train(random: np.random.Generator) -> dict[str, float]:
    return {
        RESISTANCE[0]: 2287 * random.uniform(0.7, 1.5),
        # the linear term of one train in four is zero, the end of its range
        RESISTANCE[1]: max(random.uniform(-8, 25), 0.0),
        RESISTANCE[2]: 1.746 * random.uniform(0.7, 1.2),
        MASS_FACTOR: random.uniform(0.07, 0.15),
        EFFICIENCY: random.uniform(0.78, 0.9),
        AUXILIARY: random.uniform(20, 80),
    }


@dataclass(frozen=True, eq=False)
class _Motion:
    """Speed [m/s], effort at the wheels [N] and power from the supply [W] of runs; shape (steps, runs)."""

    speed_ms: FloatArray
    effort_n: FloatArray
    power_w: FloatArray


def _drive(truths: list[dict[str, float]], gust_ms: float, random: np.random.Generator) -> _Motion:
    """Return the motion of all runs of all trains."""
    scenario = load_scenario(SCENARIO)
    ends = np.cumsum([section.length_m for section in scenario.line.sections])
    gradients = np.array([section.gradient_permille for section in scenario.line.sections]) / 1e3
    mass, length = scenario.vehicle.total_mass_kg, ends[-1]
    constant, linear, quadratic, factor, efficiency, auxiliary = (
        np.repeat([truth[name] for truth in truths], RUNS) for name in (*RESISTANCE, MASS_FACTOR, EFFICIENCY, AUXILIARY)
    )
    inertia, count = (1 + factor) * mass, RUNS * len(truths)
    level, top_ms, rate = random.uniform(0.6, 1, count), random.uniform(13, 20, count), random.uniform(0.6, 0.95, count)
    keep = np.exp(-STEP_S / GUST_S)
    wind = gust_ms * random.standard_normal(count)

    def against(place: FloatArray, speed: FloatArray) -> FloatArray:
        section = np.minimum(np.searchsorted(ends, place, side="right"), len(ends) - 1)
        kmh, air_kmh = 3.6 * speed, 3.6 * (speed + wind)
        air = quadratic * air_kmh * np.abs(air_kmh)
        return constant + linear * kmh + air + mass * GRAVITY_MS2 * gradients[section]

    steps = int(LONGEST_S / STEP_S)
    speeds, efforts = np.zeros((steps, count)), np.zeros((steps, count))
    place, speed = np.zeros(count), np.zeros(count)
    pulls, brakes, stopped = np.ones(count, dtype=bool), np.zeros(count, dtype=bool), np.zeros(count, dtype=bool)
    for step in range(1, steps):
        left = np.maximum(length - place, 0.05)
        pulls = (pulls & (speed < top_ms)) | (~brakes & (speed < 0.6 * top_ms))
        brakes |= speed**2 / (2 * left) > rate
        resistance = against(place, speed)
        pull = level * np.minimum(LARGEST_EFFORT_N, LARGEST_POWER_W / np.maximum(speed, 0.1))
        brake = np.minimum(-inertia * speed**2 / (2 * left) - resistance, 0.0)
        effort = np.where(brakes, brake, np.where(pulls, pull, 0.0))
        half = np.maximum(speed + 0.5 * STEP_S * (effort - resistance) / inertia, 0.0)
        change = (effort - against(place + 0.5 * STEP_S * speed, half)) / inertia
        after = np.maximum(speed + STEP_S * change, 0.0)
        # a train that has all but stopped stands
        stopped |= brakes & ((after < 0.01) | (place >= length - 0.005))
        after, effort = np.where(stopped, 0.0, after), np.where(stopped, 0.0, effort)
        place, speed = place + 0.5 * STEP_S * (speed + after), after
        speeds[step], efforts[step] = speed, effort
        if np.all(stopped):
            break
        wind = keep * wind + gust_ms * np.sqrt(1 - keep**2) * random.standard_normal(count)
    assert np.all(stopped)
    return _Motion(speeds, efforts, np.maximum(efforts, 0.0) * speeds / efficiency + 1e3 * auxiliary)


def _record(
    motion: _Motion, run: int, errors: Errors, gains: FloatArray, offsets: FloatArray, random: np.random.Generator
) -> str:
    """Return the readings of a run as a text in CSV, from a second before the start to two after the stop."""
    moving = np.flatnonzero(motion.speed_ms[:, run] > 0)
    every = round(1 / STEP_S)
    rows = np.arange(moving[0] - int(random.integers(1, every)), moving[-1] + 2 * every, every)
    rows = np.maximum(rows, 0)
    time = np.arange(len(rows), dtype=float)
    effort, power = motion.effort_n[rows, run], motion.power_w[rows, run]
    white = random.standard_normal((2, len(rows)))
    slow = _correlated(len(rows), np.exp(-1 / ERROR_S), random)
    effort = effort * gains[0] * (1 + errors.effort_noise * white[0] + errors.slow_effort_noise * slow)
    effort = np.where(effort != 0, effort + offsets[0], 0.0)
    power = power * gains[1] * (1 + errors.power_noise * white[1]) + offsets[1]
    speed = np.round((1 + errors.speed_gain) * motion.speed_ms[rows, run], 1)
    kept = np.ones(len(rows), dtype=bool)
    for part in range(errors.gaps):
        # each in a part of its own: two in a row would be longer than a recording may have
        first = int((part + random.uniform(0.1, 0.7)) * len(rows) / errors.gaps)
        kept[first : first + int(random.integers(2, 7))] = False
    table = zip(time[kept], speed[kept], effort[kept] / 1e3, power[kept] / 1e3, strict=True)
    lines = [f"{t:.3f},{v:.2f},{f:.2f},{p:.1f}" for t, v, f, p in table]
    return "\n".join(["time_s,speed_ms,effort_kn,power_kw", *lines]) + "\n"


def _correlated(count: int, keep: float, random: np.random.Generator) -> FloatArray:
    """Return values of variance 1, each with the correlation `keep` with the one before it."""
    drawn = random.standard_normal(count)
    values = np.empty(count)
    values[0] = drawn[0]
    for i in range(1, count):
        values[i] = keep * values[i - 1] + np.sqrt(1 - keep**2) * drawn[i]
    return values
