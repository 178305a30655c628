"""A run in the words of a driver: full power, part power, hold, coast, brake, stand."""

from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np

from railjoule.core.arrays import FloatArray

PhaseName = Literal["full_power", "part_power", "hold", "coast", "brake", "stand"]
FULL_POWER, PART_POWER, HOLD, COAST, BRAKE, STAND = range(6)
NAMES: tuple[PhaseName, ...] = ("full_power", "part_power", "hold", "coast", "brake", "stand")

FULL_SHARE = 0.97
"""From this share of the largest effort on, power counts as full."""
NO_EFFORT_SHARE = 0.004
"""Up to this share of the largest effort, the train coasts."""
STEADY_ACCELERATION_MS2 = 0.03
"""Up to this acceleration, a train under power holds its speed."""
STEADY_BRAKING_MS2 = 0.012
"""Up to this deceleration, a braking train holds its speed."""
SHORTEST_SHARE = 0.004
"""A phase shorter than this share of the run belongs to its neighbour."""


@dataclass(frozen=True)
class Phase:
    """A stretch of a run over which the driver does one thing.

    Parameters
    ----------
    phase : str
        What the driver does.
    start_m, end_m, start_s, end_s, start_ms, end_ms : float
        Place [m], time [s] and speed [m/s] at its ends.
    energy_j : float
        Line energy, auxiliaries included [J].
    """

    phase: PhaseName
    start_m: float
    end_m: float
    start_s: float
    end_s: float
    start_ms: float
    end_ms: float
    energy_j: float


def find_phases(
    position_m: FloatArray,
    time_s: FloatArray,
    speed_ms: FloatArray,
    effort_n: FloatArray,
    largest_effort_n: FloatArray,
    line_energy_j: FloatArray,
) -> tuple[Phase, ...]:
    """Return the phases of a run.

    Parameters
    ----------
    position_m, time_s, speed_ms, line_energy_j : array of shape (n + 1,)
        Place [m], time [s], speed [m/s] and line energy so far [J] at the nodes.
    effort_n, largest_effort_n : array of shape (n,)
        Effort of each cell, braking negative, and the largest tractive effort at its speed [N].
    """
    labels = _label(np.diff(position_m), np.diff(time_s), speed_ms, effort_n, largest_effort_n)
    borders = [0, *(np.flatnonzero(np.diff(labels)) + 1), len(labels)]
    segments = [[int(labels[a]), a, b] for a, b in pairwise(borders)]
    shortest = SHORTEST_SHARE * float(position_m[-1] - position_m[0])
    return tuple(
        Phase(
            NAMES[label],
            float(position_m[a]),
            float(position_m[b]),
            float(time_s[a]),
            float(time_s[b]),
            float(speed_ms[a]),
            float(speed_ms[b]),
            float(line_energy_j[b] - line_energy_j[a]),
        )
        for label, a, b in _without_short(segments, position_m, shortest)
    )


def _label(
    length_m: FloatArray, duration_s: FloatArray, speed_ms: FloatArray, effort_n: FloatArray, largest_n: FloatArray
) -> FloatArray:
    acceleration = np.abs(np.diff(speed_ms)) / duration_s
    idle = NO_EFFORT_SHARE * np.max(largest_n)
    labels = np.where(acceleration < STEADY_ACCELERATION_MS2, HOLD, PART_POWER)
    labels = np.where(effort_n > FULL_SHARE * largest_n, FULL_POWER, labels)
    braking = np.where(acceleration < STEADY_BRAKING_MS2, HOLD, BRAKE)
    labels = np.where(effort_n < 0, braking, labels)
    labels = np.where(np.abs(effort_n) <= idle, COAST, labels)
    return np.where(length_m <= 0, STAND, labels)


def _without_short(segments: list[list[int]], position_m: FloatArray, shortest_m: float) -> list[list[int]]:
    """Give segments that are too short to their longer neighbour, shortest first; standing stays."""
    segments = [list(segment) for segment in segments]

    def length(index: int) -> float:
        return float(position_m[segments[index][2]] - position_m[segments[index][1]])

    def passing(index: int) -> bool:
        """Tell a cell within which the effort changes from a phase of its own."""
        label, first, last = segments[index]
        return label == PART_POWER and last - first == 1

    while True:
        short = [k for k in range(len(segments)) if segments[k][0] != STAND and (length(k) < shortest_m or passing(k))]
        neighbours = {
            k: [j for j in (k - 1, k + 1) if 0 <= j < len(segments) and segments[j][0] != STAND] for k in short
        }
        short = [k for k in short if neighbours[k]]
        if not short:
            return segments
        k = min(short, key=length)
        j = max(neighbours[k], key=length)
        segments[j][1], segments[j][2] = min(segments[j][1], segments[k][1]), max(segments[j][2], segments[k][2])
        del segments[k]
        segments = _joined(segments)


def _joined(segments: list[list[int]]) -> list[list[int]]:
    joined: list[list[int]] = []
    for segment in segments:
        if joined and joined[-1][0] == segment[0]:
            joined[-1][2] = segment[2]
        else:
            joined.append(segment)
    return joined
