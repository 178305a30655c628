"""Backward induction over speeds and labels, and the run that it asks for.

    cost(i, w, label) = min over steps of  energy + price time + cost(i + 1, w', label')                        (8)

Source: Liashenko, Yatsko 2025, (2) and (5)-(9), made exact. The cost to go is linear in the square of speed between
grid points. Forward, a run goes in each cell to the speed that is cheapest with the cost to go from there, with exact
dynamics.
"""

import math

import numpy as np

from railjoule.core.arrays import FloatArray, IntArray
from railjoule.core.compiled import njit
from railjoule.core.dynamic_programming.grid import grid_range, place_in_row
from railjoule.core.dynamic_programming.labels import Labels
from railjoule.core.dynamic_programming.steps import (
    BRAKE,
    REGIMES,
    ROLL,
    Steps,
    exit_of_control,
    reachable_range,
    step_cost,
)
from railjoule.core.golden_section import Bracket, inner_points, min_point, narrowed, next_point
from railjoule.core.physics.cell import Cell
from railjoule.core.physics.mesh_data import MeshData, TrainLimits, cell_at, limits_at, shared_by_cells

# a grid point this close to the best speed squared, relatively, is the best one itself: its neighbours bracket it
SAME_POINT = 1e-9


@njit(cache=True, error_model="numpy")
def _between(rows: FloatArray, lower: int, weight: float, label: int) -> float:
    """Return a value between a point, at a weight of 0, and the next, at 1; infinite if either is and counts."""
    below: float = rows[lower, label]
    above: float = rows[lower + 1, label]
    # 0 x infinity is no number: a point itself does not depend on its neighbour
    if weight <= 0.0:
        return below
    if weight >= 1.0:
        return above
    return below + weight * (above - below) if max(below, above) < math.inf else math.inf


@njit(cache=True, error_model="numpy", nogil=True)
def sweep_back(
    steps: Steps, grid: FloatArray, price: float, labels: Labels, keeps_cost: bool
) -> tuple[FloatArray, IntArray, float]:
    """Return the least cost to go (8), the step that has it, and the time of the whole run.

    Parameters
    ----------
    steps : Steps
        As tabulated.
    grid : array of shape (nodes, points)
        Squares of speed [m2/s2].
    price : float
        Cost of a second, auxiliaries included [J/s]: lambda of (9).
    labels : Labels
        Of the states.
    keeps_cost : bool
        Whether the cost of all nodes is wanted, or that of the first one only.

    Returns
    -------
    cost_j : array of shape (nodes, points, labels), or (2, points, labels)
        Infinite where the end cannot be reached.
    best : array of shape (nodes - 1, points, labels)
        Number of the best step; -1 where there is none.
    time_s : float
        From the start to the end by the best steps, linear between grid points as the cost is.
    """
    nodes, points = grid.shape
    _, count, actions = labels.moves.shape
    size, rows = count // actions, nodes if keeps_cost else 2
    best = np.full((nodes - 1, points, count), -1, dtype=np.int32)
    cost, time = np.zeros((rows, points, count)), np.zeros((2, points, count))
    least, chosen = np.empty(count), np.empty(count, dtype=np.int64)
    for i in range(nodes - 2, -1, -1):
        here, onward, time_here, time_onward = cost[i % rows], cost[(i + 1) % rows], time[i % 2], time[(i + 1) % 2]
        moves, used, used_before = labels.moves[i], labels.used[i], labels.used[max(i - 1, 0)]
        here[:] = math.inf
        for k in range(points):
            # only the first of equal points has steps
            if k > 0 and grid[i, k] == grid[i, k - 1]:
                here[k], best[i, k], time_here[k] = here[k - 1], best[i, k - 1], time_here[k - 1]
                continue
            least[:] = math.inf
            for step in range(steps.first[i, k], steps.first[i, k + 1]):
                if steps.energy_j[step] == math.inf:
                    continue
                spent, first = steps.energy_j[step] + price * steps.time_s[step], size * steps.action[step]
                for label in range(first, first + used):
                    total = spent + _between(onward, steps.lower[step], steps.weight[step], label)
                    if total < least[label]:
                        least[label], chosen[label] = total, step
            for label in range(count):
                # the cell before leads to no other labels
                if label % size >= used_before:
                    continue
                for action in range(actions):
                    after = moves[label, action]
                    if after >= 0 and least[after] < here[k, label]:
                        here[k, label], step = least[after], chosen[after]
                        best[i, k, label] = step
                        ahead = _between(time_onward, steps.lower[step], steps.weight[step], after)
                        time_here[k, label] = steps.time_s[step] + ahead
    return cost, best, time[0, 0, 0]


@njit(cache=True, error_model="numpy")
def _total_cost(
    limits: TrainLimits,
    cell: Cell,
    entering_speed2: float,
    leaving_speed2: float,
    row: FloatArray,
    cost: FloatArray,
    label: int,
    price: float,
) -> float:
    """Return cost of a step and cost to go after it with a label [J]; infinite where the step is not allowed."""
    lower, weight = place_in_row(row, leaving_speed2)
    if lower < 0:
        return math.inf
    onward = _between(cost, lower, weight, label)
    if onward == math.inf:
        return math.inf
    energy, time, allowed = step_cost(limits, cell, entering_speed2, leaving_speed2)
    return energy + price * time + onward if allowed else math.inf


@njit(cache=True, error_model="numpy")
def _best_exit(
    limits: TrainLimits,
    cell: Cell,
    entering_speed2: float,
    row: FloatArray,
    cost: FloatArray,
    price: float,
    moves: IntArray,
    narrowings: int,
) -> tuple[float, int]:
    """Return the square of speed [m2/s2] at the end of a cell with the least cost, and its action; (-1, -1) if none.

    The best of full traction, holding, coasting, full braking and the grid points, then the best between the grid
    points around it by golden section: there the cost to go is linear.
    """
    best2, chosen, best = -1.0, -1, math.inf
    low, top = reachable_range(limits, cell, entering_speed2, row)
    if low > top:
        return best2, chosen
    by_regime, fastest = moves.shape[0] == REGIMES, math.inf
    if by_regime:
        # a step that ends faster than coasting does is no braking
        fastest = exit_of_control(limits, cell, entering_speed2, low, top, ROLL)
    start, end = grid_range(row, low, min(top, fastest))
    for choice in range(REGIMES + max(end - start, 0)):
        action = min(choice, BRAKE) if by_regime else 0
        if choice < REGIMES:
            leaving_speed2 = exit_of_control(limits, cell, entering_speed2, low, top, choice)
        else:
            leaving_speed2 = row[start + choice - REGIMES]
        if moves[action] < 0 or not low <= leaving_speed2 <= top or (action == BRAKE and leaving_speed2 > fastest):
            continue
        value = _total_cost(limits, cell, entering_speed2, leaving_speed2, row, cost, moves[action], price)
        if value < best:
            best2, chosen, best = leaving_speed2, action, value
    if best == math.inf or low == top or narrowings == 0:
        return best2, chosen
    label, (below, above) = moves[chosen], grid_range(row, best2 * (1.0 - SAME_POINT), best2 * (1.0 + SAME_POINT))
    left = max(low, row[below - 1]) if below > 0 else low
    right = min(top, row[above]) if above < row.shape[0] else top
    inner_left, inner_right = inner_points(left, right)
    at_left = _total_cost(limits, cell, entering_speed2, inner_left, row, cost, label, price)
    at_right = _total_cost(limits, cell, entering_speed2, inner_right, row, cost, label, price)
    bracket = Bracket(left, inner_left, inner_right, right, at_left, at_right)
    for _ in range(narrowings):
        value = _total_cost(limits, cell, entering_speed2, next_point(bracket), row, cost, label, price)
        bracket = narrowed(bracket, value)
    # the bracket may hold a kink at the grid point with a second valley beside it: only what is better counts
    return min_point(bracket) if min(bracket.value_left, bracket.value_right) < best else best2, chosen


@njit(cache=True, error_model="numpy", nogil=True)
def roll_out(
    mesh: MeshData, grid: FloatArray, cost_j: FloatArray, price: float, labels: Labels, narrowings: int
) -> tuple[FloatArray, IntArray]:
    """Return the run that follows a cost to go, with exact dynamics from cell to cell.

    Parameters
    ----------
    mesh : MeshData
        The line and the train.
    grid, price, labels
        As for `sweep_back`.
    cost_j : array of shape (nodes, points, labels)
        As that returns it.
    narrowings : int
        Steps of the golden section; 0 for the best of the controls and grid points only.

    Returns
    -------
    speed2 : array of shape (nodes,)
        Squares of speed [m2/s2]; -1 from where the run cannot go on.
    actions : array of shape (nodes - 1,)
        The action in each cell; -1 from there.
    """
    nodes = grid.shape[0]
    shared = shared_by_cells(mesh)
    speed2, actions, label = np.full(nodes, -1.0), np.full(nodes - 1, -1), 0
    speed2[0] = grid[0, 0]
    for i in range(nodes - 1):
        moves = labels.moves[i, label]
        leaving_speed2, action = _best_exit(
            limits_at(shared, i),
            cell_at(mesh, i),
            speed2[i],
            grid[i + 1],
            cost_j[i + 1],
            price,
            moves,
            narrowings,
        )
        if action < 0:
            break
        speed2[i + 1], actions[i], label = leaving_speed2, action, moves[action]
    return speed2, actions
