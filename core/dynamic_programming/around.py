"""Runs near a known one: two that bracket the timetable at one price of time, and hybrids of both.

With a price of time in place of the timetable the problem falls apart into a recursion over the nodes, which needs
nothing to be convex. Energies and times of all steps in a band of speeds are tabulated once, so that a price costs one
sweep.
"""

from typing import NamedTuple

from railjoule.core.arrays import FloatArray
from railjoule.core.dynamic_programming.backward import band_of_speeds
from railjoule.core.dynamic_programming.hybrids import both_hybrids
from railjoule.core.dynamic_programming.search import meet_time, price_scale_w, promised_energy_j, search_level
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
        The two runs and their hybrids, from what promises to need the least energy on: not in time, but each drives
        and brakes where a run that is may do so.
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
    grid = band_of_speeds(course, greatest_speed2, centre_speed2, half_width_ms, points)
    prices = price_scale_w(course, time_s), price_w, PRICE_FACTOR
    level = search_level(course, grid, greatest_speed2, time_s, *prices, TIME_TOLERANCE * time_s)
    pair = level.slower, level.faster
    others = [*pair, *both_hybrids(course, *pair, time_s)]
    others.sort(key=lambda run: promised_energy_j(course, run, level.price_w, time_s))
    return Around(meet_time(course, *pair, time_s), others, level.price_w, level.sweeps)
