"""The braking curve of train protection: the permitted speed before each lower limit, stop and prescribed speed.

The curve ends at a place with the speed that holds there, and rises backwards with a deceleration a(v) that steps with
speed: dv^2/dx = -2 a(v), so that v^2 is linear over distance between the steps. It limits the speed over place and no
effort: where the brakes are weaker, they govern. Stepwise decelerations as in UNISIG SUBSET-026, 3.13.

A run has v^2 linear within a cell, the curve has a corner in each cell in which it passes a step. A run shall nowhere
be above the curve, so that the steepest line within the cell that stays below the curve is taken. Nodes are then exact
where the deceleration falls with rising speed. If it rises from a to b, v^2 is too low by less than 2 (b - a) h for
a cell of length h, from there backwards up to where a limit is lower: an error on the safe side, of the order of h.
"""

from typing import TYPE_CHECKING

import numpy as np

from railjoule.core.arrays import FloatArray, IntArray
from railjoule.core.compiled import njit
from railjoule.core.units import MS_PER_KMH

if TYPE_CHECKING:
    # at run time, each change of the input models would compile the kernels again
    from railjoule.core.scenario import Vehicle


def permitted_speed2(
    vehicle: "Vehicle", cell_length_m: FloatArray, limit_speed2: FloatArray, fixed_speed2: FloatArray
) -> FloatArray:
    """Return the largest squares of speed at the nodes under limits and, where the vehicle has one, a braking curve.

    Parameters
    ----------
    vehicle : Vehicle
        With `braking.permitted_deceleration`, or without.
    cell_length_m : array of shape (n,)
        Lengths of the cells [m].
    limit_speed2 : array of shape (n + 1,)
        Squares of the limits at the nodes [m2/s2].
    fixed_speed2 : array of shape (n + 1,)
        Squares of prescribed speeds [m2/s2], NaN where there is none. The curve before such a node ends there;
        the node itself keeps what is permitted but for it, so that a speed that is asked for in vain is seen.

    Returns
    -------
    array of shape (n + 1,)
        Squares of speed [m2/s2].
    """
    steps = curve_steps(vehicle)
    return _under_curve(cell_length_m, limit_speed2, fixed_speed2, steps) if steps.size else limit_speed2


def curve_steps(vehicle: "Vehicle") -> FloatArray:
    """Return the squares of speed at which the steps of a braking curve begin [m2/s2], and decelerations [m/s2].

    Shape (2, k), without columns for a vehicle without a braking curve.
    """
    steps = np.array(vehicle.braking.permitted_deceleration or np.zeros((0, 2)), dtype=float)
    return np.array([(steps[:, 0] * MS_PER_KMH) ** 2, steps[:, 1]])


@njit(cache=True)
def _under_curve(
    cell_length_m: FloatArray, limit_speed2: FloatArray, fixed_speed2: FloatArray, steps: FloatArray
) -> FloatArray:
    """Return `permitted_speed2` for the steps of `curve_steps`."""
    permitted = limit_speed2.copy()
    # backwards, as what a place permits depends only on what lies ahead
    for i in range(cell_length_m.shape[0] - 1, -1, -1):
        leaving = permitted[i + 1]
        if fixed_speed2[i + 1] >= 0.0:
            leaving = min(leaving, fixed_speed2[i + 1])
        permitted[i] = min(permitted[i], leaving + _rise(cell_length_m[i], leaving, steps)[1])
    return permitted


@njit(cache=True)
def _rise(length_m: float, leaving_speed2: float, steps: FloatArray) -> tuple[float, float]:
    """Return by how much the curve lies above a square of speed a length before it, and the steepest line under it.

    Both are differences of squares of speed [m2/s2].
    """
    from_speed2, deceleration_ms2 = steps
    step, last = 0, from_speed2.shape[0] - 1
    # the curve above a step's speed has its deceleration: on the step itself the next one begins
    while step < last and from_speed2[step + 1] <= leaving_speed2:
        step += 1
    speed2, back, least = leaving_speed2, 0.0, np.inf
    while step < last:
        needed = (from_speed2[step + 1] - speed2) / (2.0 * deceleration_ms2[step])
        if back + needed >= length_m:
            break
        step, back = step + 1, back + needed
        speed2 = from_speed2[step]
        # a line under the curve is under each of its corners
        least = min(least, (speed2 - leaving_speed2) / back)
    rise = speed2 + 2.0 * deceleration_ms2[step] * (length_m - back) - leaving_speed2
    return rise, min(rise, least * length_m)


@njit(cache=True)
def curve_at(
    cell_length_m: FloatArray,
    limit2: FloatArray,
    fixed_speed2: FloatArray,
    steps: FloatArray,
    cell: IntArray,
    to_end_m: FloatArray,
) -> FloatArray:
    """Return squares of speed of the braking curve itself, with all its corners, at places in the cells [m2/s2].

    Parameters
    ----------
    cell_length_m, limit2 : array of shape (n,)
        Lengths of the cells [m] and squares of the limits within them [m2/s2].
    fixed_speed2 : array of shape (n + 1,)
        As for `permitted_speed2`.
    steps : array of shape (2, k)
        As `curve_steps`.
    cell : array of shape (m,)
        The cells of the places.
    to_end_m : array of shape (j, m)
        Distances of places to the ends of their cells [m].

    Returns
    -------
    array of shape (j, m)
    """
    count = cell_length_m.shape[0]
    leaving, curve2 = np.empty(count), np.empty_like(to_end_m)
    ahead = np.inf
    for i in range(count - 1, -1, -1):
        if i + 1 < count:
            ahead = min(ahead, limit2[i + 1])
        if fixed_speed2[i + 1] >= 0.0:
            ahead = min(ahead, fixed_speed2[i + 1])
        leaving[i] = min(ahead, limit2[i])
        # what the next cell before may leave this one's start with
        ahead = min(limit2[i], leaving[i] + _rise(cell_length_m[i], leaving[i], steps)[0])
    for j in range(curve2.shape[0]):
        for k in range(curve2.shape[1]):
            i = cell[k]
            curve2[j, k] = min(limit2[i], leaving[i] + _rise(to_end_m[j, k], leaving[i], steps)[0])
    return curve2
