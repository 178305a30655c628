"""Backward induction: the least cost to go from each speed at each node, and what to do there.

Source: Liashenko, Yatsko 2025, (2) and (5)-(9), made exact: the grid of each node ends at the greatest speed that
can be had there, the cost to go is linear in the square of speed between grid points, and besides the grid points of
the next node, full traction, coasting, holding the speed and full braking are tried, whose speeds lie between them.

Energy and time of a step do not depend on the price of time, so they are tabulated once for all prices.
"""

import math
from typing import NamedTuple

import numpy as np

from railjoule.core.arrays import FloatArray, IntArray
from railjoule.core.compiled import njit
from railjoule.core.motion.cell_step import COAST, FULL_BRAKE, FULL_TRACTION, cell_cost, exit_speed2
from railjoule.core.physics.cell import Cell
from railjoule.core.physics.course_data import CourseData, Train, cell_of, shared_by_cells
from railjoule.core.physics.effort_limit import EffortLimit

CONTROLS_BESIDE_GRID = 4
ROUNDING = 1e-10
ON_GRID = 1e-9
"""A speed squared this close to a grid point, relatively, is that point: beyond it there may be no run."""
SLOWEST_SHARE = 1 / 96
"""The least speed of a grid over the greatest one: a quarter of the first grid's step between speeds."""
HALVINGS = 60


class Steps(NamedTuple):
    """All steps from all grid points, state by state; s steps in all.

    Step `j` of the state `k` at node `i` is `first[i, k] + j`; it leads between the points `lower` and `lower + 1` of
    the next node, `share` of the way from the one to the other.
    """

    first: IntArray
    lower: IntArray
    share: FloatArray
    energy_j: FloatArray
    time_s: FloatArray
    leaving_speed2: FloatArray


@njit(cache=True, error_model="numpy")
def least_speeds(course: CourseData, greatest_speed2: FloatArray) -> FloatArray:
    """Return the least squares of speed [m2/s2] of a grid: from all of them, full traction leads on; shape (nodes,).

    Uphill a train may need its momentum: slower than this it comes to a stand, or falls below the least of what lies
    ahead. Elsewhere they are a small share of the greatest ones, as nothing can start from rest between stops.
    """
    nodes = greatest_speed2.shape[0]
    train, traction, braking = train_of(course), course.traction, course.braking
    least = greatest_speed2 * SLOWEST_SHARE**2
    for i in range(nodes - 1, -1, -1):
        if course.fixed_speed2[i] >= 0.0:
            least[i] = course.fixed_speed2[i]
        if i == nodes - 1 or course.fixed_speed2[i] >= 0.0:
            continue
        cell = cell_of(course, i)
        if exit_speed2(cell, train, traction, braking, least[i], FULL_TRACTION) >= least[i + 1]:
            continue
        low, high = least[i], greatest_speed2[i]
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            if exit_speed2(cell, train, traction, braking, middle, FULL_TRACTION) >= least[i + 1]:
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
    reach_ms: float,
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
    centre_ms, reach_ms : array of shape (nodes,) and float
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
        high = max(min(greatest, centre_ms[i] + reach_ms), least)
        low = max(least, min(centre_ms[i], high) - reach_ms)
        for k in range(points):
            speed = high - (high - low) * (points - 1 - k) / (points - 1)
            grid[i, k] = fixed if fixed >= 0.0 else speed * speed
        if fixed < 0.0 and high == greatest:
            grid[i, points - 1] = greatest_speed2[i]
    return grid


@njit(cache=True, error_model="numpy")
def place_in_row(row: FloatArray, speed2: float) -> tuple[int, float]:
    """Return the grid point below a square of speed and how far it lies on the way to the next; (-1, 0) if outside."""
    last = row.shape[0] - 1
    if speed2 < row[0] * (1.0 - ON_GRID) or speed2 > row[last] * (1.0 + 1e-12) + 1e-12:
        return -1, 0.0
    if row[last] <= row[0]:
        return 0, 0.0
    first = math.sqrt(row[0])
    lower = int((math.sqrt(speed2) - first) / (math.sqrt(row[last]) - first) * last)
    lower = min(max(lower, 0), last - 1)
    while lower > 0 and row[lower] > speed2:
        lower -= 1
    while lower < last - 1 and row[lower + 1] < speed2:
        lower += 1
    share = (speed2 - row[lower]) / (row[lower + 1] - row[lower])
    return lower, min(max(share, 0.0), 1.0) if share < 1.0 - ON_GRID else 1.0


@njit(cache=True, error_model="numpy")
def reach(
    cell: Cell,
    train: Train,
    traction: EffortLimit,
    braking: EffortLimit,
    drive: FloatArray,
    entering_speed2: float,
    row: FloatArray,
) -> tuple[float, float]:
    """Return the least and the greatest square of speed at the end of a cell that the grid of its end holds.

    The first is greater than the second where there is none.
    """
    greatest = row[row.shape[0] - 1]
    top = min(exit_speed2(cell, train, traction, braking, entering_speed2, FULL_TRACTION), greatest)
    low = max(exit_speed2(cell, train, traction, braking, entering_speed2, FULL_BRAKE), row[0])
    if top < low and top >= 0.0:
        # on the steepest braking curve both are the same but for rounding, and for what is left of a fixed point, which
        # hardly converges before a stop: what the limits allow counts
        slowed = entering_speed2 - top <= 2.0 * train.max_deceleration_ms2 * cell.length_m * (1.0 + ROUNDING)
        if low <= top + ROUNDING * max(entering_speed2, greatest) or (
            slowed and cell_cost(cell, train, traction, braking, drive, entering_speed2, top)[2]
        ):
            low = top
    return low, top


@njit(cache=True, error_model="numpy")
def grid_range(row: FloatArray, low: float, top: float) -> tuple[int, int]:
    """Return the first grid point not below `low` and the one after the last not above `top`."""
    return int(np.searchsorted(row, low)), int(np.searchsorted(row, top, side="right"))


@njit(cache=True, error_model="numpy", nogil=True)
def tabulate_steps(course: CourseData, grid: FloatArray) -> Steps:
    """Return all steps between the grid points of neighbouring nodes, and those of the controls beside them."""
    nodes, points = grid.shape
    train, traction, braking, drive = shared_by_cells(course)
    first = np.zeros((nodes - 1, points + 1), dtype=np.int64)
    span = np.empty((nodes - 1, points, 2))
    total = 0
    for i in range(nodes - 1):
        cell, row = cell_of(course, i), grid[i + 1]
        for k in range(points):
            first[i, k] = total
            if k > 0 and grid[i, k] == grid[i, k - 1]:
                continue
            span[i, k] = reach(cell, train, traction, braking, drive, grid[i, k], row)
            if span[i, k, 0] <= span[i, k, 1]:
                start, end = grid_range(row, span[i, k, 0], span[i, k, 1])
                total += CONTROLS_BESIDE_GRID + max(end - start, 0)
        first[i, points] = total
    energy, time, exits = np.full(total, np.inf), np.empty(total), np.empty(total)
    lower, share = np.empty(total, dtype=np.int64), np.empty(total)
    for i in range(nodes - 1):
        cell, row = cell_of(course, i), grid[i + 1]
        for k in range(points):
            low, top = span[i, k]
            start = int(np.searchsorted(row, low))
            for step in range(first[i, k], first[i, k + 1]):
                which = step - first[i, k]
                if which >= CONTROLS_BESIDE_GRID:
                    point = start + which - CONTROLS_BESIDE_GRID
                    leaving_speed2 = row[point]
                    lower[step], share[step] = (point, 0.0) if point < points - 1 else (point - 1, 1.0)
                else:
                    leaving_speed2 = beside_grid(cell, train, traction, braking, grid[i, k], low, top, which)
                    if not low <= leaving_speed2 <= top:
                        continue
                    lower[step], share[step] = place_in_row(row, leaving_speed2)
                joules, seconds, allowed = cell_cost(cell, train, traction, braking, drive, grid[i, k], leaving_speed2)
                if allowed and lower[step] >= 0:
                    energy[step], time[step], exits[step] = joules, seconds, leaving_speed2
    return Steps(first, lower, share, energy, time, exits)


@njit(cache=True, error_model="numpy")
def beside_grid(
    cell: Cell,
    train: Train,
    traction: EffortLimit,
    braking: EffortLimit,
    entering_speed2: float,
    low: float,
    top: float,
    which: int,
) -> float:
    """Return the square of speed to which full braking, full traction, holding or coasting leads."""
    if which == 0:
        return low
    if which == 1:
        return top
    return entering_speed2 if which == 2 else exit_speed2(cell, train, traction, braking, entering_speed2, COAST)


@njit(cache=True, error_model="numpy")
def cost_between(row: FloatArray, lower: int, share: float) -> float:
    """Return a row's value `share` of the way from one point to the next; infinite if either is and counts."""
    below: float = row[lower]
    above: float = row[lower + 1]
    if share <= 0.0:
        return below
    if share >= 1.0:
        return above
    if max(below, above) == math.inf:
        return math.inf
    return below + share * (above - below)


@njit(cache=True, error_model="numpy", nogil=True)
def sweep_back(steps: Steps, grid: FloatArray, price: float) -> tuple[FloatArray, IntArray]:
    """Return the least cost to go (8) and the step that has it, from the end to the start.

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
    """
    nodes, points = grid.shape
    cost = np.full((nodes, points), np.inf)
    best = np.full((nodes - 1, points), -1, dtype=np.int64)
    cost[nodes - 1] = 0.0
    for i in range(nodes - 2, -1, -1):
        for k in range(points):
            for step in range(steps.first[i, k], steps.first[i, k + 1]):
                if steps.energy_j[step] < np.inf:
                    onward = cost_between(cost[i + 1], steps.lower[step], steps.share[step])
                    total = steps.energy_j[step] + price * steps.time_s[step] + onward
                    if total < cost[i, k]:
                        cost[i, k], best[i, k] = total, step
        if grid[i, 0] == grid[i, points - 1]:
            cost[i], best[i] = cost[i, 0], best[i, 0]
    return cost, best
