"""Segments: stretches of cells with one action. Those that are too short for an instruction are joined or replaced."""

from dataclasses import dataclass, replace

import numpy as np

from railjoule.core.arrays import BoolArray, IntArray
from railjoule.core.phases.labels import HOLD_TOLERANCE_MS, NEGLIGIBLE_MS, PULSE_S, SHORTEST_S
from railjoule.core.phases.phase import COAST, FULL_POWER, HOLD, PART_POWER, STAND, RunData

# A notch that is taken back for seconds, and no choice of another speed; below, the train would get far too fast.
REDUCED_POWER_SHARE = 0.5
"""Power that is briefly less than full, but not below this share of it, counts as full."""
PULSE_TOLERANCE_MS = 2.0 * HOLD_TOLERANCE_MS
"""The mean speeds of pulses stay within this of one another's middle; so far up and down a driver lets it swing."""
# A limit or a gradient may cause two; three are a pattern.
MIN_PULSES = 3
"""So many times power is taken off and on before the advice is to hold by turns."""


@dataclass
class Segment:
    """Cells with one action.

    Parameters
    ----------
    kind : int
        The action, by number.
    first, last : int
        Its first cell, and the cell after its last one.
    place_m, time_s, speed_ms : float
        Place [m], time [s] and speed [m/s] of its start, which may lie within a cell.
    share : float or None
        Share of the effort of a brake, or of a hold by turns.
    is_straight : bool
        Whether it is one straight line of speed squared.
    """

    kind: int
    first: int
    last: int
    place_m: float
    time_s: float
    speed_ms: float
    share: float | None = None
    is_straight: bool = False


def segment(
    run: RunData, kind: int, first: int, last: int, share: float | None = None, is_straight: bool = False
) -> Segment:
    """Return a segment that begins at a node."""
    place, time, speed = (float(array[first]) for array in (run.position_m, run.time_s, run.speed_ms))
    return Segment(int(kind), first, last, place, time, speed, share, is_straight)


def split_segments(run: RunData, labels: IntArray, begins_hold: BoolArray) -> list[Segment]:
    """Return the segments of labelled cells."""
    starts = np.flatnonzero(np.append(True, (np.diff(labels) != 0) | begins_hold[1:])).tolist()
    return [segment(run, labels[a], a, b) for a, b in zip(starts, [*starts[1:], len(labels)], strict=True)]


def duration_s(run: RunData, one: Segment) -> float:
    """Return the duration of the cells of a segment [s]."""
    return float(run.time_s[one.last] - run.time_s[one.first])


# ---- segments that are too short beside full power and holds


def joined(run: RunData, segments: list[Segment]) -> list[Segment]:
    """Return segments without power that is briefly less than full, and without coasting that a hold covers."""
    out: list[Segment] = []
    for one, following in zip(segments, [*segments[1:], None], strict=True):
        before = out[-1] if out else None
        earlier = out[-2] if len(out) > 1 else None
        if before is None:
            out.append(replace(one))
        elif one.kind == FULL_POWER and _is_reduced_power(run, before, one):
            if earlier is None or earlier.kind == STAND:
                before.kind, before.last = FULL_POWER, one.last
            elif earlier.kind == FULL_POWER:
                earlier.last = one.last
                out.pop()
            else:
                out.append(replace(one))
        elif one.kind == HOLD and earlier is not None and _belongs_to_hold(run, before, one, earlier):
            out[-1] = segment(run, HOLD, before.first, one.last)
        elif one.kind != HOLD and following and before.kind == HOLD and _belongs_to_hold(run, one, before, following):
            before.last = one.last
        else:
            out.append(replace(one))
    return out


def _is_reduced_power(run: RunData, part: Segment, full: Segment) -> bool:
    """Return whether part power before full power is so short and strong that full power throughout does no harm."""
    used, full_work = run.work_j(part.first, part.last)
    is_short = part.kind == PART_POWER and duration_s(run, part) < SHORTEST_S
    if not is_short or used < REDUCED_POWER_SHARE * full_work:
        return False
    # The surplus of v^2, by work = m d(v^2) / 2, remains until the speed of the advice is reached.
    more = 2.0 * (full_work - used) / run.inertia_kg
    speed = run.speed_ms[part.first + 1 : full.last + 1]
    speed2 = np.minimum(speed**2 + more, speed[-1] ** 2)
    return bool(np.all(speed2 <= np.maximum(run.limit_ms[part.first : full.last], speed) ** 2))


def _belongs_to_hold(run: RunData, short: Segment, hold: Segment, following: Segment) -> bool:
    """Return whether a segment beside a hold is short and keeps the speed that is held.

    It is part power of some cells, of which one may be a border, or coasting between the hold and more power.
    """
    coasts = short.kind == COAST and following.kind in (FULL_POWER, PART_POWER, HOLD)
    if duration_s(run, short) >= SHORTEST_S or not (
        coasts or (short.kind == PART_POWER and short.last > short.first + 1)
    ):
        return False
    first, last = min(short.first, hold.first), max(short.last, hold.last)
    is_held = np.ptp(run.speed_ms[first : last + 1]) <= 2.0 * HOLD_TOLERANCE_MS
    return bool(is_held and run.keeps_one_limit(first, last, NEGLIGIBLE_MS))


# ---- pulses


def with_pulses(run: RunData, segments: list[Segment]) -> list[Segment]:
    """Return segments with pulses of power replaced by a speed that is held by turns, or by part power."""
    out: list[Segment] = []
    k = 0
    while k < len(segments):
        end = k
        while end < len(segments) and _is_pulse(run, segments[end]):
            end += 1
        first, last = k, end
        # Coasting at the ends is no pulse: it leads away from the speed that the pulses keep.
        while last > first and segments[last - 1].kind == COAST:
            last -= 1
        powered = k > 0 and segments[k - 1].kind in (FULL_POWER, PART_POWER, HOLD)
        while not powered and first < last and segments[first].kind == COAST:
            first += 1
        if _coast_count(segments[first:last]) < MIN_PULSES:
            last = first = max(end, k + 1)
        out += segments[k:first]
        unassigned = first
        while first < last:
            group = _level_group(run, segments, first, last)
            pulses = segments[first:group]
            # many pulses of one mean speed, none of them under another limit
            many = _coast_count(pulses) >= MIN_PULSES
            cells = pulses[0].first, pulses[-1].last
            lasts = run.time_s[cells[1]] - run.time_s[cells[0]] > PULSE_S
            if many and lasts and run.keeps_one_limit(*cells, NEGLIGIBLE_MS):
                out += _steady_changes(run, segments[unassigned:first])
                out += _alternating_hold(run, pulses)
                unassigned = group
            first = group
        out += _steady_changes(run, segments[unassigned:last])
        k = first
    return out


def _coast_count(segments: list[Segment]) -> int:
    return sum(one.kind == COAST for one in segments)


def _is_pulse(run: RunData, one: Segment) -> bool:
    """Return whether power or coasting is so short that it may be one of several pulses."""
    longest = {COAST: PULSE_S, FULL_POWER: SHORTEST_S, PART_POWER: SHORTEST_S}.get(one.kind, 0.0)
    return duration_s(run, one) < longest


def _level_group(run: RunData, segments: list[Segment], first: int, last: int) -> int:
    """Return the end of the pulses from `first` on that keep one mean speed: the index after one of power."""
    low, high, end = np.inf, -np.inf, first + 1
    for k in range(first, last):
        one = segments[k]
        if one.kind != COAST:
            end = k + 1
            continue
        # half-way down the coasting: the pulses of one hold share this speed, those of a changing speed do not
        middle = 0.5 * (run.speed_ms[one.first] + run.speed_ms[one.last])
        low, high = min(low, middle), max(high, middle)
        if high - low > 2.0 * PULSE_TOLERANCE_MS:
            break
    # a group that has only coasting takes the power that follows
    return min(end + 1, last) if end == first + 1 and segments[first].kind == COAST else end


def _alternating_hold(run: RunData, group: list[Segment]) -> list[Segment]:
    """Return pulses as a hold by turns.

    The end of the last pulse is an aim of its own: where the final coasting begins must not be left to chance.
    """
    last, k = group[-1].last, len(group) - 1
    # the last pulse, and so many before it that the rest is long enough for an instruction
    while k > 0 and (group[k].kind != COAST or run.time_s[last] - run.time_s[group[k].first] < SHORTEST_S):
        k -= 1
    if k == 0:
        return _steady_change(run, group)
    works = [run.work_j(one.first, one.last) for one in group if one.kind != COAST]
    share = sum(used for used, _ in works) / sum(full for _, full in works)
    return [segment(run, HOLD, group[0].first, group[k].first, share), *_steady_change(run, group[k:])]


def _steady_changes(run: RunData, group: list[Segment]) -> list[Segment]:
    """Return pulses as part power, each piece long enough for an instruction, and ending where a pulse ends."""
    out: list[Segment] = []
    begin = 0
    while begin < len(group):
        end, started = len(group), run.time_s[group[begin].first]
        for k in range(begin, len(group)):
            ended = run.time_s[group[k].last]
            # the rest after the piece must be long enough too
            is_long = min(ended - started, run.time_s[group[-1].last] - ended) >= SHORTEST_S
            if is_long and group[k].kind != COAST:
                end = k + 1
                break
        out += _steady_change(run, group[begin:end])
        begin = end
    return out


def _steady_change(run: RunData, group: list[Segment]) -> list[Segment]:
    """Return segments as one steady change of speed, or as they are where that would break a limit."""
    first, last = group[0].first, group[-1].last
    place, speed = run.position_m[first : last + 1], run.speed_ms[first : last + 1]
    slope = (speed[-1] ** 2 - speed[0] ** 2) / (place[-1] - place[0])
    speed2 = speed[0] ** 2 + slope * (place - place[0])
    largest = np.maximum(run.limit_ms[first:last], np.maximum(speed[1:], speed[:-1])) ** 2
    if np.any(np.maximum(speed2[1:], speed2[:-1]) > largest):
        return group
    return [segment(run, PART_POWER, first, last, is_straight=True)]
