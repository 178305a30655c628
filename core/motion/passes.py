"""The greatest speed at every place, by one pass forward and one backward over the mesh.

Problem: among all runs that keep every limit, the one that is fastest everywhere. Forward, each cell
starts from the greatest speed reached so far and uses full effort; backward, each cell ends at the greatest
speed allowed there and brakes fully. Both steps are exact for the mesh.

Limits of acceleration and deceleration bound speeds from the other side as well: uphill, full effort may not keep
the deceleration small enough, downhill, full braking not the acceleration. The speeds above which that happens are
taken off first; then one pass each way is enough, unless no speed is slow enough.
"""

import math

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import copy_rows, njit
from railjoule.core.physics.cell import (
    NEARLY_AT_REST_MS,
    Cell,
    duration,
    force_slopes,
    mean_speed,
    mean_speed_slope,
    needed_force,
)
from railjoule.core.physics.effort_limit import EffortLimit, max_effort_slope, supplied_limit
from railjoule.core.physics.mesh_data import MeshData, can_start, cell_at, limits_at, shared_by_cells

MOVED = -1
"""Result of a pass that met no obstacle."""
# one pass each way settles all but limits of acceleration and deceleration that bound each other; those need a few
MAX_PASSES = 50
# even bisection would be at rounding by then
ROOT_STEPS = 80
EXACT = 1e-13


@njit(cache=True)
def _excess(
    limit: EffortLimit, friction: float, cell: Cell, known: float, x: float, sign: float
) -> tuple[float, float]:
    """Return by how much the force of a cell exceeds the largest effort [N], and its derivative by `x`.

    `known` is the speed squared at one end, `x` the unknown one at the other; `sign` is 1 where the cell starts with
    `known` under full traction, -1 where it ends with it under full braking, with `friction` beside the limit [N].
    """
    root = math.sqrt(x)
    v = max(mean_speed(math.sqrt(known), root), NEARLY_AT_REST_MS)
    # infinite at rest, where the force rises with the speed squared all the same
    v_slope = mean_speed_slope(root) if root > 0.0 else 0.0
    if sign > 0.0:
        value, slope = needed_force(cell, known, x, v), force_slopes(cell, known, x, 0.0, v_slope)[1]
    else:
        value, slope = -needed_force(cell, x, known, v) - friction, -force_slopes(cell, x, known, v_slope, 0.0)[0]
    effort, effort_slope = max_effort_slope(limit, v)
    return value - effort, slope - effort_slope * v_slope


@njit(cache=True)
def _max_reachable(limit: EffortLimit, friction: float, cell: Cell, known: float, bound: float, sign: float) -> float:
    """Return the greatest speed squared up to `bound` at the unknown end of a cell; negative if there is none.

    Arguments as in `_excess`: Newton's rule, kept inside a bracket. The excess rises with the unknown, but where the
    effort rises with speed, as that of a brake may that is weak close to a stand; there the bracket is halved.
    """
    if _excess(limit, friction, cell, known, bound, sign)[0] <= 0.0:
        return bound
    # from the known speed, which is close: a cell is short
    value, slope = _excess(limit, friction, cell, known, known, sign)
    low, high, x = 0.0, bound, known
    if value > 0.0:
        high = known
        if _excess(limit, friction, cell, known, 0.0, sign)[0] > 0.0:
            return -1.0
    else:
        low = known
    for _ in range(ROOT_STEPS):
        step = x - value / slope if slope > 0.0 else 0.5 * (low + high)
        if abs(step - x) <= EXACT * bound or high - low <= EXACT * bound:
            break
        if not low < step < high:
            step = 0.5 * (low + high)
        x = step
        value, slope = _excess(limit, friction, cell, known, x, sign)
        if value > 0.0:
            high = x
        else:
            low = x
    return min(x, high)


@njit(cache=True)
def _max_steady(limit: EffortLimit, friction: float, cell: Cell, bound: float, change: float, sign: float) -> float:
    """Return the greatest speed squared up to `bound` from which the effort keeps the speed squared within `change`.

    Arguments as in `_excess`: at the known end the speed squared is the result, at the other end less by `change`.
    """
    if bound <= change or _excess(limit, friction, cell, bound, bound - change, sign)[0] <= 0.0:
        return bound
    low, high = change, bound
    for _ in range(ROOT_STEPS):
        x = 0.5 * (low + high)
        if _excess(limit, friction, cell, x, x - change, sign)[0] > 0.0:
            high = x
        else:
            low = x
    return low


@njit(cache=True)
def _take_off_unsteady(mesh: MeshData, speed2: FloatArray) -> None:
    """Lower `speed2` to where full effort keeps the deceleration, and full braking the acceleration, within limits."""
    shared = shared_by_cells(mesh)
    for i in range(mesh.cell_length_m.shape[0]):
        cell = cell_at(mesh, i)
        train, traction, braking, _ = limits_at(shared, i)
        if mesh.max_deceleration_ms2 < np.inf:
            change, limit = (
                2.0 * mesh.max_deceleration_ms2 * cell.length_m,
                supplied_limit(traction, cell.supply_share),
            )
            speed2[i] = _max_steady(limit, 0.0, cell, speed2[i], change, 1.0)
        if mesh.max_acceleration_ms2 < np.inf:
            change, limit = (
                2.0 * mesh.max_acceleration_ms2 * cell.length_m,
                supplied_limit(braking, cell.supply_share),
            )
            speed2[i + 1] = _max_steady(limit, train.friction_effort_n, cell, speed2[i + 1], change, -1.0)


@njit(cache=True)
def _pass_cells(mesh: MeshData, speed2: FloatArray, is_braking: bool) -> int:
    """Lower `speed2` to what full effort reaches, or backwards in time to what full braking can still slow down.

    Return the cell that cannot be passed, or MOVED. Backwards the known end of a cell is the one that the train leaves.
    """
    shared, sign = shared_by_cells(mesh), -1.0 if is_braking else 1.0
    max_change = 2.0 * (mesh.max_deceleration_ms2 if is_braking else mesh.max_acceleration_ms2)
    n = mesh.cell_length_m.shape[0]
    for number in range(n):
        i = n - 1 - number if is_braking else number
        known, other = (i + 1, i) if is_braking else (i, i + 1)
        cell = cell_at(mesh, i)
        train, traction, braking, _ = limits_at(shared, i)
        limit, friction = (braking, train.friction_effort_n) if is_braking else (traction, 0.0)
        if not is_braking and speed2[known] <= 0.0 and not can_start(cell, limit):
            return i
        # v^2 changes by 2 a h over a cell
        bound = min(speed2[other], speed2[known] + max_change * cell.length_m)
        supplied = supplied_limit(limit, cell.supply_share)
        reached = _max_reachable(supplied, friction, cell, speed2[known], bound, sign)
        # rest is an end where a stop is prescribed, and nowhere else
        if reached < 0.0 or (reached <= 0.0 and mesh.fixed_speed2[other] != 0.0):
            return i
        speed2[other] = reached
    return MOVED


@njit(cache=True)
def entering_speed2_under_brakes(mesh: MeshData, number: int, leaving_speed2: float, limit_speed2: float) -> float:
    """Return the greatest square of speed, up to `limit_speed2`, at the start of a cell that full braking leaves.

    Negative where full braking does not slow the train down to `leaving_speed2` at all; all in [m2/s2].
    """
    cell, (train, _, braking, _) = cell_at(mesh, number), limits_at(shared_by_cells(mesh), number)
    supplied = supplied_limit(braking, cell.supply_share)
    return _max_reachable(supplied, train.friction_effort_n, cell, leaving_speed2, limit_speed2, -1.0)


@njit(cache=True, nogil=True)
def max_speeds(mesh: MeshData) -> tuple[FloatArray, int, bool]:
    """Return the greatest feasible squares of speed, the obstacle and whether it was met while braking.

    Returns
    -------
    speed2 : array of shape (n + 1,)
        Squares of speed at the nodes [m2/s2].
    obstacle : int
        A cell that no run can pass, or MOVED.
    braking : bool
        Whether that cell asks for more braking, not more traction.
    """
    nodes = mesh.limit_speed2.shape[0]
    speed2 = mesh.limit_speed2.copy()
    for i in range(nodes):
        if mesh.fixed_speed2[i] >= 0.0:
            speed2[i] = min(mesh.fixed_speed2[i], speed2[i])
    _take_off_unsteady(mesh, speed2)
    once = mesh.max_deceleration_ms2 == np.inf and mesh.max_acceleration_ms2 == np.inf
    before = np.empty(nodes)
    for _ in range(MAX_PASSES):
        copy_rows(speed2, before)
        for is_braking in (False, True):
            obstacle = _pass_cells(mesh, speed2, is_braking)
            if obstacle != MOVED:
                return speed2, obstacle, is_braking
        for i in range(nodes):
            fixed = mesh.fixed_speed2[i]
            # an end's speed is prescribed: a run that cannot have it is none. At the start it is braking that fails,
            # elsewhere it counts as want of traction in the cell before.
            if fixed >= 0.0 and speed2[i] < fixed * (1.0 - 1e-9):
                return speed2, max(i - 1, 0), i == 0
        if once or np.max(np.abs(before - speed2)) <= 1e-12 * np.max(speed2):
            return speed2, MOVED, False
    # speeds that still fall have no end but a stand, at a place that the train may not run down so fast
    return speed2, max(int(np.argmax(before - speed2)) - 1, 0), True


@njit(cache=True, nogil=True)
def slowed_to_reach(mesh: MeshData, speed2: FloatArray) -> FloatArray:
    """Return squares of speed lowered to what full effort reaches and full braking can still slow down.

    Parameters
    ----------
    mesh : MeshData
        The line and the train.
    speed2 : array of shape (n + 1,)
        Squares of speed [m2/s2], none above the greatest feasible ones.
    """
    lowered = speed2.copy()
    _pass_cells(mesh, lowered, False)
    _pass_cells(mesh, lowered, True)
    return lowered


@njit(cache=True, nogil=True)
def running_time(cell_length_m: FloatArray, speed2: FloatArray) -> float:
    """Return the time of a run [s]."""
    total = 0.0
    for i in range(cell_length_m.shape[0]):
        total += duration(cell_length_m[i], mean_speed(math.sqrt(speed2[i]), math.sqrt(speed2[i + 1])))
    return total
