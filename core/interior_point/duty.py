"""What an optimum says on driving and coasting of a drive that takes power without effort."""

import math

import numpy as np

from railjoule.core.arrays import BoolArray, FloatArray
from railjoule.core.compiled import njit
from railjoule.core.interior_point.solver import Optimum
from railjoule.core.interior_point.switching import hull_power
from railjoule.core.motion.cell_step import COAST, exit_speed2
from railjoule.core.physics.cell import mean_speed
from railjoule.core.physics.course_data import CourseData, cell_of, shared_by_cells

NEXT_TO_NOTHING = 1e-5
"""Efforts below this share of the largest are what a barrier leaves of none."""
DRIVEN, COASTED = 0.98, 0.02
"""Shares of driving from which a cell counts as driven, and up to which as coasted."""


@njit(cache=True, error_model="numpy")
def duty(course: CourseData, optimum: Optimum) -> tuple[FloatArray, FloatArray]:
    """Return on which share of each cell a drive that is switched at will is on, and what driving is worth there.

    Parameters
    ----------
    course : CourseData
    optimum : Optimum
        Of any decision where the drive is on.

    Returns
    -------
    share : array of shape (n,)
        From 0 to 1.
    worth : array of shape (n,)
        Price of force over least power per effort: above 1 driving pays, below it coasting.
    """
    h, w = course.cell_length_m, optimum.speed2
    share, worth = np.empty(h.shape[0]), np.empty(h.shape[0])
    for i in range(h.shape[0]):
        v = mean_speed(math.sqrt(w[i]), math.sqrt(w[i + 1]))
        kind, parameters = course.drive_kind, course.drive_parameters
        power, touch = hull_power(kind, parameters, False, course.traction, 0.0, v, 0.0)
        share[i] = min(optimum.traction_n[i] / touch, 1.0)
        worth[i] = optimum.force_price[i] * v / (h[i] * power[1])
    return share, worth


@njit(cache=True, error_model="numpy")
def coasting_exactly(course: CourseData, optimum: Optimum, off: BoolArray) -> FloatArray:
    """Return squares of speed [m2/s2] of a run that coasts where it all but coasts; shape (n + 1,).

    The method leaves tiny efforts everywhere, and with any effort the drive would count as on.

    Parameters
    ----------
    course : CourseData
    optimum : Optimum
    off : array of shape (n,)
        Where the drive is off.
    """
    speed2, residue = optimum.speed2.copy(), NEXT_TO_NOTHING * course.traction.constant_n
    train, traction, braking, _ = shared_by_cells(course)
    for i in range(off.shape[0]):
        small = optimum.traction_n[i] < residue and optimum.braking_n[i] < residue
        if off[i] and small and course.fixed_speed2[i + 1] < 0.0 and speed2[i] > 0.0:
            leaving = exit_speed2(cell_of(course, i), train, traction, braking, speed2[i], COAST)
            # never so far that the next cell would notice, nor beyond a limit
            if abs(leaving - speed2[i + 1]) < NEXT_TO_NOTHING * speed2[i + 1]:
                speed2[i + 1] = min(leaving, course.largest_speed2[i + 1])
    return speed2
