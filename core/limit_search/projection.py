"""Limits made feasible: all of them scaled by one factor until the trip takes a given time."""

import math

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.limit_search.regulation import Regulation
from railjoule.core.limit_search.whole_cells import trip_cost
from railjoule.core.physics.mesh_data import MeshData

EXACT = 1e-9
"""How close a trip comes to its time, as a share: a millionth of a second of a quarter of an hour."""
# as many halvings bring any bracket below rounding
MAX_TRIPS = 60
MAX_REPEATS = 4
"""After so many secants on one side of the time the bracket is halved."""
# At constant speed time falls by the factor by which limits rise. A step goes this many times as far, so that it ends
# beyond the time: two trips on either side of it make a bracket, two on the same side do not.
OVERSHOOT = 1.2
FIRST_WIDENING = 0.1
"""How far beyond the factor that a trip at constant speed would need, as a logarithm, the other side is looked for."""
STANDING_WIDENING = 0.7
"""By so much, a factor of 2, limits rise under which the train stands."""
NARROWEST = 1e-13
"""Bracket of logarithms that rounding does not let grow narrower."""


@njit(cache=True)
def _scaled(limits_ms: FloatArray, logarithm: float, min_ms: float, most_ms: float) -> FloatArray:
    return np.minimum(np.maximum(limits_ms * math.exp(logarithm), min_ms), most_ms)


@njit(cache=True, error_model="numpy", nogil=True)
def scale_to_time(
    mesh: MeshData,
    regulation: Regulation,
    borders_m: FloatArray,
    limits_ms: FloatArray,
    min_ms: float,
    most_ms: float,
    running_time_s: float,
) -> tuple[FloatArray, float, float, int]:
    """Return limits scaled so that a trip takes a time: Illinois' rule on the logarithms of factor and time.

    Parameters
    ----------
    mesh, regulation, borders_m, limits_ms
        As in `railjoule.core.limit_search.trip.trip`.
    min_ms, most_ms : float
        Between which limits stay [m/s].
    running_time_s : float
        The time [s].

    Returns
    -------
    limits_ms : array of shape (k,)
        The scaled limits [m/s].
    running_time_s, energy_j : float
        Of their trip; if even the greatest limits take longer, theirs.
    trips : int
        How many were driven.
    """
    low, high = math.log(min_ms / limits_ms.max()), math.log(most_ms / limits_ms.min())
    x = min(max(0.0, low), high)
    width, trips, last_side, repeats = FIRST_WIDENING, 0, 0, 0
    late_known = early_known = False
    late = early = excess = 0.0
    found, time, energy = limits_ms, math.inf, math.inf
    for _ in range(MAX_TRIPS):
        found = _scaled(limits_ms, x, min_ms, most_ms)
        time, energy = trip_cost(mesh, regulation, borders_m, found)
        trips += 1
        excess = math.log(time / running_time_s)
        # at an end of what limits may be, no other factor brings the time closer
        if abs(excess) <= EXACT or (excess > 0.0 and x >= high) or (excess < 0.0 and x <= low):
            break
        side = 1 if excess > 0.0 else -1
        repeats = repeats + 1 if side == last_side else 0
        # Illinois' rule: an end that stays again counts half, which moves the secant towards it; else it might stay
        # for ever while the other end creeps
        if side > 0:
            early = 0.5 * early if repeats else early
            low, late, late_known = x, excess, True
        else:
            late = 0.5 * late if repeats else late
            high, early, early_known = x, excess, True
        last_side = side
        if late_known and early_known:
            # a secant does not leave limits under which the train stands, or a range of them that hardly bind
            share = 0.5 if late == math.inf or repeats >= MAX_REPEATS else late / (late - early)
            x = low + (high - low) * share
        elif side > 0:
            x = min(x + (OVERSHOOT * excess + width if excess < math.inf else STANDING_WIDENING), high)
            width *= 2.0
        else:
            x = max(x + OVERSHOOT * excess - width, low)
            width *= 2.0
        if high - low <= NARROWEST:
            break
    if excess > EXACT and early_known:
        # time jumps where a train just passes a hill, or stands: the run that arrives is the early one
        found = _scaled(limits_ms, high, min_ms, most_ms)
        time, energy = trip_cost(mesh, regulation, borders_m, found)
        trips += 1
    return found, time, energy, trips
