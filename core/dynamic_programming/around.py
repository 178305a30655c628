"""Runs near a known one: two that bracket the timetable at one price of time, and hybrids of both.

With a price of time in place of the timetable the problem falls apart into a recursion over the nodes, which needs
nothing to be convex. Energies and times of all steps in a band of speeds are tabulated once, so that a price costs one
sweep.
"""

from typing import NamedTuple

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.dynamic_programming.backward import least_speeds, speed_grid
from railjoule.core.dynamic_programming.hybrids import both_hybrids
from railjoule.core.dynamic_programming.search import FIRST_FACTOR, FIRST_POINTS, Level, meet_time, search_level
from railjoule.core.physics.course_data import CourseData

# How close to the timetable a run on a band ends the search for its price: what is missing, each solution of its
# decision makes up
TIME_TOLERANCE = 1e-4
# By how much the bracket of the price first widens: the price of free switching is off by a tenth at most
PRICE_FACTOR = 1.25


class Around(NamedTuple):
    """What a band of speeds holds.

    Parameters
    ----------
    meeting : array of shape (nodes,)
        Squares of speed [m2/s2] of the mean of the two runs that takes the running time.
    others : list of arrays of shape (nodes,)
        The two runs and their hybrids: not in time, but each drives and brakes where a run that is may do so.
    price_w : float
        Price of a second between those of the two, auxiliaries included [J/s].
    sweeps : int
        How many backward inductions it took.
    """

    meeting: FloatArray
    others: list[FloatArray]
    price_w: float
    sweeps: int


def runs_around(
    course: CourseData,
    greatest_speed2: FloatArray,
    time_s: float,
    centre_speed2: FloatArray,
    price_w: float,
    half_width_ms: float,
    points: int,
) -> Around:
    """Return the runs on a band of speeds that bracket a running time, and their hybrids.

    Parameters
    ----------
    course : CourseData
        What the run obeys.
    greatest_speed2 : array of shape (nodes,)
        Greatest feasible squares of speed [m2/s2].
    time_s : float
        Running time allowed [s].
    centre_speed2 : array of shape (nodes,)
        Squares of speed in the middle of the band [m2/s2].
    price_w : float
        About what a second costs, auxiliaries included [J/s].
    half_width_ms, points : float and int
        Half of the width of the band [m/s], and how many speeds each node has.

    Raises
    ------
    SolverError
        If the band holds no run.
    """
    level = _level(course, greatest_speed2, time_s, centre_speed2, price_w, half_width_ms, points, PRICE_FACTOR)
    pair = level.slower, level.faster
    others = [*pair, *both_hybrids(course, *pair, time_s)]
    return Around(meet_time(course, *pair, time_s), others, level.price_w, level.sweeps)


def coarse_run(course: CourseData, greatest_speed2: FloatArray, time_s: float) -> tuple[FloatArray, float]:
    """Return a run that meets a running time on a coarse grid of all speeds [m2/s2], and its price of time [J/s].

    Raises
    ------
    SolverError
        If the grid holds no run.
    """
    greatest = float(np.sqrt(greatest_speed2.max()))
    price = _price_scale_w(course, time_s)
    given = course, greatest_speed2, time_s, 0.25 * greatest_speed2, price, greatest, FIRST_POINTS, FIRST_FACTOR
    level = _level(*given)
    return meet_time(course, level.slower, level.faster, time_s), level.price_w


def _level(
    course: CourseData,
    greatest_speed2: FloatArray,
    time_s: float,
    centre_speed2: FloatArray,
    price_w: float,
    half_width_ms: float,
    points: int,
    factor: float,
) -> Level:
    bounds = greatest_speed2, least_speeds(course, greatest_speed2), course.fixed_speed2
    grid = speed_grid(*bounds, np.sqrt(centre_speed2), half_width_ms, points)
    scale = _price_scale_w(course, time_s)
    return search_level(course, grid, greatest_speed2, time_s, scale, price_w, factor, TIME_TOLERANCE * time_s)


def _price_scale_w(course: CourseData, time_s: float) -> float:
    """Return a natural price of time [J/s]: kinetic energy at the mean speed by running time."""
    mean = float(course.cell_length_m.sum()) / time_s
    return course.half_inertia_kg * mean**2 / time_s
