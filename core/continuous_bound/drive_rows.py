"""Energy of a drive per metre less the worth of its effort, over rows of speed and a grid of prices of force.

For a price of force y [J/N m, without unit] a train at speed v chooses among driving, coasting and braking the least of

    h(y, v) = min over efforts of e(x, v) - y x,      e the line's energy per metre [J/m], braking x < 0,

and friction brakes may add their effort where the price is negative. The table lies nowhere above h:

- Between two rows of speed the limit F of effort is replaced by a line at or above it, and an effort by its share u of
  that line. For a fixed u everything but e(u F(v), v) is then linear in v, and e lies at most the sag

      du^2 / 8 sup max(e_uu, 0) + dv^2 / 8 sup max(e_vv along u, 0)

  below the bilinear interpolant of its values at the corners (u, v) of a rectangle; the values are lowered by it. So
  the linear interpolant over speed of the least over u at both rows lies below h.
- As a minimum of functions that are affine in y, h is concave in y: chords of a grid of prices lie below it. Beyond the
  grid it goes on with the slope of the greatest effort.

References: the suprema of curvature are those of `railjoule.core.chain_proof.table`.
"""

import math
import threading
from collections.abc import Hashable
from typing import NamedTuple

import numpy as np

from railjoule.core.arrays import FloatArray, IntArray
from railjoule.core.chain_proof.limit_lines import upper_line
from railjoule.core.chain_proof.table import (
    BRAKING,
    CLOSED_FORMS,
    DRIVING,
    LEAST_LOSS,
    energy_point,
    estimated_sag,
    loss_curvatures,
)
from railjoule.core.compiled import njit
from railjoule.core.drive.kernels import has_standstill_brake, shaft_force, work_bounds
from railjoule.core.drive.kinds import CONSTANT_EFFICIENCY, GEARED
from railjoule.core.drive.loss_map import PATCH
from railjoule.core.physics.course_data import CourseData
from railjoule.core.physics.effort_limit import EffortLimit, largest_effort

SPEEDS, GREATEST_RATIO = 240, 1.055
"""Row j of so many lies at the share (j / SPEEDS)^3 of the greatest speed; next to rest rows stand in the ratio."""
LOSSLESS_SPEEDS, LOSSLESS_RATIO = 160, 1.08
"""The same for a drive of constant efficiency, whose energy per metre does not sag between rows."""
SLOWEST_MS = 1e-4
"""The first row [m/s]."""
EFFORT_SHARES = (np.arange(193) / 192) ** 1.5
"""Shares of the largest effort of the table: a train that holds its speed needs little."""
ALL_OR_NOTHING = np.array([0.0, 1.0])
"""The shares for a drive whose energy is linear in effort."""
SLOWEST_MS, GREATEST_RATIO = 1e-4, 1.08
"""Below the speed where these rows stand in the ratio, they fall by it down to the first [m/s]."""
LIMIT_EXCESS = 2e-5
"""Strips in which the line above a limit exceeds it by more than this share of the largest effort are halved."""
NARROWEST_MS = 1e-4
"""Strips are not halved below that."""
MOST_KEPT = 8
"""So many tables are kept, of 2 MB each."""
PRICE_STEPS = ((0.17, 0.0025, 1.0), (3.0, 0.0, 1.015), (100.0, 0.0, 1.03), (1e8, 0.0, 1.1))
"""Up to a distance from 1 the distances of prices grow by a step, or by a ratio: a partial effort costs about 1."""
CLOSE = 1.0
"""Up to this distance there are as many around the recuperation factor, which is what braking in part is worth."""


class DriveRows(NamedTuple):
    """The table of one drive under its limits.

    Parameters
    ----------
    speed_ms : array of shape (m,)
        Rows of speed, rising, above zero [m/s].
    price : array of shape (k,)
        Grid of prices of force, rising.
    least : array of shape (k, m)
        At most h [J/m].
    driving_n, braking_n : array of shape (m,)
        At least the largest effort of the drive, and of all brakes [N].
    at_rest : array of shape (4,)
        Greatest tractive and electric braking effort [N], least energy per work of driving, most per work of braking.
    friction_n : float
        Largest effort of the friction brakes [N].
    """

    speed_ms: FloatArray
    price: FloatArray
    least: FloatArray
    driving_n: FloatArray
    braking_n: FloatArray
    at_rest: FloatArray
    friction_n: float


_KEPT: dict[Hashable, DriveRows] = {}
_LOCK = threading.Lock()


def drive_rows(course: CourseData, fastest_ms: float) -> DriveRows:
    """Return the table of a course's drive up to a speed [m/s]; kept for the next call with the same drive."""
    limits = course.traction, course.braking
    key = (
        course.drive_kind,
        course.drive_parameters.tobytes(),
        *((limit.constant_n, limit.power_w, limit.table.tobytes()) for limit in limits),
        course.recuperation_factor,
        course.friction_effort_n,
        fastest_ms,
    )
    with _LOCK:
        known = _KEPT.pop(key, None)
    if known is None:
        known = _make_rows(course, fastest_ms)
    with _LOCK:
        # the latest stands last
        _KEPT[key] = known
        while len(_KEPT) > MOST_KEPT:
            del _KEPT[next(iter(_KEPT))]
    return known


def _make_rows(course: CourseData, fastest_ms: float) -> DriveRows:
    lossless = course.drive_kind == CONSTANT_EFFICIENCY
    density = (LOSSLESS_SPEEDS, LOSSLESS_RATIO) if lossless else (SPEEDS, GREATEST_RATIO)
    speed = _row_speeds(fastest_ms, *density)
    for limit in (course.traction, course.braking):
        speed = _halve_loose_strips(limit, speed)
    most = np.array([_upper_efforts(limit, speed) for limit in (course.traction, course.braking)])
    effort_share = ALL_OR_NOTHING if course.drive_kind == CONSTANT_EFFICIENCY else EFFORT_SHARES
    energy = fill_energies(course, speed, most, effort_share)
    bounds = work_bounds(course.drive_kind, course.drive_parameters)
    price = _price_grid(course, bounds)
    least = np.empty((len(price), len(speed)))
    fill_least(energy, most, effort_share, price, course.friction_effort_n, least)
    at_rest = np.array([course.traction.constant_n, course.braking.constant_n, *bounds])
    return DriveRows(
        speed, price, least, most[0], most[1] + course.friction_effort_n, at_rest, course.friction_effort_n
    )


def _row_speeds(fastest_ms: float, count: int, ratio: float) -> FloatArray:
    """Return rows of speed before corners are added [m/s]; shape (m,)."""
    first = math.ceil(1.0 / (ratio ** (1.0 / 3.0) - 1.0))
    fast = fastest_ms * (np.arange(first, count + 1) / count) ** 3
    steps = math.ceil(math.log(fast[0] / SLOWEST_MS) / math.log(ratio))
    slow: FloatArray = np.geomspace(SLOWEST_MS, fast[0], steps, endpoint=False)
    return np.append(slow, fast)


def _price_grid(course: CourseData, bounds: tuple[float, float]) -> FloatArray:
    """Return the prices at which h is known: those at which a drive without losses of its own begins to pay, too."""
    away = [0.0]
    for end, step, ratio in PRICE_STEPS:
        while away[-1] < end:
            away.append(away[-1] * ratio + step)
    distance = np.array(away)
    returned = course.recuperation_factor * distance[distance < CLOSE]
    grids = [
        1.0 - distance,
        1.0 + distance,
        course.recuperation_factor - returned,
        course.recuperation_factor + returned,
    ]
    kinks = [0.0, bounds[0], bounds[1] * course.recuperation_factor]
    return np.unique(np.concatenate([*grids, kinks]))


def _halve_loose_strips(limit: EffortLimit, speed: FloatArray) -> FloatArray:
    """Return rows of speed [m/s] between which a line lies close above a limit."""
    added: list[float] = []
    open_strips = list(zip(np.append(0.0, speed[:-1]).tolist(), speed.tolist(), strict=True))[1:]
    while open_strips:
        v1, v2 = open_strips.pop()
        constant, slope = upper_line(limit, v1, v2)
        excess = max(constant + slope * v - largest_effort(limit, v) for v in (v1, v2))
        if excess > LIMIT_EXCESS * limit.constant_n and v2 - v1 > NARROWEST_MS:
            middle = 0.5 * (v1 + v2)
            added.append(middle)
            open_strips += [(v1, middle), (middle, v2)]
    return np.union1d(speed, added)


def _upper_efforts(limit: EffortLimit, speed: FloatArray) -> FloatArray:
    """Return efforts at the rows [N] whose linear interpolant lies at or above a limit; shape (m,)."""
    most = np.full(len(speed), largest_effort(limit, float(speed[0])))
    for j in range(len(speed) - 1):
        constant, slope = upper_line(limit, float(speed[j]), float(speed[j + 1]))
        most[j] = max(most[j], constant + slope * speed[j])
        most[j + 1] = max(largest_effort(limit, float(speed[j + 1])), constant + slope * speed[j + 1])
    return most


@njit(cache=True, error_model="numpy", nogil=True)
def fill_energies(course: CourseData, speed: FloatArray, most: FloatArray, share: FloatArray) -> FloatArray:
    """Return the line's energy per metre by share of effort [J/m], lowered by the sag; shape (2, m, k).

    Parameters
    ----------
    course : CourseData
        Whose drive is asked.
    speed : array of shape (m,)
        Rows [m/s].
    most : array of shape (2, m)
        Efforts of the share 1, driving and braking [N].
    share : array of shape (k,)
        Shares of these, rising from 0 to 1.
    """
    rows = speed.shape[0]
    energy = np.zeros((2, rows, share.shape[0]))
    points = np.empty((rows, share.shape[0], 7))
    for mode in (DRIVING, BRAKING):
        limit = course.traction if mode == DRIVING else course.braking
        for j in range(rows):
            inside = largest_effort(limit, speed[j])
            top = most[mode, j]
            step = top * (share[-1] - share[-2])
            for k in range(share.shape[0]):
                terms = energy_point(course, mode, top * share[k], inside, step, speed[j])
                p = points[j, k]
                p[0], p[1], p[2], p[3], p[4], p[5] = terms
                p[6] = (
                    p[0] - shaft_force(course.drive_kind, course.drive_parameters, mode == BRAKING, top * share[k])[0]
                )
        sags = _sags(course, mode, speed, most[mode], share, points)
        for j in range(rows):
            for k in range(share.shape[0]):
                energy[mode, j, k] = points[j, k, 0] - sags[j, k]
        if mode == BRAKING:
            _return_to_line(energy[mode], course)
    return energy


@njit(cache=True, error_model="numpy")
def _sags(
    course: CourseData, mode: int, speed: FloatArray, most: FloatArray, share: FloatArray, points: FloatArray
) -> FloatArray:
    """Return the greatest sag of the rectangles around each point [J/m]; shape (m, k)."""
    rows, kind = speed.shape[0], course.drive_kind
    sags, patch = np.zeros((rows, share.shape[0])), np.empty(PATCH)
    if kind == CONSTANT_EFFICIENCY:
        return sags
    for j in range(rows - 1):
        width = speed[j + 1] - speed[j]
        slope = (most[j + 1] - most[j]) / width
        high = max(most[j], most[j + 1])
        row = np.empty(share.shape[0] - 1)
        if kind in CLOSED_FORMS:
            for k in range(len(row)):
                u = share[k + 1]
                effort = min(most[j], most[j + 1]) * share[k], high * u
                e_xx, e_vv, e_xv = loss_curvatures(
                    kind, course.drive_parameters, mode == BRAKING, effort, (speed[j], speed[j + 1]), patch
                )
                e_xx = max(e_xx, 0.0)
                step, turn = high * (u - share[k]), u * abs(slope)
                bend = max(turn * turn * e_xx + 2.0 * turn * e_xv + e_vv, 0.0)
                row[k] = 0.125 * (step * step * e_xx + width * width * bend)
                if GEARED[kind]:
                    row[k] = max(row[k], _cut_off(points, j, k))
        else:
            row[:] = _estimated_row(points[j], points[j + 1], most[j], most[j + 1], share, width)
        for q in range(2):
            sags[j + q, :-1] = np.maximum(sags[j + q, :-1], row)
            sags[j + q, 1:] = np.maximum(sags[j + q, 1:], row)
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
    # over speed the effort changes with its limit
    start = slow[:, 0], slow[:, 2] + turn * slow[:, 1], slow[:, 5] + turn * (2.0 * slow[:, 4] + turn * slow[:, 3])
    end = fast[:, 0], fast[:, 2] + turn * fast[:, 1], fast[:, 5] + turn * (2.0 * fast[:, 4] + turn * fast[:, 3])
    across = estimated_sag(start, end, width + 0.0 * turn)
    return along + np.maximum(across[:-1], across[1:])


@njit(cache=True, error_model="numpy")
def _cut_off(points: FloatArray, j: int, k: int) -> float:
    """Return the greatest sag of a map's loss that is cut off at zero at a corner: the highest corner's loss."""
    lowest, highest = math.inf, 0.0
    for q in range(2):
        for r in range(2):
            p = points[j + q, k + r]
            lowest, highest = min(lowest, p[6] - LEAST_LOSS * abs(p[0])), max(highest, p[6])
    return highest if lowest <= 0.0 else 0.0


@njit(cache=True, error_model="numpy")
def _return_to_line(energy: FloatArray, course: CourseData) -> None:
    """Turn the energy of a braking drive into that of the line, in place: max(e, r e), see `chain_proof.table`."""
    factor = course.recuperation_factor
    rows = energy.shape[0]
    if has_standstill_brake(course.drive_kind, course.drive_parameters):
        # what it would draw another brake does without power: a concave function, above its chords
        for j in range(rows):
            for k in range(energy.shape[1]):
                energy[j, k] = min(factor * energy[j, k], 0.0)
        return
    kinks = np.zeros(energy.shape)
    for j in range(rows - 1):
        for k in range(energy.shape[1] - 1):
            high = max(energy[j, k], energy[j, k + 1], energy[j + 1, k], energy[j + 1, k + 1])
            deep = -min(energy[j, k], energy[j, k + 1], energy[j + 1, k], energy[j + 1, k + 1])
            if high > 0.0 and deep > 0.0:
                kink = (1.0 - factor) * high * deep / (high + deep)
                for q in range(2):
                    for r in range(2):
                        kinks[j + q, k + r] = max(kinks[j + q, k + r], kink)
    for j in range(rows):
        for k in range(energy.shape[1]):
            energy[j, k] = max(energy[j, k], factor * energy[j, k]) - kinks[j, k]


@njit(cache=True, error_model="numpy", nogil=True)
def fill_least(
    energy: FloatArray, most: FloatArray, share: FloatArray, price: FloatArray, friction: float, least: FloatArray
) -> None:
    """Fill h at the rows for each price: the least of coasting, driving and braking; arguments as in `DriveRows`."""
    hull = np.empty(energy.shape[2], dtype=np.int64)
    for j in range(energy.shape[1]):
        least[:, j] = 0.0
        for mode in range(2):
            e = energy[mode, j]
            columns = hull[: _lower_hull(e, share, hull)]
            costs, efforts = e[columns], most[mode, j] * share[columns]
            # an effort of the hull is the best one between the slopes on its two sides; braking is worth the opposite
            worth = price if mode == 0 else -price
            slopes = (costs[1:] - costs[:-1]) / (efforts[1:] - efforts[:-1])
            place = np.searchsorted(slopes, worth)
            least[:, j] = np.minimum(least[:, j], costs[place] - worth * efforts[place])
        least[:, j] += friction * np.minimum(price, 0.0)


@njit(cache=True, error_model="numpy")
def _lower_hull(e: FloatArray, share: FloatArray, hull: IntArray) -> int:
    """Fill the columns of the lower convex hull of a row, and return how many there are."""
    count = 0
    for k in range(e.shape[0]):
        while count >= 2:
            a, b = hull[count - 2], hull[count - 1]
            if (e[b] - e[a]) * (share[k] - share[a]) < (e[k] - e[a]) * (share[b] - share[a]):
                break
            count -= 1
        hull[count] = k
        count += 1
    return count


@njit(cache=True, error_model="numpy")
def bracket(rows: DriveRows, price: float) -> tuple[int, float]:
    """Return the number of the grid's price below a price, and the share of the way from there to the next."""
    g = min(max(int(np.searchsorted(rows.price, price)) - 1, 0), rows.price.shape[0] - 2)
    share = (price - rows.price[g]) / (rows.price[g + 1] - rows.price[g])
    return g, min(max(share, 0.0), 1.0)
