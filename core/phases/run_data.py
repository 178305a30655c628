"""The arrays of a run that its phases are found in."""

from typing import NamedTuple

from railjoule.core.arrays import FloatArray


class RunData(NamedTuple):
    """A run of n cells; a dwell is a cell without length.

    Parameters
    ----------
    position_m, time_s, speed_ms : array of shape (n + 1,)
        Place [m], time [s] and speed [m/s] at the nodes.
    energy_j : array of shape (n + 1,)
        Energy taken at the line so far, auxiliaries apart [J].
    effort_n : array of shape (n,)
        Effort at the wheels in each cell, braking negative [N].
    largest_effort_n, largest_braking_n : array of shape (n,)
        Largest tractive and braking effort at the speed of each cell, both positive [N].
    limit_ms : array of shape (n,)
        Speed limit of each cell [m/s].
    inertia_kg : float
        Mass that resists acceleration [kg].
    max_deceleration_ms2 : float
        The strongest deceleration allowed, infinite where there is no bound [m/s2].
    """

    position_m: FloatArray
    time_s: FloatArray
    speed_ms: FloatArray
    energy_j: FloatArray
    effort_n: FloatArray
    largest_effort_n: FloatArray
    largest_braking_n: FloatArray
    limit_ms: FloatArray
    inertia_kg: float
    max_deceleration_ms2: float
