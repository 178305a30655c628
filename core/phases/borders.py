"""Borders of segments within cells, and the straight pieces of part power and braking."""

import math

import numpy as np

from railjoule.core.arrays import BoolArray, FloatArray
from railjoule.core.phases.labels import HOLD_TOLERANCE_MS, NEGLIGIBLE_MS, SHORTEST_S, STEADY_MS2
from railjoule.core.phases.phase import BRAKE, COAST, FULL_POWER, HOLD, PART_POWER, STAND
from railjoule.core.phases.run_data import RunData
from railjoule.core.phases.segments import COLUMNS, FIRST, KIND, LAST, PLACE, SHARE, SPEED, STEADY, TIME, duration_s

# A driver has a few notches and cannot tell nine tenths from all of it. Lower, and the advised brake would stop short.
FULL_BRAKING_SHARE = 0.9
"""From this share of what the brakes have on, in each cell, the train brakes fully."""
# within 2 per cent of the next cell it is the same braking; with less, the train coasted for a part of the cell
WHOLE_CELL_SHARE = 0.98
"""A brake's first cell with less than this share of the next one's effort is braked in part."""
# the efforts of the neighbours are taken at their own mean speeds, so the cell between them may be a little outside
EFFORT_SLACK = 0.05
"""A cell passes on from one segment to the next if its effort lies between theirs, or beside them by this share."""
TIMING_TOLERANCE_S = 0.25
"""A straight piece takes as long as the run does there, but for so much: what counts at walking pace."""
# no kind of segment has this number
DROPPED = -1.0


def with_borders_in_cells(run: RunData, rows: FloatArray) -> FloatArray:
    """Return segments without the cells within which the effort changes: the border of their neighbours lies in them.

    With one effort in each cell, one of part power stands where the best run would end full power within the cell; so
    does a brake's first cell. The energy of such a cell belongs to the neighbour that has its effort. One cell of power
    between coasting is full power for a part of it.
    """
    rows = rows.copy()
    # In order from the front, as a border that has moved is the start of the next segment.
    for k in range(rows.shape[0]):
        kind, first, last = rows[k, KIND], int(rows[k, FIRST]), int(rows[k, LAST])
        before = rows[k - 1, KIND] if k > 0 else STAND
        if _is_short_power(run, rows, k) and before in (COAST, STAND):
            if _move_border(run, rows[k + 1], first, last, FULL_POWER):
                rows[k, KIND] = FULL_POWER
            continue
        if before not in (FULL_POWER, COAST, HOLD):
            continue
        if kind == BRAKE:
            in_part = abs(run.effort_n[first]) < WHOLE_CELL_SHARE * abs(run.effort_n[min(first + 1, last - 1)])
            if in_part and rows[k, PLACE] == run.position_m[first]:
                _move_border(run, rows[k], first, first + 1, before)
            continue
        if kind != PART_POWER or rows[k, STEADY] > 0.0 or duration_s(run, rows[k]) >= SHORTEST_S:
            continue
        if k + 1 == rows.shape[0]:
            continue
        after = rows[k + 1, KIND]
        # no cell of power may lie in coasting as a whole
        single = last == first + 1 or COAST not in (before, after)
        passes_on = after in (FULL_POWER, COAST, HOLD, BRAKE)
        if single and passes_on and after != before and _move_border(run, rows[k + 1], first, last, before):
            rows[k, KIND] = DROPPED
            if before == COAST:
                rows[k + 1, FIRST] = first
            else:
                rows[k - 1, LAST] = last
    remaining: FloatArray = rows[rows[:, KIND] != DROPPED]
    return remaining


def _is_short_power(run: RunData, rows: FloatArray, row: int) -> bool:
    """Return whether a segment is a cell of part power that quickens the train, before coasting."""
    if rows[row, KIND] != PART_POWER or rows[row, STEADY] > 0.0 or rows[row, LAST] > rows[row, FIRST] + 1:
        return False
    if duration_s(run, rows[row]) >= SHORTEST_S or row + 1 == rows.shape[0] or rows[row + 1, KIND] != COAST:
        return False
    return bool(run.speed_ms[int(rows[row, LAST])] > run.speed_ms[int(rows[row, FIRST])])


def _move_border(run: RunData, row: FloatArray, first: int, last: int, before: float) -> bool:
    """Let a segment begin within cells at the end of which another would begin; return False where that is too far.

    The work of the cells and the speeds at their ends stay as they are.
    """
    length = run.position_m[last] - run.position_m[first]
    speed2, leaving2 = run.speed_ms[first] ** 2, run.speed_ms[last] ** 2
    # With one effort before the border and another after it, both constant, v^2 is linear on either side. Work and
    # end speeds stay those of the cells, so the border is where the two efforts have the mean effort as their
    # average.
    slope = (leaving2 - speed2) / length
    effort = largest = 0.0
    for i in range(first, last):
        share = (run.position_m[i + 1] - run.position_m[i]) / length
        effort += share * run.effort_n[i]
        largest += share * run.largest_effort_n[i]
    half = 0.5 * run.inertia_kg
    # the effort with which the speed would stay
    holding_n = effort - slope * half
    before_n = _effort_of(before, largest, holding_n, 0.0)
    after_n = _effort_of(row[KIND], largest, holding_n, run.effort_n[min(last, run.effort_n.shape[0] - 1)])
    if abs(before_n - after_n) <= 1e-9 * abs(largest):
        return False
    part = (effort - after_n) / (before_n - after_n)
    if not -EFFORT_SLACK < part < 1.0 + EFFORT_SLACK:
        return False
    part = min(max(part, 0.0), 1.0)
    border2 = max(speed2 + (slope + (before_n - effort) / half) * part * length, 0.0)
    chord2 = speed2 + slope * part * length
    speed = math.sqrt(border2)
    if last - first > 1 and abs(speed - math.sqrt(chord2)) > 2.0 * HOLD_TOLERANCE_MS:
        return False
    # the corner of the two lines may lie above both ends, and thus above a limit that the cell itself keeps
    if speed > max(np.min(run.limit_ms[first:last]), run.speed_ms[first], run.speed_ms[last]):
        return False
    row[PLACE], row[SPEED] = run.position_m[first] + part * length, speed
    # length over mean speed, as v^2 is linear; the bound is for starts, where both speeds are 0
    duration = 2.0 * part * length / max(run.speed_ms[first] + speed, 1e-9)
    row[TIME] = min(run.time_s[first] + duration, run.time_s[last])
    return True


def _effort_of(kind: float, largest: float, holding_n: float, braking: float) -> float:
    """Return the effort [N] that a kind of segment has where it could be full power, a hold or a brake."""
    if kind == FULL_POWER:
        return largest
    if kind == HOLD:
        return holding_n
    return braking if kind == BRAKE else 0.0


def without_negligible_power(run: RunData, rows: FloatArray, negligible: BoolArray) -> FloatArray:
    """Return segments without full power between coasting that advice cannot tell; mark its cells as negligible.

    Advice tells places in whole metres, power at the next one and coasting at the nearest: power that begins and ends
    at the same would be an instruction of no length. It is coasting, if it changes the speed by less than a tenth of a
    km/h.
    """
    out = np.empty_like(rows)
    count = k = 0
    while k < rows.shape[0]:
        between = count > 0 and k + 1 < rows.shape[0] and rows[k, KIND] == FULL_POWER
        if between and out[count - 1, KIND] == COAST and rows[k + 1, KIND] == COAST and _is_negligible(run, rows, k):
            negligible[int(rows[k, FIRST]) : int(rows[k, LAST])] = True
            out[count - 1, LAST] = rows[k + 1, LAST]
            k += 2
            continue
        out[count] = rows[k]
        count += 1
        k += 1
    return out[:count]


def _is_negligible(run: RunData, rows: FloatArray, row: int) -> bool:
    """Return whether power has no length in whole metres and hardly changes the speed."""
    if math.ceil(rows[row, PLACE]) < round(rows[row + 1, PLACE]):
        return False
    work = 0.0
    for i in range(int(rows[row, FIRST]), int(rows[row, LAST])):
        work += run.effort_n[i] * (run.position_m[i + 1] - run.position_m[i])
    mean_speed = 0.5 * (rows[row, SPEED] + rows[row + 1, SPEED])
    return bool(work < 2.0 * NEGLIGIBLE_MS * run.inertia_kg * mean_speed)


# ---- straight pieces


def with_steady_pieces(run: RunData, rows: FloatArray) -> FloatArray:
    """Return segments with part power and braking cut into pieces over which the speed squared changes steadily."""
    out = np.empty((run.effort_n.shape[0] + rows.shape[0], COLUMNS))
    count = k = 0
    while k < rows.shape[0]:
        end = k + 1
        kind = rows[k, KIND]
        if kind == PART_POWER and rows[k, STEADY] == 0.0:
            # short coasting between or after part power is but less of it
            while end < rows.shape[0] and _continues_part_power(run, rows[end]):
                end += 1
            count = _write_pieces(run, rows, k, end, out, count)
        elif kind == BRAKE and not _is_full_brake(run, rows[k]):
            count = _write_pieces(run, rows, k, end, out, count)
        else:
            out[count] = rows[k]
            if kind == BRAKE:
                out[count, SHARE] = _braking_share(run, rows[k])
            count += 1
        k = end
    return out[:count]


def _continues_part_power(run: RunData, row: FloatArray) -> bool:
    """Return whether a segment after part power may be a part of it."""
    if row[KIND] == PART_POWER:
        return bool(row[STEADY] == 0.0)
    return bool(row[KIND] == COAST and duration_s(run, row) < SHORTEST_S)


def _is_full_brake(run: RunData, row: FloatArray) -> bool:
    """Return whether a brake takes nearly all that the brakes have in each cell; the first may be braked in part."""
    first, last = int(row[FIRST]), int(row[LAST])
    for i in range(first if last == first + 1 else first + 1, last):
        if -run.effort_n[i] < FULL_BRAKING_SHARE * (spare_braking_n(run, i) - run.effort_n[i]):
            return False
    return True


def _braking_share(run: RunData, row: FloatArray) -> float:
    """Return which share of what the brakes have is used; a first cell that is braked in part tells nothing."""
    first, last = int(row[FIRST]), int(row[LAST])
    if row[PLACE] > run.position_m[first] and last > first + 1:
        first += 1
    used = all_of_it = 0.0
    for i in range(first, last):
        length = run.position_m[i + 1] - run.position_m[i]
        used -= run.effort_n[i] * length
        all_of_it += (spare_braking_n(run, i) - run.effort_n[i]) * length
    return min(used / all_of_it, 1.0) if all_of_it > 0.0 else 1.0


def spare_braking_n(run: RunData, cell: int, gain_ms2: float = 0.0) -> float:
    """Return how much more a train could brake in a cell than it does [N].

    Parameters
    ----------
    run : RunData
        The run.
    cell : int
        Where it is.
    gain_ms2 : float
        By how much its square of speed changes more over a metre, in the part of the cell in question, than on
        average over the cell [m/s2].
    """
    half = 0.5 * run.inertia_kg
    spare = max(run.largest_braking_n[cell] + run.effort_n[cell] + half * gain_ms2, 0.0)
    if run.max_deceleration_ms2 < math.inf:
        change = run.speed_ms[cell + 1] ** 2 - run.speed_ms[cell] ** 2
        # d(v^2)/dx = 2 a: the deceleration that is left is the limit less what the run has
        slope = change / (run.position_m[cell + 1] - run.position_m[cell]) + gain_ms2
        spare = min(spare, max(half * (2.0 * run.max_deceleration_ms2 + slope), 0.0))
    return float(spare)


def _write_pieces(run: RunData, rows: FloatArray, first_row: int, end_row: int, out: FloatArray, count: int) -> int:
    """Write the straight pieces of rows that follow one another; return how many segments there are then."""
    nodes, coasts = _nodes_of(run, rows, first_row, end_row)
    begin, end = 0, nodes.shape[0] - 1
    while begin < end:
        kind = rows[first_row, KIND]
        if coasts[begin]:
            kind, until = COAST, begin + 1
            while until < end and coasts[until]:
                until += 1
        else:
            until = _steady_end(run, nodes, coasts, begin)
            change = abs(nodes[until, 2] - nodes[begin, 2])
            if change <= min(STEADY_MS2 * (nodes[until, 1] - nodes[begin, 1]), 2.0 * HOLD_TOLERANCE_MS):
                kind = HOLD
        row = out[count]
        row[KIND], row[FIRST], row[LAST] = kind, nodes[begin, 3], nodes[until, 3]
        row[PLACE], row[TIME], row[SPEED] = nodes[begin, 0], nodes[begin, 1], nodes[begin, 2]
        row[SHARE], row[STEADY] = np.nan, 1.0
        if kind == BRAKE:
            row[SHARE] = _braking_share(run, row)
        count += 1
        begin = until
    return count


def _nodes_of(run: RunData, rows: FloatArray, first_row: int, end_row: int) -> tuple[FloatArray, BoolArray]:
    """Return place, time, speed and number of the nodes of rows, and whether the train coasts from each of them."""
    first, last = int(rows[first_row, FIRST]), int(rows[end_row - 1, LAST])
    nodes = np.empty((last - first + 2, 4))
    coasts = np.zeros(last - first + 2, np.bool_)
    begin = rows[first_row, PLACE]
    nodes[0] = begin, rows[first_row, TIME], rows[first_row, SPEED], float(first)
    end = rows[end_row, PLACE] if end_row < rows.shape[0] else run.position_m[last]
    count, k = 1, first_row
    for i in range(first + 1, last + 1):
        if begin < run.position_m[i] < end:
            while int(rows[k, LAST]) <= i:
                k += 1
            nodes[count] = run.position_m[i], run.time_s[i], run.speed_ms[i], float(i)
            coasts[count] = rows[k, KIND] == COAST
            count += 1
    nodes[count] = end, run.time_s[last], run.speed_ms[last], float(last)
    if end_row < rows.shape[0]:
        nodes[count, 1], nodes[count, 2] = rows[end_row, TIME], rows[end_row, SPEED]
    return nodes[: count + 1], coasts[: count + 1]


def _steady_end(run: RunData, nodes: FloatArray, coasts: BoolArray, begin: int) -> int:
    """Return the farthest node to which a straight line of speed squared stays near the run, and below limits.

    It ends within part power, or where coasting ends or begins. The slopes that pass near all nodes so far are an
    interval, which each further node narrows.
    """
    place, speed2 = nodes[begin, 0], nodes[begin, 2] ** 2
    # One pass instead of a fit for each end: a line from `begin` passes near a node if its slope lies in an interval
    # of that node, so the intersection of all intervals so far tells whether any line does.
    least, most, best = -np.inf, np.inf, begin + 1
    for k in range(begin + 1, nodes.shape[0]):
        distance, speed = nodes[k, 0] - place, nodes[k, 2]
        slope = (speed**2 - speed2) / distance
        delay_s = 2.0 * distance / (nodes[begin, 2] + speed) - (nodes[k, 1] - nodes[begin, 1])
        if least <= slope <= most and abs(delay_s) <= TIMING_TOLERANCE_S and not (coasts[k] and coasts[k - 1]):
            best = k
        i = int(nodes[k, 3])
        limit = min(run.limit_ms[i - 1], run.limit_ms[min(i, run.limit_ms.shape[0] - 1)])
        low = max(speed - HOLD_TOLERANCE_MS, 0.0)
        high = min(speed + HOLD_TOLERANCE_MS, max(limit, speed))
        least, most = max(least, (low**2 - speed2) / distance), min(most, (high**2 - speed2) / distance)
        if least > most:
            break
    return best
