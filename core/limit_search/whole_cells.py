"""Runs with one effort in each cell, as a trajectory has it: no effort beyond its limit, no limit of the line passed.

A trip that changes its effort within cells (`railjoule.core.limit_search.trip`) is no run over its mesh: put together,
the force of a mixed cell, or of a part whose gradient differs from the cell's mean, may pass a limit. Here each cell
leads to the speed that the regulator wants at its end, or to the nearest one that the train reaches. With nodes
at the corners of a trip both are the same but for rounding.
"""

import math

import numpy as np

from railjoule.core.arrays import BoolArray, FloatArray
from railjoule.core.compiled import njit
from railjoule.core.limit_search.regulation import Regulation, braking_curves
from railjoule.core.limit_search.trip import comes_to_a_stand, trip
from railjoule.core.motion.cell_step import COAST, FULL_BRAKE, FULL_TRACTION, cell_cost, exit_speed2
from railjoule.core.physics.cell import Cell, mean_speed, needed_force
from railjoule.core.physics.course_data import CourseData, Train, cell_of, shared_by_cells
from railjoule.core.physics.effort_limit import EffortLimit, largest_effort

# its cell would tell nothing but rounding, and a train whose regulator changes its effort a millimetre beside its mark
# drives no other run
SHORTEST_PART_M = 1e-3
"""A corner of a trip this close to a node is merged with it."""
ROUNDING = 1e-10
"""Brakes reach a square of speed where they miss it by less than this share: curve and cell find it by iteration."""
PASSED_SHARE = 1e-9
"""A limit counts as passed where the square of speed exceeds it by more than this share, which is rounding."""


@njit(cache=True, error_model="numpy")
def _is_possible(
    cell: Cell, train: Train, traction: EffortLimit, braking: EffortLimit, speed2: float, wanted2: float
) -> bool:
    """Return whether efforts and accelerations within their limits lead from one square of speed to another."""
    v = mean_speed(math.sqrt(speed2), math.sqrt(wanted2))
    # dv/dt = dv^2/ds / 2
    force, acceleration = needed_force(cell, speed2, wanted2, v), (wanted2 - speed2) / (2.0 * cell.length_m)
    if not -train.max_deceleration_ms2 <= acceleration <= train.max_acceleration_ms2:
        return False
    return -largest_effort(braking, v) - train.friction_effort_n <= force <= largest_effort(traction, v)


@njit(cache=True, error_model="numpy")
def _coasting_speed2(
    cell: Cell, train: Train, traction: EffortLimit, braking: EffortLimit, speed2: float, limit2: float
) -> float:
    """Return the square of speed that a regulator wants which holds its limit, and coasts above it.

    Where coasting is faster than the limit, a train that reaches the limit within the cell coasts from there.
    """
    coasting2 = exit_speed2(cell, train, traction, braking, speed2, COAST)
    # The corner where coasting ends may lie a little before the node that it was merged with. To hold the limit over
    # that little would take effort in the whole cell, and with it the power of motors that are on.
    merged = (speed2 - coasting2) * SHORTEST_PART_M / cell.length_m
    if speed2 >= limit2 and coasting2 < limit2 <= coasting2 + merged:
        return coasting2
    if speed2 >= limit2 or coasting2 <= speed2:
        return max(limit2, coasting2)
    full2 = exit_speed2(cell, train, traction, braking, speed2, FULL_TRACTION)
    if full2 <= limit2:
        return limit2
    # full effort is at the limit after the part (limit2 - speed2) / (full2 - speed2); in the rest it coasts
    return limit2 + (full2 - limit2) / (full2 - speed2) * (coasting2 - speed2)


@njit(cache=True, error_model="numpy")
def nearest_speed2(
    cell: Cell, train: Train, traction: EffortLimit, braking: EffortLimit, speed2: float, wanted2: float
) -> float:
    """Return the square of speed [m2/s2] nearest to a wanted one to which efforts within their limits lead.

    Negative where full effort does not bring the train through the cell, infinite where even that lets it slow down
    more than is allowed: in a tunnel or up a steep hill, entered too fast.
    """
    moves = speed2 > 0.0 or wanted2 > 0.0
    if moves and _is_possible(cell, train, traction, braking, speed2, wanted2):
        return wanted2
    most = exit_speed2(cell, train, traction, braking, speed2, FULL_TRACTION)
    if most < speed2 * (1.0 - ROUNDING) - 2.0 * train.max_deceleration_ms2 * cell.length_m:
        return math.inf
    if wanted2 >= most:
        return most
    least = exit_speed2(cell, train, traction, braking, speed2, FULL_BRAKE)
    return least if least > wanted2 + ROUNDING * speed2 else wanted2


@njit(cache=True, error_model="numpy", nogil=True)
def trip_over_cells(
    course: CourseData,
    regulation: Regulation,
    borders_m: FloatArray,
    limits_ms: FloatArray,
    position_m: FloatArray,
    speed2: FloatArray,
) -> tuple[int, float, float]:
    """Drive once under limits, with one effort in each cell.

    Arguments and results as `railjoule.core.limit_search.trip.trip`. Where the time is infinite, the last node is that
    where the trip fails: at a stand, or faster than it may be.
    """
    curve, _ = braking_curves(course, regulation, borders_m, limits_ms)
    train, traction, braking, drive = shared_by_cells(course)
    record = position_m.shape[0] > 0
    w, time, energy, section = max(course.fixed_speed2[0], 0.0), 0.0, 0.0, 0
    if record:
        position_m[0], speed2[0] = regulation.position_m[0], w
    for i in range(regulation.top_speed2.shape[0]):
        cell = cell_of(course, i)
        # a border that all but falls on a node was merged with it
        middle = regulation.position_m[i] + 0.5 * cell.length_m
        while section < borders_m.shape[0] and borders_m[section] <= middle:
            section += 1
        wanted2 = limits_ms[section] * limits_ms[section]
        if not regulation.brakes and w > 0.0:
            wanted2 = _coasting_speed2(cell, train, traction, braking, w, wanted2)
        wanted2 = min(wanted2, curve[i + 1], regulation.top_speed2[i])
        after = nearest_speed2(cell, train, traction, braking, w, wanted2)
        stands = comes_to_a_stand(w, after, curve[i + 1]) or (after <= 0.0 and w <= 0.0)
        if record:
            position_m[i + 1], speed2[i + 1] = regulation.position_m[i + 1], max(after, 0.0)
        if stands or after > regulation.bound_speed2[i + 1] * (1.0 + PASSED_SHARE):
            return i + 2, math.inf, math.inf
        cost, duration, _ = cell_cost(cell, train, traction, braking, drive, w, after)
        time += duration
        energy += cost
        w = after
    return regulation.position_m.shape[0], time, energy


@njit(cache=True, nogil=True)
def trip_cost(
    course: CourseData, regulation: Regulation, borders_m: FloatArray, limits_ms: FloatArray
) -> tuple[float, float]:
    """Return running time [s] and line energy without auxiliaries [J] of a trip; arguments as `trip`."""
    nothing = np.empty(0)
    if regulation.whole_cells:
        _, time, energy = trip_over_cells(course, regulation, borders_m, limits_ms, nothing, nothing)
    else:
        _, time, energy = trip(course, regulation, borders_m, limits_ms, nothing, nothing)
    return time, energy


@njit(cache=True, error_model="numpy", nogil=True)
def followed(course: CourseData, wanted_speed2: FloatArray, coasts: BoolArray) -> FloatArray:
    """Return the squares of speed of a train that follows others as closely as the limits of its efforts allow.

    Parameters
    ----------
    course : CourseData
        Over whose n cells it drives.
    wanted_speed2 : array of shape (n + 1,)
        Squares of speed to follow, only the first of which may be zero before the last [m2/s2].
    coasts : array of shape (n,)
        Whether it takes no effort in a cell.

    Returns
    -------
    array of shape (n + 1,)
        Squares of speed [m2/s2]; negative from where the train comes to a stand.
    """
    train, traction, braking, _ = shared_by_cells(course)
    speed2 = np.full(wanted_speed2.shape[0], -1.0)
    speed2[0] = wanted_speed2[0]
    last = wanted_speed2.shape[0] - 2
    for i in range(last + 1):
        cell = cell_of(course, i)
        wanted2 = wanted_speed2[i + 1]
        if coasts[i] and speed2[i] > 0.0:
            coasting2 = exit_speed2(cell, train, traction, braking, speed2[i], COAST)
            # not into a stand, nor past the speed that is prescribed at the end
            wanted2 = coasting2 if coasting2 > 0.0 and i < last else wanted2
        speed2[i + 1] = nearest_speed2(cell, train, traction, braking, speed2[i], wanted2)
        if speed2[i + 1] == math.inf:
            # goes on even so: whoever checks the run's accelerations says what is wrong with it
            speed2[i + 1] = exit_speed2(cell, train, traction, braking, speed2[i], FULL_TRACTION)
        if speed2[i + 1] <= 0.0 and i < last:
            speed2[i + 1] = -1.0
            break
    return speed2
