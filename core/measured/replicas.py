"""Replicas of a recording: the same speeds with other errors of the same size, which show how far they move an energy.

A speed that is known is recorded again: with noise of the estimated deviation, in the steps of the recorder at another
phase, and at other moments between its samples, as no recorder sees when an effort changes. Each replica is smoothed by
its own estimate of the noise.
"""

from contextlib import suppress
from dataclasses import replace

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.errors import RailjouleError
from railjoule.core.measured.place import Placement
from railjoule.core.measured.recording import Recording, between_samples
from railjoule.core.measured.run import MeasuredRun, run_at
from railjoule.core.measured.smoothing import LEAST_STEP_MS, SLOWEST_SHARE
from railjoule.core.measured.speed_error import noise_deviation

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
    step = max(recording.speed_step_ms, LEAST_STEP_MS)
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
