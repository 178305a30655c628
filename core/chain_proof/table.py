"""Energy of a drive per metre, tabulated over effort and speed so that no point lies below the table.

`lowered_energy` serves both bounds: that of chains, with the table below, and `railjoule.core.continuous_bound`.

Between four corners of the table the bilinear interpolant of `DriveTable.low` lies below the energy per metre
e(x, v) = P(x, v) / v, so that a plane below the corners of a region lies below the drive in all of it. The interpolant
of the true values exceeds a function by at most

    sag = dx^2 / 8 sup max(e_xx, 0) + dv^2 / 8 sup max(e_vv, 0),

the errors of interpolating along x, then along v; `low` is the true value less the greatest sag of the rectangles
around. Only curvature upwards counts: a map which is not convex needs nothing else. Sources of the suprema:

- Losses of geared motors are bicubic patches L(M, y) = sum c_ab M^a y^b, M = m x, y = t v; the loss polynomial is one
  patch. e = share x + L / v. e_xx = m^2 L_MM / v is linear in M and cubic in y: its supremum is at most that of its
  Bezier points at both ends of M. Of L / v the terms y and y^2 have no curvature left, so that
  e_vv = 2 a0(M) / v^3 + 2 a3(M) t^3 with the cubics a0 = L(M, 0), continued to rest, and a3: Bezier points again, at
  both ends of v, between which it is monotone. That is rigorous up to rounding.
- A constant efficiency has no curvature, e = x / eta. Windings lose c x^2: e = x + c x^2 / v, so that
  e_xx = 2 c / v and e_vv = 2 c x^2 / v^3, both greatest where v is least.
- Induction machines, and kinds that this file does not know, have no such closed form: their suprema are estimated from
  values, slopes and curvatures at the corners, times `SAFETY`. `premise` words that premise.
"""

import math
from typing import NamedTuple

import numpy as np

from railjoule.core.arrays import FloatArray, IntArray
from railjoule.core.compiled import Value, njit
from railjoule.core.drive.geared import (
    BY_SPEED,
    BY_SPEED2,
    BY_TORQUE,
    BY_TORQUE2,
    LOSS_COEFFICIENT,
    MOTORS,
    NO_LOAD,
    TURNS,
)
from railjoule.core.drive.kernels import has_standstill_brake, power_when_on, shaft_force, work_bounds
from railjoule.core.drive.kinds import CONSTANT_EFFICIENCY, COPPER_LOSS, GEARED, LOSS_MAP, LOSS_POLYNOMIAL, PowerTerms
from railjoule.core.drive.loss_map import BRAKING_TABLE, DRIVING_TABLE, HEAD, PATCH, piece_in
from railjoule.core.physics.effort_limit import EffortLimit, max_effort, upper_line
from railjoule.core.physics.energy_balance import energy_per_metre
from railjoule.core.physics.mesh_data import MeshData

EFFORTS, SPEEDS = 128, 256
"""Steps of a table; its sag falls with their squares, the time to fill it grows with their product."""
SAFETY = 1.5
"""By how much a machine's curvature between the points may exceed what they tell."""
# runs keep their limits to 1e-8, the boxes of the proof widen them by 2e-8
ABOVE = 1e-6
"""A table goes beyond the largest effort by this share."""
MIN_EFFORT = 1e-9
"""Stands for no effort, where a drive that is on would be off, as a share of the largest."""
MIN_LOSS = 1e-9
"""A loss no greater than this share of the energy counts as cut off: the difference is rounded."""
DRIVING, BRAKING = 0, 1
CLOSED_FORMS = (CONSTANT_EFFICIENCY, COPPER_LOSS, LOSS_POLYNOMIAL, LOSS_MAP)
"""Kinds of drives whose curvature is known between the points of a table, and whose power goes on beyond a limit."""


class DriveTable(NamedTuple):
    """The table of a drive under the limits of a meshed line.

    Parameters
    ----------
    low : array of shape (2, SPEEDS + 1, EFFORTS + 1)
        Energy of the line over a metre, less the sag [J/m], by driving and braking effort; in braking, the least over
        what friction brakes may leave to the electric one. Infinite where no effort is allowed.
    last : array of shape (2, SPEEDS + 1)
        The last column of each row that any allowed effort needs; -1 where there is none.
    slowest_ms, fastest_ms : float
        Speeds of the first and of the last row; row j lies at slowest + (fastest - slowest) (j / SPEEDS)^2.
    top_n : array of shape (2,)
        Efforts of the last column [N].
    """

    low: FloatArray
    last: IntArray
    slowest_ms: float
    fastest_ms: float
    top_n: FloatArray


def premise(kind: int) -> str:
    """Return in one clause what the table of a kind of drive assumes, empty where it assumes nothing."""
    if kind in CLOSED_FORMS:
        return ""
    return (
        "between the points of a table of its power, the machines' power curves at most "
        f"{SAFETY:g} times as much as at these points"
    )


@njit(cache=True, error_model="numpy")
def row_speed(slowest: float, fastest: float, row: float) -> float:
    """Return the speed of a row [m/s]: dense near rest, where the energy per metre is curved as 1 / v."""
    share = row / SPEEDS
    return slowest + (fastest - slowest) * share * share


@njit(cache=True, error_model="numpy")
def row_at(table: DriveTable, speed: float) -> float:
    """Return the row of a speed [m/s], with its fraction."""
    share = (speed - table.slowest_ms) / (table.fastest_ms - table.slowest_ms)
    return SPEEDS * math.sqrt(max(share, 0.0))


@njit(cache=True, error_model="numpy")
def _bezier_most(c0: float, c1: float, c2: float, c3: float, start: float, end: float) -> float:
    """Return an upper bound of a cubic over a range: the greatest of its Bezier points."""
    first = ((c3 * start + c2) * start + c1) * start + c0
    last = ((c3 * end + c2) * end + c1) * end + c0
    third = (end - start) / 3.0
    second = first + third * ((3.0 * c3 * start + 2.0 * c2) * start + c1)
    before_last = last - third * ((3.0 * c3 * end + 2.0 * c2) * end + c1)
    highest: float = max(first, second, before_last, last)
    return highest


@njit(cache=True, error_model="numpy")
def _patch_curvatures(
    c: FloatArray,
    torque: tuple[float, float],
    corner: tuple[float, float],
    turning: tuple[float, float],
    speed: tuple[float, float],
    turns: float,
) -> tuple[float, float, float]:
    """Return suprema of L_MM / v, of the second derivative of L / v by v, and of the size of its mixed one.

    For one motor and one patch, whose 16 coefficients are `c`.

    `torque` and `turning` are the ranges of M and of y, `corner` that of the patch, from which its coefficients count;
    `speed` is that of v.
    """
    x1, x2 = torque[0] - corner[0], torque[1] - corner[0]
    y1, y2 = turning[0] - corner[1], turning[1] - corner[1]
    by_torque = -math.inf
    for x in (x1, x2):
        t0, t1 = 2.0 * c[8] + 6.0 * c[12] * x, 2.0 * c[9] + 6.0 * c[13] * x
        t2, t3 = 2.0 * c[10] + 6.0 * c[14] * x, 2.0 * c[11] + 6.0 * c[15] * x
        by_torque = max(by_torque, _bezier_most(t0, t1, t2, t3, y1, y2))
    by_speed, back = -math.inf, -corner[1]
    for v in speed:
        # of each power of M what L has at rest, and its term of y^3
        r, g = 2.0 / (v * v * v), 2.0 * turns * turns * turns
        s0 = r * (((c[3] * back + c[2]) * back + c[1]) * back + c[0]) + g * c[3]
        s1 = r * (((c[7] * back + c[6]) * back + c[5]) * back + c[4]) + g * c[7]
        s2 = r * (((c[11] * back + c[10]) * back + c[9]) * back + c[8]) + g * c[11]
        s3 = r * (((c[15] * back + c[14]) * back + c[13]) * back + c[12]) + g * c[15]
        by_speed = max(by_speed, _bezier_most(s0, s1, s2, s3, x1, x2))
    # a curvature downwards counts as none, so that it does not matter which end of v it is divided by
    return by_torque / speed[0], by_speed, _mixed_most(c, x2, y2, turning[1]) / (speed[0] * speed[0])


@njit(cache=True, error_model="numpy")
def _mixed_most(c: FloatArray, x: float, y: float, turning: float) -> float:
    """Return an upper bound of |y L_My - L_M| over a patch up to x and y from its corner: the sum of its terms' sizes.

    The second derivative of L / v by M and v is that over v^2.
    """
    most = 0.0
    power = 1.0
    for a in range(1, 4):
        row = 4 * a
        size = abs(c[row]) + abs(c[row + 1]) * (turning + y) + abs(c[row + 2]) * y * (2.0 * turning + y)
        most += a * power * (size + abs(c[row + 3]) * y * y * (3.0 * turning + y))
        power *= x
    return most


@njit(cache=True, error_model="numpy")
def loss_curvatures(
    kind: int,
    parameters: FloatArray,
    braking: bool,
    effort: tuple[float, float],
    speed: tuple[float, float],
    patch: FloatArray,
) -> tuple[float, float, float]:
    """Return suprema of e_xx, e_vv, |e_xv| over a rectangle, of a kind in `CLOSED_FORMS`; `patch` has room for 16."""
    if kind == CONSTANT_EFFICIENCY:
        return 0.0, 0.0, 0.0
    if kind == COPPER_LOSS:
        e_xx = 2.0 * parameters[LOSS_COEFFICIENT] / speed[0]
        slope = effort[1] / speed[0]
        return e_xx, e_xx * slope * slope, e_xx * slope
    motors, turns = parameters[MOTORS], parameters[TURNS]
    m = work_bounds(kind, parameters)[1 if braking else 0] / (motors * turns)
    torque, turning = (m * effort[0], m * effort[1]), (turns * speed[0], turns * speed[1])
    if kind == LOSS_POLYNOMIAL:
        patch[:] = 0.0
        patch[0], patch[1], patch[2] = parameters[NO_LOAD], parameters[BY_SPEED], parameters[BY_SPEED2]
        patch[4], patch[8] = parameters[BY_TORQUE], parameters[BY_TORQUE2]
        e_xx, e_vv, e_xv = _patch_curvatures(patch, torque, (0.0, 0.0), turning, speed, turns)
        return motors * m * m * e_xx, motors * e_vv, motors * m * e_xv
    start = int(parameters[BRAKING_TABLE]) if braking else DRIVING_TABLE
    torques, speeds = int(parameters[start]), int(parameters[start + 1])
    first_torque = start + HEAD
    first_speed = first_torque + torques
    e_xx = e_vv = e_xv = -math.inf
    for i in range(
        piece_in(parameters, first_torque, torques, torque[0]),
        piece_in(parameters, first_torque, torques, torque[1]) + 1,
    ):
        for j in range(
            piece_in(parameters, first_speed, speeds, turning[0]),
            piece_in(parameters, first_speed, speeds, turning[1]) + 1,
        ):
            c = first_speed + speeds + PATCH * (i * (speeds - 1) + j)
            corner = parameters[first_torque + i], parameters[first_speed + j]
            # the part of the rectangle that lies in the patch; the last ones go on beyond the map
            x1, y1 = max(torque[0], corner[0]), max(turning[0], corner[1])
            x2 = torque[1] if i == torques - 2 else min(torque[1], parameters[first_torque + i + 1])
            y2 = turning[1] if j == speeds - 2 else min(turning[1], parameters[first_speed + j + 1])
            found = _patch_curvatures(
                parameters[c : c + PATCH], (x1, x2), corner, (y1, y2), (y1 / turns, y2 / turns), turns
            )
            e_xx, e_vv, e_xv = max(e_xx, found[0]), max(e_vv, found[1]), max(e_xv, found[2])
    return motors * m * m * e_xx, motors * e_vv, motors * m * e_xv


@njit(cache=True, error_model="numpy")
def estimated_sag(start: tuple[Value, Value, Value], end: tuple[Value, Value, Value], step: Value) -> Value:
    """Return the sag of a function below the chord of two points, from value, slope and curvature at both.

    The least of three: a quarter of what its slope changes by, an eighth of its curvature, and the chord less the
    tangent at the first point.
    """
    value, slope, curvature = start
    end_value, end_slope, end_curvature = end
    bend = 0.125 * step * step * np.maximum(curvature, end_curvature)
    by_bend = np.maximum(0.25 * step * (end_slope - slope), bend)
    concave = 0.5 * step * step * np.maximum(np.maximum(-curvature, -end_curvature), 0.0)
    by_start = end_value - value - slope * step + concave
    sag: Value = SAFETY * np.maximum(np.minimum(by_bend, by_start), 0.0)
    return sag


@njit(cache=True, error_model="numpy")
def energy_point(mesh: MeshData, mode: int, effort: float, most: float, step: float, speed: float) -> PowerTerms:
    """Return e, e_x, e_v, e_xx, e_xv, e_vv [J/m] of a drive that is on; machines go on straight beyond an effort."""
    kind, parameters, braking = mesh.drive_kind, mesh.drive_parameters, mode == BRAKING
    if kind in CLOSED_FORMS:
        return energy_per_metre(power_when_on(kind, parameters, braking, effort, speed), speed)
    # beyond their pull-out machines have no power at all, and at it an infinite slope: the chord below it goes on
    least = MIN_EFFORT * most
    inside = min(max(effort, least), most)
    p, p_x, p_v, p_xx, p_xv, p_vv = power_when_on(kind, parameters, braking, inside, speed)
    if effort > inside:
        before = max(inside - step, least)
        p += (p - power_when_on(kind, parameters, braking, before, speed)[0]) / (inside - before) * (effort - inside)
        p_xx = 0.0
    return energy_per_metre((p, p_x, p_v, p_xx, p_xv, p_vv), speed)


@njit(cache=True, error_model="numpy")
def _reach(limit: EffortLimit, table: DriveTable, mode: int) -> IntArray:
    """Return how many columns the strips between rows need, and fill the last column of each row."""
    slowest, fastest, reach = table.slowest_ms, table.fastest_ms, np.empty(SPEEDS, dtype=np.int64)
    for j in range(SPEEDS):
        v1, v2 = row_speed(slowest, fastest, j), row_speed(slowest, fastest, j + 1)
        constant, slope = upper_line(limit, v1, v2)
        most = constant + max(slope * v1, slope * v2)
        reach[j] = min(max(math.ceil(most / table.top_n[mode] * EFFORTS), 1), EFFORTS)
    for j in range(SPEEDS + 1):
        table.last[mode, j] = max(reach[max(j - 1, 0)], reach[min(j, SPEEDS - 1)])
    return reach


@njit(cache=True, error_model="numpy", nogil=True)
def lowered_energy(
    mesh: MeshData,
    mode: int,
    speed: FloatArray,
    top: FloatArray,
    share: FloatArray,
    last: IntArray,
    reach: IntArray,
) -> FloatArray:
    """Return energy from the supply per metre [J/m], lowered so that bilinear interpolants lie below it.

    Parameters
    ----------
    mesh : MeshData
        Whose drive is asked.
    mode : int
        DRIVING or BRAKING.
    speed, top : array of shape (m,)
        Rows of speed [m/s], and the efforts of the share 1 there [N].
    share : array of shape (k,)
        Shares of these efforts, rising from 0 to 1.
    last : array of shape (m,)
        The last column of each row that is needed.
    reach : array of shape (m - 1,)
        How many rectangles between a row and the next are needed.

    Returns
    -------
    array of shape (m, k)
        Infinite beyond the last columns.
    """
    rows, points = speed.shape[0], np.zeros((speed.shape[0], share.shape[0], 7))
    energy, is_braking = np.full((rows, share.shape[0]), np.inf), mode == BRAKING
    limit = mesh.braking if is_braking else mesh.traction
    for j in range(rows):
        most, step = max_effort(limit, speed[j]), top[j] * (share[-1] - share[-2])
        for k in range(last[j] + 1):
            p, effort = points[j, k], top[j] * share[k]
            p[0], p[1], p[2], p[3], p[4], p[5] = energy_point(mesh, mode, effort, most, step, speed[j])
            p[6] = p[0] - shaft_force(mesh.drive_kind, mesh.drive_parameters, is_braking, effort)[0]
    sags = _sags(mesh, mode, speed, top, share, points, reach)
    for j in range(rows):
        energy[j, : last[j] + 1] = points[j, : last[j] + 1, 0] - sags[j, : last[j] + 1]
    if is_braking:
        replaced = has_standstill_brake(mesh.drive_kind, mesh.drive_parameters)
        _take_from_supply(energy, last, reach, mesh.recuperation_factor, replaced)
    return energy


@njit(cache=True, error_model="numpy")
def _sags(
    mesh: MeshData,
    mode: int,
    speed: FloatArray,
    top: FloatArray,
    share: FloatArray,
    points: FloatArray,
    reach: IntArray,
) -> FloatArray:
    """Return the greatest sag of the rectangles around each point [J/m]; shape (m, k).

    Over speed the effort of a share changes with the effort of the share 1.
    """
    kind, sags, patch = mesh.drive_kind, np.zeros(points.shape[:2]), np.empty(PATCH)
    for j in range(speed.shape[0] - 1):
        width, high, count = speed[j + 1] - speed[j], max(top[j], top[j + 1]), reach[j]
        slope, row = (top[j + 1] - top[j]) / width, np.empty(count)
        if kind in CLOSED_FORMS:
            for k in range(count):
                u = share[k + 1]
                effort = min(top[j], top[j + 1]) * share[k], high * u
                e_xx, e_vv, e_xv = loss_curvatures(
                    kind, mesh.drive_parameters, mode == BRAKING, effort, (speed[j], speed[j + 1]), patch
                )
                e_xx = max(e_xx, 0.0)
                step, turn = high * (u - share[k]), u * abs(slope)
                bend = max(turn * turn * e_xx + 2.0 * turn * e_xv + e_vv, 0.0)
                row[k] = 0.125 * (step * step * e_xx + width * width * bend)
                if GEARED[kind]:
                    row[k] = max(row[k], _cut_off(points, j, k))
        else:
            end = count + 1
            row[:] = _estimated_row(points[j, :end], points[j + 1, :end], top[j], top[j + 1], share[:end], width)
        for q in range(2):
            sags[j + q, :count] = np.maximum(sags[j + q, :count], row)
            sags[j + q, 1 : count + 1] = np.maximum(sags[j + q, 1 : count + 1], row)
    return sags


@njit(cache=True, error_model="numpy")
def _estimated_row(
    slow: FloatArray, fast: FloatArray, slow_top: float, fast_top: float, share: FloatArray, width: float
) -> FloatArray:
    """Return the estimated sags of the rectangles between two rows of points [J/m]; shape (k - 1,)."""
    rises = share[1:] - share[:-1]
    along = np.zeros(len(rises))
    for p, top in ((slow, slow_top), (fast, fast_top)):
        a, b = p[:-1], p[1:]
        found = estimated_sag((a[:, 0], a[:, 1], a[:, 3]), (b[:, 0], b[:, 1], b[:, 3]), top * rises)
        along = np.maximum(along, found)
    turn = share * ((fast_top - slow_top) / width)
    start = slow[:, 0], slow[:, 2] + turn * slow[:, 1], slow[:, 5] + turn * (2.0 * slow[:, 4] + turn * slow[:, 3])
    end = fast[:, 0], fast[:, 2] + turn * fast[:, 1], fast[:, 5] + turn * (2.0 * fast[:, 4] + turn * fast[:, 3])
    across = estimated_sag(start, end, width + 0.0 * turn)
    return along + np.maximum(across[:-1], across[1:])


@njit(cache=True, error_model="numpy")
def _cut_off(points: FloatArray, j: int, k: int) -> float:
    """Return the sag of a map's loss that is cut off at zero at a corner: no more than the highest corner's loss.

    Cut off it has a corner of its own, which the curvature of its patch does not show.
    """
    lowest, highest = math.inf, 0.0
    for q in range(2):
        for r in range(2):
            p = points[j + q, k + r]
            lowest, highest = min(lowest, p[6] - MIN_LOSS * abs(p[0])), max(highest, p[6])
    return highest if lowest <= 0.0 else 0.0


@njit(cache=True, error_model="numpy")
def _take_from_supply(low: FloatArray, last: IntArray, reach: IntArray, factor: float, replaced: bool) -> None:
    """Turn the energy of the drive into that of the supply, in place; `replaced` where a standstill brake never draws.

    The supply's part u(e) = max(e, r e) is convex and rises: u of what lies below lies below, but the interpolant of u
    at the corners exceeds u of the interpolant, where these lie on both sides of zero, by up to
    (1 - r) a b / (a + b), a the highest of them and -b the lowest: the chord's distance from the kink.
    """
    if replaced:
        # only the energy that it generates: where it would draw a standstill brake stands in, in the mode without power
        low *= factor
        return
    kinks = np.zeros(low.shape)
    for j in range(low.shape[0] - 1):
        for k in range(reach[j]):
            high = max(low[j, k], low[j, k + 1], low[j + 1, k], low[j + 1, k + 1])
            deep = -min(low[j, k], low[j, k + 1], low[j + 1, k], low[j + 1, k + 1])
            if high > 0.0 and deep > 0.0:
                kink = (1.0 - factor) * high * deep / (high + deep)
                for q in range(2):
                    for r in range(2):
                        kinks[j + q, k + r] = max(kinks[j + q, k + r], kink)
    for j in range(low.shape[0]):
        for k in range(last[j] + 1):
            low[j, k] = max(low[j, k], factor * low[j, k]) - kinks[j, k]


@njit(cache=True, error_model="numpy")
def _spare_by_friction(low: FloatArray, last: IntArray, window: int) -> None:
    """Take the least over the electric share that friction brakes leave free, in place.

    An effort between two points k and k + 1 leaves electric shares whose table lies between points of the windows
    of both; each such point is no less than the least of the window that it is in, so that the interpolant of the two
    leasts lies below.
    """
    for j in range(low.shape[0]):
        row = low[j].copy()
        for k in range(last[j] + 1):
            for q in range(max(0, k - window), k):
                low[j, k] = min(low[j, k], row[q])


@njit(cache=True, error_model="numpy", nogil=True)
def tabulate(mesh: MeshData, slowest: float, fastest: float) -> DriveTable:
    """Return the table of a meshed line's drive between two speeds [m/s], the first above zero."""
    top = np.array([mesh.traction.constant_n, mesh.braking.constant_n]) * (1.0 + ABOVE)
    low = np.full((2, SPEEDS + 1, EFFORTS + 1), np.inf)
    table = DriveTable(low, np.full((2, SPEEDS + 1), -1), slowest, fastest, top)
    speed, share = np.empty(SPEEDS + 1), np.arange(EFFORTS + 1) / EFFORTS
    for j in range(SPEEDS + 1):
        speed[j] = row_speed(slowest, fastest, j)
    for mode in (DRIVING, BRAKING):
        limit = mesh.traction if mode == DRIVING else mesh.braking
        if limit.constant_n <= 0.0:
            continue
        reach = _reach(limit, table, mode)
        tops = np.full(SPEEDS + 1, top[mode])
        low[mode] = lowered_energy(mesh, mode, speed, tops, share, table.last[mode], reach)
        if mode == BRAKING and mesh.friction_effort_n > 0.0:
            window = math.ceil(mesh.friction_effort_n / (top[mode] / EFFORTS))
            _spare_by_friction(low[mode], table.last[mode], window)
    return table
