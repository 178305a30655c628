"""Grids of speeds over the nodes of a meshed line, as squares of speed [m2/s2].

The grid of each node ends at the greatest speed that a train can have there. The cost to go is linear in the square of
speed between grid points: that is kinetic energy but for a factor, and a train saves later the energy that it carries.
"""

import math

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.motion.cell_step import COAST, FULL_TRACTION, exit_speed2
from railjoule.core.physics.cell import Cell
from railjoule.core.physics.mesh_data import MeshData, TrainLimits, cell_at, limits_at, shared_by_cells

# Beyond the last point there may be no run, and a cost to go between that point and an infinite one would be infinite
ON_GRID = 1e-9
"""A square of speed this close to a grid point, relatively, is that point."""
# A quarter of the first grid's step between speeds, 1 / 24. Slower runs are not found. Half or double of it moves
# drives with idle losses between local optima by -520 to +370 millionths of their energy, and is no better or worse
# over 13 shipped scenarios (mean -27 and +46)
SLOWEST_SHARE = 1 / 96
"""The least speed of a grid over the greatest one."""
# a bisection of doubles has come to neighbouring numbers after 53 halvings
HALVINGS = 60


@njit(cache=True, error_model="numpy")
def exit_under(limits: TrainLimits, cell: Cell, entering_speed2: float, control: int) -> float:
    """Return the square of speed [m2/s2] to which a control of `motion.cell_step` leads; negative after a stand."""
    return exit_speed2(cell, limits.train, limits.traction, limits.braking, entering_speed2, control)


@njit(cache=True, error_model="numpy")
def min_speeds(mesh: MeshData, fastest_speed2: FloatArray) -> FloatArray:
    """Return the least squares of speed [m2/s2] of a grid: from all of them, full traction leads on; shape (nodes,).

    Uphill a train may need its momentum: slower than this it comes to a stand, or falls below the least speed ahead.
    Elsewhere they are a small share of the greatest ones, as nothing can start from rest between stops.
    """
    last = fastest_speed2.shape[0] - 1
    shared = shared_by_cells(mesh)
    least = np.where(mesh.fixed_speed2 >= 0.0, mesh.fixed_speed2, fastest_speed2 * SLOWEST_SHARE**2)
    for i in range(last - 1, -1, -1):
        cell, limits = cell_at(mesh, i), limits_at(shared, i)
        if mesh.fixed_speed2[i] >= 0.0 or exit_under(limits, cell, least[i], FULL_TRACTION) >= least[i + 1]:
            continue
        low, high = least[i], fastest_speed2[i]
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            if exit_under(limits, cell, middle, FULL_TRACTION) >= least[i + 1]:
                high = middle
            else:
                low = middle
        least[i] = high
    return least


@njit(cache=True, error_model="numpy")
def speed_band(
    mesh: MeshData, fastest_speed2: FloatArray, centre_speed2: FloatArray, half_width_ms: float, points: int
) -> FloatArray:
    """Return a grid whose speeds are evenly spaced within a band around a run, and hold its upper end.

    A node with a fixed speed has it in all its points. In neutral sections the points are the speeds to which the
    points before them coast.

    Parameters
    ----------
    mesh : MeshData
        The line and the train.
    fastest_speed2, centre_speed2 : array of shape (nodes,)
        Greatest feasible squares of speed, and those in the middle of the band [m2/s2].
    half_width_ms : float
        Half of the width of the band [m/s].
    points : int
        Number of speeds of each node.

    Returns
    -------
    array of shape (nodes, points)
        Squares of speed, rising at each node.
    """
    nodes, min_speed2 = fastest_speed2.shape[0], min_speeds(mesh, fastest_speed2)
    grid = np.empty((nodes, points))
    for i in range(nodes):
        if mesh.fixed_speed2[i] >= 0.0:
            grid[i] = mesh.fixed_speed2[i]
            continue
        centre, greatest, least = math.sqrt(centre_speed2[i]), math.sqrt(fastest_speed2[i]), math.sqrt(min_speed2[i])
        high = max(min(greatest, centre + half_width_ms), least)
        low = max(least, min(centre, high) - half_width_ms)
        # counted from the upper end, which the fastest run needs to the last digit
        for k in range(points):
            speed = high - (high - low) * (points - 1 - k) / (points - 1)
            grid[i, k] = speed * speed
        if high == greatest:
            grid[i, points - 1] = fastest_speed2[i]
    _align_with_coasting(mesh, fastest_speed2, grid)
    return grid


@njit(cache=True, error_model="numpy")
def _align_with_coasting(mesh: MeshData, fastest_speed2: FloatArray, grid: FloatArray) -> None:
    """Move the points of a grid in neutral sections to where the points before them coast, in place."""
    # Between two points the cost to go is infinite if it is at one of them, as at the edge of a band, beyond which no
    # state is known. A train that only coasts cannot steer clear of it, and each cell would take another point
    limits, last = shared_by_cells(mesh).own, grid.shape[1] - 1
    for i in range(grid.shape[0] - 1):
        if mesh.supply_share[i] >= 1.0 or mesh.fixed_speed2[i] >= 0.0 or mesh.fixed_speed2[i + 1] >= 0.0:
            continue
        cell, greatest = cell_at(mesh, i), fastest_speed2[i + 1]
        top = exit_under(limits, cell, grid[i, last], COAST)
        # where it has to brake instead, the points stay
        if top > greatest * (1.0 + ON_GRID) or exit_under(limits, cell, grid[i, 0], COAST) <= 0.0:
            continue
        for k in range(last + 1):
            grid[i + 1, k] = min(exit_under(limits, cell, grid[i, k], COAST), greatest)


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
def grid_range(row: FloatArray, low: float, top: float) -> tuple[int, int]:
    """Return the first grid point not below `low` and the one after the last not above `top`."""
    return int(np.searchsorted(row, low)), int(np.searchsorted(row, top, side="right"))
