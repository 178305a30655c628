"""Runs that follow one of two runs and go on with the other.

Where the cheapest run changes its kind with the price of time, its time jumps over the timetable. The best run that
meets it then follows the slower of both and goes on with the faster, or the other way round, and no more: by Shapley
and Folkman one constraint that couples the cells leaves a gap of the size of one of them.

Reference: Ekeland, Temam 1976, "Convex analysis and variational problems", appendix I.
"""

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.physics.cell import duration, mean_speed
from railjoule.core.physics.course_data import CourseData

# Runs whose squares of speed differ by less cross between two nodes: one cell changes speed by some percent
CROSSING = 2e-2


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


def both_hybrids(course: CourseData, slower: FloatArray, faster: FloatArray, time_s: float) -> list[FloatArray]:
    """Return the hybrids of two runs that begin with the one and with the other; as `hybrids`."""
    return [*hybrids(course, slower, faster, time_s), *hybrids(course, faster, slower, time_s)]


def _durations(course: CourseData, speed2: FloatArray) -> FloatArray:
    """Return the times of the cells of a run [s]."""
    speed = np.sqrt(speed2)
    return duration(course.cell_length_m, mean_speed(speed[:-1], speed[1:]))
