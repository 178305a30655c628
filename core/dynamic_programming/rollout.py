"""Forward again: the run that the cost to go asks for, with exact dynamics from cell to cell."""

import math

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.dynamic_programming.backward import (
    CONTROLS_BESIDE_GRID,
    beside_grid,
    cost_between,
    grid_range,
    place_in_row,
    reach,
)
from railjoule.core.motion.cell_step import cell_cost
from railjoule.core.physics.cell import Cell
from railjoule.core.physics.course_data import CourseData, Train, cell_of, shared_by_cells
from railjoule.core.physics.effort_limit import EffortLimit

GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)


@njit(cache=True, error_model="numpy")
def total_cost(
    cell: Cell,
    train: Train,
    traction: EffortLimit,
    braking: EffortLimit,
    drive: FloatArray,
    entering_speed2: float,
    leaving_speed2: float,
    row: FloatArray,
    cost: FloatArray,
    price: float,
) -> float:
    """Return cost of a step and cost to go after it [J]; infinite where the way is not allowed."""
    lower, share = place_in_row(row, leaving_speed2)
    if lower < 0:
        return math.inf
    onward = cost_between(cost, lower, share)
    if onward == math.inf:
        return math.inf
    energy, time, allowed = cell_cost(cell, train, traction, braking, drive, entering_speed2, leaving_speed2)
    return energy + price * time + onward if allowed else math.inf


@njit(cache=True, error_model="numpy")
def best_exit(
    cell: Cell,
    train: Train,
    traction: EffortLimit,
    braking: EffortLimit,
    drive: FloatArray,
    entering_speed2: float,
    row: FloatArray,
    cost: FloatArray,
    price: float,
    narrowings: int,
) -> float:
    """Return the square of speed at the end of a cell with the least cost; negative where there is none.

    The best of full traction, coasting, holding, full braking and the grid points, then the best between the grid
    points around it by golden section: there the cost to go is linear.
    """
    low, top = reach(cell, train, traction, braking, drive, entering_speed2, row)
    if low > top:
        return -1.0
    start, end = grid_range(row, low, top)
    best2, best = -1.0, math.inf
    for which in range(CONTROLS_BESIDE_GRID + max(end - start, 0)):
        if which < CONTROLS_BESIDE_GRID:
            leaving_speed2 = beside_grid(cell, train, traction, braking, entering_speed2, low, top, which)
        else:
            leaving_speed2 = row[start + which - CONTROLS_BESIDE_GRID]
        if low <= leaving_speed2 <= top:
            value = total_cost(cell, train, traction, braking, drive, entering_speed2, leaving_speed2, row, cost, price)
            if value < best:
                best2, best = leaving_speed2, value
    if best == math.inf or low == top or narrowings == 0:
        return best2
    below, above = grid_range(row, best2 * (1.0 - 1e-9), best2 * (1.0 + 1e-9))
    left = max(low, row[below - 1]) if below > 0 else low
    right = min(top, row[above]) if above < row.shape[0] else top
    first, second = right - GOLDEN * (right - left), left + GOLDEN * (right - left)
    value_first = total_cost(cell, train, traction, braking, drive, entering_speed2, first, row, cost, price)
    value_second = total_cost(cell, train, traction, braking, drive, entering_speed2, second, row, cost, price)
    for _ in range(narrowings):
        if value_first < value_second:
            right, second, value_second = second, first, value_first
            first = right - GOLDEN * (right - left)
            value_first = total_cost(cell, train, traction, braking, drive, entering_speed2, first, row, cost, price)
        else:
            left, first, value_first = first, second, value_second
            second = left + GOLDEN * (right - left)
            value_second = total_cost(cell, train, traction, braking, drive, entering_speed2, second, row, cost, price)
    if min(value_first, value_second) < best:
        return first if value_first < value_second else second
    return best2


@njit(cache=True, error_model="numpy", nogil=True)
def roll_out(course: CourseData, grid: FloatArray, cost_j: FloatArray, price: float, narrowings: int) -> FloatArray:
    """Return the squares of speed [m2/s2] of the run that follows a cost to go; -1 from where it cannot go on.

    Parameters
    ----------
    course : CourseData
        What the run obeys.
    grid, cost_j : array of shape (nodes, points)
        Squares of speed [m2/s2] and cost to go [J].
    price : float
        Cost of a second [J/s].
    narrowings : int
        Steps of the golden section; 0 for the best of the controls and grid points alone.
    """
    nodes = grid.shape[0]
    speed2 = np.full(nodes, -1.0)
    speed2[0] = grid[0, 0]
    train, traction, braking, drive = shared_by_cells(course)
    for i in range(nodes - 1):
        speed2[i + 1] = best_exit(
            cell_of(course, i),
            train,
            traction,
            braking,
            drive,
            speed2[i],
            grid[i + 1],
            cost_j[i + 1],
            price,
            narrowings,
        )
        if speed2[i + 1] < 0.0:
            break
    return speed2
