"""Limits made feasible: all of them scaled by one factor until the trip takes a given time."""

import math

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.limit_search.trip import trip_cost
from railjoule.core.limit_search.way import Way
from railjoule.core.physics.course_data import CourseData

EXACT = 1e-9
MOST_TRIPS = 60
FIRST_WIDENING = 0.1


@njit(cache=True)
def _scaled(limits_ms: FloatArray, logarithm: float, least_ms: float, most_ms: float) -> FloatArray:
    return np.minimum(np.maximum(limits_ms * math.exp(logarithm), least_ms), most_ms)


@njit(cache=True, error_model="numpy", nogil=True)
def scale_to_time(
    course: CourseData,
    way: Way,
    borders_m: FloatArray,
    limits_ms: FloatArray,
    least_ms: float,
    most_ms: float,
    running_time_s: float,
) -> tuple[FloatArray, float, float, int]:
    """Return limits scaled so that a trip takes a time: Illinois' rule on the logarithms of factor and time.

    Parameters
    ----------
    course, way, borders_m, limits_ms
        As in `railjoule.core.limit_search.trip.trip`.
    least_ms, most_ms : float
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
    low, high = math.log(least_ms / limits_ms.max()), math.log(most_ms / limits_ms.min())
    x = min(max(0.0, low), high)
    # a trip at constant speed shows about where to look
    width, trips, last_side = FIRST_WIDENING, 0, 0
    excess_low, excess_high = math.inf, -math.inf
    found = limits_ms
    time = energy = math.inf
    for _ in range(MOST_TRIPS):
        found = _scaled(limits_ms, x, least_ms, most_ms)
        time, energy = trip_cost(course, way, borders_m, found)
        trips += 1
        excess = math.log(time / running_time_s)
        if abs(excess) <= EXACT or (excess > 0.0 and x >= high) or (excess < 0.0 and x <= low):
            break
        if excess > 0.0:
            if excess_low < math.inf and excess_high > -math.inf and last_side > 0:
                excess_high *= 0.5
            low, excess_low, last_side = x, excess, 1
        else:
            if excess_low < math.inf and excess_high > -math.inf and last_side < 0:
                excess_low *= 0.5
            high, excess_high, last_side = x, excess, -1
        if excess_low < math.inf and excess_high > -math.inf:
            x = low + (high - low) * excess_low / (excess_low - excess_high)
        elif excess > 0.0:
            # time falls about as limits rise
            x = min(x + (1.2 * excess + width if excess < math.inf else 0.7), high)
            width *= 2.0
        else:
            x = max(x + 1.2 * excess - width, low)
            width *= 2.0
        if high - low <= 1e-14:
            break
    return found, time, energy, trips
