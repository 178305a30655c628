"""Prices for the chains: of the squares of speed at the nodes, from the multipliers of an optimum.

A multiplier is the price at the optimum's own speed. In an interval far from it that price may be an arbitrage: more
than driving costs there, or less than braking returns, so that chains drive and jump down, or jump up and brake. With K
half the inertia, a tractive effort x changes K w by x over a metre for the energy P / v, and braking likewise, so that
neither pays while K w is worth between

    lo(v) = r max over x of generated(x, v) / (x v)    and    hi(v) = min over x of P(x, v) / (x v).

Each interval's price is the multiplier clipped to this window at its speed. If limits of effort bind, as in a start,
the optimum's own price rightly lies outside of the window at its own speed: the window is widened by that factor.
"""

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.chain_proof.table import BRAKING, DRIVING, EFFORTS, SPEEDS, DriveTable, row_speed
from railjoule.core.interior_point.solver import Optimum
from railjoule.core.physics.mesh_data import MeshData


def node_prices(mesh: MeshData, optimum: Optimum) -> FloatArray:
    """Return the slopes of the cost to go by the square of speed at each node [J s2/m2]; shape (n + 1,).

    They are -K times the price of force, which is a multiplier at the middle of its cell.
    """
    length = mesh.cell_length_m
    middle = optimum.force_price / length
    between = (middle[:-1] * length[1:] + middle[1:] * length[:-1]) / (length[1:] + length[:-1])
    return -mesh.half_inertia_kg * np.concatenate([middle[:1], between, middle[-1:]])


def worth_of_speed(mesh: MeshData, table: DriveTable) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return speeds [m/s], and what a square of speed returns by braking and costs by driving there [J s2/m2]."""
    speed = np.array([row_speed(table.slowest_ms, table.fastest_ms, row) for row in range(SPEEDS + 1)])
    efforts = np.arange(1, EFFORTS + 1) / EFFORTS
    with np.errstate(divide="ignore", invalid="ignore"):
        driving = table.low[DRIVING, :, 1:] / (efforts * table.top_n[DRIVING])
        braking = -table.low[BRAKING, :, 1:] / (efforts * table.top_n[BRAKING])
    returned = np.max(np.where(np.isfinite(braking), braking, 0.0), axis=1).clip(min=0.0)
    cost = np.min(np.where(np.isfinite(driving), driving, np.inf), axis=1)
    known = np.isfinite(cost)
    if not known.any():
        return speed, np.full(len(speed), -np.inf), np.full(len(speed), np.inf)
    cost = np.interp(speed, speed[known], cost[known])
    return speed, mesh.half_inertia_kg * returned, mesh.half_inertia_kg * np.maximum(cost, returned)


def interval_prices(
    node_price: FloatArray,
    around_ms: FloatArray,
    worth: tuple[FloatArray, FloatArray, FloatArray],
    low2: FloatArray,
    high2: FloatArray,
) -> FloatArray:
    """Return a price for each interval of each node [J s2/m2]; shape as that of the intervals.

    Parameters
    ----------
    node_price : array of shape (n + 1,)
        Prices of the multipliers.
    around_ms : array of shape (n + 1,)
        Speeds of the run whose multipliers they are [m/s].
    worth : tuple of 3 arrays
        As `worth_of_speed`.
    low2, high2 : array of shape (n + 1, m)
        Squares of speed at the ends of the intervals [m2/s2]; infinite where a node has fewer.
    """
    speed, returned, cost = worth
    middle = 0.5 * (np.sqrt(low2) + np.sqrt(high2))
    least, most = np.interp(middle, speed, returned), np.interp(middle, speed, cost)
    own = -node_price[:, None]
    min_here = np.interp(around_ms, speed, returned)[:, None]
    max_here = np.interp(around_ms, speed, cost)[:, None]
    # a window that is open to one side is widened by nothing
    falls = np.divide(own, min_here, out=np.ones_like(own), where=min_here > 0)
    rises = np.divide(own, max_here, out=np.ones_like(own), where=np.isfinite(max_here) & (max_here > 0))
    return -np.clip(own, least * np.minimum(falls, 1.0), most * np.maximum(rises, 1.0))
