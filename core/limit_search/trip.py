"""One trip under the limits of sections, over distance, by a regulator without dead zone or delay.

Below the limit of the section in which its front is, the train drives at full effort; at the limit with just enough to
hold it; above it, it coasts, if the regulator coasts. It brakes along the curves of
`railjoule.core.limit_search.regulation` and where it would run faster than the line allows. Within a cell the net force
is constant; a cell in which the regulator changes its effort is cut there, so that time and energy do not jump with
limits and borders. Its efforts may pass their limits by some thousandths in the cells that are cut, which a search does
not mind.

A trip that changes its effort within cells is no run over its mesh: put together, the force of a mixed cell, or of a
part whose gradient differs from the cell's mean, may pass a limit. In `trip_over_cells`, as in a trajectory, each cell
has one effort, which leads to the speed that the regulator wants at its end, or to the nearest one that the train
reaches. With nodes at the corners of a trip both are the same but for rounding.

Source: Shtompel, Khvorost 2025, (5) in the limit of no dead zone and no ramp; the rule before a stop is railjoule's.
"""

import math

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.limit_search.regulation import Regulation, braking_curves
from railjoule.core.motion.cell_step import COAST, FULL_TRACTION, cell_cost, exit_speed2
from railjoule.core.motion.driving import ROUNDING, reachable_speed2
from railjoule.core.physics.cell import Cell
from railjoule.core.physics.effort_limit import EffortLimit
from railjoule.core.physics.mesh_data import MeshData, Train, cell_at, limits_at, part_of_cell, shared_by_cells

# Share by which a square of speed may miss its limit and still be at it: more than what cuts and the fixed point of a
# cell leave, or the regulator would change its effort again and again beside its mark.
AT_LIMIT = 1e-7
MIN_SHARE = 1e-7
"""A cut this close to the end of a cell, as a share of it, is none."""
CORRECTIONS, EXACT_CUT = 4, 1e-10
HOLD = 3
"""A control beside those of `railjoule.core.motion.cell_step`."""
# A regulator changes its effort two or three times within a cell at most; a trip with one that would go on for longer
# counts as one that does not arrive.
MAX_CUTS = 12
NODES_PER_CELL = 8
"""A trip has room for so many nodes a cell."""
SLOWEST2 = 0.1**2
"""Square of the speed of 0.1 m/s [m2/s2], below which bounds count no run between its stops."""
# its cell would tell nothing but rounding, and a train whose regulator changes its effort a millimetre beside its mark
# drives no other run
SHORTEST_PART_M = 1e-3
"""A corner of a trip this close to a node is merged with it."""
PASSED_SHARE = 1e-9
"""A limit counts as passed where the square of speed exceeds it by more than this share, which is rounding."""


@njit(cache=True)
def comes_to_a_stand(speed2: float, after2: float, curve2: float) -> bool:
    """Return whether a train that slows down from a square of speed to another stands, though no stop asks for it.

    One slower than any run of which a bound is known does, too: over another mesh it would stand.
    """
    return after2 < 0.0 or (after2 < speed2 and after2 < SLOWEST2 < curve2)


@njit(cache=True, error_model="numpy")
def _cut(
    cell: Cell,
    train: Train,
    traction: EffortLimit,
    braking: EffortLimit,
    speed2: float,
    control: int,
    share: float,
    end2: float,
    fall: float,
) -> tuple[float, float]:
    """Return the share of a cell after which a control meets a line of squares of speed, and that square.

    The line falls by `fall` a metre to `end2` at the end of the cell. Over part of a cell the resistance is another
    than over all of it, so a first share is corrected; what is left of the difference is rounding.
    """
    after = speed2
    for _ in range(CORRECTIONS):
        after = exit_speed2(part_of_cell(cell, share * cell.length_m), train, traction, braking, speed2, control)
        line2 = end2 + fall * cell.length_m * (1.0 - share)
        # Newton's rule on the control less the line: both are all but linear in the share
        steepness = (after - speed2) / share + fall * cell.length_m
        if abs(line2 - after) <= EXACT_CUT * max(line2, 1.0) or steepness == 0.0:
            break
        share = min(max(share + (line2 - after) / steepness, 0.5 * share), 1.0)
    return share, after


@njit(cache=True, error_model="numpy")
def _next(
    cell: Cell,
    train: Train,
    traction: EffortLimit,
    braking: EffortLimit,
    speed2: float,
    wanted2: float,
    top2: float,
    end2: float,
    fall: float,
) -> tuple[float, float]:
    """Return the share of a cell in which the regulator keeps its control, and the square of speed after it.

    `wanted2` is the limit of the section, `top2` that of the line, `end2` the braking curve at the end of the cell.
    """
    level2 = min(wanted2, top2)
    small = AT_LIMIT * max(level2, 1.0)
    start2 = end2 + fall * cell.length_m
    control, share = FULL_TRACTION, 1.0
    if speed2 < level2 - small:
        after = exit_speed2(cell, train, traction, braking, speed2, FULL_TRACTION)
        if after > level2:
            # at one effort v^2 is linear over the cell: the place by proportion
            share = (level2 - speed2) / (after - speed2)
    else:
        after = exit_speed2(cell, train, traction, braking, speed2, COAST)
        control = COAST
        if speed2 <= level2 + small and (after < level2 or level2 == top2):
            # held by effort, as far as it reaches, or by the brake that the line asks for
            full2 = exit_speed2(cell, train, traction, braking, speed2, FULL_TRACTION) if after < level2 else level2
            after = min(level2, full2)
            control = HOLD if after == level2 else FULL_TRACTION
        elif after < level2:
            share = (speed2 - level2) / (speed2 - after)
        elif after > top2:
            if speed2 >= top2 - small:
                after, control = top2, HOLD
            else:
                share, level2 = (top2 - speed2) / (after - speed2), top2
    if share < 1.0:
        share, after = _cut(cell, train, traction, braking, speed2, control, share, level2, 0.0)
    if after <= start2 + (end2 - start2) * share + small:
        return (1.0, after) if share >= 1.0 - MIN_SHARE else (share, after)
    # from here on the braking curve is lower than where the control leads
    if speed2 >= start2 - small:
        return 1.0, end2
    # the part s at which speed2 + s (after - speed2) / share meets start2 + s (end2 - start2)
    share = (start2 - speed2) / ((after - speed2) / share + start2 - end2)
    if share >= 1.0 - MIN_SHARE:
        return 1.0, end2
    if control == HOLD:
        return share, speed2 + (after - speed2) * share
    return _cut(cell, train, traction, braking, speed2, control, share, end2, fall)


@njit(cache=True, error_model="numpy", nogil=True)
def trip(
    mesh: MeshData, regulation: Regulation, borders_m: FloatArray, limits_ms: FloatArray
) -> tuple[FloatArray, FloatArray, float, float]:
    """Drive once under limits.

    Parameters
    ----------
    mesh, regulation : MeshData, Regulation
        Train and line, and their limits for the regulator.
    borders_m : array of shape (k - 1,)
        Between sections, rising [m].
    limits_ms : array of shape (k,)
        Of the sections [m/s].

    Returns
    -------
    position_m, speed2 : array of shape (m,)
        Places [m] and squares of speed [m2/s2] wherever the regulator changes its effort, up to where a trip fails.
    running_time_s, energy_j : float
        Its time [s] and its line energy without auxiliaries [J], both infinite where it comes to a stand.
    """
    curve, fall = braking_curves(mesh, regulation, borders_m, limits_ms)
    shared = shared_by_cells(mesh)
    sections, w = limits_ms.shape[0], max(mesh.fixed_speed2[0], 0.0)
    size = NODES_PER_CELL * (regulation.position_m.shape[0] + sections)
    position, speed2 = np.empty(size), np.empty(size)
    position[0], speed2[0] = regulation.position_m[0], w
    nodes, section, time, energy = 1, 0, 0.0, 0.0
    for i in range(regulation.top_speed2.shape[0]):
        whole = cell_at(mesh, i)
        train, traction, braking, drive = limits_at(shared, i)
        place, end = regulation.position_m[i], regulation.position_m[i + 1]
        while section < sections - 1 and borders_m[section] <= place:
            section += 1
        done = False
        for _ in range(MAX_CUTS + sections):
            until, until2 = end, curve[i + 1]
            limit2, top2 = limits_ms[section] * limits_ms[section], regulation.top_speed2[i]
            if section < sections - 1 and borders_m[section] < end:
                until = borders_m[section]
                until2 += fall[i] * (end - until)
                if regulation.brakes:
                    until2 = min(until2, limits_ms[section + 1] * limits_ms[section + 1])
            if regulation.brakes:
                top2 = min(top2, limit2)
            cell = part_of_cell(whole, until - place)
            share, after = _next(cell, train, traction, braking, w, limit2, top2, until2, fall[i])
            # only at the end of a cell may a stop ask for rest
            if comes_to_a_stand(w, after, curve[i + 1] if share == 1.0 and until == end else math.inf):
                return position[:nodes], speed2[:nodes], math.inf, math.inf
            after = max(after, 0.0)
            step = (until - place) * share
            if step > 0.0:
                cost, duration, _ = cell_cost(part_of_cell(whole, step), train, traction, braking, drive, w, after)
                time += duration
                energy += cost
            w = after
            place = until if share == 1.0 else place + step
            if step > 0.0 and nodes < size:
                position[nodes], speed2[nodes] = place, w
                nodes += 1
            if share == 1.0:
                if until == end:
                    done = True
                    break
                section += 1
        if not done:
            return position[:nodes], speed2[:nodes], math.inf, math.inf
    return position[:nodes], speed2[:nodes], time, energy


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
    mesh: MeshData, regulation: Regulation, borders_m: FloatArray, limits_ms: FloatArray
) -> tuple[FloatArray, FloatArray, float, float]:
    """Drive once under limits, with one effort in each cell.

    Arguments and results as `railjoule.core.limit_search.trip.trip`. A failed trip has infinite time and ends at the
    node of its failure: at a stand, or faster than it may be.
    """
    curve, _ = braking_curves(mesh, regulation, borders_m, limits_ms)
    shared = shared_by_cells(mesh)
    w, time, energy, section = max(mesh.fixed_speed2[0], 0.0), 0.0, 0.0, 0
    position, speed2 = regulation.position_m, np.full(regulation.position_m.shape[0], w)
    for i in range(regulation.top_speed2.shape[0]):
        cell = cell_at(mesh, i)
        train, traction, braking, drive = limits_at(shared, i)
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
        speed2[i + 1] = max(after, 0.0)
        if stands or after > regulation.bound_speed2[i + 1] * (1.0 + PASSED_SHARE):
            return position[: i + 2], speed2[: i + 2], math.inf, math.inf
        cost, duration, _ = cell_cost(cell, train, traction, braking, drive, w, after)
        time += duration
        energy += cost
        w = after
    return position, speed2, time, energy


@njit(cache=True, nogil=True)
def regulated_trip(
    mesh: MeshData, regulation: Regulation, borders_m: FloatArray, limits_ms: FloatArray
) -> tuple[FloatArray, FloatArray, float, float]:
    """Drive once under limits as the regulation asks; arguments and results as `trip`."""
    if regulation.whole_cells:
        return trip_over_cells(mesh, regulation, borders_m, limits_ms)
    return trip(mesh, regulation, borders_m, limits_ms)
