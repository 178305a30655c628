"""Planes below the energy and the time of a cell, over a box of its two squares of speed, in one mode of driving.

With w and y the squares of speed at both ends, the force of a cell is F = k1 y - k0 w + A + B v, k1 = k + C / 2 and
k0 = k - C / 2. A run drives in one of four modes, and takes from the line h e(x, v) of the drive's table:

    DRIVE   0 < F <= limit                        x = F
    OFF     -friction <= F <= 0, but for rounding no power
    BRAKE   0 < -F <= electric limit              x = -F, less what friction brakes may do
    BLEND   electric limit <= -F                  x = electric limit, less the same

Its account chooses the cheapest share of the electric brake, so that the least over all shares lies below it. A plane
e >= c0 + cx x + cv v below the corners of the table that hold the box becomes one in w and y: all is linear but
v = (sqrt w + sqrt y) / 2, which is concave: chords lie below, tangents above; the sign of its factor says which.
Time h / v is convex and falls with v: its tangent at a tangent of v.
"""

import math
from typing import NamedTuple

import numpy as np

from railjoule.core.arrays import FloatArray, IntArray
from railjoule.core.chain_proof.limit_lines import WIDENING, upper_line
from railjoule.core.chain_proof.table import BRAKING, DRIVING, EFFORTS, SPEEDS, DriveTable, row_at, row_speed
from railjoule.core.compiled import borrowed, njit
from railjoule.core.drive.kernels import has_standstill_brake, negligible_effort
from railjoule.core.physics.cell import mean_speed
from railjoule.core.physics.course_data import CourseData, cell_of, shared_by_cells
from railjoule.core.physics.effort_limit import EffortLimit, effort_range

DRIVE, OFF, BRAKE, BLEND = range(4)
ENERGY, ENERGY_W, ENERGY_Y, TIME, TIME_W, TIME_Y, LOWER, LOWER_W, UPPER, UPPER_W = range(10)
"""Columns of a box: energy and time at w = y = 0 with their slopes, and the lines y >= and y <= of its limits."""
COLUMNS = 10
ROUNDING_ROWS = 1e-9
"""A box reaches so far beyond a row before it needs the next one; the ranges of speed are wider than that."""

Plane = tuple[float, float, float]
"""Value at w = y = 0 and slopes by w and y."""
Lines = tuple[float, float, float, float]
"""y >= l0 + l1 w and y <= u0 + u1 w: l0, l1, u0, u1."""
Box = tuple[float, float, float, float]
"""The least and the greatest w, the least and the greatest y."""


class Steps(NamedTuple):
    """A cell's motion F = k1 y - k0 w + A + B v over a length h, and what limits its change of w."""

    length_m: float
    k1: float
    k0: float
    constant_n: float
    linear: float
    rise: float
    fall: float


@njit(cache=True, error_model="numpy")
def steps_of(course: CourseData, number: int) -> Steps:
    """Return the motion through one cell of a course."""
    cell = cell_of(course, number)
    half, wide = 0.5 * cell.quadratic, 2.0 * cell.length_m * (1.0 + WIDENING)
    return Steps(
        cell.length_m,
        cell.inertia + half,
        cell.inertia - half,
        cell.constant_n,
        cell.linear,
        wide * course.max_acceleration_ms2,
        wide * course.max_deceleration_ms2,
    )


@njit(cache=True, error_model="numpy")
def _chord(box: Box) -> Plane:
    """Return a plane below the mean speed over a box."""
    a, b, c, d = box
    sa, sb, sc, sd = math.sqrt(a), math.sqrt(b), math.sqrt(c), math.sqrt(d)
    by_w = 0.5 / (sa + sb) if b > a else 0.0
    by_y = 0.5 / (sc + sd) if d > c else 0.0
    return 0.5 * (sa + sc) - by_w * a - by_y * c, by_w, by_y


@njit(cache=True, error_model="numpy")
def _tangent(box: Box, w: float, y: float) -> Plane:
    """Return a plane above the mean speed over a box, which touches it at a point."""
    a, b, c, d = box
    sw, sy = math.sqrt(w), math.sqrt(y)
    by_w = 0.25 / sw if b > a else 0.0
    by_y = 0.25 / sy if d > c else 0.0
    return 0.5 * (sw + sy) - by_w * w - by_y * y, by_w, by_y


@njit(cache=True, error_model="numpy")
def _line(steps: Steps, constant: float, slope: float, speed: Plane) -> tuple[float, float]:
    """Return y = l0 + l1 w on which k1 y - k0 w + A = constant + slope v, with v on a plane."""
    by_y = steps.k1 - slope * speed[2]
    start = (constant + slope * speed[0] - steps.constant_n) / by_y
    return start, (steps.k0 + slope * speed[1]) / by_y


@njit(cache=True, error_model="numpy")
def _limit_line(
    steps: Steps, box: Box, centre: tuple[float, float], speeds: tuple[float, float], effort: Plane, upper: bool
) -> tuple[float, float]:
    """Return the line of F <= a0 + a1 v, or of F >= -(a0 + a1 v) if not `upper`; `effort` is (a0, a1, 0)."""
    a0, a1 = effort[0], effort[1]
    sign = 1.0 if upper else -1.0
    for _ in range(2):
        slope = sign * a1 - steps.linear
        # looser: an upper line with more than v times a rising effort, a lower one with less
        speed = _tangent(box, centre[0], centre[1]) if sign * slope > 0.0 else _chord(box)
        # an effort that rises as steeply as inertia asks for no line: its greatest value does
        if steps.k1 - slope * speed[2] > 0.1 * steps.k1:
            break
        a0, a1 = a0 + max(a1 * speeds[0], a1 * speeds[1]), 0.0
    return _line(steps, sign * a0, slope, speed)


@njit(cache=True, error_model="numpy")
def minorant(
    low: FloatArray,
    last: IntArray,
    table: DriveTable,
    step: float,
    efforts: tuple[float, float],
    speeds: tuple[float, float],
    price: float,
    by_price: bool,
) -> Plane:
    """Return c0, cx, cv: a plane below the energy per metre [J/m] over ranges of effort [N] and speed [m/s].

    Any slopes make a minorant, with c0 the least over the table's points around the range. `by_price` takes a given
    slope by effort: with the price of effort the minimum over the effort of priced cells is exact, however wide the
    box. Else it is the secant. The slope by speed is the secant at the effort that is cheapest so. Infinite where the
    table has no such point: no run has that effort at that speed.
    """
    j1 = min(max(int(row_at(table, speeds[0]) - ROUNDING_ROWS), 0), SPEEDS - 1)
    j2 = min(max(math.ceil(row_at(table, speeds[1]) + ROUNDING_ROWS), j1 + 1), SPEEDS)
    k1 = min(max(int(efforts[0] / step - ROUNDING_ROWS), 0), EFFORTS - 1)
    k2 = min(max(math.ceil(efforts[1] / step + ROUNDING_ROWS), k1 + 1), EFFORTS)
    middle = (j1 + j2) // 2
    ends = min(k2, last[middle])
    first = min(k1, ends - 1)
    cx = price if by_price or ends < 1 else (low[middle, ends] - low[middle, first]) / (step * (ends - first))
    at = min(k1, last[j1], last[j2])
    least = math.inf
    for k in range(k1, min(k2, last[j1], last[j2]) + 1):
        value = low[j1, k] - cx * step * k
        if value < least:
            least, at = value, k
    v1, v2 = row_speed(table.slowest_ms, table.fastest_ms, j1), row_speed(table.slowest_ms, table.fastest_ms, j2)
    cv = (low[j2, at] - low[j1, at]) / (v2 - v1)
    c0 = math.inf
    for j in range(j1, j2 + 1):
        least = math.inf
        for k in range(k1, min(k2, last[j]) + 1):
            least = min(least, low[j, k] - cx * step * k)
        c0 = min(c0, least - cv * row_speed(table.slowest_ms, table.fastest_ms, j))
    return c0, cx, cv


@njit(cache=True, error_model="numpy")
def _least_of_plane(plane: Plane, box: Box, lines: Lines) -> float:
    """Return about the least of a plane over a box within lines: at their ends by w."""
    best = math.inf
    for w in (box[0], box[1]):
        low = min(max(box[2], lines[0] + lines[1] * w), box[3])
        high = max(min(box[3], lines[2] + lines[3] * w), box[2])
        best = min(best, plane[1] * w + min(plane[2] * low, plane[2] * high))
    return plane[0] + best


@njit(cache=True, error_model="numpy")
def _energy_plane(steps: Steps, minor: Plane, effort: Plane, box: Box, touch: tuple[float, float]) -> Plane:
    """Return the plane below a cell's energy from c0 + cx x + cv v, x = x0 + xf (F) + xv v given as (x0, xf, xv)."""
    c0, cx, cv = minor
    x0, by_force, by_speed = effort
    factor = cv + cx * (by_speed + by_force * steps.linear)
    speed = _chord(box) if factor > 0.0 else _tangent(box, touch[0], touch[1])
    force = cx * by_force
    return (
        steps.length_m * (c0 + cx * x0 + force * steps.constant_n + factor * speed[0]),
        steps.length_m * (factor * speed[1] - force * steps.k0),
        steps.length_m * (factor * speed[2] + force * steps.k1),
    )


@njit(cache=True, error_model="numpy")
def mode_lines(
    steps: Steps,
    mode: int,
    box: Box,
    speeds: tuple[float, float],
    limit: tuple[float, float, float],
    friction: tuple[float, float],
) -> Lines:
    """Return the lines of a mode's limits in a box.

    `limit` is the line above the mode's electric effort and its least value, `friction` what friction brakes do and
    up to which effort the drive counts as off [N].
    """
    centre = 0.5 * (box[0] + box[1]), 0.5 * (box[2] + box[3])
    a0, a1, least = limit
    spare, off = friction
    if mode == DRIVE:
        l0, l1 = _limit_line(steps, box, centre, speeds, (0.0, 0.0, 0.0), False)
        u0, u1 = _limit_line(steps, box, centre, speeds, (a0, a1, 0.0), True)
    else:
        above = -least if mode == BLEND else off if mode == OFF else 0.0
        u0, u1 = _limit_line(steps, box, centre, speeds, (above, 0.0, 0.0), True)
        below = a0 + (0.0 if mode == BRAKE else spare * (1.0 + WIDENING)) + (off if mode == OFF else 0.0)
        l0, l1 = _limit_line(steps, box, centre, speeds, (below, a1, 0.0), False)
    # of two limits the tighter one at the middle: both hold, one line does
    if u0 + u1 * centre[0] > steps.rise + centre[0]:
        u0, u1 = steps.rise, 1.0
    if l0 + l1 * centre[0] < centre[0] - steps.fall:
        l0, l1 = -steps.fall, 1.0
    return l0, l1, u0, u1


@njit(cache=True, error_model="numpy")
def _best_energy(
    table: DriveTable,
    steps: Steps,
    mode: int,
    box: Box,
    speeds: tuple[float, float],
    limit: tuple[float, float, float],
    touch: tuple[float, float],
    lines: Lines,
    prices: Plane,
) -> Plane:
    """Return the plane below the energy whose least is greatest with prices (onward / (h k1), of w, of y)."""
    a0, a1, least = limit
    most = a0 + max(a1 * speeds[0], a1 * speeds[1])
    f1 = steps.k1 * box[2] - steps.k0 * box[1] + steps.constant_n + steps.linear * speeds[0]
    f2 = steps.k1 * box[3] - steps.k0 * box[0] + steps.constant_n + steps.linear * speeds[1]
    side = DRIVING if mode == DRIVE else BRAKING
    low, high, wanted, effort = max(f1, 0.0), min(f2, most), prices[0], (0.0, 1.0, 0.0)
    if mode == BRAKE:
        low, high, wanted, effort = max(-f2, 0.0), min(-f1, most), -prices[0], (0.0, -1.0, 0.0)
    elif mode == BLEND:
        low, high, wanted, effort = least, most, 0.0, (a0, 0.0, a1)
    step = table.top_n[side] / EFFORTS
    best, found = -math.inf, (0.0, 0.0, 0.0)
    for by_price in (False, True):
        given = step, (min(low, high), high), speeds, wanted
        minor = minorant(table.low[side], table.last[side], table, *given, by_price)
        if minor[0] == math.inf:
            return math.inf, 0.0, 0.0
        # of the electric limit a minorant that falls with effort takes the line above, one that rises the least
        x = (least, 0.0, 0.0) if mode == BLEND and minor[1] > 0.0 else effort
        plane = _energy_plane(steps, minor, x, box, touch)
        value = _least_of_plane((plane[0], plane[1] + prices[1], plane[2] + prices[2]), box, lines)
        if value > best:
            best, found = value, plane
    return found


@njit(cache=True, error_model="numpy")
def _mode_limit(
    traction: EffortLimit, braking: EffortLimit, mode: int, replaced: bool, v1: float, v2: float
) -> tuple[float, float, float]:
    """Return the line above what a mode's drive does over a range of speed, and the least of the electric brake."""
    if mode == DRIVE:
        a0, a1 = upper_line(traction, v1, v2)
        return a0, a1, 0.0
    if mode == OFF and not replaced:
        return 0.0, 0.0, 0.0
    a0, a1 = upper_line(braking, v1, v2)
    return a0, a1, effort_range(braking, v1, v2)[0]


@njit(cache=True, error_model="numpy")
def fill_box(
    table: DriveTable,
    steps: Steps,
    traction: EffortLimit,
    braking: EffortLimit,
    friction: tuple[float, float, bool],
    mode: int,
    box: Box,
    prices: tuple[float, float, float],
    row: FloatArray,
) -> bool:
    """Fill one box's planes and lines; False where no run passes it in that mode.

    Parameters
    ----------
    table : DriveTable
    steps : Steps
        Of the cell.
    traction, braking : EffortLimit
    friction : tuple
        What friction brakes do [N], up to which effort the drive counts as off [N], whether a standstill brake stands
        in for the electric one without power.
    mode : int
    box : Box
    prices : tuple
        Of a second [J/s] and of both squares of speed, as slopes of the cost to go [J s2/m2]: they choose between
        minorants, which hold with any.
    row : array of shape (COLUMNS,)
        What is filled.
    """
    a, b, c, d = box
    v1 = mean_speed(math.sqrt(a), math.sqrt(c))
    v2 = mean_speed(math.sqrt(b), math.sqrt(d))
    f1 = steps.k1 * c - steps.k0 * b + steps.constant_n + steps.linear * v1
    f2 = steps.k1 * d - steps.k0 * a + steps.constant_n + steps.linear * v2
    if (mode == DRIVE and f2 <= 0.0) or (mode != DRIVE and f1 > friction[1]):
        return False
    limit = _mode_limit(traction, braking, mode, friction[2], v1, v2)
    if mode == BLEND and -f1 < limit[2]:
        return False
    lines = mode_lines(steps, mode, box, (v1, v2), limit, (friction[0], friction[1]))
    # no w of the box leads to a y of it
    if (
        max(lines[2] + lines[3] * a, lines[2] + lines[3] * b) < c
        or min(lines[0] + lines[1] * a, lines[0] + lines[1] * b) > d
    ):
        return False
    w = 0.5 * (a + b)
    y = min(max(min(max(0.5 * (c + d), lines[0] + lines[1] * w), lines[2] + lines[3] * w), c), d)
    speed, h, v = _tangent(box, w, y), steps.length_m, mean_speed(math.sqrt(w), math.sqrt(y))
    slope = -h / (v * v)
    row[TIME], row[TIME_W], row[TIME_Y] = 2.0 * h / v + slope * speed[0], slope * speed[1], slope * speed[2]
    row[LOWER], row[LOWER_W], row[UPPER], row[UPPER_W] = lines
    row[ENERGY] = row[ENERGY_W] = row[ENERGY_Y] = 0.0
    if mode != OFF:
        second, start, end = prices
        given = -end / (h * steps.k1), second * row[TIME_W] - start, second * row[TIME_Y] + end
        plane = _best_energy(table, steps, mode, box, (v1, v2), limit, (w, y), lines, given)
        if plane[0] == math.inf:
            return False
        row[ENERGY], row[ENERGY_W], row[ENERGY_Y] = plane
    return True


@njit(cache=True, error_model="numpy", nogil=True)
def fill_boxes(
    course: CourseData,
    table: DriveTable,
    low: FloatArray,
    high: FloatArray,
    first: IntArray,
    start: IntArray,
    end: IntArray,
    mode: IntArray,
    node_price: FloatArray,
    second: float,
) -> tuple[IntArray, IntArray, IntArray, IntArray, FloatArray]:
    """Return the boxes that runs may pass: the first of each cell, their intervals, modes and rows of `COLUMNS`.

    Parameters
    ----------
    course : CourseData
    table : DriveTable
    low, high : array of shape (n + 1, m)
        Squares of speed at the ends of the intervals of each node [m2/s2].
    first : array of shape (n + 1,)
        Where the pairs of each cell begin.
    start, end, mode : array of shape (k,)
        Pairs of intervals of a cell's two nodes, and modes.
    node_price : array of shape (n + 1, m)
        Slopes of the cost to go in each interval [J s2/m2].
    second : float
        Price of a second, auxiliaries included [J/s].
    """
    count = start.shape[0]
    kept, rows = np.zeros(low.shape[0], dtype=np.int64), np.empty((count, COLUMNS))
    starts, ends, modes = np.empty(count, np.int64), np.empty(count, np.int64), np.empty(count, np.int64)
    train, traction, braking, drive = shared_by_cells(course)
    table = DriveTable(
        borrowed(table.low), borrowed(table.last), table.slowest_ms, table.fastest_ms, borrowed(table.top_n)
    )
    off, replaced = negligible_effort(train.drive_kind, drive), has_standstill_brake(train.drive_kind, drive)
    friction = train.friction_effort_n, off, replaced and braking.constant_n > 0.0
    m = 0
    for i in range(low.shape[0] - 1):
        kept[i] = m
        steps = steps_of(course, i)
        for pair in range(first[i], first[i + 1]):
            k, q = start[pair], end[pair]
            box = low[i, k], high[i, k], low[i + 1, q], high[i + 1, q]
            prices = second, node_price[i, k], node_price[i + 1, q]
            if fill_box(table, steps, traction, braking, friction, mode[pair], box, prices, rows[m]):
                starts[m], ends[m], modes[m] = k, q, mode[pair]
                m += 1
    kept[low.shape[0] - 1] = m
    return kept, starts[:m], ends[:m], modes[:m], rows[:m]
