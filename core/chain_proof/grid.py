"""Intervals of speed at the nodes, the pairs of them that cells join, and the halving of those that are left."""

import math

import numpy as np

from railjoule.core.arrays import BoolArray, FloatArray, IntArray
from railjoule.core.chain_proof.boxes import BLEND, BRAKE, DRIVE, OFF, Grid, Pairs, cell_motion
from railjoule.core.compiled import njit
from railjoule.core.physics.effort_limit import WIDENING
from railjoule.core.physics.mesh_data import MeshData

FIRST_SHARE, GROWTH = 1 / 80, 1.4
"""Width of the first intervals around a run as a share of the greatest speed, and by what they widen away from it."""
# time and idle losses over a metre go as 1 / v: their tangents lie far below over an interval of several times a speed
GREATEST_RATIO = 1.6
"""The largest ratio of the ends of a first interval."""
ROUNDING = 1e-7
"""Speeds up to this share above the fastest run's are covered, which other runs reach by rounding."""
NARROWEST_MS = 2e-3
"""Intervals are not halved below that."""


def first_grid(mesh: MeshData, fastest2: FloatArray, slowest2: FloatArray, around2: FloatArray) -> Grid:
    """Return intervals that widen with the distance from a run.

    Parameters
    ----------
    mesh : MeshData
    fastest2, slowest2, around2 : array of shape (n + 1,)
        Squares of the greatest and least speeds, and of those of the run [m2/s2].
    """
    nodes = []
    width = FIRST_SHARE * math.sqrt(float(fastest2.max()))
    steps = width * np.cumsum(GROWTH ** np.arange(60)) - 0.5 * width
    offsets = np.concatenate([-steps[::-1], steps])
    for i in range(len(fastest2)):
        fixed = mesh.fixed_speed2[i]
        if fixed >= 0.0:
            nodes.append(np.array([fixed, fixed]))
            continue
        low, high = math.sqrt(slowest2[i]), math.sqrt(fastest2[i] * (1.0 + ROUNDING))
        inside = math.sqrt(around2[i]) + offsets
        # no slivers at the ends
        inside = inside[(inside > low + 0.3 * width) & (inside < high - 0.3 * width)]
        nodes.append(_cut_by_ratio(np.concatenate([[low], inside, [max(high, low)]])) ** 2)
    count = np.array([len(edges) - 1 for edges in nodes])
    lower, upper = np.full((len(nodes), count.max()), np.inf), np.full((len(nodes), count.max()), np.inf)
    for i, edges in enumerate(nodes):
        lower[i, : count[i]], upper[i, : count[i]] = edges[:-1], edges[1:]
    return Grid(lower, upper, count)


def _cut_by_ratio(edges: FloatArray) -> FloatArray:
    """Return edges of intervals none of which is longer than `GREATEST_RATIO`."""
    ratios = edges[1:] / edges[:-1]
    parts = np.maximum(np.ceil(np.log(ratios) / math.log(GREATEST_RATIO)), 1).astype(int)
    cut = [low * ratio ** (np.arange(count) / count) for low, ratio, count in zip(edges, ratios, parts, strict=False)]
    return np.concatenate([*cut, edges[-1:]])


@njit(cache=True, error_model="numpy", nogil=True)
def _fill_pairs(
    mesh: MeshData, low: FloatArray, high: FloatArray, count: IntArray, fastest: float, pairs: IntArray, fill: bool
) -> IntArray:
    """Return the first pair of each cell, and fill them if there is room; `fastest` is a speed [m/s]."""
    n = count.shape[0] - 1
    first = np.zeros(n + 1, dtype=np.int64)
    wide = 1.0 + WIDENING
    brakes = mesh.braking.constant_n > 0.0
    m = 0
    for i in range(n):
        first[i] = m
        cell, powered = cell_motion(mesh, i), mesh.supply_share[i] >= 1.0
        resisting = cell.linear * fastest
        for k in range(count[i]):
            a, b = low[i, k], high[i, k]
            top = (mesh.traction.constant_n * wide + cell.k0 * b - cell.least_n) / cell.k1
            strongest = (mesh.braking.constant_n + mesh.friction_effort_n) * wide
            bottom = (cell.k0 * a - strongest - cell.most_n - resisting) / cell.k1
            # forces within what rounding and a drive that counts as off leave
            bottom, top = max(bottom, a - cell.fall) - 1e-9, min(top, b + cell.rise) + 1e-9
            for q in range(count[i + 1]):
                if high[i + 1, q] < bottom or low[i + 1, q] > top:
                    continue
                for mode in range(4):
                    if (mode >= BRAKE and not brakes) or (mode == BLEND and mesh.friction_effort_n <= 0.0):
                        continue
                    # in a neutral section friction brakes work with the drive off
                    if mode != OFF and not powered:
                        continue
                    if mode == DRIVE and cell.k1 * high[i + 1, q] - cell.k0 * a + cell.most_n + resisting <= 0.0:
                        continue
                    if fill:
                        pairs[0, m], pairs[1, m], pairs[2, m] = k, q, mode
                    m += 1
    first[n] = m
    return first


def all_pairs(mesh: MeshData, grid: Grid) -> Pairs:
    """Return every pair of intervals that a cell may join, in each mode."""
    low, high, count = grid
    fastest = math.sqrt(float(high[np.isfinite(high)].max()))
    first = _fill_pairs(mesh, low, high, count, fastest, np.empty((3, 0), dtype=np.int64), False)
    pairs = np.empty((3, first[-1]), dtype=np.int64)
    first = _fill_pairs(mesh, low, high, count, fastest, pairs, True)
    return Pairs(first, pairs[0], pairs[1], pairs[2])


@njit(cache=True, error_model="numpy")
def _halved_nodes(
    low: FloatArray, high: FloatArray, count: IntArray, used: BoolArray
) -> tuple[FloatArray, FloatArray, IntArray, IntArray, IntArray]:
    """Return the halves of the intervals used on both sides: ends, counts; the first half of each, and how many."""
    nodes, width = count.shape[0], low.shape[1]
    first, halves = np.full((nodes, width), -1), np.zeros((nodes, width), dtype=np.int64)
    new = np.zeros(nodes, dtype=np.int64)
    for i in range(nodes):
        for k in range(count[i]):
            if used[i, k, 0] and used[i, k, 1]:
                first[i, k] = new[i]
                halves[i, k] = 2 if math.sqrt(high[i, k]) - math.sqrt(low[i, k]) > NARROWEST_MS else 1
                new[i] += halves[i, k]
    lower, upper = np.full((nodes, max(new.max(), 1)), np.inf), np.full((nodes, max(new.max(), 1)), np.inf)
    for i in range(nodes):
        for k in range(count[i]):
            m = first[i, k]
            if m < 0:
                continue
            lower[i, m], upper[i, m + halves[i, k] - 1] = low[i, k], high[i, k]
            if halves[i, k] == 2:
                # by speed, not its square
                middle = (0.5 * (math.sqrt(low[i, k]) + math.sqrt(high[i, k]))) ** 2
                upper[i, m] = lower[i, m + 1] = middle
    return lower, upper, new, first, halves


@njit(cache=True, error_model="numpy", nogil=True)
def halved(grid: Grid, boxes: Pairs, alive: BoolArray) -> tuple[Grid, Pairs]:
    """Return the grid of halved intervals and the pairs between halves of boxes that are alive.

    A node without an interval has no run left.
    """
    kept, start, end, mode = boxes
    low, high, count = grid
    n = count.shape[0] - 1
    used = np.zeros((n + 1, low.shape[1], 2), dtype=np.bool_)
    used[0, :, 0], used[n, :, 1] = True, True
    for i in range(n):
        for m in range(kept[i], kept[i + 1]):
            if alive[m]:
                used[i, start[m], 1] = used[i + 1, end[m], 0] = True
    lower, upper, new, first, halves = _halved_nodes(low, high, count, used)
    begin, pairs, o = np.zeros(n + 1, dtype=np.int64), np.empty((3, 4 * alive.sum()), np.int64), 0
    for i in range(n):
        begin[i] = o
        for m in range(kept[i], kept[i + 1]):
            k, q = first[i, start[m]], first[i + 1, end[m]]
            if not alive[m] or k < 0 or q < 0:
                continue
            for x in range(halves[i, start[m]]):
                for y in range(halves[i + 1, end[m]]):
                    pairs[0, o], pairs[1, o], pairs[2, o] = k + x, q + y, mode[m]
                    o += 1
    begin[n] = o
    return Grid(lower, upper, new), Pairs(begin, pairs[0, :o], pairs[1, :o], pairs[2, :o])
