"""Runs with one effort in each cell, as a trajectory has it: no effort beyond its limit, no limit of the line passed.

A trip that changes its effort within cells (`railjoule.core.limit_search.trip`) is no run over its mesh: put together,
the force of a mixed cell, or of a part whose gradient differs from the cell's mean, may pass a limit. Here each cell
leads to the speed that the regulator wants at its end, or to the nearest one that the train reaches. With nodes
at the corners of a trip both are the same but for rounding.
"""

import math

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.limit_search.regulation import Regulation, braking_curves
from railjoule.core.limit_search.trip import comes_to_a_stand, trip
from railjoule.core.motion.cell_step import COAST, FULL_TRACTION, cell_cost, exit_speed2
from railjoule.core.motion.driving import ROUNDING, reachable_speed2
from railjoule.core.physics.cell import Cell
from railjoule.core.physics.effort_limit import EffortLimit
from railjoule.core.physics.mesh_data import MeshData, Train, cell_of, shared_by_cells

# its cell would tell nothing but rounding, and a train whose regulator changes its effort a millimetre beside its mark
# drives no other run
SHORTEST_PART_M = 1e-3
"""A corner of a trip this close to a node is merged with it."""
PASSED_SHARE = 1e-9
"""A limit counts as passed where the square of speed exceeds it by more than this share, which is rounding."""


@njit(cache=True, error_model="numpy")
def _coasting_speed2(
    cell: Cell, train: Train, traction: EffortLimit, braking: EffortLimit, speed2: float, limit2: float
) -> float:
    """Return the square of speed that a regulator wants which holds its limit, and coasts above it.

    A train that reaches the limit within the cell coasts from there, if coasting is faster than the limit.
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


@njit(cache=True, error_model="numpy", nogil=True)
def trip_over_cells(
    mesh: MeshData,
    regulation: Regulation,
    borders_m: FloatArray,
    limits_ms: FloatArray,
    position_m: FloatArray,
    speed2: FloatArray,
) -> tuple[int, float, float]:
    """Drive once under limits, with one effort in each cell.

    Arguments and results as `railjoule.core.limit_search.trip.trip`. A failed trip has infinite time and ends at the
    node of its failure: at a stand, or faster than it may be.
    """
    curve, _ = braking_curves(mesh, regulation, borders_m, limits_ms)
    train, traction, braking, drive = shared_by_cells(mesh)
    record = position_m.shape[0] > 0
    w, time, energy, section = max(mesh.fixed_speed2[0], 0.0), 0.0, 0.0, 0
    if record:
        position_m[0], speed2[0] = regulation.position_m[0], w
    for i in range(regulation.top_speed2.shape[0]):
        cell = cell_of(mesh, i)
        # a border that all but falls on a node was merged with it
        middle = regulation.position_m[i] + 0.5 * cell.length_m
        while section < borders_m.shape[0] and borders_m[section] <= middle:
            section += 1
        wanted2 = limits_ms[section] * limits_ms[section]
        if not regulation.brakes and w > 0.0:
            wanted2 = _coasting_speed2(cell, train, traction, braking, w, wanted2)
        wanted2 = min(wanted2, curve[i + 1], regulation.top_speed2[i])
        after = reachable_speed2(cell, train, traction, braking, w, wanted2)
        if after < w * (1.0 - ROUNDING) - 2.0 * train.max_deceleration_ms2 * cell.length_m:
            # in a tunnel or up a steep hill, entered too fast, even full effort slows the train down too much
            after = math.inf
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
    mesh: MeshData, regulation: Regulation, borders_m: FloatArray, limits_ms: FloatArray
) -> tuple[float, float]:
    """Return running time [s] and line energy without auxiliaries [J] of a trip; arguments as `trip`."""
    nothing = np.empty(0)
    if regulation.whole_cells:
        _, time, energy = trip_over_cells(mesh, regulation, borders_m, limits_ms, nothing, nothing)
    else:
        _, time, energy = trip(mesh, regulation, borders_m, limits_ms, nothing, nothing)
    return time, energy
