"""Lines above a limit of effort over a range of speed."""

import math

from railjoule.core.compiled import njit
from railjoule.core.physics.effort_limit import EffortLimit, bezier_points, largest_effort, piece_at

WIDENING = 2e-8
"""Limits are widened by this share: what the product calls a run keeps them to 1e-8."""
NARROW_MS = 1e-9
"""Over so short a range a line needs no slope."""


@njit(cache=True, error_model="numpy")
def upper_line(limit: EffortLimit, v1: float, v2: float) -> tuple[float, float]:
    """Return a0, a1 with limit(v) <= a0 + a1 v [N] for all speeds between two above zero [m/s]."""
    wide = 1.0 + WIDENING
    constant = limit.constant_n * wide
    f1, f2 = wide * largest_effort(limit, v1), wide * largest_effort(limit, v2)
    untabulated = limit.table.shape[0] == 0
    if untabulated and (limit.power_w == math.inf or f2 >= constant):
        return constant, 0.0
    if untabulated and v2 - v1 < NARROW_MS:
        # it falls with speed
        return f1, 0.0
    slope = (f2 - f1) / (v2 - v1) if v2 - v1 >= NARROW_MS else 0.0
    lift = 0.0
    if untabulated:
        # P / v is convex, below its chord; where the constant limit ends there is a corner above it
        corner = limit.power_w / limit.constant_n
        if v1 < corner < v2:
            lift = max(0.0, constant - f1 - slope * (corner - v1))
        return f1 + lift - slope * v1, slope
    third = (v2 - v1) / 3.0
    first, last = piece_at(limit, v1), piece_at(limit, v2)
    for piece in range(first, last + 1):
        start = v1 if piece == first else limit.table[piece, 0]
        end = v2 if piece == last else limit.table[piece + 1, 0]
        points = bezier_points(limit, piece, start, end)
        third = (end - start) / 3.0
        by_constant = excess = -math.inf
        for q in range(4):
            line = f1 + slope * (start + q * third - v1)
            excess = max(excess, wide * points[q] - line)
            by_constant = max(by_constant, constant - line)
        lift = max(lift, min(excess, by_constant))
    if lift >= max(constant - f1, constant - f2):
        return constant, 0.0
    return f1 + lift - slope * v1, slope
