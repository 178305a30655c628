"""The largest effort at a speed: a constant, and a power or a table over speed.

A table holds a cubic between each two knots of speed, with the values and the slopes that the limit has there, taken
from inside the piece: a knot may be a corner. Pieces that miss the limit are halved until they do not, so that a corner
that nobody named ends up in a piece of a tenth of a millimetre a second, whose cubic cuts it off from below. The table
is then lowered by what it still exceeds the limit anywhere, a few millionths: no run asks a motor for more than it has.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from railjoule.core.arrays import FloatArray, IntArray
from railjoule.core.compiled import borrowed, njit
from railjoule.core.drive.loss_map import HERMITE

# pieces are looked up in steps of this length: short enough to leave one or two to search, and few enough for a cache
TABLE_STEP_MS = 0.125
# where the fit begins, before pieces that miss are halved; longer ones would but take more halvings
LONGEST_PIECE_MS = 0.5
# With less, tables get longer, as the fourth root of it; with more, runs give away more of what the motors have, since
# a table is lowered by what it exceeds its limit.
FIT_SHARE = 1e-6
"""How close a table comes to its limit, as a share of the largest effort."""
# what a piece so narrow misses at a corner is within that share, too
NARROWEST_MS = 1e-4
"""Pieces are not halved below that."""
INSIDE = np.arange(1, 8) / 8
"""Points at which a piece is compared with the limit that it stands for, as shares of its width."""
# a limit may end at no effort, of which nothing is a share
MIN_SHARE = 0.01
"""Limits below this share of the largest effort count as this much where a table's excess is a share of them."""
# errors of the differences go with its square, those of rounding with its inverse
SLOPE_SHARE = 1e-3
"""Step of the differences that give a slope, as a share of the width of a piece."""
SLOWEST_MS = 1e-3
"""Stands for rest in limits of power, which end at the constant limit long before."""
WIDENING = 2e-8
"""Limits are widened by this share: what the product calls a run keeps them to 1e-8."""
NARROW_MS = 1e-9
"""Over so short a range a line needs no slope."""
NO_TABLE, NO_PIECES = np.zeros((0, 5)), np.zeros(0, dtype=np.int64)


class EffortLimit(NamedTuple):
    """Limits of one direction of effort, in a form that compiled code takes.

    Parameters
    ----------
    constant_n : float
        The largest effort at any speed [N].
    power_w : float
        The largest effort times speed [W]; infinite where there is no such limit, or a table stands for it.
    table : array of shape (m, 5)
        Pieces of the limit over speed, from 0: begin [m/s] and coefficients of a cubic from there.
    first_piece : array of shape (k,)
        Number of the piece that holds the beginning of each of k equal steps of speed.
    """

    constant_n: float
    power_w: float = np.inf
    table: FloatArray = NO_TABLE
    first_piece: IntArray = NO_PIECES

    def effort_n(self, speed_ms: FloatArray) -> FloatArray:
        """Return the largest effort [N] at speeds above zero [m/s]; shape as the argument's."""
        speed = np.asarray(speed_ms, dtype=float)
        effort = np.empty(speed.size)
        _fill_efforts(self, speed.ravel(), effort)
        return effort.reshape(speed.shape)

    def lowered(self, share: float) -> "EffortLimit":
        """Return a limit that is lower by a share at every speed."""
        kept = 1.0 - share
        table = self.table.copy()
        table[:, 1:] *= kept
        return EffortLimit(kept * self.constant_n, kept * self.power_w, table, self.first_piece)


def fitted_limit(
    constant_n: float, limit_n: Callable[[FloatArray], FloatArray], top_speed_ms: float, corners_ms: FloatArray
) -> EffortLimit:
    """Return the table of a limit over speed, nowhere above it.

    Parameters
    ----------
    constant_n : float
        The largest effort at any speed [N]; where the limit is higher the table need not be close to it.
    limit_n : callable
        The limit [N] at an array of speeds [m/s] of any shape.
    top_speed_ms : float
        Up to which speed it is wanted [m/s].
    corners_ms : array
        Speeds at which its slope may jump, as far as they are known [m/s].
    """

    def capped(speed: FloatArray) -> FloatArray:
        # far above the constant limit, as near rest, it does not matter how steep it is
        return np.minimum(limit_n(speed), 2 * constant_n)

    knots = table_speeds(top_speed_ms)
    knots = np.union1d(knots, corners_ms[(corners_ms > NARROWEST_MS) & (corners_ms < knots[-1])])
    start, width = knots[:-1], np.diff(knots)
    fitted, over = [], 1.0
    while len(start):
        cubic = _cubics(capped, start, width)
        true = capped(start[:, None] + width[:, None] * INSIDE)
        found = cubic @ INSIDE ** np.arange(4)[:, None]
        missed = np.abs(found - true).max(axis=1) > FIT_SHARE * constant_n
        split = missed & (true.min(axis=1) < constant_n) & (width > NARROWEST_MS)
        fitted.append(np.column_stack([start, cubic / width[:, None] ** np.arange(4)])[~split])
        # above the constant limit, which caps it, a table may exceed what it stands for
        limited = true[~split] < constant_n
        excess = (found - true)[~split][limited] / np.maximum(true[~split][limited], MIN_SHARE * constant_n)
        over = max(over, 1.0 + float(np.max(excess, initial=0.0)))
        width = 0.5 * width[split]
        start = np.concatenate([start[split], start[split] + width])
        width = np.tile(width, 2)
    table = np.concatenate(fitted)
    # between the places that are compared it may exceed the limit by a little more than there
    table[:, 1:] /= 1.0 + 2.0 * (over - 1.0)
    table = table[np.argsort(table[:, 0])]
    steps = np.arange(0.0, table[-1, 0] + TABLE_STEP_MS, TABLE_STEP_MS)
    first = np.searchsorted(table[:, 0], steps, side="right") - 1
    return EffortLimit(constant_n, np.inf, np.ascontiguousarray(table), first.astype(np.int64))


def _cubics(limit_n: Callable[[FloatArray], FloatArray], start: FloatArray, width: FloatArray) -> FloatArray:
    """Return coefficients of 1, x, x^2, x^3 for pieces that run from 0 to 1; shape (pieces, 4)."""
    steps = np.array([0.0, SLOPE_SHARE, 2 * SLOPE_SHARE, 1 - 2 * SLOPE_SHARE, 1 - SLOPE_SHARE, 1.0])
    f = limit_n(start[:, None] + width[:, None] * steps)
    # differences of second order, from one side
    first = (4 * f[:, 1] - 3 * f[:, 0] - f[:, 2]) / (2 * SLOPE_SHARE)
    last = (3 * f[:, 5] - 4 * f[:, 4] + f[:, 3]) / (2 * SLOPE_SHARE)
    cubics: FloatArray = np.column_stack([f[:, 0], f[:, 5], first, last]) @ HERMITE.T
    return cubics


def table_speeds(top_speed_ms: float) -> FloatArray:
    """Return equal steps of speed [m/s] from 0 to just beyond `top_speed_ms`; shape (m + 1,)."""
    return np.arange(0.0, top_speed_ms + 2 * LONGEST_PIECE_MS, LONGEST_PIECE_MS)


@njit(cache=True)
def borrowed_limit(limit: EffortLimit) -> EffortLimit:
    """Return a limit whose arrays are `borrowed`, for the loops of a compiled function."""
    return EffortLimit(limit.constant_n, limit.power_w, borrowed(limit.table), borrowed(limit.first_piece))


@njit(cache=True, error_model="numpy")
def piece_at(limit: EffortLimit, speed: float) -> int:
    """Return the number of the piece of a table at a speed [m/s]; the last one goes on."""
    # not a number, as where there is no run, becomes a large negative integer: it must not lead out of the table
    step = max(min(int(speed / TABLE_STEP_MS), limit.first_piece.shape[0] - 1), 0)
    piece, last = int(limit.first_piece[step]), limit.table.shape[0] - 1
    # the step's first piece holds where the step begins; within it, the next ones may begin
    while piece < last and limit.table[piece + 1, 0] <= speed:
        piece += 1
    return piece


@njit(cache=True, error_model="numpy")
def limit_over_speed(limit: EffortLimit, speed: float) -> tuple[float, float, float]:
    """Return the limit that varies with speed [N] and its first and second derivative, without the constant."""
    if limit.table.shape[0] == 0:
        effort = limit.power_w / speed
        return effort, -effort / speed, 2.0 * effort / (speed * speed)
    c = limit.table[piece_at(limit, speed)]
    x = speed - c[0]
    return (
        ((c[4] * x + c[3]) * x + c[2]) * x + c[1],
        (3.0 * c[4] * x + 2.0 * c[3]) * x + c[2],
        6.0 * c[4] * x + 2.0 * c[3],
    )


@njit(cache=True, error_model="numpy")
def supplied_effort(limit: EffortLimit, supply_share: float, speed: float) -> float:
    """Return the largest effort [N] at a speed above zero [m/s] where there is a share of the constant limit."""
    # a function of its own, as it needs no derivatives: compilers do not drop those of a call they do not inline
    if limit.table.shape[0] == 0:
        return min(supply_share * limit.constant_n, limit.power_w / speed)
    return min(supply_share * limit.constant_n, limit_over_speed(limit, speed)[0])


@njit(cache=True, error_model="numpy")
def max_effort_slope(limit: EffortLimit, speed: float) -> tuple[float, float]:
    """Return the largest effort [N] at a speed above zero [m/s], and its derivative by the speed."""
    # most efforts are limited by the constant: no look at the limit that varies
    if limit.table.shape[0] > 0 or limit.power_w / speed < limit.constant_n:
        varying, by_speed, _ = limit_over_speed(limit, speed)
        if varying < limit.constant_n:
            return varying, by_speed
    return limit.constant_n, 0.0


@njit(cache=True, error_model="numpy")
def supplied_limit(limit: EffortLimit, supply_share: float) -> EffortLimit:
    """Return a limit where there is a share of its constant."""
    return EffortLimit(supply_share * limit.constant_n, limit.power_w, limit.table, limit.first_piece)


@njit(cache=True, error_model="numpy")
def max_effort(limit: EffortLimit, speed: float) -> float:
    """Return the largest effort [N] at a speed above zero [m/s]."""
    return supplied_effort(limit, 1.0, speed)


@njit(cache=True, error_model="numpy")
def bezier_points(limit: EffortLimit, piece: int, start: float, end: float) -> tuple[float, float, float, float]:
    """Return the Bezier points of a table's piece between two speeds, which hold its values between them."""
    c = limit.table[piece]
    x, y = start - c[0], end - c[0]
    first = ((c[4] * x + c[3]) * x + c[2]) * x + c[1]
    last = ((c[4] * y + c[3]) * y + c[2]) * y + c[1]
    third = (y - x) / 3.0
    second = first + third * ((3.0 * c[4] * x + 2.0 * c[3]) * x + c[2])
    before_last = last - third * ((3.0 * c[4] * y + 2.0 * c[3]) * y + c[2])
    return first, second, before_last, last


@njit(cache=True, error_model="numpy")
def effort_range(limit: EffortLimit, slow: float, fast: float) -> tuple[float, float]:
    """Return at most the least and at least the greatest of a limit [N] between two speeds above zero [m/s]."""
    at_slow, at_fast = max_effort(limit, slow), max_effort(limit, fast)
    least, greatest = min(at_slow, at_fast), max(at_slow, at_fast)
    # a limit of power falls with speed: its ends tell all. A curve may rise
    if limit.table.shape[0] > 0:
        first, last = piece_at(limit, slow), piece_at(limit, fast)
        for piece in range(first, last + 1):
            start = slow if piece == first else limit.table[piece, 0]
            end = fast if piece == last else limit.table[piece + 1, 0]
            a, b, c, d = bezier_points(limit, piece, start, end)
            least, greatest = min(least, a, b, c, d), max(greatest, a, b, c, d)
    return least, min(greatest, limit.constant_n)


@njit(cache=True, error_model="numpy")
def upper_line(limit: EffortLimit, v1: float, v2: float) -> tuple[float, float]:
    """Return a0, a1 with limit(v) <= a0 + a1 v [N] for all speeds between two above zero [m/s]."""
    wide = 1.0 + WIDENING
    constant = limit.constant_n * wide
    f1, f2 = wide * max_effort(limit, v1), wide * max_effort(limit, v2)
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


@njit(cache=True, nogil=True)
def _fill_efforts(limit: EffortLimit, speed: FloatArray, effort: FloatArray) -> None:
    for i in range(speed.shape[0]):
        effort[i] = max_effort(limit, speed[i])
