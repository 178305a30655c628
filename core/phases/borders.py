"""Borders of segments within cells, and the straight pieces of part power and braking."""

import math
from collections.abc import Iterator

import numpy as np

from railjoule.core.arrays import BoolArray, FloatArray
from railjoule.core.phases.labels import HOLD_TOLERANCE_MS, NEGLIGIBLE_MS, SHORTEST_S, STEADY_MS2
from railjoule.core.phases.phase import BRAKE, COAST, FULL_POWER, HOLD, PART_POWER, STAND, RunData
from railjoule.core.phases.segments import Segment, duration_s

# A driver has a few notches and cannot distinguish nine tenths from full braking. With a lower share, the advised brake
# would stop short.
FULL_BRAKING_SHARE = 0.9
"""From this share of the effort of the brakes on, in each cell, the train brakes fully."""
# within 2 per cent of the next cell it is the same braking; with less, the train coasted for a part of the cell
WHOLE_CELL_SHARE = 0.98
"""A brake's first cell with less than this share of the next one's effort is braked in part."""
# The efforts of the neighbours are taken at their own mean speeds, so the cell between them may be a little outside.
EFFORT_SLACK = 0.05
"""A cell passes on from one segment to the next if its effort lies between theirs, or outside by at most this share."""
TIMING_TOLERANCE_S = 0.25
"""Largest difference between the duration of a straight piece and of the run there [s]; it counts at walking pace."""
# no kind of segment has this number
DROPPED = -1


def with_borders_in_cells(run: RunData, segments: list[Segment]) -> list[Segment]:
    """Return segments without the cells within which the effort changes: the border of their neighbours lies in them.

    With one effort in each cell, one of part power stands where the best run would end full power within the cell; so
    does a brake's first cell. The energy of such a cell belongs to the neighbour that has its effort. One cell of power
    between coasting is full power for a part of it.
    """
    # In order from the front, as a border that has moved is the start of the next segment.
    for k, one in enumerate(segments):
        previous = segments[k - 1] if k > 0 else None
        following = segments[k + 1] if k + 1 < len(segments) else None
        before = previous.kind if previous else STAND
        if _is_short_power(run, one, following) and before in (COAST, STAND):
            if following and _move_border(run, following, one.first, one.last, FULL_POWER):
                one.kind = FULL_POWER
            continue
        if before not in (FULL_POWER, COAST, HOLD):
            continue
        if one.kind == BRAKE:
            second = min(one.first + 1, one.last - 1)
            in_part = abs(run.effort_n[one.first]) < WHOLE_CELL_SHARE * abs(run.effort_n[second])
            if in_part and one.place_m == run.position_m[one.first]:
                _move_border(run, one, one.first, one.first + 1, before)
        elif previous and following and _passes_on(run, before, one, following):
            one.kind = DROPPED
            if before == COAST:
                following.first = one.first
            else:
                previous.last = one.last
    return [one for one in segments if one.kind != DROPPED]


def _passes_on(run: RunData, before: int, one: Segment, following: Segment) -> bool:
    """Return whether short part power is but a border between its neighbours, and move the border if so."""
    if one.kind != PART_POWER or one.is_straight or duration_s(run, one) >= SHORTEST_S:
        return False
    after = following.kind
    # no cell of power may lie in coasting as a whole
    single = one.last == one.first + 1 or COAST not in (before, after)
    leads_on = after in (FULL_POWER, COAST, HOLD, BRAKE) and after != before
    return single and leads_on and _move_border(run, following, one.first, one.last, before)


def _is_short_power(run: RunData, one: Segment, following: Segment | None) -> bool:
    """Return whether a segment is a cell of part power that accelerates the train, before coasting."""
    is_cell = one.kind == PART_POWER and not one.is_straight and one.last == one.first + 1
    if not is_cell or following is None or following.kind != COAST or duration_s(run, one) >= SHORTEST_S:
        return False
    return bool(run.speed_ms[one.last] > run.speed_ms[one.first])


def _move_border(run: RunData, one: Segment, first: int, last: int, before: int) -> bool:
    """Let a segment begin within cells at the end of which another would begin; return False where that is too far.

    The work of the cells and the speeds at their ends stay as they are.
    """
    length = run.position_m[last] - run.position_m[first]
    speed2, leaving2 = run.speed_ms[first] ** 2, run.speed_ms[last] ** 2
    # With one effort before the border and another after it, both constant, v^2 is linear on either side. Work and end
    # speeds stay those of the cells, so the border is where the two efforts have the mean effort as their average.
    slope, half = (leaving2 - speed2) / length, 0.5 * run.inertia_kg
    effort, largest = (work / length for work in run.work_j(first, last))
    # the effort with which the speed would stay
    efforts = {FULL_POWER: largest, HOLD: effort - slope * half}
    before_n = efforts.get(before, 0.0)
    braking_n = run.effort_n[min(last, len(run.effort_n) - 1)]
    after_n = braking_n if one.kind == BRAKE else efforts.get(one.kind, 0.0)
    if abs(before_n - after_n) <= 1e-9 * abs(largest):
        return False
    part = (effort - after_n) / (before_n - after_n)
    if not -EFFORT_SLACK < part < 1.0 + EFFORT_SLACK:
        return False
    part = min(max(part, 0.0), 1.0)
    speed = math.sqrt(max(speed2 + (slope + (before_n - effort) / half) * part * length, 0.0))
    chord = math.sqrt(speed2 + slope * part * length)
    if last - first > 1 and abs(speed - chord) > 2.0 * HOLD_TOLERANCE_MS:
        return False
    # the corner of the two lines may lie above both ends, and thus above a limit that the cell itself keeps
    if speed > max(np.min(run.limit_ms[first:last]), run.speed_ms[first], run.speed_ms[last]):
        return False
    one.place_m, one.speed_ms = float(run.position_m[first] + part * length), speed
    # length over mean speed, as v^2 is linear; the bound is for starts, where both speeds are 0
    duration = 2.0 * part * length / max(run.speed_ms[first] + speed, 1e-9)
    one.time_s = float(min(run.time_s[first] + duration, run.time_s[last]))
    return True


def without_negligible_power(run: RunData, segments: list[Segment], negligible: BoolArray) -> list[Segment]:
    """Return segments without full power between coasting that advice cannot show; mark its cells as negligible.

    Advice shows places in whole metres, power at the next one and coasting at the nearest: power that begins and ends
    at the same one would be an instruction of no length. It is coasting, if it changes the speed by less than a tenth
    of a km/h.
    """
    out: list[Segment] = []
    k = 0
    while k < len(segments):
        kinds = [one.kind for one in (*out[-1:], *segments[k : k + 2])]
        if kinds == [COAST, FULL_POWER, COAST] and _is_negligible(run, segments[k], segments[k + 1]):
            negligible[segments[k].first : segments[k].last] = True
            out[-1].last = segments[k + 1].last
            k += 2
        else:
            out.append(segments[k])
            k += 1
    return out


def _is_negligible(run: RunData, power: Segment, coast: Segment) -> bool:
    """Return whether power has no length in whole metres and hardly changes the speed."""
    if math.ceil(power.place_m) < round(coast.place_m):
        return False
    mean_speed = 0.5 * (power.speed_ms + coast.speed_ms)
    return run.work_j(power.first, power.last)[0] < 2.0 * NEGLIGIBLE_MS * run.inertia_kg * mean_speed


# ---- straight pieces


def with_steady_pieces(run: RunData, segments: list[Segment]) -> list[Segment]:
    """Return segments with part power and braking cut into pieces over which the speed squared changes steadily."""
    out: list[Segment] = []
    k = 0
    while k < len(segments):
        one, end = segments[k], k + 1
        is_bent = one.kind == PART_POWER and not one.is_straight
        # short coasting between or after part power is but less of it
        while is_bent and end < len(segments) and _continues_part_power(run, segments[end]):
            end += 1
        if is_bent or (one.kind == BRAKE and not _is_full_brake(run, one)):
            out += _pieces(run, segments[k:end], segments[end] if end < len(segments) else None)
        else:
            if one.kind == BRAKE:
                one.share = _braking_share(run, one)
            out.append(one)
        k = end
    return out


def _continues_part_power(run: RunData, one: Segment) -> bool:
    """Return whether a segment after part power may be a part of it."""
    if one.kind == PART_POWER:
        return not one.is_straight
    return one.kind == COAST and duration_s(run, one) < SHORTEST_S


def _is_full_brake(run: RunData, one: Segment) -> bool:
    """Return whether a brake takes nearly all that the brakes have in each cell; the first may be braked in part."""
    cells = range(one.first if one.last == one.first + 1 else one.first + 1, one.last)
    used = [-float(run.effort_n[i]) for i in cells]
    return all(n >= FULL_BRAKING_SHARE * (spare_braking_n(run, i) + n) for i, n in zip(cells, used, strict=True))


def _braking_share(run: RunData, one: Segment) -> float:
    """Return the share of the brakes that is used; a first cell that is braked in part does not count."""
    first = one.first + (one.place_m > run.position_m[one.first] and one.last > one.first + 1)
    used = -run.work_j(first, one.last)[0]
    lengths = np.diff(run.position_m[first : one.last + 1]).tolist()
    spare = sum(spare_braking_n(run, i) * length for i, length in enumerate(lengths, first))
    return min(used / (used + spare), 1.0) if used + spare > 0.0 else 1.0


def spare_braking_n(run: RunData, cell: int, gain_ms2: float = 0.0) -> float:
    """Return how much more a train could brake in a cell than it does [N].

    Parameters
    ----------
    run : RunData
    cell : int
    gain_ms2 : float
        By how much its square of speed changes more over a metre, in the part of the cell in question, than on
        average over the cell [m/s2].
    """
    half = 0.5 * run.inertia_kg
    spare = max(run.max_braking_n[cell] + run.effort_n[cell] + half * gain_ms2, 0.0)
    if run.max_deceleration_ms2 < math.inf:
        change = run.speed_ms[cell + 1] ** 2 - run.speed_ms[cell] ** 2
        # d(v^2)/dx = 2 a: the deceleration that is left is the limit less that of the run
        slope = change / (run.position_m[cell + 1] - run.position_m[cell]) + gain_ms2
        spare = min(spare, max(half * (2.0 * run.max_deceleration_ms2 + slope), 0.0))
    return float(spare)


def _pieces(run: RunData, group: list[Segment], following: Segment | None) -> Iterator[Segment]:
    """Yield the straight pieces of segments that follow one another."""
    nodes, coasts = _nodes(run, group, following)
    begin, end = 0, len(nodes) - 1
    while begin < end:
        kind = group[0].kind
        if coasts[begin]:
            kind, until = COAST, begin + 1
            while until < end and coasts[until]:
                until += 1
        else:
            until = _steady_end(run, nodes, coasts, begin)
            change = abs(nodes[until, 2] - nodes[begin, 2])
            if change <= min(STEADY_MS2 * (nodes[until, 1] - nodes[begin, 1]), 2.0 * HOLD_TOLERANCE_MS):
                kind = HOLD
        place, time, speed, first = nodes[begin].tolist()
        piece = Segment(kind, int(first), int(nodes[until, 3]), place, time, speed, is_straight=True)
        if kind == BRAKE:
            piece.share = _braking_share(run, piece)
        yield piece
        begin = until


def _nodes(run: RunData, group: list[Segment], following: Segment | None) -> tuple[FloatArray, BoolArray]:
    """Return place, time, speed and number of the nodes of segments, and whether the train coasts from each of them."""
    start, last = group[0], group[-1].last
    track = np.column_stack([run.position_m, run.time_s, run.speed_ms, np.arange(len(run.time_s))])
    end = (following.place_m, following.time_s, following.speed_ms) if following else track[last, :3]
    inner = track[start.first + 1 : last + 1]
    inner = inner[(inner[:, 0] > start.place_m) & (inner[:, 0] < end[0])]
    later = [*group, *([following] if following else [])]
    coasts = [next(one.kind for one in later if one.last > i) == COAST for i in inner[:, 3].astype(int).tolist()]
    nodes = np.vstack([[start.place_m, start.time_s, start.speed_ms, start.first], inner, [*end, last]])
    return nodes, np.array([False, *coasts, False])


def _steady_end(run: RunData, nodes: FloatArray, coasts: BoolArray, begin: int) -> int:
    """Return the farthest node to which a straight line of speed squared stays near the run, and below limits.

    It ends within part power, or where coasting ends or begins. A line from `begin` passes near a node if its slope
    lies in an interval of that node, so that the intersection of all intervals decides whether any line does.
    """
    place, time, started, _ = nodes[begin]
    distance, speed = nodes[begin + 1 :, 0] - place, nodes[begin + 1 :, 2]
    cells = nodes[begin + 1 :, 3].astype(int)
    limit = np.minimum(run.limit_ms[cells - 1], run.limit_ms[np.minimum(cells, len(run.limit_ms) - 1)])
    low = np.maximum(speed - HOLD_TOLERANCE_MS, 0.0)
    high = np.minimum(speed + HOLD_TOLERANCE_MS, np.maximum(limit, speed))
    slope, least, most = ((one**2 - started**2) / distance for one in (speed, low, high))
    # the intervals of all nodes before each one
    least = np.maximum.accumulate(np.append(-np.inf, least))
    most = np.minimum.accumulate(np.append(np.inf, most))
    # the duration of the line is its length over its mean speed, which may be 0
    mean = 0.5 * (started + speed)
    in_time = np.abs(distance - mean * (nodes[begin + 1 :, 1] - time)) <= TIMING_TOLERANCE_S * mean
    near = (least[:-1] <= slope) & (slope <= most[:-1]) & in_time
    fits = near & ~(coasts[begin + 1 :] & coasts[begin:-1])
    return begin + 1 + int(np.max(np.flatnonzero(fits), initial=0))
