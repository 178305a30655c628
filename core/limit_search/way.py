"""What a regulator obeys: the line's own limits and stops with the braking curves before them, and section limits.

Limits of sections hold for the front of the train. Those of the line are kept at any price, by braking ahead at a
constant deceleration; a regulator that brakes keeps those of the sections alike, one that coasts does not brake for
them.
"""

from typing import NamedTuple

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.motion.course import Course
from railjoule.core.motion.passes import entering_speed2_under_brakes
from railjoule.core.physics.course_data import CourseData


class Way(NamedTuple):
    """A course as a regulator sees it; n cells.

    Parameters
    ----------
    position_m : array of shape (n + 1,)
        Nodes [m].
    top_speed2 : array of shape (n,)
        Squares of the limit of line and vehicle within each cell [m2/s2].
    bound_speed2 : array of shape (n + 1,)
        The same at the nodes, where both neighbours count, and 0 at stops [m2/s2].
    deceleration_ms2 : float
        Of braking ahead [m/s2].
    brakes : bool
        Whether limits of sections are braked for.
    """

    position_m: FloatArray
    top_speed2: FloatArray
    bound_speed2: FloatArray
    deceleration_ms2: float
    brakes: bool


def way_of(course: Course, stop_deceleration_ms2: float, brakes: bool) -> Way:
    """Return the way of a course for a regulator that `brakes` for sections or coasts."""
    data = course.data
    bound = data.largest_speed2.copy()
    fixed = data.fixed_speed2 >= 0
    bound[fixed] = np.minimum(bound[fixed], data.fixed_speed2[fixed])
    bound[0] = data.largest_speed2[0]
    return Way(
        position_m=course.position_m,
        top_speed2=course.cell_limit_ms**2,
        bound_speed2=bound,
        deceleration_ms2=min(stop_deceleration_ms2, data.max_deceleration_ms2),
        brakes=brakes,
    )


@njit(cache=True)
def section_at(borders_m: FloatArray, place_m: float) -> int:
    """Return the number of the section that begins at or before a place [m]."""
    number = 0
    while number < borders_m.shape[0] and borders_m[number] <= place_m:
        number += 1
    return number


@njit(cache=True, error_model="numpy")
def braking_curves(
    course: CourseData, way: Way, borders_m: FloatArray, limits_ms: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the squares of speed from which braking ahead still keeps all limits, and how they fall in each cell.

    Parameters
    ----------
    course : CourseData
        What the train obeys.
    way : Way
        The same for a regulator.
    borders_m : array of shape (k - 1,)
        Between sections, rising [m].
    limits_ms : array of shape (k,)
        Of the sections [m/s].

    Returns
    -------
    curve_speed2 : array of shape (n + 1,)
        At the nodes [m2/s2].
    fall_ms2 : array of shape (n,)
        By how much it falls over a metre within a cell while the train brakes [m/s2].
    """
    n = way.top_speed2.shape[0]
    curve, fall = np.empty(n + 1), np.empty(n)
    curve[n] = way.bound_speed2[n]
    section = limits_ms.shape[0] - 1
    if way.brakes:
        curve[n] = min(curve[n], limits_ms[section] * limits_ms[section])
    for i in range(n - 1, -1, -1):
        h = course.cell_length_m[i]
        steepest = curve[i + 1] + 2.0 * way.deceleration_ms2 * h
        reached = entering_speed2_under_brakes(course, i, curve[i + 1], steepest)
        fall[i] = max(reached - curve[i + 1], 0.0) / h
        end, value = way.position_m[i + 1], curve[i + 1]
        while way.brakes and section > 0 and borders_m[section - 1] >= way.position_m[i]:
            border = borders_m[section - 1]
            value = value + fall[i] * (end - border)
            lower = min(limits_ms[section - 1], limits_ms[section])
            value = min(value, lower * lower)
            end = border
            section -= 1
        value = min(value + fall[i] * (end - way.position_m[i]), way.bound_speed2[i])
        if way.brakes:
            value = min(value, limits_ms[section] * limits_ms[section])
        curve[i] = value
    return curve, fall
