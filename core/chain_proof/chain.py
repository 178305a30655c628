"""The shortest chains of boxes from end to end, with linear prices of the squares of speed between cells.

The cost to go from an interval k of node i is at least p[i, k] w + C[i, k], where C[i, k] is the least over its boxes
of what the cell takes beyond the prices, E + L T + p[i+1, q] y - p[i, k] w, and of C at the next node; likewise to
come. Each interval may have a price of its own, as a chain enters and leaves a node in one interval.
The minimum of a box's plane over the box and its lines lies at the ends of the possible range of w or where a line
leaves the box: along w it is convex and straight between these.
"""

import math

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.chain_proof.boxes import (
    ENERGY,
    ENERGY_W,
    ENERGY_Y,
    LOWER,
    LOWER_W,
    TIME,
    TIME_W,
    TIME_Y,
    UPPER,
    UPPER_W,
    Box,
    Grid,
    Pairs,
)
from railjoule.core.compiled import njit

EMPTY_RANGE = 1e-9
"""A range of w so much below nothing, absolute and relative, still counts: its ends are rounded."""


@njit(cache=True, error_model="numpy")
def _cut(first: float, last: float, constant: float, slope: float) -> tuple[float, float]:
    """Return the part of a range of w in which constant + slope w is not below zero."""
    if slope > 0.0:
        return max(first, -constant / slope), last
    if slope < 0.0:
        return first, min(last, -constant / slope)
    return (first, last) if constant >= 0.0 else (math.inf, -math.inf)


@njit(cache=True, error_model="numpy")
def min_of_box(
    row: FloatArray, box: Box, second: float, start_price: float, end_price: float
) -> tuple[float, float, float]:
    """Return the least of a box's priced plane, and the squares of speed w and y there; infinite where none is."""
    a, b, c, d = box
    first, last = _cut(a, b, row[UPPER] - c, row[UPPER_W])
    first, last = _cut(first, last, d - row[LOWER], -row[LOWER_W])
    if first > last:
        if not first <= last + EMPTY_RANGE * (1.0 + abs(last)):
            return math.inf, a, c
        first = last = min(max(last, a), b)
    by_w = row[ENERGY_W] + second * row[TIME_W] - start_price
    by_y = row[ENERGY_Y] + second * row[TIME_Y] + end_price
    rising = by_y >= 0.0
    l0, l1, end = (row[LOWER], row[LOWER_W], c) if rising else (row[UPPER], row[UPPER_W], d)
    kink = (end - l0) / l1 if l1 != 0.0 else first
    best, w, y = math.inf, first, end
    for place in (first, last, min(max(kink, first), last)):
        line = l0 + l1 * place
        at = max(line, end) if rising else min(line, end)
        value = by_w * place + by_y * at
        if value < best:
            best, w, y = value, place, at
    return row[ENERGY] + second * row[TIME] + best, w, y


@njit(cache=True, error_model="numpy", nogil=True)
def chain(
    grid: Grid, boxes: Pairs, rows: FloatArray, node_price: FloatArray, second: float
) -> tuple[float, FloatArray, float]:
    """Return the value of the best chain [J], that of the best through each box, and the time of the first [s]."""
    low, high, count = grid
    kept, start, end, _ = boxes
    n, width = count.shape[0] - 1, low.shape[1]
    ahead, behind = np.full((n + 1, width), np.inf), np.full((n + 1, width), np.inf)
    through, took = np.full(start.shape[0], np.inf), np.zeros(start.shape[0])
    choice = np.full((n + 1, width), -1)
    for k in range(count[n]):
        ahead[n, k] = -max(node_price[n, k] * low[n, k], node_price[n, k] * high[n, k])
    for k in range(count[0]):
        behind[0, k] = min(node_price[0, k] * low[0, k], node_price[0, k] * high[0, k])
    for i in range(n - 1, -1, -1):
        for m in range(kept[i], kept[i + 1]):
            k, q = start[m], end[m]
            box = Box(low[i, k], high[i, k], low[i + 1, q], high[i + 1, q])
            value, w, y = min_of_box(rows[m], box, second, node_price[i, k], node_price[i + 1, q])
            through[m] = value
            took[m] = rows[m, TIME] + rows[m, TIME_W] * w + rows[m, TIME_Y] * y
            if value + ahead[i + 1, q] < ahead[i, k]:
                ahead[i, k], choice[i, k] = value + ahead[i + 1, q], m
    for i in range(n):
        for m in range(kept[i], kept[i + 1]):
            behind[i + 1, end[m]] = min(behind[i + 1, end[m]], behind[i, start[m]] + through[m])
    for i in range(n):
        for m in range(kept[i], kept[i + 1]):
            through[m] += behind[i, start[m]] + ahead[i + 1, end[m]]
    best, at = math.inf, 0
    for k in range(count[0]):
        if behind[0, k] + ahead[0, k] < best:
            best, at = behind[0, k] + ahead[0, k], k
    time = 0.0
    for i in range(n):
        m = choice[i, at]
        if m < 0:
            break
        time, at = time + took[m], end[m]
    return best, through, time
