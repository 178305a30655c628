"""Forward again: the run that the cost to go asks for, with exact dynamics from cell to cell."""

import math

import numpy as np

from railjoule.core.arrays import FloatArray, IntArray
from railjoule.core.compiled import njit
from railjoule.core.dynamic_programming.backward import (
    CONTROLS_BESIDE_GRID,
    Steps,
    TrainLimits,
    cost_between,
    exit_of_control,
    grid_range,
    limits_of,
    place_in_row,
    reachable_range,
    step_cost,
)
from railjoule.core.golden_section import Bracket, inner_points, lowest_point, narrowed, next_point
from railjoule.core.physics.cell import Cell
from railjoule.core.physics.course_data import CourseData, cell_of

# a grid point this close to the best speed squared, relatively, is the best one itself: its neighbours bracket it
SAME_POINT = 1e-9


@njit(cache=True, error_model="numpy")
def total_cost(
    limits: TrainLimits,
    cell: Cell,
    entering_speed2: float,
    leaving_speed2: float,
    row: FloatArray,
    cost: FloatArray,
    price: float,
) -> float:
    """Return cost of a step and cost to go after it [J]; infinite where the step is not allowed."""
    lower, weight = place_in_row(row, leaving_speed2)
    if lower < 0:
        return math.inf
    onward = cost_between(cost, lower, weight)
    if onward == math.inf:
        return math.inf
    energy, time, allowed = step_cost(limits, cell, entering_speed2, leaving_speed2)
    return energy + price * time + onward if allowed else math.inf


@njit(cache=True, error_model="numpy")
def best_exit(
    limits: TrainLimits,
    cell: Cell,
    entering_speed2: float,
    row: FloatArray,
    cost: FloatArray,
    price: float,
    narrowings: int,
    least_point: int,
    most_point: int,
) -> float:
    """Return the square of speed [m2/s2] at the end of a cell with the least cost; negative where there is none.

    The best of full traction, coasting, holding, full braking and the grid points from the least to the most, then
    the best between the grid points around it by golden section: there the cost to go is linear.
    """
    low, top = reachable_range(limits, cell, entering_speed2, row)
    if low > top:
        return -1.0
    start, end = grid_range(row, low, top)
    start, end = max(start, least_point), min(end, most_point + 1)
    best2, best = -1.0, math.inf
    for choice in range(CONTROLS_BESIDE_GRID + max(end - start, 0)):
        if choice < CONTROLS_BESIDE_GRID:
            leaving_speed2 = exit_of_control(limits, cell, entering_speed2, low, top, choice)
        else:
            leaving_speed2 = row[start + choice - CONTROLS_BESIDE_GRID]
        if low <= leaving_speed2 <= top:
            value = total_cost(limits, cell, entering_speed2, leaving_speed2, row, cost, price)
            if value < best:
                best2, best = leaving_speed2, value
    if best == math.inf or low == top or narrowings == 0:
        return best2
    below, above = grid_range(row, best2 * (1.0 - SAME_POINT), best2 * (1.0 + SAME_POINT))
    left = max(low, row[below - 1]) if below > 0 else low
    right = min(top, row[above]) if above < row.shape[0] else top
    inner_left, inner_right = inner_points(left, right)
    at_left = total_cost(limits, cell, entering_speed2, inner_left, row, cost, price)
    at_right = total_cost(limits, cell, entering_speed2, inner_right, row, cost, price)
    bracket = Bracket(left, inner_left, inner_right, right, at_left, at_right)
    for _ in range(narrowings):
        value = total_cost(limits, cell, entering_speed2, next_point(bracket), row, cost, price)
        bracket = narrowed(bracket, value)
    # the bracket may hold a kink at the grid point with a second valley beside it: only what is better counts
    return lowest_point(bracket) if min(bracket.value_left, bracket.value_right) < best else best2


@njit(cache=True, error_model="numpy")
def likely_points(steps: Steps, best: IntArray, row: FloatArray, entering_speed2: float) -> tuple[int, int]:
    """Return the first and the last point of the next row between which the best exit from a speed is looked for.

    They enclose, with a point more to each side, where the best steps of the two points around the speed lead.

    Parameters
    ----------
    steps : Steps
        All of the grid.
    best : array of shape (points,)
        Numbers of the best steps from a node; -1 where there is none.
    row : array of shape (points,)
        Squares of speed of that node [m2/s2].
    entering_speed2 : float
        Square of speed at the node [m2/s2].
    """
    points = row.shape[0]
    lower, _ = place_in_row(row, entering_speed2)
    if lower < 0 or best[lower] < 0 or best[lower + 1] < 0:
        return 0, points - 1
    one, other = steps.lower[best[lower]], steps.lower[best[lower + 1]]
    return max(min(one, other) - 1, 0), min(max(one, other) + 2, points - 1)


@njit(cache=True, error_model="numpy", nogil=True)
def roll_out(
    course: CourseData,
    grid: FloatArray,
    steps: Steps,
    cost_j: FloatArray,
    best: IntArray,
    price: float,
    narrowings: int,
) -> FloatArray:
    """Return the squares of speed [m2/s2] of the run that follows a cost to go; -1 from where it cannot go on.

    Parameters
    ----------
    course : CourseData
        What the run obeys.
    grid, cost_j : array of shape (nodes, points)
        Squares of speed [m2/s2] and cost to go [J].
    steps : Steps
        As tabulated over the grid.
    best : array of shape (nodes - 1, points)
        Numbers of the best steps.
    price : float
        Cost of a second [J/s].
    narrowings : int
        Steps of the golden section; 0 for the best of the controls and grid points alone.
    """
    nodes, points = grid.shape
    speed2 = np.full(nodes, -1.0)
    speed2[0] = grid[0, 0]
    limits = limits_of(course)
    for i in range(nodes - 1):
        cell, entering, row, cost = cell_of(course, i), speed2[i], grid[i + 1], cost_j[i + 1]
        least, most = likely_points(steps, best[i], grid[i], entering)
        leaving = best_exit(limits, cell, entering, row, cost, price, narrowings, least, most)
        if leaving < 0.0 and (least > 0 or most < points - 1):
            # what can be reached from between two points need not lie near where they lead
            leaving = best_exit(limits, cell, entering, row, cost, price, narrowings, 0, points - 1)
        speed2[i + 1] = leaving
        if leaving < 0.0:
            break
    return speed2
