"""Prove how far a point is from the best run: the lower bound, sharpened by cutting speeds into intervals."""

import math
from typing import NamedTuple

import numpy as np

from railjoule.core.arrays import BoolArray, FloatArray, IntArray
from railjoule.core.compiled import njit
from railjoule.core.interior_point.certificate import (
    LOOSE,
    cell_minimum,
    fastest_of_better_runs,
    price_cells,
    tangent_minimum,
)
from railjoule.core.interior_point.solver import Optimum
from railjoule.core.interior_point.start import SLOWEST_SPEED2
from railjoule.core.physics.course_data import CourseData
from railjoule.core.physics.effort_limit import EffortLimit
from railjoule.core.physics.reference import reference_energy

# Intervals of speed at a node. Each pair of neighbours is a box, so the table of their values has this squared times
# the cells; LARGEST_TABLE keeps it to 32 MB on long lines, which then get fewer intervals and a looser bound.
MOST_INTERVALS = 64
LARGEST_TABLE = 4_000_000
MOST_ROUNDS = 60
"""Of cutting; the budget of boxes ends it before, but where intervals cannot be cut further."""
SPLIT_SHARE = 0.5
"""Intervals are cut that lie on chains up to so far from the lowest one to the target: fewer need more rounds."""
TARGET_SHARE = 0.9
"""Of the tolerance that the target uses up, so that rounding does not decide."""


class Proof(NamedTuple):
    """A lower bound and how it was found.

    Parameters
    ----------
    bound_j : float
        Energy that no run on the mesh undercuts, dwells not included [J].
    loose_cells : int
        Cells whose minimum over all speeds lies lower than at the point.
    evaluations : int
        Boxes that were looked at.
    """

    bound_j: float
    loose_cells: int
    evaluations: int


@njit(cache=True, error_model="numpy", nogil=True)
def prove(
    course: CourseData, optimum: Optimum, fastest: FloatArray, running_time: float, tolerance: float, budget: int
) -> Proof:
    """Return a lower bound of the energy of every run on a mesh.

    Parameters
    ----------
    course : CourseData
    optimum : Optimum
    fastest : array of shape (n + 1,)
        Squares of speed of the fastest run [m2/s2].
    running_time : float
        Time allowed without dwells [s].
    tolerance : float
        Relative gap that is good enough.
    budget : int
        How many boxes may be looked at beyond one a cell.
    """
    traction, braking = course.traction, course.braking
    w = optimum.speed2
    n = w.shape[0] - 1
    cells, ends, price_of_time = price_cells(course, optimum)
    tops = fastest_of_better_runs(course, optimum, fastest, running_time)
    offset = ends - price_of_time * running_time
    reference = reference_energy(course, optimum.energy_j, running_time)
    intervals = min(MOST_INTERVALS, int(math.sqrt(LARGEST_TABLE / n)) + 2)
    low, high = np.zeros((n + 1, intervals)), np.zeros((n + 1, intervals))
    for i in range(n + 1):
        fixed = course.fixed_speed2[i]
        slowest = math.sqrt(SLOWEST_SPEED2) if w[i] >= SLOWEST_SPEED2 else 0.0
        low[i, 0] = math.sqrt(fixed) if fixed >= 0.0 else slowest
        high[i, 0] = math.sqrt(fixed) if fixed >= 0.0 else tops[i]
    tables = traction.table.shape[0] > 0 or braking.table.shape[0] > 0
    loose = np.zeros(n, dtype=np.bool_)
    total = offset
    for i in range(n):
        v0, v1 = math.sqrt(w[i]), math.sqrt(w[i + 1])
        box = low[i, 0], high[i, 0], low[i + 1, 0], high[i + 1, 0]
        here, least = tangent_minimum(cells[i], v0, v1, *box)
        if tables or least < here - LOOSE * reference:
            here = cell_minimum(cells[i], traction, braking, v0, v0, v1, v1)
            least = cell_minimum(cells[i], traction, braking, *box)
            loose[i] = least < here - LOOSE * reference
        total += least
    bound = min(total, optimum.energy_j)
    evaluations = n
    if optimum.energy_j - bound > tolerance * reference and budget > 0:
        target = optimum.energy_j - TARGET_SHARE * tolerance * reference
        sharper, more = _sharpen(cells, traction, braking, low, high, loose, offset, target, budget)
        bound = max(bound, sharper)
        evaluations += more
    return Proof(bound, int(loose.sum()), evaluations)


@njit(cache=True, error_model="numpy")
def _sharpen(
    cells: FloatArray,
    traction: EffortLimit,
    braking: EffortLimit,
    low: FloatArray,
    high: FloatArray,
    loose: BoolArray,
    offset: float,
    target: float,
    budget: int,
) -> tuple[float, int]:
    """Drop intervals of speed through which no run below `target` can pass; return the bound and the boxes seen."""
    n, intervals = loose.shape[0], low.shape[1]
    count = np.ones(n + 1, dtype=np.int64)
    value = np.empty((n, intervals, intervals))
    fresh = np.ones(n + 1, dtype=np.bool_)
    evaluations, bound, cut = 0, -np.inf, loose
    for _ in range(MOST_ROUNDS):
        for i in range(n):
            # only cells with a cut node are asked again
            if fresh[i] or fresh[i + 1]:
                for a in range(count[i]):
                    for b in range(count[i + 1]):
                        value[i, a, b] = cell_minimum(
                            cells[i], traction, braking, low[i, a], high[i, a], low[i + 1, b], high[i + 1, b]
                        )
                evaluations += count[i] * count[i + 1]
        forward, backward = _chain(value, count)
        best = forward[n, : count[n]].min() + offset
        bound = max(bound, min(best, target))
        if best >= target or evaluations > budget:
            break
        fresh[:] = False
        for i in range(n + 1):
            kept = 0
            for a in range(count[i]):
                if forward[i, a] + backward[i, a] + offset < target:
                    low[i, kept], high[i, kept] = low[i, a], high[i, a]
                    forward[i, kept], backward[i, kept] = forward[i, a], backward[i, a]
                    kept += 1
            fresh[i] = kept < count[i]
            count[i] = kept
        below = best - offset + SPLIT_SHARE * (target - best)
        if not _split(low, high, count, cut, fresh, forward + backward, below):
            if cut.all() or not cut.any():
                break
            # a better run may also avoid a loose cell by what it does beside it: its neighbours are cut, too
            wider = cut.copy()
            wider[1:] |= cut[:-1]
            wider[:-1] |= cut[1:]
            cut = wider
    return bound, evaluations


@njit(cache=True)
def _chain(value: FloatArray, count: IntArray) -> tuple[FloatArray, FloatArray]:
    """Return the least sums of cells from the start to each interval, and from each interval to the end."""
    n, intervals = value.shape[0], value.shape[1]
    forward, backward = np.full((n + 1, intervals), np.inf), np.full((n + 1, intervals), np.inf)
    forward[0, : count[0]] = 0.0
    backward[n, : count[n]] = 0.0
    for i in range(n):
        for b in range(count[i + 1]):
            for a in range(count[i]):
                forward[i + 1, b] = min(forward[i + 1, b], forward[i, a] + value[i, a, b])
    for i in range(n - 1, -1, -1):
        for a in range(count[i]):
            for b in range(count[i + 1]):
                backward[i, a] = min(backward[i, a], value[i, a, b] + backward[i + 1, b])
    return forward, backward


@njit(cache=True)
def _split(
    low: FloatArray,
    high: FloatArray,
    count: IntArray,
    loose: BoolArray,
    fresh: BoolArray,
    through: FloatArray,
    below: float,
) -> bool:
    """Halve the intervals at loose cells that lie on chains of a value `below`; return whether anything was cut."""
    n = loose.shape[0]
    cut = False
    for i in range(n + 1):
        beside = (i > 0 and loose[i - 1]) or (i < n and loose[i])
        if not beside or high[i, 0] <= low[i, 0]:
            continue
        for a in range(count[i] - 1, -1, -1):
            if count[i] >= low.shape[1]:
                break
            if through[i, a] <= below:
                middle = 0.5 * (low[i, a] + high[i, a])
                low[i, count[i]], high[i, count[i]] = middle, high[i, a]
                high[i, a] = middle
                count[i] += 1
                fresh[i] = cut = True
    return cut
