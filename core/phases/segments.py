"""Runs of cells that are done alike, and what becomes of those that are too short for an instruction.

A segment is a row of an array, its columns below: what is done, its cells, place, time and speed where it begins, the
share of effort of a brake or a hold by turns, and whether it is one straight line of speed squared.
"""

import numpy as np

from railjoule.core.arrays import BoolArray, FloatArray, IntArray
from railjoule.core.phases.labels import HOLD_TOLERANCE_MS, NEGLIGIBLE_MS, PULSE_S, SHORTEST_S
from railjoule.core.phases.phase import COAST, FULL_POWER, HOLD, PART_POWER, STAND
from railjoule.core.phases.run_data import RunData

# an array and no tuple, as rows are changed in place and cut out
KIND, FIRST, LAST, PLACE, TIME, SPEED, SHARE, STEADY = range(8)
COLUMNS = 8
# a notch that is taken back for seconds, and no choice of another speed; below, the train would get far too fast
REDUCED_POWER_SHARE = 0.5
"""Power that is briefly less than full, but not below this share of it, counts as full."""
PULSE_TOLERANCE_MS = 2.0 * HOLD_TOLERANCE_MS
"""The mean speeds of pulses stay within this of one another's middle; so far up and down a driver lets it swing."""
# twice is what a limit or a gradient may cause; three times is a pattern
LEAST_PULSES = 3
"""So many times power is taken off and on before the advice is to hold by turns."""


def segments_of(run: RunData, labels: IntArray, begins_hold: BoolArray) -> FloatArray:
    """Return the segments of labelled cells; shape (k, COLUMNS)."""
    n = labels.shape[0]
    rows = np.zeros((n, COLUMNS))
    count = 0
    for i in range(n):
        if i > 0 and labels[i] == labels[i - 1] and not begins_hold[i]:
            rows[count - 1, LAST] = i + 1
            continue
        _set(run, rows, count, labels[i], i, i + 1)
        count += 1
    return rows[:count]


def _set(run: RunData, rows: FloatArray, row: int, kind: int, first: int, last: int) -> None:
    """Make a row a segment that begins at a node."""
    rows[row, KIND], rows[row, FIRST], rows[row, LAST] = kind, first, last
    rows[row, PLACE], rows[row, TIME] = run.position_m[first], run.time_s[first]
    rows[row, SPEED], rows[row, SHARE], rows[row, STEADY] = run.speed_ms[first], np.nan, 0.0


def duration_s(run: RunData, row: FloatArray) -> float:
    """Return how long the cells of a segment last [s]."""
    return float(run.time_s[int(row[LAST])] - run.time_s[int(row[FIRST])])


# ---- what is too short beside full power and holds


def joined(run: RunData, rows: FloatArray) -> FloatArray:
    """Return segments without power that is briefly less than full, and without coasting that a hold covers."""
    out = np.empty_like(rows)
    count = 0
    for k in range(rows.shape[0]):
        row = rows[k]
        out[count] = row
        count += 1
        if row[KIND] == FULL_POWER and count > 1 and _is_reduced_power(run, out[count - 2], row):
            if count == 2 or out[count - 3, KIND] == STAND:
                out[count - 2, KIND], out[count - 2, LAST] = FULL_POWER, row[LAST]
                count -= 1
            elif out[count - 3, KIND] == FULL_POWER:
                out[count - 3, LAST] = row[LAST]
                count -= 2
        elif row[KIND] == HOLD and count > 2 and _belongs_to_hold(run, out[count - 2], row, out[count - 3]):
            _set(run, out, count - 2, HOLD, int(out[count - 2, FIRST]), int(row[LAST]))
            count -= 1
        elif (
            count > 1
            and k + 1 < rows.shape[0]
            and out[count - 2, KIND] == HOLD
            and _belongs_to_hold(run, row, out[count - 2], rows[k + 1])
        ):
            out[count - 2, LAST] = row[LAST]
            count -= 1
    return out[:count]


def _is_reduced_power(run: RunData, part: FloatArray, full: FloatArray) -> bool:
    """Return whether part power before full power is so short and strong that full power throughout does no harm."""
    if part[KIND] != PART_POWER or duration_s(run, part) >= SHORTEST_S:
        return False
    used = full_work = 0.0
    first, last, end = int(part[FIRST]), int(part[LAST]), int(full[LAST])
    for i in range(first, last):
        length = run.position_m[i + 1] - run.position_m[i]
        used += run.effort_n[i] * length
        full_work += run.largest_effort_n[i] * length
    if used < REDUCED_POWER_SHARE * full_work:
        return False
    # what full power adds is kept until the speed of the advice is reached
    # the surplus of v^2, by work = m d(v^2) / 2
    more = 2.0 * (full_work - used) / run.inertia_kg
    for i in range(first, end):
        speed2 = min(run.speed_ms[i + 1] ** 2 + more, run.speed_ms[end] ** 2)
        if speed2 > max(run.limit_ms[i], run.speed_ms[i + 1]) ** 2:
            return False
    return True


def _belongs_to_hold(run: RunData, short: FloatArray, hold: FloatArray, following: FloatArray) -> bool:
    """Return whether a segment beside a hold is short and keeps the speed that is held.

    It is part power of some cells, of which one may be a border, or coasting between the hold and more power.
    """
    if duration_s(run, short) >= SHORTEST_S:
        return False
    if short[KIND] == COAST:
        if following[KIND] != FULL_POWER and following[KIND] != PART_POWER and following[KIND] != HOLD:
            return False
    elif short[KIND] != PART_POWER or short[LAST] == short[FIRST] + 1:
        return False
    first = int(min(short[FIRST], hold[FIRST]))
    last = int(max(short[LAST], hold[LAST]))
    speeds = run.speed_ms[first : last + 1]
    return bool(_keeps_one_limit(run, first, last) and np.max(speeds) - np.min(speeds) <= 2.0 * HOLD_TOLERANCE_MS)


# ---- pulses


def with_pulses(run: RunData, rows: FloatArray) -> FloatArray:
    """Return segments with pulses of power made what a driver can do: hold the speed by turns, or part power."""
    out = np.empty((2 * rows.shape[0] + 2, COLUMNS))
    count = k = 0
    while k < rows.shape[0]:
        end = k
        while end < rows.shape[0] and _is_pulse(run, rows[end]):
            end += 1
        first, last = k, end
        # coasting at the ends is no pulse: it leads away from the speed that the pulses keep
        while last > first and rows[last - 1, KIND] == COAST:
            last -= 1
        powered = k > 0 and rows[k - 1, KIND] in (FULL_POWER, PART_POWER, HOLD)
        while not powered and first < last and rows[first, KIND] == COAST:
            first += 1
        if np.sum(rows[first:last, KIND] == COAST) < LEAST_PULSES:
            last = first = max(end, k + 1)
        out[count : count + first - k] = rows[k:first]
        count += first - k
        unassigned = first
        while first < last:
            group = _level_group(run, rows, first, last)
            if _is_alternating_hold(run, rows[first:group]):
                count = _write_steady_changes(run, rows[unassigned:first], out, count)
                count = _write_alternating_hold(run, rows[first:group], out, count)
                unassigned = group
            first = group
        count = _write_steady_changes(run, rows[unassigned:last], out, count)
        k = first
    return out[:count]


def _is_pulse(run: RunData, row: FloatArray) -> bool:
    """Return whether power or coasting is so short that it may be one of several pulses."""
    if row[KIND] == COAST:
        return duration_s(run, row) < PULSE_S
    return (row[KIND] == FULL_POWER or row[KIND] == PART_POWER) and duration_s(run, row) < SHORTEST_S


def _level_group(run: RunData, rows: FloatArray, first: int, last: int) -> int:
    """Return the end of the pulses from `first` on that keep one mean speed: the row after one of power."""
    low, high, end = np.inf, -np.inf, first + 1
    for k in range(first, last):
        if rows[k, KIND] != COAST:
            end = k + 1
            continue
        # of the coasting, half-way down: the pulses of one hold share it, those of a changing speed do not
        middle = 0.5 * (run.speed_ms[int(rows[k, FIRST])] + run.speed_ms[int(rows[k, LAST])])
        low, high = min(low, middle), max(high, middle)
        if high - low > 2.0 * PULSE_TOLERANCE_MS:
            break
    # a group of coasting alone takes the power that follows
    return min(end + 1, last) if end == first + 1 and rows[first, KIND] == COAST else end


def _is_alternating_hold(run: RunData, group: FloatArray) -> bool:
    """Return whether pulses of one mean speed are so many that they are a hold; none of them under another's limit."""
    first, last = int(group[0, FIRST]), int(group[-1, LAST])
    many = np.sum(group[:, KIND] == COAST) >= LEAST_PULSES and run.time_s[last] - run.time_s[first] > PULSE_S
    return bool(many and _keeps_one_limit(run, first, last))


def _keeps_one_limit(run: RunData, first: int, last: int) -> bool:
    """Return whether all speeds of cells keep the lowest limit of them."""
    return bool(np.max(run.speed_ms[first : last + 1]) <= np.min(run.limit_ms[first:last]) + NEGLIGIBLE_MS)


def _write_alternating_hold(run: RunData, group: FloatArray, out: FloatArray, count: int) -> int:
    """Write pulses as a hold by turns; return how many segments there are then.

    The end of the last pulse is aimed at: where in a turn coasting for good begins must not be left to chance.
    """
    last = int(group[-1, LAST])
    row = group.shape[0] - 1
    # the last pulse, and so many before it that the rest is long enough for an instruction
    while row > 0 and (group[row, KIND] != COAST or run.time_s[last] - run.time_s[int(group[row, FIRST])] < SHORTEST_S):
        row -= 1
    if row > 0:
        _set(run, out, count, HOLD, int(group[0, FIRST]), int(group[row, FIRST]))
        out[count, SHARE] = _share_of_full_power(run, group)
        count += 1
    return _write_steady_change(run, group[row:], out, count)


def _write_steady_change(run: RunData, rows: FloatArray, out: FloatArray, count: int) -> int:
    """Write rows as one steady change of speed, or as they are where that would break a limit."""
    first, last = int(rows[0, FIRST]), int(rows[-1, LAST])
    if not _steady_change_keeps_limits(run, first, last):
        out[count : count + rows.shape[0]] = rows
        return count + len(rows)
    _set(run, out, count, PART_POWER, first, last)
    out[count, STEADY] = 1.0
    return count + 1


def _share_of_full_power(run: RunData, group: FloatArray) -> float:
    """Return which share of full power the powered cells of a group use."""
    used = full = 0.0
    for k in range(group.shape[0]):
        if group[k, KIND] != COAST:
            for i in range(int(group[k, FIRST]), int(group[k, LAST])):
                length = run.position_m[i + 1] - run.position_m[i]
                used += run.effort_n[i] * length
                full += run.largest_effort_n[i] * length
    return used / full


def _write_steady_changes(run: RunData, group: FloatArray, out: FloatArray, count: int) -> int:
    """Write pulses as part power, each piece long enough for an instruction, and ending where a pulse ends."""
    begin = 0
    while begin < group.shape[0]:
        end, started = begin + 1, run.time_s[int(group[begin, FIRST])]
        # what is left after the piece must be long enough too
        for k in range(begin, group.shape[0]):
            long = run.time_s[int(group[k, LAST])] - started >= SHORTEST_S
            rest = run.time_s[int(group[-1, LAST])] - run.time_s[int(group[k, LAST])]
            end = k + 1
            if long and group[k, KIND] != COAST and rest >= SHORTEST_S:
                break
        count = _write_steady_change(run, group[begin:end], out, count)
        begin = end
    return count


def _steady_change_keeps_limits(run: RunData, first: int, last: int) -> bool:
    """Return whether a steady change of speed between two nodes keeps the limits."""
    place, speed2 = run.position_m[first], run.speed_ms[first] ** 2
    slope = (run.speed_ms[last] ** 2 - speed2) / (run.position_m[last] - place)
    for i in range(first, last):
        top = max(speed2 + slope * (run.position_m[i] - place), speed2 + slope * (run.position_m[i + 1] - place))
        if top > max(run.limit_ms[i], run.speed_ms[i], run.speed_ms[i + 1]) ** 2:
            return False
    return True
