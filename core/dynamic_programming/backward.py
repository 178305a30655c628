"""Backward induction: the least cost to go from each speed at each node, and what to do there.

Source: Liashenko, Yatsko 2025, (2) and (5)-(9), made exact: the grid of each node ends at the greatest speed that
can be had there, the cost to go is linear in the square of speed between grid points, and besides the grid points of
the next node, full traction, coasting, holding the speed and full braking are tried, whose speeds lie between them.
The square of speed is kinetic energy but for a factor: what a train carries on, it saves later, so that the cost to go
is nearly linear in it, and not in speed.

Energy and time of a step do not depend on the price of time, so they are tabulated once for all prices.
"""

import math
from typing import NamedTuple

import numpy as np

from railjoule.core.arrays import FloatArray, IntArray
from railjoule.core.compiled import njit
from railjoule.core.dynamic_programming.power_table import PowerTable, tabulated_cost
from railjoule.core.motion.cell_step import COAST, FULL_BRAKE, FULL_TRACTION, cell_cost, exit_speed2
from railjoule.core.physics.cell import Cell
from railjoule.core.physics.course_data import CourseData, Train, cell_of, shared_by_cells
from railjoule.core.physics.effort_limit import EffortLimit

FULL_BRAKING, FULL_POWER, HOLDING, COASTING = range(4)
CONTROLS_BESIDE_GRID = 4
# On the steepest braking curve full braking ends at the greatest speed of the grid but for this, as a share of the
# square of speed: the fixed point of an exit speed ends at 1e-13 of it, where it converges fast
ROUNDING = 1e-10
# A speed squared this close to a grid point, relatively, is that point: beyond it there may be no run, and a cost to go
# between the last point and an infinite one would be infinite
ON_GRID = 1e-9
# The least speed of a grid over the greatest one: a quarter of the first grid's step between speeds, 1 / 24. Slower
# runs are not found. Half or double of it moves drives that jump between local optima by -520 to +370 millionths of
# their energy, and is no better or worse over 13 shipped scenarios (mean -27 and +46)
SLOWEST_SHARE = 1 / 96
# a bisection of doubles has come to neighbouring numbers after 53 halvings
HALVINGS = 60


class TrainLimits(NamedTuple):
    """What a train can do and what its drive takes; made once for a course, not for each cell.

    To make such a tuple costs little, but for each cell it would count references to its arrays.

    Parameters
    ----------
    train : Train
        Its plain numbers.
    traction, braking : EffortLimit
        Largest efforts of the drive and of the electric brake.
    drive : array
        Parameters of the drive.
    """

    train: Train
    traction: EffortLimit
    braking: EffortLimit
    drive: FloatArray


@njit(cache=True, error_model="numpy")
def limits_of(course: CourseData) -> TrainLimits:
    """Return what the train of a course can do."""
    return TrainLimits(*shared_by_cells(course))


class Steps(NamedTuple):
    """All steps from all grid points, state by state; s steps in all.

    Step `j` of the state `k` at node `i` is `first[i, k] + j`; it leads between the points `lower` and `lower + 1` of
    the next node, at `weight` between the one, 0, and the other, 1, in the square of speed. Steps that are not
    allowed have infinite energy. `action` is 0 where a table of powers does not say what the drive does.
    """

    first: IntArray
    lower: IntArray
    weight: FloatArray
    energy_j: FloatArray
    time_s: FloatArray
    leaving_speed2: FloatArray
    action: IntArray


@njit(cache=True, error_model="numpy")
def _exit_speed2(limits: TrainLimits, cell: Cell, entering_speed2: float, control: int) -> float:
    return exit_speed2(cell, limits.train, limits.traction, limits.braking, entering_speed2, control)


@njit(cache=True, error_model="numpy")
def step_cost(
    limits: TrainLimits, cell: Cell, entering_speed2: float, leaving_speed2: float
) -> tuple[float, float, bool]:
    """Return line energy of a step without auxiliaries [J], its time [s], and whether the limits of effort allow it."""
    train, traction, braking, drive = limits
    return cell_cost(cell, train, traction, braking, drive, entering_speed2, leaving_speed2)


@njit(cache=True, error_model="numpy")
def least_speeds(course: CourseData, greatest_speed2: FloatArray) -> FloatArray:
    """Return the least squares of speed [m2/s2] of a grid: from all of them, full traction leads on; shape (nodes,).

    Uphill a train may need its momentum: slower than this it comes to a stand, or falls below the least of what lies
    ahead. Elsewhere they are a small share of the greatest ones, as nothing can start from rest between stops.
    """
    nodes = greatest_speed2.shape[0]
    limits = limits_of(course)
    least = greatest_speed2 * SLOWEST_SHARE**2
    for i in range(nodes - 1, -1, -1):
        if course.fixed_speed2[i] >= 0.0:
            least[i] = course.fixed_speed2[i]
        if i == nodes - 1 or course.fixed_speed2[i] >= 0.0:
            continue
        cell = cell_of(course, i)
        if _exit_speed2(limits, cell, least[i], FULL_TRACTION) >= least[i + 1]:
            continue
        low, high = least[i], greatest_speed2[i]
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            if _exit_speed2(limits, cell, middle, FULL_TRACTION) >= least[i + 1]:
                high = middle
            else:
                low = middle
        least[i] = high
    return least


@njit(cache=True, error_model="numpy")
def speed_grid(
    greatest_speed2: FloatArray,
    least_speed2: FloatArray,
    fixed_speed2: FloatArray,
    centre_ms: FloatArray,
    half_width_ms: float,
    points: int,
) -> FloatArray:
    """Return squares of speed [m2/s2], rising at each node; shape (nodes, points).

    The speeds are evenly spaced over what is possible within a band, and hold its upper end. A node with a fixed
    speed has it in all its points.

    Parameters
    ----------
    greatest_speed2, least_speed2 : array of shape (nodes,)
        Greatest and least squares of speed [m2/s2].
    fixed_speed2 : array of shape (nodes,)
        Prescribed ones, negative where the speed is free.
    centre_ms, half_width_ms : array of shape (nodes,) and float
        Middle and half of the width of the band [m/s].
    points : int
        How many speeds each node has.
    """
    nodes = greatest_speed2.shape[0]
    grid = np.empty((nodes, points))
    for i in range(nodes):
        fixed = fixed_speed2[i]
        greatest = math.sqrt(greatest_speed2[i])
        least = math.sqrt(least_speed2[i])
        high = max(min(greatest, centre_ms[i] + half_width_ms), least)
        low = max(least, min(centre_ms[i], high) - half_width_ms)
        # counted from the upper end, which the fastest run needs to the last digit
        for k in range(points):
            speed = high - (high - low) * (points - 1 - k) / (points - 1)
            grid[i, k] = fixed if fixed >= 0.0 else speed * speed
        if fixed < 0.0 and high == greatest:
            grid[i, points - 1] = greatest_speed2[i]
    return grid


@njit(cache=True, error_model="numpy")
def laid_along_coasting(course: CourseData, grid: FloatArray, greatest_speed2: FloatArray) -> FloatArray:
    """Return a grid whose points in neutral sections are those to which the points before them coast.

    Parameters
    ----------
    course : CourseData
        What the run obeys.
    grid : array of shape (nodes, points)
        Squares of speed, rising at each node [m2/s2]; changed in place.
    greatest_speed2 : array of shape (nodes,)
        Greatest feasible squares of speed [m2/s2].
    """
    # Between two points the cost to go is infinite if it is at one of them, as at the edge of a band, beyond which no
    # state is known. A train that only coasts cannot steer clear of it, and each cell would take another point
    limits, last = limits_of(course), grid.shape[1] - 1
    for i in range(grid.shape[0] - 1):
        if course.powered[i] >= 1.0 or course.fixed_speed2[i] >= 0.0 or course.fixed_speed2[i + 1] >= 0.0:
            continue
        cell, greatest = cell_of(course, i), greatest_speed2[i + 1]
        top = _exit_speed2(limits, cell, grid[i, last], COAST)
        # where it has to brake instead, the points stay
        if top > greatest * (1.0 + ON_GRID) or _exit_speed2(limits, cell, grid[i, 0], COAST) <= 0.0:
            continue
        for k in range(last + 1):
            grid[i + 1, k] = min(_exit_speed2(limits, cell, grid[i, k], COAST), greatest)
    return grid


def band_of_speeds(
    course: CourseData, greatest_speed2: FloatArray, centre_speed2: FloatArray, half_width_ms: float, points: int
) -> FloatArray:
    """Return the grid of a band of speeds around a run, squares of speed in all [m2/s2]; as `speed_grid`."""
    bounds = greatest_speed2, least_speeds(course, greatest_speed2), course.fixed_speed2
    grid = speed_grid(*bounds, np.sqrt(centre_speed2), half_width_ms, points)
    return laid_along_coasting(course, grid, greatest_speed2)


@njit(cache=True, error_model="numpy")
def place_in_row(row: FloatArray, speed2: float) -> tuple[int, float]:
    """Return the grid point below a square of speed and its weight between it, 0, and the next, 1; (-1, 0) outside."""
    last = row.shape[0] - 1
    # above the last point lies nothing but the rounding of a square root, where a train stops even if all points are 0
    if speed2 < row[0] * (1.0 - ON_GRID) or speed2 > row[last] * (1.0 + 1e-12) + 1e-12:
        return -1, 0.0
    if row[last] <= row[0]:
        return 0, 0.0
    first = math.sqrt(row[0])
    # the points are even in speed, but for rounding and the last one: a guess, put right by at most some steps
    lower = int((math.sqrt(speed2) - first) / (math.sqrt(row[last]) - first) * last)
    lower = min(max(lower, 0), last - 1)
    while lower > 0 and row[lower] > speed2:
        lower -= 1
    while lower < last - 1 and row[lower + 1] < speed2:
        lower += 1
    weight = (speed2 - row[lower]) / (row[lower + 1] - row[lower])
    return lower, min(max(weight, 0.0), 1.0) if weight < 1.0 - ON_GRID else 1.0


@njit(cache=True, error_model="numpy")
def reachable_range(limits: TrainLimits, cell: Cell, entering_speed2: float, row: FloatArray) -> tuple[float, float]:
    """Return the least and the greatest square of speed at the end of a cell that the grid of its end holds.

    The first is greater than the second where there is none.
    """
    greatest = row[row.shape[0] - 1]
    top = min(_exit_speed2(limits, cell, entering_speed2, FULL_TRACTION), greatest)
    low = max(_exit_speed2(limits, cell, entering_speed2, FULL_BRAKE), row[0])
    if top < low and top >= 0.0:
        # on the steepest braking curve both are the same but for rounding, and for what is left of a fixed point, which
        # hardly converges before a stop: what the limits allow counts
        slowed = entering_speed2 - top <= 2.0 * limits.train.max_deceleration_ms2 * cell.length_m * (1.0 + ROUNDING)
        if low <= top + ROUNDING * max(entering_speed2, greatest) or (
            slowed and step_cost(limits, cell, entering_speed2, top)[2]
        ):
            low = top
    return low, top


@njit(cache=True, error_model="numpy")
def grid_range(row: FloatArray, low: float, top: float) -> tuple[int, int]:
    """Return the first grid point not below `low` and the one after the last not above `top`."""
    return int(np.searchsorted(row, low)), int(np.searchsorted(row, top, side="right"))


@njit(cache=True, error_model="numpy", nogil=True)
def tabulate_steps(course: CourseData, grid: FloatArray, table: PowerTable) -> Steps:
    """Return all steps between the grid points of neighbouring nodes, and those of the controls beside them.

    Parameters
    ----------
    course : CourseData
        The line and the train.
    grid : array of shape (nodes, points)
        Squares of speed, rising at each node [m2/s2].
    table : PowerTable
        Table that prices the steps and gives their actions; if it is empty, each step has an account of its own.
    """
    nodes, points = grid.shape
    limits = limits_of(course)
    # the steps of all states stand in one array: how many there are has to be counted first
    first = np.zeros((nodes - 1, points + 1), dtype=np.int64)
    span = np.empty((nodes - 1, points, 2))
    total = 0
    for i in range(nodes - 1):
        cell, row = cell_of(course, i), grid[i + 1]
        for k in range(points):
            first[i, k] = total
            # all points of a node with a fixed speed are one
            if k > 0 and grid[i, k] == grid[i, k - 1]:
                continue
            span[i, k] = reachable_range(limits, cell, grid[i, k], row)
            if span[i, k, 0] <= span[i, k, 1]:
                start, end = grid_range(row, span[i, k, 0], span[i, k, 1])
                total += CONTROLS_BESIDE_GRID + max(end - start, 0)
        first[i, points] = total
    energy, time, exits = np.full(total, np.inf), np.empty(total), np.empty(total)
    lower, weight = np.empty(total, dtype=np.int64), np.empty(total)
    action, is_exact = np.zeros(total, dtype=np.int64), table.loss_w.shape[1] == 0
    for i in range(nodes - 1):
        cell, row = cell_of(course, i), grid[i + 1]
        for k in range(points):
            low, top = span[i, k]
            start = int(np.searchsorted(row, low))
            for step in range(first[i, k], first[i, k + 1]):
                point = start + step - first[i, k] - CONTROLS_BESIDE_GRID
                if point >= start:
                    leaving_speed2 = row[point]
                    lower[step], weight[step] = (point, 0.0) if point < points - 1 else (point - 1, 1.0)
                else:
                    leaving_speed2 = exit_of_control(limits, cell, grid[i, k], low, top, step - first[i, k])
                    if not low <= leaving_speed2 <= top:
                        continue
                    lower[step], weight[step] = place_in_row(row, leaving_speed2)
                if is_exact:
                    joules, seconds, allowed = step_cost(limits, cell, grid[i, k], leaving_speed2)
                else:
                    # between full braking and full power no step breaks a limit, but one from rest to rest never ends
                    joules, seconds, action[step] = tabulated_cost(table, cell, grid[i, k], leaving_speed2)
                    allowed = seconds < np.inf
                if allowed and lower[step] >= 0:
                    energy[step], time[step], exits[step] = joules, seconds, leaving_speed2
    return Steps(first, lower, weight, energy, time, exits, action)


@njit(cache=True, error_model="numpy")
def exit_of_control(
    limits: TrainLimits, cell: Cell, entering_speed2: float, low: float, top: float, control: int
) -> float:
    """Return the square of speed [m2/s2] to which full braking, full power, holding or coasting leads."""
    if control == FULL_BRAKING:
        return low
    if control == FULL_POWER:
        return top
    return entering_speed2 if control == HOLDING else _exit_speed2(limits, cell, entering_speed2, COAST)


@njit(cache=True, error_model="numpy")
def cost_between(row: FloatArray, lower: int, weight: float) -> float:
    """Return a row's value between a point, at a weight of 0, and the next, at 1; infinite if either is and counts."""
    below: float = row[lower]
    above: float = row[lower + 1]
    # 0 x infinity is no number: a point itself does not depend on its neighbour
    if weight <= 0.0:
        return below
    if weight >= 1.0:
        return above
    if max(below, above) == math.inf:
        return math.inf
    return below + weight * (above - below)


@njit(cache=True, error_model="numpy", nogil=True)
def sweep_back(steps: Steps, grid: FloatArray, price: float) -> tuple[FloatArray, IntArray, FloatArray]:
    """Return the least cost to go (8), the step that has it and its time to go, from the end to the start.

    Parameters
    ----------
    steps : Steps
        As tabulated.
    grid : array of shape (nodes, points)
        Squares of speed [m2/s2].
    price : float
        Cost of a second [J/s]: lambda of (9).

    Returns
    -------
    cost_j : array of shape (nodes, points)
        Infinite where the end cannot be reached.
    best : array of shape (nodes - 1, points)
        Number of the best step; -1 where there is none.
    time_s : array of shape (nodes, points)
        Time to go by the best steps, linear between grid points as the cost is; infinite where that is.
    """
    nodes, points = grid.shape
    cost, time = np.full((nodes, points), np.inf), np.full((nodes, points), np.inf)
    best = np.full((nodes - 1, points), -1, dtype=np.int64)
    cost[nodes - 1] = time[nodes - 1] = 0.0
    for i in range(nodes - 2, -1, -1):
        for k in range(points):
            for step in range(steps.first[i, k], steps.first[i, k + 1]):
                if steps.energy_j[step] < np.inf:
                    # (8): the cost of the step, and the least from where it leads
                    onward = cost_between(cost[i + 1], steps.lower[step], steps.weight[step])
                    total = steps.energy_j[step] + price * steps.time_s[step] + onward
                    if total < cost[i, k]:
                        cost[i, k], best[i, k] = total, step
            step = best[i, k]
            if step >= 0:
                time[i, k] = steps.time_s[step] + cost_between(time[i + 1], steps.lower[step], steps.weight[step])
        # only the first of the equal points of a fixed speed has steps
        if grid[i, 0] == grid[i, points - 1]:
            cost[i], best[i], time[i] = cost[i, 0], best[i, 0], time[i, 0]
    return cost, best, time
