"""Planes below the energy and the time of a cell, over a box of its two squares of speed, in one mode of driving.

With w and y the squares of speed at both ends, the force of a cell is F = k1 y - k0 w + A + B v, k1 = k + C / 2 and
k0 = k - C / 2; the mean starting resistance, which falls with both, lies between its values at two corners of the box,
and A has one bound below and one above. A run drives in one of four modes, and takes from the line h e(x, v) of the
drive's table:

    DRIVE   0 < F <= limit                        x = F
    OFF     -friction <= F <= 0, but for rounding no power
    BRAKE   0 < -F <= electric limit              x = -F, less what friction brakes may do
    BLEND   electric limit <= -F                  x = electric limit, less the same

Its account chooses the cheapest share of the electric brake, so that the least over all shares lies below it. A plane
e >= c0 + cx x + cv v below the corners of the table that hold the box becomes one in w and y: all is linear but
v = (sqrt w + sqrt y) / 2, which is concave: chords lie below, tangents above; the sign of its factor decides.
Time h / v is convex and falls with v: its tangent at a tangent of v.
"""

import math
from typing import NamedTuple

import numpy as np

from railjoule.core.arrays import FloatArray, IntArray
from railjoule.core.chain_proof.table import BRAKING, DRIVING, EFFORTS, SPEEDS, DriveTable, row_at, row_speed
from railjoule.core.compiled import borrowed, njit
from railjoule.core.drive.kernels import has_standstill_brake, negligible_effort
from railjoule.core.physics.cell import mean_speed
from railjoule.core.physics.effort_limit import WIDENING, EffortLimit, effort_range, upper_line
from railjoule.core.physics.mesh_data import MeshData, cell_at, limits_at, shared_by_cells
from railjoule.core.physics.resistance import mean_starting_resistance

DRIVE, OFF, BRAKE, BLEND = range(4)
ENERGY, ENERGY_W, ENERGY_Y, TIME, TIME_W, TIME_Y, LOWER, LOWER_W, UPPER, UPPER_W = range(10)
"""Columns of a box: energy and time at w = y = 0 with their slopes, and the lines y >= and y <= of its limits."""
COLUMNS = 10
ROUNDING_ROWS = 1e-9
"""A box reaches so far beyond a row before it needs the next one; the ranges of speed are wider than that."""


class Grid(NamedTuple):
    """Intervals of speed at the nodes.

    Parameters
    ----------
    low, high : array of shape (nodes, intervals)
        Squares of speed at their ends [m2/s2].
    counts : array of shape (nodes,)
        Number of intervals of each node.
    """

    low: FloatArray
    high: FloatArray
    counts: IntArray


class Pairs(NamedTuple):
    """Pairs of intervals that cells join: where those of each cell begin, the intervals at both nodes, and the mode."""

    first: IntArray
    start: IntArray
    end: IntArray
    mode: IntArray


class Plane(NamedTuple):
    """Value at w = y = 0 and slopes by w and y."""

    value: float
    by_w: float
    by_y: float


class Lines(NamedTuple):
    """y >= lower + lower_by_w w and y <= upper + upper_by_w w."""

    lower: float
    lower_by_w: float
    upper: float
    upper_by_w: float


class Box(NamedTuple):
    """The least and the greatest w, the least and the greatest y [m2/s2]."""

    low_w: float
    high_w: float
    low_y: float
    high_y: float


class Minorant(NamedTuple):
    """c0 + cx x + cv v, a plane below the energy per metre [J/m] over effort x [N] and speed v [m/s]."""

    constant: float
    by_effort: float
    by_speed: float


class CellMotion(NamedTuple):
    """A cell's motion F = k1 y - k0 w + A + B v over a length h, and what limits its change of w.

    A is between `least_n` and `most_n`, which differ by what a starting resistance varies.
    """

    length_m: float
    k1: float
    k0: float
    least_n: float
    most_n: float
    linear: float
    rise: float
    fall: float


@njit(cache=True, error_model="numpy")
def cell_motion(mesh: MeshData, number: int) -> CellMotion:
    """Return the motion through one cell of a meshed line."""
    cell = cell_at(mesh, number)
    half, wide = 0.5 * cell.quadratic, 2.0 * cell.length_m * (1.0 + WIDENING)
    return CellMotion(
        cell.length_m,
        cell.inertia + half,
        cell.inertia - half,
        cell.constant_n,
        cell.constant_n + cell.starting_n,
        cell.linear,
        wide * mesh.max_acceleration_ms2,
        wide * mesh.max_deceleration_ms2,
    )


@njit(cache=True, error_model="numpy")
def motion_in_box(cell: CellMotion, starting: tuple[float, float], box: Box) -> CellMotion:
    """Return the motion with the range of a starting resistance, at rest and where it ends, in one box."""
    least = mean_starting_resistance(starting[0], starting[1], box.high_w, box.high_y)
    most = mean_starting_resistance(starting[0], starting[1], box.low_w, box.low_y)
    # `least_n` of a cell is without any
    bare = cell.least_n
    return CellMotion(cell.length_m, cell.k1, cell.k0, bare + least, bare + most, cell.linear, cell.rise, cell.fall)


@njit(cache=True, error_model="numpy")
def _chord(box: Box) -> Plane:
    """Return a plane below the mean speed over a box."""
    a, b, c, d = box
    sa, sb, sc, sd = math.sqrt(a), math.sqrt(b), math.sqrt(c), math.sqrt(d)
    by_w = 0.5 / (sa + sb) if b > a else 0.0
    by_y = 0.5 / (sc + sd) if d > c else 0.0
    return Plane(0.5 * (sa + sc) - by_w * a - by_y * c, by_w, by_y)


@njit(cache=True, error_model="numpy")
def _tangent(box: Box, w: float, y: float) -> Plane:
    """Return a plane above the mean speed over a box, which touches it at a point."""
    sw, sy = math.sqrt(w), math.sqrt(y)
    by_w = 0.25 / sw if box.high_w > box.low_w else 0.0
    by_y = 0.25 / sy if box.high_y > box.low_y else 0.0
    return Plane(0.5 * (sw + sy) - by_w * w - by_y * y, by_w, by_y)


@njit(cache=True, error_model="numpy")
def _line(cell: CellMotion, constant: float, slope: float, speed: Plane, resisting: float) -> tuple[float, float]:
    """Return y = l0 + l1 w on which k1 y - k0 w + A = constant + slope v, with v on a plane and A as `resisting`."""
    by_y = cell.k1 - slope * speed.by_y
    start = (constant + slope * speed.value - resisting) / by_y
    return start, (cell.k0 + slope * speed.by_w) / by_y


@njit(cache=True, error_model="numpy")
def _limit_line(
    cell: CellMotion,
    box: Box,
    centre: tuple[float, float],
    speeds: tuple[float, float],
    a0: float,
    a1: float,
    upper: bool,
) -> tuple[float, float]:
    """Return the line of F <= a0 + a1 v, or of F >= -(a0 + a1 v) if not `upper`."""
    sign = 1.0 if upper else -1.0
    for _ in range(2):
        slope = sign * a1 - cell.linear
        # looser: an upper line with more than v times a rising effort, a lower one with less
        speed = _tangent(box, centre[0], centre[1]) if sign * slope > 0.0 else _chord(box)
        # an effort that rises as steeply as inertia asks for no line: its greatest value does
        if cell.k1 - slope * speed.by_y > 0.1 * cell.k1:
            break
        a0, a1 = a0 + max(a1 * speeds[0], a1 * speeds[1]), 0.0
    return _line(cell, sign * a0, slope, speed, cell.least_n if upper else cell.most_n)


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
) -> Minorant:
    """Return a plane below the energy per metre over ranges of effort [N] and speed [m/s].

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
    return Minorant(c0, cx, cv)


@njit(cache=True, error_model="numpy")
def _min_of_plane(plane: Plane, box: Box, lines: Lines) -> float:
    """Return about the least of a plane over a box within lines: at their ends by w."""
    best = math.inf
    for w in (box.low_w, box.high_w):
        low = min(max(box.low_y, lines.lower + lines.lower_by_w * w), box.high_y)
        high = max(min(box.high_y, lines.upper + lines.upper_by_w * w), box.low_y)
        best = min(best, plane.by_w * w + min(plane.by_y * low, plane.by_y * high))
    return plane.value + best


@njit(cache=True, error_model="numpy")
def _energy_plane(
    cell: CellMotion, minor: Minorant, effort: tuple[float, float, float], box: Box, touch: tuple[float, float]
) -> Plane:
    """Return the plane below a cell's energy from c0 + cx x + cv v, x = x0 + xf (F) + xv v given as (x0, xf, xv)."""
    c0, cx, cv = minor
    x0, by_force, by_speed = effort
    factor = cv + cx * (by_speed + by_force * cell.linear)
    speed = _chord(box) if factor > 0.0 else _tangent(box, touch[0], touch[1])
    force = cx * by_force
    resisting = cell.least_n if force > 0.0 else cell.most_n
    return Plane(
        cell.length_m * (c0 + cx * x0 + force * resisting + factor * speed.value),
        cell.length_m * (factor * speed.by_w - force * cell.k0),
        cell.length_m * (factor * speed.by_y + force * cell.k1),
    )


@njit(cache=True, error_model="numpy")
def mode_lines(
    cell: CellMotion,
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
    centre = 0.5 * (box.low_w + box.high_w), 0.5 * (box.low_y + box.high_y)
    a0, a1, least = limit
    spare, off = friction
    if mode == DRIVE:
        l0, l1 = _limit_line(cell, box, centre, speeds, 0.0, 0.0, False)
        u0, u1 = _limit_line(cell, box, centre, speeds, a0, a1, True)
    else:
        above = -least if mode == BLEND else off if mode == OFF else 0.0
        u0, u1 = _limit_line(cell, box, centre, speeds, above, 0.0, True)
        below = a0 + (0.0 if mode == BRAKE else spare * (1.0 + WIDENING)) + (off if mode == OFF else 0.0)
        l0, l1 = _limit_line(cell, box, centre, speeds, below, a1, False)
    # of two limits the tighter one at the middle: both hold, one line does
    if u0 + u1 * centre[0] > cell.rise + centre[0]:
        u0, u1 = cell.rise, 1.0
    if l0 + l1 * centre[0] < centre[0] - cell.fall:
        l0, l1 = -cell.fall, 1.0
    return Lines(l0, l1, u0, u1)


@njit(cache=True, error_model="numpy")
def _best_energy(
    table: DriveTable,
    cell: CellMotion,
    mode: int,
    box: Box,
    speeds: tuple[float, float],
    limit: tuple[float, float, float],
    touch: tuple[float, float],
    lines: Lines,
    prices: tuple[float, float, float],
) -> Plane:
    """Return the plane below the energy whose least is greatest with prices (onward / (h k1), of w, of y)."""
    a0, a1, least = limit
    most = a0 + max(a1 * speeds[0], a1 * speeds[1])
    f1 = cell.k1 * box.low_y - cell.k0 * box.high_w + cell.least_n + cell.linear * speeds[0]
    f2 = cell.k1 * box.high_y - cell.k0 * box.low_w + cell.most_n + cell.linear * speeds[1]
    side = DRIVING if mode == DRIVE else BRAKING
    low, high, wanted, effort = max(f1, 0.0), min(f2, most), prices[0], (0.0, 1.0, 0.0)
    if mode == BRAKE:
        low, high, wanted, effort = max(-f2, 0.0), min(-f1, most), -prices[0], (0.0, -1.0, 0.0)
    elif mode == BLEND:
        low, high, wanted, effort = least, most, 0.0, (a0, 0.0, a1)
    step = table.top_n[side] / EFFORTS
    best, found = -math.inf, Plane(0.0, 0.0, 0.0)
    for by_price in (False, True):
        given = step, (min(low, high), high), speeds, wanted
        minor = minorant(table.low[side], table.last[side], table, *given, by_price)
        if minor.constant == math.inf:
            return Plane(math.inf, 0.0, 0.0)
        # of the electric limit a minorant that falls with effort takes the line above, one that rises the least
        x = (least, 0.0, 0.0) if mode == BLEND and minor.by_effort > 0.0 else effort
        plane = _energy_plane(cell, minor, x, box, touch)
        value = _min_of_plane(Plane(plane.value, plane.by_w + prices[1], plane.by_y + prices[2]), box, lines)
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
    cell: CellMotion,
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
    cell : Steps
        Of the cell.
    traction, braking : EffortLimit
    friction : tuple
        Effort of friction brakes [N], up to which effort the drive counts as off [N], whether a standstill brake stands
        in for the electric one without power.
    mode : int
    box : Box
    prices : tuple
        Of a second [J/s] and of both squares of speed, as slopes of the cost to go [J s2/m2]: they choose between
        minorants, which hold with any.
    row : array of shape (COLUMNS,)
        To be filled.
    """
    a, b, c, d = box
    v1 = mean_speed(math.sqrt(a), math.sqrt(c))
    v2 = mean_speed(math.sqrt(b), math.sqrt(d))
    f1 = cell.k1 * c - cell.k0 * b + cell.least_n + cell.linear * v1
    f2 = cell.k1 * d - cell.k0 * a + cell.most_n + cell.linear * v2
    if (mode == DRIVE and f2 <= 0.0) or (mode != DRIVE and f1 > friction[1]):
        return False
    limit = _mode_limit(traction, braking, mode, friction[2], v1, v2)
    if mode == BLEND and -f1 < limit[2]:
        return False
    lines = mode_lines(cell, mode, box, (v1, v2), limit, (friction[0], friction[1]))
    # no w of the box leads to a y of it
    if (
        max(lines.upper + lines.upper_by_w * a, lines.upper + lines.upper_by_w * b) < c
        or min(lines.lower + lines.lower_by_w * a, lines.lower + lines.lower_by_w * b) > d
    ):
        return False
    w = 0.5 * (a + b)
    y = max(0.5 * (c + d), lines.lower + lines.lower_by_w * w)
    y = min(max(min(y, lines.upper + lines.upper_by_w * w), c), d)
    speed, h, v = _tangent(box, w, y), cell.length_m, mean_speed(math.sqrt(w), math.sqrt(y))
    slope = -h / (v * v)
    row[TIME], row[TIME_W], row[TIME_Y] = 2.0 * h / v + slope * speed.value, slope * speed.by_w, slope * speed.by_y
    row[LOWER], row[LOWER_W], row[UPPER], row[UPPER_W] = lines
    row[ENERGY] = row[ENERGY_W] = row[ENERGY_Y] = 0.0
    if mode != OFF:
        second, start, end = prices
        given = -end / (h * cell.k1), second * row[TIME_W] - start, second * row[TIME_Y] + end
        plane = _best_energy(table, cell, mode, box, (v1, v2), limit, (w, y), lines, given)
        if plane.value == math.inf:
            return False
        row[ENERGY], row[ENERGY_W], row[ENERGY_Y] = plane
    return True


@njit(cache=True, error_model="numpy", nogil=True)
def fill_boxes(
    mesh: MeshData, table: DriveTable, grid: Grid, pairs: Pairs, node_price: FloatArray, second: float
) -> tuple[Pairs, FloatArray]:
    """Return those pairs that runs may pass, and their boxes: rows of `COLUMNS`.

    Parameters
    ----------
    mesh : MeshData
    table : DriveTable
    grid : Grid
    pairs : Pairs
    node_price : array of shape (n + 1, m)
        Slopes of the cost to go in each interval [J s2/m2].
    second : float
        Price of a second, auxiliaries included [J/s].
    """
    low, high, _ = grid
    count = pairs.start.shape[0]
    kept, rows = np.zeros(low.shape[0], dtype=np.int64), np.empty((count, COLUMNS))
    passed = np.empty((3, count), np.int64)
    shared = shared_by_cells(mesh)
    train, _, _, drive = shared.own
    table = DriveTable(
        borrowed(table.low), borrowed(table.last), table.slowest_ms, table.fastest_ms, borrowed(table.top_n)
    )
    off, replaced = negligible_effort(train.drive_kind, drive), has_standstill_brake(train.drive_kind, drive)
    m, starting = 0, (mesh.starting_n, mesh.starting_ends_ms)
    for i in range(low.shape[0] - 1):
        kept[i] = m
        cell = cell_motion(mesh, i)
        train, traction, braking, _ = limits_at(shared, i)
        friction = train.friction_effort_n, off, replaced and braking.constant_n > 0.0
        for pair in range(pairs.first[i], pairs.first[i + 1]):
            k, q, mode = pairs.start[pair], pairs.end[pair], pairs.mode[pair]
            box = Box(low[i, k], high[i, k], low[i + 1, q], high[i + 1, q])
            prices = second, node_price[i, k], node_price[i + 1, q]
            motion = motion_in_box(cell, starting, box) if starting[0] > 0.0 else cell
            if fill_box(table, motion, traction, braking, friction, mode, box, prices, rows[m]):
                passed[0, m], passed[1, m], passed[2, m] = k, q, mode
                m += 1
    kept[low.shape[0] - 1] = m
    return Pairs(kept, passed[0, :m], passed[1, :m], passed[2, :m]), rows[:m]
