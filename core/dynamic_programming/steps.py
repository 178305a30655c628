"""The steps of backward induction: all ways from each grid point through one cell, with their energies and times.

Besides the grid points of the next node, a step may end where full traction, holding the speed, coasting or full
braking leads, between two grid points. Energy and time of a step do not depend on the price of time, so they are
tabulated once for all prices.
"""

import math
from typing import NamedTuple

import numpy as np

from railjoule.core.arrays import FloatArray, IntArray
from railjoule.core.compiled import njit
from railjoule.core.dynamic_programming.grid import exit_under, grid_range, place_in_row
from railjoule.core.dynamic_programming.power_table import PowerTable, tabulated_cost
from railjoule.core.motion.cell_step import COAST, FULL_BRAKE, FULL_TRACTION, cell_cost
from railjoule.core.physics.cell import Cell
from railjoule.core.physics.mesh_data import MeshData, TrainLimits, cell_at, limits_at, shared_by_cells

REGIMES = 4
POWER, HOLD, ROLL, BRAKE = range(REGIMES)
"""The controls beside the grid, first of the steps of a state, and the regimes that a driver is advised."""
# the fixed point of an exit speed ends at 1e-13 of it, where it converges fast
ROUNDING = 1e-10
"""By how much full braking may miss the greatest speed of the grid on the steepest braking curve, relatively."""


class Steps(NamedTuple):
    """All steps from all grid points, state by state; s steps in all.

    Step `j` of the state `k` at node `i` is `first[i, k] + j`; it leads between the points `lower` and `lower + 1` of
    the next node, at `weight` between the one, 0, and the other, 1, in the square of speed. Steps that are not
    allowed have infinite energy. `action` is a regime, or what a table of powers gives, else 0.
    """

    first: IntArray
    lower: IntArray
    weight: FloatArray
    energy_j: FloatArray
    time_s: FloatArray
    leaving_speed2: FloatArray
    action: IntArray


@njit(cache=True, error_model="numpy")
def step_cost(
    limits: TrainLimits, cell: Cell, entering_speed2: float, leaving_speed2: float
) -> tuple[float, float, bool]:
    """Return line energy of a step without auxiliaries [J], its time [s], and whether the limits of effort allow it."""
    train, traction, braking, drive = limits
    return cell_cost(cell, train, traction, braking, drive, entering_speed2, leaving_speed2)


@njit(cache=True, error_model="numpy")
def reachable_range(limits: TrainLimits, cell: Cell, entering_speed2: float, row: FloatArray) -> tuple[float, float]:
    """Return the least and the greatest square of speed at the end of a cell that the grid of its end holds.

    The first is greater than the second where there is none.
    """
    greatest = row[row.shape[0] - 1]
    top = min(exit_under(limits, cell, entering_speed2, FULL_TRACTION), greatest)
    low = max(exit_under(limits, cell, entering_speed2, FULL_BRAKE), row[0])
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
def exit_of_control(
    limits: TrainLimits, cell: Cell, entering_speed2: float, low: float, top: float, control: int
) -> float:
    """Return the square of speed [m2/s2] to which full power, holding, coasting or full braking leads."""
    if control == POWER:
        return top
    if control == HOLD:
        return entering_speed2
    return exit_under(limits, cell, entering_speed2, COAST) if control == ROLL else low


@njit(cache=True, error_model="numpy", nogil=True)
def tabulate_steps(mesh: MeshData, grid: FloatArray, table: PowerTable, by_regime: bool) -> Steps:
    """Return all steps between the grid points of neighbouring nodes, and those of the controls beside them.

    Parameters
    ----------
    mesh : MeshData
        The line and the train.
    grid : array of shape (nodes, points)
        Squares of speed, rising at each node [m2/s2].
    table : PowerTable
        Table that prices the steps and gives their actions; if it is empty, each step has an account of its own.
    by_regime : bool
        Whether actions are regimes: then steps to grid points brake, and no step that ends faster than coasting does.
    """
    nodes, points = grid.shape
    shared = shared_by_cells(mesh)
    # the steps of all states stand in one array: how many there are has to be counted first
    first = np.zeros((nodes - 1, points + 1), dtype=np.int64)
    span = np.empty((nodes - 1, points, 2))
    total = 0
    for i in range(nodes - 1):
        cell, row, limits = cell_at(mesh, i), grid[i + 1], limits_at(shared, i)
        for k in range(points):
            first[i, k] = total
            # equal points, as all of a node with a fixed speed are, have the steps of the first of them
            if k > 0 and grid[i, k] == grid[i, k - 1]:
                continue
            span[i, k] = reachable_range(limits, cell, grid[i, k], row)
            if span[i, k, 0] <= span[i, k, 1]:
                start, end = grid_range(row, span[i, k, 0], span[i, k, 1])
                total += REGIMES + max(end - start, 0)
        first[i, points] = total
    energy, time, exits = np.full(total, np.inf), np.empty(total), np.empty(total)
    lower, weight = np.empty(total, dtype=np.int64), np.empty(total)
    action, is_exact = np.zeros(total, dtype=np.int64), table.loss_w.shape[1] == 0
    for i in range(nodes - 1):
        cell, row, limits = cell_at(mesh, i), grid[i + 1], limits_at(shared, i)
        for k in range(points):
            (low, top), coasted = span[i, k], math.inf
            if by_regime and first[i, k] < first[i, k + 1]:
                coasted = exit_of_control(limits, cell, grid[i, k], low, top, ROLL)
            start = int(np.searchsorted(row, low))
            for step in range(first[i, k], first[i, k + 1]):
                control = step - first[i, k]
                if control >= REGIMES:
                    point = start + control - REGIMES
                    leaving_speed2 = row[point]
                    lower[step], weight[step] = (point, 0.0) if point < points - 1 else (point - 1, 1.0)
                else:
                    leaving_speed2 = exit_of_control(limits, cell, grid[i, k], low, top, control)
                    if not low <= leaving_speed2 <= top:
                        continue
                    lower[step], weight[step] = place_in_row(row, leaving_speed2)
                if is_exact:
                    joules, seconds, allowed = step_cost(limits, cell, grid[i, k], leaving_speed2)
                else:
                    # between full braking and full power no step breaks a limit, but one from rest to rest never ends
                    joules, seconds, action[step] = tabulated_cost(table, cell, grid[i, k], leaving_speed2)
                    allowed = seconds < np.inf
                if by_regime:
                    action[step] = min(control, BRAKE)
                    allowed = allowed and (control < BRAKE or leaving_speed2 <= coasted)
                if allowed and lower[step] >= 0:
                    energy[step], time[step], exits[step] = joules, seconds, leaving_speed2
    return Steps(first, lower, weight, energy, time, exits, action)
