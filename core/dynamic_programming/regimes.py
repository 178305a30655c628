"""Runs that change their regime seldom: backward induction whose state also holds the regime and the changes left.

A driver who is advised wants few orders. So a cell is driven in one of four regimes: full power, a speed that is held,
coasting, braking; and between two stops the regime changes at most a given number of times. The state is the square
of speed, the regime and the number of changes left:

    V(i, c, r, w) = min over r' of  cost(i, r', w) + V(i + 1, c', r', w'),    c' = c if r' = r, else c - 1

A train that leaves a stop has all its changes again, and its first regime is none of them. Steps and their costs are
those of `backward`; of its steps from a state, three are those of power, holding and coasting, and all that end slower
than coasting does are braking.
"""

import math

import numpy as np

from railjoule.core.arrays import FloatArray, IntArray
from railjoule.core.compiled import njit
from railjoule.core.dynamic_programming.backward import (
    COASTING,
    CONTROLS_BESIDE_GRID,
    FULL_BRAKING,
    FULL_POWER,
    HOLDING,
    ROUNDING,
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
from railjoule.core.motion.cell_step import COAST, FULL_BRAKE, FULL_TRACTION, exit_speed2
from railjoule.core.physics.cell import Cell
from railjoule.core.physics.course_data import CourseData, cell_of

REGIMES = 4
POWER, HOLD, ROLL, BRAKE = range(REGIMES)
NO_REGIME = -1
"""Before the first cell, and at a stop."""


@njit(cache=True, error_model="numpy")
def _own_step(regime: int) -> int:
    """Return the number of the step of a regime among those beside the grid; -1 for braking, which has many."""
    if regime == POWER:
        return FULL_POWER
    if regime == HOLD:
        return HOLDING
    return COASTING if regime == ROLL else -1


@njit(cache=True, error_model="numpy")
def _coasted_speed2(limits: TrainLimits, cell: Cell, entering_speed2: float) -> float:
    return exit_speed2(cell, limits.train, limits.traction, limits.braking, entering_speed2, COAST)


@njit(cache=True, error_model="numpy", nogil=True)
def sweep_back_regimes(course: CourseData, steps: Steps, grid: FloatArray, price: float, changes: int) -> FloatArray:
    """Return the least cost to go [J]; infinite where the end cannot be reached.

    Parameters
    ----------
    course : CourseData
        What the run obeys.
    steps : Steps
        As tabulated over the grid.
    grid : array of shape (nodes, points)
        Squares of speed [m2/s2].
    price : float
        Cost of a second [J/s].
    changes : int
        How often the regime may change between two stops.

    Returns
    -------
    array of shape (nodes, changes + 1, 4, points)
        By node, changes left, regime of the cell before, and speed.
    """
    nodes, points = grid.shape
    limits = limits_of(course)
    cost = np.full((nodes, changes + 1, REGIMES, points), np.inf)
    cost[nodes - 1] = 0.0
    driven = np.empty((changes + 1, REGIMES))
    for i in range(nodes - 2, -1, -1):
        cell = cell_of(course, i)
        stop = course.fixed_speed2[i] == 0.0
        for k in range(points):
            if k > 0 and grid[i, k] == grid[i, k - 1]:
                cost[i, :, :, k] = cost[i, :, :, k - 1]
                continue
            coasted = _coasted_speed2(limits, cell, grid[i, k])
            _drive_state(steps, cost[i + 1], price, steps.first[i, k], steps.first[i, k + 1], coasted, driven)
            for left in range(changes + 1):
                cheapest = driven[changes].min() if stop else math.inf
                if left > 0 and not stop:
                    cheapest = driven[left - 1].min()
                for regime in range(REGIMES):
                    cost[i, left, regime, k] = cheapest if stop else min(cheapest, driven[left, regime])
    return cost


@njit(cache=True, error_model="numpy")
def _drive_state(
    steps: Steps, onward: FloatArray, price: float, first: int, end: int, coasted: float, driven: FloatArray
) -> None:
    """Write the least cost of a cell and of what follows, by the changes left and the regime of the cell."""
    driven[:] = np.inf
    if end == first:
        return
    for regime in (POWER, HOLD, ROLL):
        _drive_step(steps, onward, price, first + _own_step(regime), regime, driven)
    _drive_step(steps, onward, price, first + FULL_BRAKING, BRAKE, driven)
    for step in range(first + CONTROLS_BESIDE_GRID, end):
        # points of the grid rise: what ends faster than coasting is no braking
        if steps.leaving_speed2[step] > coasted:
            break
        _drive_step(steps, onward, price, step, BRAKE, driven)


@njit(cache=True, error_model="numpy")
def _drive_step(steps: Steps, onward: FloatArray, price: float, step: int, regime: int, driven: FloatArray) -> None:
    """Lower the least costs of a regime to those of one of its steps."""
    if steps.energy_j[step] == math.inf:
        return
    here = steps.energy_j[step] + price * steps.time_s[step]
    for left in range(driven.shape[0]):
        total = here + cost_between(onward[left, regime], steps.lower[step], steps.weight[step])
        driven[left, regime] = min(driven[left, regime], total)


@njit(cache=True, error_model="numpy", nogil=True)
def roll_out_regimes(
    course: CourseData, grid: FloatArray, cost_j: FloatArray, price: float, changes: int
) -> tuple[FloatArray, IntArray]:
    """Return the run that follows a cost to go, with exact dynamics from cell to cell.

    Parameters
    ----------
    course, grid, price, changes
        As `sweep_back_regimes`.
    cost_j : array of shape (nodes, changes + 1, 4, points)
        As that returns it.

    Returns
    -------
    speed2 : array of shape (nodes,)
        Squares of speed [m2/s2]; -1 from where the run cannot go on.
    regimes : array of shape (nodes - 1,)
        What each cell is driven in; -1 from there.
    """
    nodes = grid.shape[0]
    limits = limits_of(course)
    speed2, regimes = np.full(nodes, -1.0), np.full(nodes - 1, NO_REGIME)
    speed2[0] = grid[0, 0]
    regime, left = NO_REGIME, changes
    for i in range(nodes - 1):
        if course.fixed_speed2[i] == 0.0:
            regime, left = NO_REGIME, changes
        cell, row, onward = cell_of(course, i), grid[i + 1], cost_j[i + 1]
        leaving, chosen = _best_regime(limits, cell, speed2[i], row, onward, price, regime, left)
        if chosen < 0:
            break
        if regime not in (NO_REGIME, chosen):
            left -= 1
        regime, regimes[i], speed2[i + 1] = chosen, chosen, leaving
    return speed2, regimes


@njit(cache=True, error_model="numpy", nogil=True)
def drive_regimes(
    course: CourseData,
    greatest_speed2: FloatArray,
    planned2: FloatArray,
    regimes: IntArray,
    cell_number: int,
    share: float,
) -> FloatArray:
    """Return the run of given regimes, one cell of which is driven in two.

    It keeps below the greatest speeds, which end in full braking, and brakes for the planned speeds where it is to
    brake. The one cell mixes its regime, up to a share of its length, with that of the next cell.

    Parameters
    ----------
    course : CourseData
        What the run obeys.
    greatest_speed2, planned2 : array of shape (nodes,)
        Greatest feasible squares of speed, and those of the run whose brakes are taken over [m2/s2].
    regimes : array of shape (nodes - 1,)
        What each cell is driven in.
    cell_number, share : int and float
        The cell that is driven in two regimes, and the share of its own one.

    Returns
    -------
    array of shape (nodes,)
        Squares of speed [m2/s2]; -1 from where the train comes to a stand or cannot keep below the greatest.
    """
    nodes = planned2.shape[0]
    limits = limits_of(course)
    speed2 = np.full(nodes, -1.0)
    speed2[0] = planned2[0]
    for i in range(nodes - 1):
        cell, entering = cell_of(course, i), speed2[i]
        leaving = _exit_of_regime(limits, cell, entering, regimes[i], planned2[i + 1])
        if i == cell_number and i + 1 < nodes - 1:
            other = _exit_of_regime(limits, cell, entering, regimes[i + 1], planned2[i + 1])
            leaving = share * leaving + (1.0 - share) * other
        least = exit_speed2(cell, limits.train, limits.traction, limits.braking, entering, FULL_BRAKE)
        if regimes[i] == BRAKE:
            # who comes faster than planned brakes fully until the plan is met
            leaving = max(leaving, least)
        leaving = min(leaving, greatest_speed2[i + 1])
        fixed = course.fixed_speed2[i + 1]
        if fixed >= 0.0 and leaving >= fixed * (1.0 - ROUNDING):
            leaving = fixed
        stands = leaving <= 0.0 and fixed != 0.0
        if stands or leaving < least - ROUNDING * greatest_speed2.max() or (fixed >= 0.0 and leaving != fixed):
            break
        speed2[i + 1] = leaving
    return speed2


@njit(cache=True, error_model="numpy")
def _exit_of_regime(limits: TrainLimits, cell: Cell, entering_speed2: float, regime: int, planned2: float) -> float:
    """Return the square of speed to which a regime leads, braking no further than to a planned one [m2/s2]."""
    if regime == HOLD:
        # what full power does not hold is no speed that is held
        top = exit_speed2(cell, limits.train, limits.traction, limits.braking, entering_speed2, FULL_TRACTION)
        return min(entering_speed2, top)
    if regime == POWER:
        return exit_speed2(cell, limits.train, limits.traction, limits.braking, entering_speed2, FULL_TRACTION)
    coasted = _coasted_speed2(limits, cell, entering_speed2)
    return min(coasted, planned2) if regime == BRAKE else coasted


@njit(cache=True, error_model="numpy")
def _best_regime(
    limits: TrainLimits,
    cell: Cell,
    entering_speed2: float,
    row: FloatArray,
    onward: FloatArray,
    price: float,
    regime: int,
    left: int,
) -> tuple[float, int]:
    """Return the square of speed at the end of a cell and its regime; -1 where there is no way on."""
    best2, chosen, least = -1.0, -1, math.inf
    low, top = reachable_range(limits, cell, entering_speed2, row)
    if low > top:
        return best2, chosen
    coasted = _coasted_speed2(limits, cell, entering_speed2)
    start, end = grid_range(row, low, min(top, coasted))
    for other in range(REGIMES):
        remaining = left if regime in (NO_REGIME, other) else left - 1
        if remaining < 0:
            continue
        count = 1 + max(end - start, 0) if other == BRAKE else 1
        for choice in range(count):
            if other != BRAKE:
                leaving = exit_of_control(limits, cell, entering_speed2, low, top, _own_step(other))
            else:
                leaving = low if choice == 0 else row[start + choice - 1]
            if not low <= leaving <= top or (other == BRAKE and leaving > coasted):
                continue
            lower, weight = place_in_row(row, leaving)
            if lower < 0:
                continue
            ahead = cost_between(onward[remaining, other], lower, weight)
            if ahead == math.inf:
                continue
            energy, time, allowed = step_cost(limits, cell, entering_speed2, leaving)
            total = energy + price * time + ahead
            if allowed and total < least:
                best2, chosen, least = leaving, other, total
    return best2, chosen
