"""The driver's action in each cell of a run: by the effort, and then where the driver holds the speed."""

from itertools import pairwise

import numpy as np

from railjoule.core.arrays import BoolArray, IntArray
from railjoule.core.phases.phase import BRAKE, COAST, FULL_POWER, HOLD, PART_POWER, STAND, RunData
from railjoule.core.units import MS_PER_KMH

# optima follow the limit of effort to rounding, but a cell across a kink of it has the mean of both sides
FULL_SHARE = 0.97
"""From this share of the largest effort on, power counts as full."""
# of 200 kN these are 20 N; coasting that is made exact has 0, an interior point leaves residues of some 1e-7
NO_EFFORT_SHARE = 1e-4
"""Up to this share of the largest effort the train coasts: a kilometre of it changes speed by less than 0.1 km/h."""
NEGLIGIBLE_MS = 0.05 * MS_PER_KMH
"""Less than the advice's rounding to 0.1 km/h: an effort beside coasting that changes the speed by less is none."""
HOLD_TOLERANCE_MS = 0.5 * MS_PER_KMH
"""Speeds that differ by less read the same on a speedometer of whole km/h: the speed is held."""
# HOLD_TOLERANCE_MS over ten seconds
STEADY_MS2 = 0.05 * MS_PER_KMH
"""A speed that changes by less than half a km/h in ten seconds is steady [m/s2]."""
# Shorter, and the advice names pulses that nobody can follow; longer, and holds below short limits vanish.
SHORTEST_S = 5.0
"""Least duration of an instruction that a driver can read and follow [s]; assumed."""
PULSE_S = 2 * SHORTEST_S
"""Power or coasting that lasts less may be one of several pulses."""


def label_cells(run: RunData) -> tuple[IntArray, BoolArray, BoolArray]:
    """Return the action in each cell.

    Returns
    -------
    labels : array of shape (n,)
        Full or part power, hold, coast, brake, stand, by number.
    begins_hold : array of shape (n,)
        Whether a hold begins there: two may follow one another.
    negligible : array of shape (n,)
        Whether the cell counts as coasting though it has a small effort.
    """
    speed, effort = run.speed_ms, run.effort_n
    # standing first: a start has full effort too, at a speed that is still almost zero
    stands = (np.diff(run.position_m) <= 0) | (np.maximum(speed[1:], speed[:-1]) < NEGLIGIBLE_MS)
    idle = np.abs(effort) <= NO_EFFORT_SHARE * np.max(run.max_effort_n)
    conditions = [stands, idle, effort < 0, effort > FULL_SHARE * run.max_effort_n]
    labels = np.select(conditions, [STAND, COAST, BRAKE, FULL_POWER], PART_POWER).astype(np.int64)
    # before the holds, as a hold may lie across coasting but not across its noise
    negligible = _coast_through_negligible(run, labels)
    return labels, _mark_holds(run, labels), negligible


def _stretches(labels: IntArray) -> list[tuple[int, int]]:
    """Return the first cell and the cell after the last one of each stretch of one label."""
    return list(pairwise([0, *(np.flatnonzero(np.diff(labels)) + 1).tolist(), len(labels)]))


def _coast_through_negligible(run: RunData, labels: IntArray) -> BoolArray:
    """Label cells beside coasting as coasting if their effort is negligible; return which they are."""
    negligible = np.zeros(len(labels), np.bool_)
    for first, last in _stretches(labels):
        is_beside = COAST in (*labels[max(first - 1, 0) : first], *labels[last : last + 1])
        mean_speed = 0.5 * (run.speed_ms[first] + run.speed_ms[last])
        # work = m v dv: the change of speed that the effort makes is compared, whatever its length
        is_small = abs(run.work_j(first, last)[0]) < NEGLIGIBLE_MS * run.inertia_kg * mean_speed
        if is_beside and is_small and labels[first] in (PART_POWER, BRAKE):
            labels[first:last], negligible[first:last] = COAST, True
    return negligible


def _mark_holds(run: RunData, labels: IntArray) -> BoolArray:
    """Mark the stretches over which the speed is held, by power, brakes or short coasting; return their starts."""
    begins = np.zeros(len(labels), np.bool_)
    may_hold = (labels == PART_POWER) | (labels == BRAKE)
    # cells whose speed power or brakes keep
    steady = may_hold & (np.abs(np.diff(run.speed_ms)) <= STEADY_MS2 * np.diff(run.time_s))
    for first, last in _stretches(labels):
        if labels[first] == COAST:
            may_hold[first:last] = run.time_s[last] - run.time_s[first] < PULSE_S
    i = 0
    while i < len(labels):
        end = _hold_end(run, may_hold, steady, i) if steady[i] else i
        if run.time_s[end] - run.time_s[i] >= SHORTEST_S:
            labels[i:end], begins[i], i = HOLD, True, end
        else:
            i += 1
    return begins


def _hold_end(run: RunData, may_hold: BoolArray, steady: BoolArray, first: int) -> int:
    """Return the end of the longest stretch from a cell on whose speeds read the same and all keep all its limits."""
    end, low, high, limit = first, run.speed_ms[first], run.speed_ms[first], np.inf
    for i in range(first, len(may_hold)):
        low, high = min(low, run.speed_ms[i + 1]), max(high, run.speed_ms[i + 1])
        limit = min(limit, run.limit_ms[i])
        # twice the tolerance, as it is one to each side of the speed that is held
        if not may_hold[i] or high - low > 2.0 * HOLD_TOLERANCE_MS or high > limit + NEGLIGIBLE_MS:
            break
        if steady[i]:
            end = i + 1
    return end
