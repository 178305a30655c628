"""Runs for tests of phases and advice, put together by hand from pieces."""

import numpy as np

from railjoule.core.arrays import frozen_array
from railjoule.core.phases import RunData

LARGEST_N = 100e3
INERTIA_KG = 100e3
# a kernel is compiled anew for each kind of array: these are the kinds that a trajectory gives
FROZEN = ("position_m", "time_s", "speed_ms", "max_effort_n", "max_braking_n")


def run_of(*pieces, start_ms=10.0, limit_ms=np.inf, cell_m=10.0, **fields):
    """Return a run of pieces (length [m], speed at the end [m/s], effort share), each cut into cells.

    The square of speed is linear in each piece; a piece without length is a stand of 30 s. The line takes what the
    effort gives, and nothing comes back.
    """
    position, speed, effort, duration = [0.0], [start_ms], [], []
    for length, end_ms, share in pieces:
        count = max(round(length / cell_m), 1)
        for speed2 in np.linspace(speed[-1] ** 2, end_ms**2, count + 1)[1:]:
            position.append(position[-1] + length / count)
            duration.append(2 * length / count / (speed[-1] + speed2**0.5) if length else 30.0)
            speed.append(speed2**0.5)
            effort.append(share * LARGEST_N)
    efforts = np.array(effort)
    taken = np.append(0, np.cumsum(np.maximum(efforts, 0) * np.diff(position)))
    cells = np.ones(len(effort))
    values = {
        "position_m": np.array(position),
        "time_s": np.append(0, np.cumsum(duration)),
        "speed_ms": np.array(speed),
        "energy_j": taken,
        "effort_n": efforts,
        "max_effort_n": LARGEST_N * cells,
        "max_braking_n": LARGEST_N * cells,
        "limit_ms": limit_ms * cells,
        "inertia_kg": INERTIA_KG,
        "max_deceleration_ms2": np.inf,
    }
    values |= fields
    return RunData(**{name: frozen_array(value) if name in FROZEN else value for name, value in values.items()})


def in_short(phases):
    """Return name and ends [m] of phases."""
    return [(phase.phase, phase.start_m, phase.end_m) for phase in phases]
