"""The price of time at which the cheapest run meets the timetable, on ever finer grids around the run found so far."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from railjoule.core.arrays import FloatArray
from railjoule.core.dynamic_programming.backward import Steps, least_speeds, speed_grid, sweep_back, tabulate_steps
from railjoule.core.dynamic_programming.rollout import roll_out
from railjoule.core.errors import SolverError
from railjoule.core.motion import running_time
from railjoule.core.motion.passes import slowed_to_reach
from railjoule.core.physics.account import run_energy
from railjoule.core.physics.course_data import CourseData

FIRST_POINTS, POINTS = 24, (13, 9, 7)
"""Speeds at each node on the first grid, which spans all of them, and on the next; the last number stays."""
FIRST_BAND_SHARE, NARROWING = 0.1, 0.3
"""Half of the second grid's band over the greatest speed, and by what the band narrows once the run is steady."""
STEADY_SHARE = 5e-4
"""A run is steady if a new grid makes it cheaper by less than this share of its kinetic energy at the mean speed."""
LEAST_BAND_MS, MOST_LEVELS = 0.02, 14
FIRST_NEAR, LEAST_NEAR = 2e-3, 5e-5
"""How close to the running time a level's run must come, as a share of it: at first, halved from level to level."""
NARROWINGS = 4
FIRST_FACTOR = 8.0
"""By how much the first bracket of the price widens, step by step."""
NEXT_FACTOR = 1.02
LEAST_WIDTH = 1e-4
MOST_WIDENINGS, MOST_SWEEPS = 20, 60
PRICE_SHARES = (1e-6, 1e4)
"""The least and the greatest price that is tried, over kinetic energy at the mean speed by running time."""
TINY = 1e-300
WIDENING, MOST_FAILURES = 2.0, 3
"""A band that holds no run is widened; a search that meets so many ends with the best run so far."""


@dataclass(frozen=True, eq=False)
class Level:
    """One grid with its steps, and the two runs on it whose times bracket the timetable.

    Parameters
    ----------
    grid : array of shape (nodes, points)
        Squares of speed [m2/s2].
    steps : Steps
        All steps between them.
    price_w : float
        Price of a second between those of the two runs [J/s].
    slower, faster : array of shape (nodes,)
        Squares of speed of both runs [m2/s2].
    sweeps : int
        How many backward inductions it took.
    """

    grid: FloatArray
    steps: Steps
    price_w: float
    slower: FloatArray
    faster: FloatArray
    sweeps: int


def search_level(
    course: CourseData,
    grid: FloatArray,
    fastest_speed2: FloatArray,
    time_s: float,
    price_scale_w: float,
    first_price_w: float,
    factor: float,
    near_s: float,
) -> Level:
    """Return the runs on one grid that bracket a running time.

    Parameters
    ----------
    course : CourseData
        What the run obeys.
    grid : array of shape (nodes, points)
        Squares of speed [m2/s2].
    fastest_speed2 : array of shape (nodes,)
        The fastest run [m2/s2], which bounds the search where the grid's own runs are all too slow.
    time_s : float
        Running time allowed [s].
    price_scale_w, first_price_w, factor : float
        A natural price of time, where the search begins [J/s], and by which factor its bracket widens. Prices count
        the auxiliaries: none is below their power.
    near_s : float
        The search ends with a run whose time is this close [s], or with prices that hardly differ.

    Raises
    ------
    SolverError
        If no run reaches the end on this grid.
    """
    steps = tabulate_steps(course, grid)
    runs: dict[float, tuple[FloatArray, float]] = {}

    def lateness(log_price: float) -> float:
        if log_price not in runs:
            price = math.exp(log_price)
            cost, _ = sweep_back(steps, grid, price)
            speed2 = roll_out(course, grid, cost, price, NARROWINGS)
            if speed2[-1] < 0:
                raise SolverError("dynamic programming found no run that reaches the end on its grid of speeds.")
            runs[log_price] = speed2, running_time(course.cell_length_m, speed2) - time_s
        return runs[log_price][1]

    least, most = (math.log(price_scale_w * share) for share in PRICE_SHARES)
    # a second costs at least what the auxiliaries take: a run that is early at that price had better be early
    least, most = (max(bound, math.log(max(course.auxiliary_power_w, TINY))) for bound in (least, most))
    first = other = min(max(math.log(first_price_w), least), most)
    for widening in range(MOST_WIDENINGS):
        wider = other + math.copysign(math.log(factor) * 1.5**widening, lateness(first))
        other = min(max(wider, least), most)
        if lateness(first) * lateness(other) <= 0 or other != wider:
            break
        first = other
    slow, fast = (first, other) if lateness(first) >= lateness(other) else (other, first)
    if lateness(slow) <= 0:
        # the cheapest run at any price is early, and at the least price it is the cheapest of all
        lowest = min(slow, fast)
        return Level(grid, steps, math.exp(lowest), runs[lowest][0], runs[lowest][0], len(runs))
    if lateness(fast) > 0:
        return Level(grid, steps, math.exp(fast), runs[fast][0], fastest_speed2, len(runs))
    for _ in range(MOST_SWEEPS):
        if min(abs(lateness(slow)), abs(lateness(fast))) <= near_s or abs(slow - fast) <= LEAST_WIDTH:
            break
        # regula falsi, drawn to the middle: times jump where the cheapest run changes its kind
        share = lateness(slow) / (lateness(slow) - lateness(fast))
        between = slow + (0.5 * share + 0.25) * (fast - slow)
        if lateness(between) >= 0:
            slow = between
        else:
            fast = between
    return Level(grid, steps, math.exp(0.5 * (slow + fast)), runs[slow][0], runs[fast][0], len(runs))


def meet_time(course: CourseData, slower: FloatArray, faster: FloatArray, time_s: float) -> FloatArray:
    """Return the run between two whose time is as asked for, within 1e-6 s; squares of speed of shape (nodes,).

    The mean of two runs in the square of speed keeps all limits but those of power, which are met by slowing down.
    """

    def between(share: float) -> FloatArray:
        return slowed_to_reach(course, slower + share * (faster - slower))

    def lateness(share: float) -> float:
        return running_time(course.cell_length_m, between(share)) - time_s

    if lateness(0.0) <= 0:
        return between(0.0)
    if lateness(1.0) >= 0:
        return between(1.0)
    share = brentq(lateness, 0.0, 1.0, xtol=1e-14, rtol=1e-14)
    return between(float(share))


@dataclass(frozen=True, eq=False)
class Found:
    """The cheapest run.

    Parameters
    ----------
    speed2 : array of shape (nodes,)
        Squares of speed [m2/s2].
    price_w : float
        Price of a second, auxiliaries included [J/s].
    first : Level
        The first grid, which spans all speeds.
    sweeps : int
        Backward inductions on all grids together.
    unrefined_ms : float or None
        Half of the width of the band of speeds [m/s] that ended the search because it held no run; None where the
        search ended by itself.
    """

    speed2: FloatArray
    price_w: float
    first: Level
    sweeps: int
    unrefined_ms: float | None = None


def search(course: CourseData, greatest_speed2: FloatArray, time_s: float) -> Found:
    """Return the cheapest run that meets a running time, by backward induction.

    Parameters
    ----------
    course : CourseData
        What the run obeys.
    greatest_speed2 : array of shape (nodes,)
        Greatest feasible squares of speed [m2/s2].
    time_s : float
        Running time allowed [s]; longer than the shortest possible.

    Raises
    ------
    SolverError
        If no run on the grid meets the timetable.
    """
    greatest = np.sqrt(greatest_speed2)
    mean = course.cell_length_m.sum() / time_s
    kinetic = course.half_inertia_kg * mean**2
    scale = kinetic / time_s
    half, points, near = float(greatest.max()), FIRST_POINTS, FIRST_NEAR * time_s
    bounds = greatest_speed2, least_speeds(course, greatest_speed2), course.fixed_speed2
    grid = speed_grid(*bounds, 0.5 * greatest, half, points)
    first = level = search_level(course, grid, greatest_speed2, time_s, scale, scale, FIRST_FACTOR, near)
    speed2, sweeps = meet_time(course, first.slower, first.faster, time_s), first.sweeps
    best, least, price = speed2, _total_energy(course, speed2), first.price_w
    half *= FIRST_BAND_SHARE
    failures, unrefined, steady_at = 0, None, math.inf
    for number in range(MOST_LEVELS):
        points, near = POINTS[min(number, len(POINTS) - 1)], max(0.5 * near, LEAST_NEAR * time_s)
        grid = speed_grid(*bounds, np.sqrt(speed2), half, points)
        try:
            level = search_level(course, grid, greatest_speed2, time_s, scale, level.price_w, NEXT_FACTOR, near)
        except SolverError:
            failures, unrefined = failures + 1, half
            if failures == MOST_FAILURES:
                break
            half *= WIDENING
            continue
        speed2, sweeps, unrefined = meet_time(course, level.slower, level.faster, time_s), sweeps + level.sweeps, None
        energy = _total_energy(course, speed2)
        if energy < least:
            best, least, price = speed2, energy, level.price_w
        before, steady_at = steady_at, min(steady_at, energy)
        if before - steady_at <= STEADY_SHARE * kinetic or number == 0:
            if half < LEAST_BAND_MS:
                break
            half *= NARROWING
    return Found(best, price, first, sweeps, unrefined)


def _total_energy(course: CourseData, speed2: FloatArray) -> float:
    """Return the line energy of a run with auxiliaries on its way [J]: runs may differ in their times."""
    return float(run_energy(course, speed2) + course.auxiliary_power_w * running_time(course.cell_length_m, speed2))
