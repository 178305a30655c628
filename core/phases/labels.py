"""What a driver does in each cell of a run: by the effort alone, and then where he but holds his speed."""

import math

import numpy as np

from railjoule.core.arrays import BoolArray, FloatArray, IntArray
from railjoule.core.phases.phase import BRAKE, COAST, FULL_POWER, HOLD, PART_POWER, STAND
from railjoule.core.phases.run_data import RunData
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
"""A speed that stays within this of another reads the same on a speedometer of whole km/h: it is held."""
# as HOLD_TOLERANCE_MS over ten seconds: what a hold of that length may change in all
STEADY_MS2 = 0.05 * MS_PER_KMH
"""A speed that changes by less than half a km/h in ten seconds is steady [m/s2]."""
# Shorter, and the advice names pulses that nobody can follow; longer, and holds below short limits vanish.
SHORTEST_S = 5.0
"""An instruction that lasts less is read, begun and over before the next is read; assumed."""
PULSE_S = 2 * SHORTEST_S
"""Power or coasting that lasts less may be one of several pulses."""


def label_cells(run: RunData) -> tuple[IntArray, BoolArray, BoolArray]:
    """Return what is done in each cell.

    Returns
    -------
    labels : array of shape (n,)
        Full or part power, hold, coast, brake, stand, by number.
    begins_hold : array of shape (n,)
        Whether a hold begins there: two may follow one another.
    negligible : array of shape (n,)
        Whether the cell counts as coasting though it has an effort: one too small to tell.
    """
    position_m, speed_ms, effort_n, largest_n = run.position_m, run.speed_ms, run.effort_n, run.largest_effort_n
    labels = np.empty(effort_n.shape[0], np.int64)
    idle = NO_EFFORT_SHARE * np.max(largest_n)
    for i in range(effort_n.shape[0]):
        # standing first: a start has full effort too, at a speed that is still next to none
        if position_m[i + 1] <= position_m[i] or max(speed_ms[i], speed_ms[i + 1]) < NEGLIGIBLE_MS:
            labels[i] = STAND
        elif abs(effort_n[i]) <= idle:
            labels[i] = COAST
        elif effort_n[i] < 0.0:
            labels[i] = BRAKE
        elif effort_n[i] > FULL_SHARE * largest_n[i]:
            labels[i] = FULL_POWER
        else:
            labels[i] = PART_POWER
    # before the holds, as a hold may lie across coasting but not across its noise
    negligible = _coast_through_negligible(run, labels)
    return labels, _mark_holds(run, labels), negligible


def _end_of_run(labels: IntArray, first: int) -> int:
    """Return the cell after the last one of the same label."""
    last = first + 1
    while last < labels.shape[0] and labels[last] == labels[first]:
        last += 1
    return last


def _coast_through_negligible(run: RunData, labels: IntArray) -> BoolArray:
    """Let runs of cells beside coasting coast too if their effort is too small to tell; return which they are."""
    n = labels.shape[0]
    negligible = np.zeros(n, np.bool_)
    first, before = 0, -1
    while first < n:
        last = _end_of_run(labels, first)
        beside = before == COAST or (last < n and labels[last] == COAST)
        if beside and (labels[first] == PART_POWER or labels[first] == BRAKE):
            work = 0.0
            for i in range(first, last):
                work += run.effort_n[i] * (run.position_m[i + 1] - run.position_m[i])
            mean_speed = 0.5 * (run.speed_ms[first] + run.speed_ms[last])
            # work = m v dv: the change of speed that the effort makes is compared, whatever its length
            if abs(work) < NEGLIGIBLE_MS * run.inertia_kg * mean_speed:
                labels[first:last] = COAST
                negligible[first:last] = True
        before = labels[first]
        first = last
    return negligible


def _mark_holds(run: RunData, labels: IntArray) -> BoolArray:
    """Mark the stretches over which the speed is held, by power, brakes or short coasting; return where they begin."""
    n = labels.shape[0]
    begins = np.zeros(n, np.bool_)
    may_hold, steady = _hold_candidates(run, labels)
    i = 0
    while i < n:
        # holds begin and end with cells whose speed power or brakes keep
        end = _hold_end(run.speed_ms, run.limit_ms, may_hold, steady, i) if steady[i] else i
        if run.time_s[end] - run.time_s[i] >= SHORTEST_S:
            labels[i:end] = HOLD
            begins[i] = True
            i = end
        else:
            i += 1
    return begins


def _hold_candidates(run: RunData, labels: IntArray) -> tuple[BoolArray, BoolArray]:
    """Return which cells may lie in a hold, and in which of them power or brakes keep the speed; of shape (n,)."""
    time_s, speed_ms = run.time_s, run.speed_ms
    may_hold, steady = np.zeros(labels.shape[0], np.bool_), np.zeros(labels.shape[0], np.bool_)
    first = 0
    while first < labels.shape[0]:
        last = _end_of_run(labels, first)
        if labels[first] == COAST:
            may_hold[first:last] = time_s[last] - time_s[first] < PULSE_S
        elif labels[first] == PART_POWER or labels[first] == BRAKE:
            may_hold[first:last] = True
            for i in range(first, last):
                steady[i] = abs(speed_ms[i + 1] - speed_ms[i]) <= STEADY_MS2 * (time_s[i + 1] - time_s[i])
        first = last
    return may_hold, steady


def _hold_end(speed_ms: FloatArray, limit_ms: FloatArray, may_hold: BoolArray, steady: BoolArray, first: int) -> int:
    """Return the end of the longest stretch from a cell on whose speeds read the same and all keep all its limits."""
    end = first
    low = high = speed_ms[first]
    limit = math.inf
    for i in range(first, may_hold.shape[0]):
        low, high = min(low, speed_ms[i + 1]), max(high, speed_ms[i + 1])
        limit = min(limit, limit_ms[i])
        # twice the tolerance, as it is one to each side of the speed that is held
        if not may_hold[i] or high - low > 2.0 * HOLD_TOLERANCE_MS or high > limit + NEGLIGIBLE_MS:
            break
        if steady[i]:
            end = i + 1
    return end
