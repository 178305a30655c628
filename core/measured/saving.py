"""The potential saving of a measured run: its energy beside the optimum for the same time and the same stops.

Errors of the recorder become energy: noise and steps of the speed are accelerations that the train never had. Their
share of the saving is found from replicas of the run, and from replicas of the optimum, which has nothing to save. The
model's own error is the difference between modelled and measured energy, where that was measured.

A replica records a known speed again: with noise of the estimated deviation, in the steps of the recorder at another
phase, and at other moments between its samples, as no recorder sees when an effort changes. Each replica is smoothed by
its own estimate of the noise.
"""

from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np
import scipy

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.errors import InfeasibleLineError, RailjouleError, RecordingError, TimetableError
from railjoule.core.measured.place import Placement
from railjoule.core.measured.recording import Recording, between_samples
from railjoule.core.measured.run import MeasuredRun, run_at
from railjoule.core.measured.speed import MIN_STEP_MS, SLOWEST_SHARE, noise_deviation
from railjoule.core.strategies import solve
from railjoule.core.trajectory import Trajectory
from railjoule.core.units import J_PER_KWH

REPLICAS, FEWEST_REPLICAS = 8, 4
"""Of the run, and as many of the optimum; fewer give no reliable spread."""
CONFIDENCE = 0.95
MODEL_DEVIATIONS = 2.0
"""The one error of the model that is seen counts as its standard deviation; 95 % lie within two of them."""
SEED = 1


@dataclass(frozen=True, eq=False)
class Saving:
    """A measured run beside the optimum over the same part of the line, with its stops, dwells, time and end speeds.

    `speed_error_kwh` is how far the saving may lie below and above `possible_kwh` for errors of the recorder's speed,
    both positive; infinite if they cannot be estimated.
    """

    run: MeasuredRun
    optimum: Trajectory
    speed_error_kwh: tuple[float, float]

    @property
    def possible_kwh(self) -> float:
        """Energy of the modelled run less that of the optimum [kWh], both by the same model.

        A run at the optimum may come out a per cent below it: between two samples it may have done what cost more.
        """
        return self.run.modelled.energy_kwh - self.optimum.energy_kwh

    @property
    def at_most_kwh(self) -> float | None:
        """Upper bound for any run in this time: the modelled run less the lower bound [kWh]."""
        bound = self.optimum.lower_bound_kwh
        return None if bound is None else self.run.modelled.energy_kwh - bound

    @property
    def interval_kwh(self) -> tuple[float, float]:
        """Between which energies the potential saving lies by the errors of speed and model [kWh]."""
        model, (below, above) = MODEL_DEVIATIONS * (self.run.model_error_kwh or 0.0), self.speed_error_kwh
        return self.possible_kwh - below - model, self.possible_kwh + above + model

    @property
    def is_certain(self) -> bool:
        """Whether the errors of speed and model do not explain all of it.

        A model that cannot drive the run has an error; where no energy was measured, its size is not known.
        """
        is_model_open = self.run.model_error_kwh is None and bool(self.run.contradictions)
        return self.interval_kwh[0] > 0 and not is_model_open

    @property
    def doubt(self) -> str:
        """Why no saving can be stated, in a sentence; empty where one can."""
        if self.is_certain:
            return ""
        saved, below, model = self.possible_kwh, self.speed_error_kwh[0], self.run.model_error_kwh
        start = f"No saving can be stated: the optimum needs {saved:.3g} kWh less than the modelled run, but "
        if saved <= 0:
            return "No saving can be stated: by its samples, the run is as good as the optimum."
        if not np.isfinite(below):
            return start + "the errors of the speed are too large for the model."
        if saved <= below:
            return start + f"the steps and the noise of the speed explain up to {below:.2g} kWh."
        if model is None:
            return start + (
                "its speed takes more effort than the scenario's vehicle has, and no measured energy shows the error "
                "of the model: check vehicle, line and place."
            )
        of_speed = (
            f", and the steps and the noise of the speed explain up to {below:.2g} kWh"
            if saved > MODEL_DEVIATIONS * model
            else ""
        )
        return start + f"the model is {model:.3g} kWh off the measured energy{of_speed}: fit the train first."


def possible_saving(run: MeasuredRun) -> Saving:
    """Compute the potential saving of a measured run.

    Raises
    ------
    RecordingError
        If the scenario's train cannot keep the measured time: then it is another train, or its limits are others.
    RailjouleError
        As `railjoule.core.solve`.
    """
    try:
        optimum = solve(run.scenario, "optimal")
    except TimetableError as error:
        raise RecordingError(
            f"{run.recording.name}: the run takes {error.travel_time_s:.4g} s without its stops, but the scenario's "
            f"train needs at least {error.shortest_time_s:.4g} s: its efforts or the line's limits are not those "
            "of this run."
        ) from None
    except InfeasibleLineError as error:
        raise RecordingError(f"{run.recording.name}: the scenario's train cannot drive this run. {error}") from None
    return Saving(run, optimum, _speed_error_kwh(run, optimum))


def _speed_error_kwh(run: MeasuredRun, optimum: Trajectory) -> tuple[float, float]:
    """Return how far below and above its value the saving may lie for the errors of the speed [kWh]."""
    random = np.random.default_rng(SEED)
    # per second that a replica takes longer, the optimum needs less
    price = (optimum.price_of_time_w or 0.0) / J_PER_KWH
    time = run.recording.duration_s
    biases, spreads = [], []
    for times, speeds, energy in (
        (run.recording.time_s, run.speed_ms, run.modelled.energy_kwh),
        (optimum.time_s, optimum.speed_ms, optimum.energy_kwh),
    ):
        again = replicas(run, times, speeds, REPLICAS, random)
        if len(again) < FEWEST_REPLICAS:
            return np.inf, np.inf
        errors = [one.modelled.energy_kwh - energy + price * (one.recording.duration_s - time) for one in again]
        biases.append(float(np.mean(errors)))
        quantile = float(scipy.stats.t.ppf(0.5 + 0.5 * CONFIDENCE, len(errors) - 1))
        spreads.append(quantile * float(np.std(errors, ddof=1)) * (1 + 1 / len(errors)) ** 0.5)
    return max(spreads) + max(*biases, 0.0), max(spreads) - min(*biases, 0.0)


MOMENTS = (0.1, 0.9)
"""Of the time between two samples: a replica's sample lies beyond one and before the next."""


def replicas(
    run: MeasuredRun, time_s: FloatArray, speed_ms: FloatArray, count: int, random: np.random.Generator
) -> list[MeasuredRun]:
    """Return replicas of a recording whose speeds are known; fewer where the model cannot drive one.

    Parameters
    ----------
    run : MeasuredRun
        Its recorder and its part of the line are those of the replicas.
    time_s, speed_ms : array of shape (m,)
        The speed over the time of the run.
    count : int
    random : numpy.random.Generator
        Source of the errors.
    """
    length = run.scenario.line.length_m
    part = Placement(0.0, length, run.placement.scale, length, run.placement.how)
    found = []
    for _ in range(count):
        # an effort that is beyond the map of a drive is the noise of one replica
        with suppress(RailjouleError):
            found.append(run_at(_recorded_again(run, time_s, speed_ms, random), run.scenario, part, passes=1))
    return found


def _recorded_again(
    run: MeasuredRun, time_s: FloatArray, speed_ms: FloatArray, random: np.random.Generator
) -> Recording:
    recording = run.recording
    step = max(recording.speed_step_ms, MIN_STEP_MS)
    clock = recording.clock_s
    # both ends stay: beyond them the speed is not known
    time = np.concatenate([clock[:1], clock[:-1] + random.uniform(*MOMENTS) * np.diff(clock), clock[-1:]])
    true = np.interp(time, time_s, speed_ms / run.placement.scale)
    speed = true + recording.speed_noise_ms * random.standard_normal(len(time))
    phase = step * random.random()
    speed = step * np.round((speed + phase) / step) - phase
    speed = np.where(true > 0, np.maximum(speed, SLOWEST_SHARE * step), 0.0)
    moving = np.flatnonzero(speed > 0)
    part = slice(max(int(moving[0]) - 1, 0), int(moving[-1]) + 2)
    speed, time = speed[part], between_samples(time[part], speed[part])
    return replace(
        recording,
        time_s=frozen_array(time - time[0]),
        speed_ms=frozen_array(speed),
        clock_s=frozen_array(time - time[0]),
        gap_s=frozen_array(np.zeros(len(time) - 1)),
        speed_noise_ms=noise_deviation(speed, recording.speed_step_ms),
        position_m=None,
        effort_n=None,
        brake_applied=None,
        power_w=None,
        energy_j=None,
    )
