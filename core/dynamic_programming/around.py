"""Runs near a known one: two that bracket the timetable at one price of time, and hybrids of both.

With a price of time in place of the timetable the problem falls apart into a recursion over the nodes, which needs
nothing to be convex. Energies and times of all steps in a band of speeds are tabulated once, so that a price costs one
sweep. Where the cheapest run changes its kind with the price, its time jumps over the timetable; the best run that
meets it then follows the slower of both and goes on with the faster, or the other way round, and no more: by Shapley
and Folkman one constraint that couples the cells leaves a gap of the size of one of them.

Reference: Ekeland, Temam 1976, "Convex analysis and variational problems", appendix I.
"""

from typing import NamedTuple

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.dynamic_programming.backward import least_speeds, speed_grid
from railjoule.core.dynamic_programming.search import FIRST_FACTOR, FIRST_POINTS, Level, meet_time, search_level
from railjoule.core.physics.cell import duration, mean_speed
from railjoule.core.physics.course_data import CourseData

# How close to the timetable a run on a band ends the search for its price: what is missing, each solution of its
# decision makes up
TIME_TOLERANCE = 1e-4
# By how much the bracket of the price first widens: the price of free switching is off by a tenth at most
PRICE_FACTOR = 1.25
# Runs whose squares of speed differ by less cross between two nodes: one cell changes speed by some percent
CROSSING = 2e-2


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
    both = [*hybrids(course, *pair, time_s), *hybrids(course, *pair[::-1], time_s)]
    return Around(meet_time(course, *pair, time_s), [*pair, *both], level.price_w, level.sweeps)


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


def hybrids(course: CourseData, first: FloatArray, then: FloatArray, time_s: float) -> list[FloatArray]:
    """Return the run that follows one and goes on with another where that takes a time closest to one, if any.

    It changes over where the speeds of both cross, and is no run to drive there, but tells where to drive and brake.

    Parameters
    ----------
    course : CourseData
        What the runs obey.
    first, then : array of shape (nodes,)
        Squares of speed [m2/s2].
    time_s : float
        Running time wanted [s].
    """
    # up to each node with the one, and from there with the other
    until = np.append(0.0, np.cumsum(_durations(course, first)))
    times = until + np.append(0.0, np.cumsum(_durations(course, then)[::-1]))[::-1]
    crossing = np.abs(first - then) <= CROSSING * np.maximum(first, then)
    # where the rest is the same, a change over changes nothing
    different = np.logical_or.accumulate(first != then) & np.logical_or.accumulate((first != then)[::-1])[::-1]
    places = np.flatnonzero(crossing & different)
    if len(places) == 0:
        return []
    place = places[np.argmin(np.abs(times[places] - time_s))]
    return [np.concatenate([first[:place], then[place:]])]


def _durations(course: CourseData, speed2: FloatArray) -> FloatArray:
    """Return the times of the cells of a run [s]."""
    speed = np.sqrt(speed2)
    return duration(course.cell_length_m, mean_speed(speed[:-1], speed[1:]))
