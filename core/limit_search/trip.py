"""One trip under the limits of sections, over distance, by a regulator without dead zone or delay.

Below the limit of the section in which its front is, the train drives at full effort; at the limit with just enough to
hold it; above it, it coasts, if the regulator coasts. It brakes along the curves of
`railjoule.core.limit_search.regulation` and where it would run faster than the line allows. Within a cell the net force
is constant; a cell in which the regulator changes its effort is cut there, so that time and energy do not jump with
limits and borders. Its efforts may pass their limits by some thousandths in the cells that are cut, which a search does
not mind; `railjoule.core.limit_search.whole_cells` makes a run of it.

Source: Shtompel, Khvorost 2025, (5) in the limit of no dead zone and no ramp; the rule before a stop is railjoule's.
"""

import math

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.limit_search.regulation import Regulation, braking_curves, section_at
from railjoule.core.motion.cell_step import COAST, FULL_TRACTION, cell_cost, exit_speed2
from railjoule.core.physics.cell import Cell
from railjoule.core.physics.effort_limit import EffortLimit
from railjoule.core.physics.mesh_data import MeshData, Train, cell_of, part_of_cell, shared_by_cells

# Share by which a square of speed may miss its limit and still be at it: more than what cuts and the fixed point of a
# cell leave, or the regulator would change its effort again and again beside its mark.
ROUNDING = 1e-7
MIN_SHARE = 1e-7
"""A cut this close to the end of a cell, as a share of it, is none."""
CORRECTIONS, EXACT_CUT = 4, 1e-10
HOLD = 3
"""A control beside those of `railjoule.core.motion.cell_step`."""
# A regulator changes its effort two or three times within a cell at most; a trip with one that would go on for longer
# counts as one that does not arrive.
MAX_CUTS = 12
SLOWEST2 = 0.1**2
"""Square of the speed of 0.1 m/s [m2/s2], below which bounds count no run between its stops."""


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
    small = ROUNDING * max(level2, 1.0)
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
    mesh: MeshData,
    regulation: Regulation,
    borders_m: FloatArray,
    limits_ms: FloatArray,
    position_m: FloatArray,
    speed2: FloatArray,
) -> tuple[int, float, float]:
    """Drive once under limits; fill places [m] and squares of speed [m2/s2], whose arrays must be long enough.

    Parameters
    ----------
    mesh, regulation : MeshData, Regulation
        Train and line, and their limits for the regulator.
    borders_m : array of shape (k - 1,)
        Between sections, rising [m].
    limits_ms : array of shape (k,)
        Of the sections [m/s].
    position_m, speed2 : array of shape (m,)
        Filled; empty where they are not needed.

    Returns
    -------
    (nodes, running_time_s, energy_j) : int and floats
        How many nodes the trip has, its time [s], infinite where it comes to a stand, and its line energy without
        auxiliaries [J].
    """
    curve, fall = braking_curves(mesh, regulation, borders_m, limits_ms)
    train, traction, braking, drive = shared_by_cells(mesh)
    record = position_m.shape[0] > 0
    sections = limits_ms.shape[0]
    w = max(mesh.fixed_speed2[0], 0.0)
    section = section_at(borders_m, regulation.position_m[0])
    time = energy = 0.0
    nodes = 1
    if record:
        position_m[0], speed2[0] = regulation.position_m[0], w
    for i in range(regulation.top_speed2.shape[0]):
        whole = cell_of(mesh, i)
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
                return nodes, math.inf, math.inf
            after = max(after, 0.0)
            step = (until - place) * share
            if step > 0.0:
                cost, duration, _ = cell_cost(part_of_cell(whole, step), train, traction, braking, drive, w, after)
                time += duration
                energy += cost
            w = after
            place = until if share == 1.0 else place + step
            if record and step > 0.0 and nodes < position_m.shape[0]:
                position_m[nodes], speed2[nodes] = place, w
                nodes += 1
            if share == 1.0:
                if until == end:
                    done = True
                    break
                section += 1
        if not done:
            return nodes, math.inf, math.inf
    return nodes, time, energy
