"""What a driver does at once, as squares of speed: hold the speed, coast on, brake for what lies ahead."""

import math

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.motion import Course, greatest_speeds
from railjoule.core.motion.cell_step import COAST, FULL_BRAKE, FULL_TRACTION, exit_speed2
from railjoule.core.motion.course import FREE
from railjoule.core.physics.course_data import CourseData, cell_of, shared_by_cells

# Square of a speed that counts as standing: 0.03 mm/s, rounding of the last braking cell.
STANDING_SPEED2 = 1e-9


def braking_envelope(course: Course) -> FloatArray:
    """Return the greatest squares of speed from which full braking keeps all limits and stops ahead; shape (n + 1,)."""
    # the start is left free: whether the train is slow enough there is the question
    fixed = course.data.fixed_speed2.copy()
    fixed[0] = FREE
    speed2, _, _ = greatest_speeds(course.data._replace(fixed_speed2=fixed))
    return speed2


@njit(cache=True, error_model="numpy", nogil=True)
def held_speed(course: CourseData, speed2: float, coasting: bool) -> FloatArray:
    """Return squares of speed of a train that holds its speed as far as its effort reaches, or coasts.

    Parameters
    ----------
    course : CourseData
        What the train obeys.
    speed2 : float
        Square of its speed at the first node [m2/s2].
    coasting : bool
        Whether it coasts on.

    Returns
    -------
    array of shape (n + 1,)
        Squares of speed [m2/s2]; 0 from where it comes to a stand.
    """
    n = course.cell_length_m.shape[0]
    train, traction, braking, _ = shared_by_cells(course)
    run = np.zeros(n + 1)
    run[0] = speed2
    for i in range(n):
        cell = cell_of(course, i)
        if coasting:
            after = exit_speed2(cell, train, traction, braking, run[i], COAST)
        else:
            # never faster than held, though downhill the train would need its brakes for that
            after = min(speed2, exit_speed2(cell, train, traction, braking, run[i], FULL_TRACTION))
        if after <= 0.0:
            break
        run[i + 1] = after
    return run


@njit(cache=True, error_model="numpy", nogil=True)
def fully_braked(course: CourseData, speed2: float) -> tuple[FloatArray, float]:
    """Return squares of speed under full braking, and where the train stands; not a number where it does not.

    Parameters
    ----------
    course : CourseData
        What the train obeys.
    speed2 : float
        Square of its speed at the first node [m2/s2].

    Returns
    -------
    run : array of shape (n + 1,)
        Squares of speed [m2/s2]; 0 from where it stands.
    distance_m : float
        From the first node to where it stands [m].
    """
    n = course.cell_length_m.shape[0]
    train, traction, braking, _ = shared_by_cells(course)
    run = np.zeros(n + 1)
    run[0] = speed2
    distance = 0.0
    for i in range(n):
        cell = cell_of(course, i)
        after = exit_speed2(cell, train, traction, braking, run[i], FULL_BRAKE)
        if after <= 0.0:
            # constant force within a cell: v^2 falls linearly, so its zero is found by proportion
            return run, distance + cell.length_m * run[i] / (run[i] - after)
        run[i + 1] = after
        distance += cell.length_m
    return run, math.nan
