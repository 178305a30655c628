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

from railjoule.core.arrays import FloatArray
from railjoule.core.chain_proof.table import BRAKING, DRIVING, lowered_energy
from railjoule.core.compiled import njit
from railjoule.core.drive.kernels import has_standstill_brake, work_bounds
from railjoule.core.drive.kinds import CONSTANT_EFFICIENCY
from railjoule.core.interior_point.envelope import lower_hull
from railjoule.core.physics.effort_limit import EffortLimit, max_effort, upper_line
from railjoule.core.physics.mesh_data import MeshData, at_place
from railjoule.core.physics.place_limits import NO_PLACE
from railjoule.core.physics.resistance import starting_resistance

SPEEDS, LOSSLESS_SPEEDS = 240, 160
"""Row j of so many lies at the share (j / SPEEDS)^3 of the greatest speed. The second number is for a drive of constant
efficiency, whose energy per metre does not sag between rows."""
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
MAX_KEPT = 8
"""So many tables are kept, of 2 MB each."""
PRICE_STEPS = ((0.17, 0.0025, 1.0), (3.0, 0.0, 1.015), (100.0, 0.0, 1.03), (1e8, 0.0, 1.1))
"""Up to a distance from 1 the distances of prices grow by a step, or by a ratio: a partial effort costs about 1."""
CLOSE = 1.0
"""Up to this distance there are as many around the recuperation factor, which is what braking in part is worth."""


class DriveRows(NamedTuple):
    """The table of one drive under the limits of one kind of place.

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
    friction_n, recuperation_factor : float
        Largest effort of the friction brakes [N], and share of the generated energy that the supply takes back.
    starting_n : array of shape (m,)
        Starting resistance of the train [N]; it is linear between rows.
    starting_at_rest_n : float
        The same at rest [N].
    """

    speed_ms: FloatArray
    price: FloatArray
    least: FloatArray
    driving_n: FloatArray
    braking_n: FloatArray
    at_rest: FloatArray
    friction_n: float
    recuperation_factor: float
    starting_n: FloatArray
    starting_at_rest_n: float


class PlaceRows(NamedTuple):
    """The tables of all kinds of places of a line, over the same rows and prices; the last is that of NO_PLACE.

    Parameters
    ----------
    speed_ms, price
        As in `DriveRows`.
    least, driving_n, braking_n, at_rest : arrays of shape (p, k, m), (p, m), (p, m) and (p, 4)
        The same at each kind of place.
    friction_n, recuperation_factor : array of shape (p,)
        The same.
    starting_n, starting_at_rest_n : arrays of shape (p, m) and (p,)
        The same; equal at all places.
    """

    speed_ms: FloatArray
    price: FloatArray
    least: FloatArray
    driving_n: FloatArray
    braking_n: FloatArray
    at_rest: FloatArray
    friction_n: FloatArray
    recuperation_factor: FloatArray
    starting_n: FloatArray
    starting_at_rest_n: FloatArray


@njit(cache=True)
def rows_at(rows: PlaceRows, place: int) -> DriveRows:
    """Return the table of one kind of place."""
    return DriveRows(
        rows.speed_ms,
        rows.price,
        rows.least[place],
        rows.driving_n[place],
        rows.braking_n[place],
        rows.at_rest[place],
        rows.friction_n[place],
        rows.recuperation_factor[place],
        rows.starting_n[place],
        rows.starting_at_rest_n[place],
    )


_KEPT: dict[Hashable, PlaceRows] = {}
_LOCK = threading.Lock()


def drive_rows(mesh: MeshData, fastest_ms: float) -> PlaceRows:
    """Return the tables of a meshed line's drive up to a speed [m/s]; kept for the next call with the same drive."""
    key = (
        mesh.drive_kind,
        mesh.drive_parameters.tobytes(),
        *((limit.constant_n, limit.power_w, limit.table.tobytes()) for limit in (mesh.traction, mesh.braking)),
        mesh.recuperation_factor,
        mesh.friction_effort_n,
        *(array.tobytes() for array in mesh.places),
        mesh.starting_n,
        mesh.starting_ends_ms,
        fastest_ms,
    )
    with _LOCK:
        # the latest stands last
        rows = _KEPT.pop(key) if key in _KEPT else _make_rows(mesh, fastest_ms)
        _KEPT[key] = rows
        while len(_KEPT) > MAX_KEPT:
            del _KEPT[next(iter(_KEPT))]
    return rows


def _make_rows(mesh: MeshData, fastest_ms: float) -> PlaceRows:
    # the last one is also found by the number of NO_PLACE
    meshes = [at_place(mesh, place) for place in (*range(len(mesh.places.friction_n)), NO_PLACE)]
    is_lossless = mesh.drive_kind == CONSTANT_EFFICIENCY
    speed = _row_speeds(fastest_ms, LOSSLESS_SPEEDS if is_lossless else SPEEDS)
    if mesh.starting_n > 0.0 and speed[0] < mesh.starting_ends_ms < speed[-1]:
        # its corner: between rows it is linear
        speed = np.union1d(speed, mesh.starting_ends_ms)
    for one in meshes:
        for limit in (one.traction, one.braking):
            speed = _halve_loose_strips(limit, speed)
    bounds = work_bounds(mesh.drive_kind, mesh.drive_parameters)
    price = np.unique(np.concatenate([_price_grid(one, bounds) for one in meshes]))
    effort_share = ALL_OR_NOTHING if is_lossless else EFFORT_SHARES
    rows = [_rows_of_place(one, speed, price, effort_share, bounds) for one in meshes]
    return PlaceRows(speed, price, *(np.array(column) for column in list(zip(*rows, strict=True))[2:]))


def _rows_of_place(
    mesh: MeshData, speed: FloatArray, price: FloatArray, effort_share: FloatArray, bounds: tuple[float, float]
) -> DriveRows:
    """Return the table of a drive over given rows of speed [m/s], prices and shares of the largest effort."""
    most = np.array([_upper_efforts(limit, speed) for limit in (mesh.traction, mesh.braking)])
    energy = fill_energies(mesh, speed, most, effort_share)
    # A machine cannot reach some efforts of the lines above its limits, so their power is NaN. The least that the drive
    # needs per work at the wheels is a lower bound there, too.
    effort = most[:, :, np.newaxis] * effort_share
    per_work = np.array([bounds[0], -bounds[1] * mesh.recuperation_factor]).reshape(2, 1, 1)
    energy = np.where(np.isnan(energy), per_work * effort, energy)
    least, friction = np.empty((len(price), len(speed))), mesh.friction_effort_n
    fill_least(energy, most, effort_share, price, friction, least)
    at_rest = np.array([mesh.traction.constant_n, mesh.braking.constant_n, *bounds])
    return DriveRows(
        speed,
        price,
        least,
        most[0],
        most[1] + friction,
        at_rest,
        friction,
        mesh.recuperation_factor,
        starting_resistance(mesh.starting_n, mesh.starting_ends_ms, speed),
        mesh.starting_n,
    )


def _row_speeds(fastest_ms: float, count: int) -> FloatArray:
    """Return rows of speed before corners are added [m/s]; shape (m,)."""
    first = math.ceil(1.0 / (GREATEST_RATIO ** (1.0 / 3.0) - 1.0))
    fast = fastest_ms * (np.arange(first, count + 1) / count) ** 3
    steps = math.ceil(math.log(fast[0] / SLOWEST_MS) / math.log(GREATEST_RATIO))
    slow: FloatArray = np.geomspace(SLOWEST_MS, fast[0], steps, endpoint=False)
    return np.append(slow, fast)


def _price_grid(mesh: MeshData, bounds: tuple[float, float]) -> FloatArray:
    """Return the prices at which h is known: those at which a drive without losses of its own begins to pay, too."""
    away = [0.0]
    for end, step, ratio in PRICE_STEPS:
        while away[-1] < end:
            away.append(away[-1] * ratio + step)
    distance = np.array(away)
    returned = mesh.recuperation_factor * distance[distance < CLOSE]
    grids = [
        1.0 - distance,
        1.0 + distance,
        mesh.recuperation_factor - returned,
        mesh.recuperation_factor + returned,
    ]
    kinks = [0.0, bounds[0], bounds[1] * mesh.recuperation_factor]
    return np.unique(np.concatenate([*grids, kinks]))


def _halve_loose_strips(limit: EffortLimit, speed: FloatArray) -> FloatArray:
    """Return rows of speed [m/s] between which a line lies close above a limit."""
    added: list[float] = []
    open_strips = list(zip(np.append(0.0, speed[:-1]).tolist(), speed.tolist(), strict=True))[1:]
    while open_strips:
        v1, v2 = open_strips.pop()
        constant, slope = upper_line(limit, v1, v2)
        excess = max(constant + slope * v - max_effort(limit, v) for v in (v1, v2))
        if excess > LIMIT_EXCESS * limit.constant_n and v2 - v1 > NARROWEST_MS:
            middle = 0.5 * (v1 + v2)
            added.append(middle)
            open_strips += [(v1, middle), (middle, v2)]
    return np.union1d(speed, added)


def _upper_efforts(limit: EffortLimit, speed: FloatArray) -> FloatArray:
    """Return efforts at the rows [N] whose linear interpolant lies at or above a limit; shape (m,)."""
    most = np.full(len(speed), max_effort(limit, float(speed[0])))
    for j in range(len(speed) - 1):
        constant, slope = upper_line(limit, float(speed[j]), float(speed[j + 1]))
        most[j] = max(most[j], constant + slope * speed[j])
        most[j + 1] = max(max_effort(limit, float(speed[j + 1])), constant + slope * speed[j + 1])
    return most


@njit(cache=True, error_model="numpy", nogil=True)
def fill_energies(mesh: MeshData, speed: FloatArray, most: FloatArray, share: FloatArray) -> FloatArray:
    """Return the energy from the supply per metre by share of effort [J/m], lowered by the sag; shape (2, m, k).

    Parameters
    ----------
    mesh : MeshData
        Whose drive is asked.
    speed : array of shape (m,)
        Rows [m/s].
    most : array of shape (2, m)
        Efforts of the share 1, driving and braking [N].
    share : array of shape (k,)
        Shares of these, rising from 0 to 1.
    """
    rows, columns = speed.shape[0], share.shape[0]
    energy, last, reach = np.empty((2, rows, columns)), np.full(rows, columns - 1), np.full(rows - 1, columns - 1)
    for mode in (DRIVING, BRAKING):
        energy[mode] = lowered_energy(mesh, mode, speed, most[mode], share, last, reach)
    if has_standstill_brake(mesh.drive_kind, mesh.drive_parameters):
        # what it would draw another brake does without power: a concave function, above its chords
        energy[BRAKING] = np.minimum(energy[BRAKING], 0.0)
    return energy


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
            columns = hull[: lower_hull(share, e, e.shape[0], hull)]
            costs, efforts = e[columns], most[mode, j] * share[columns]
            # an effort of the hull is the best one between the slopes on its two sides; braking is worth the opposite
            worth = price if mode == 0 else -price
            slopes = (costs[1:] - costs[:-1]) / (efforts[1:] - efforts[:-1])
            place = np.searchsorted(slopes, worth)
            least[:, j] = np.minimum(least[:, j], costs[place] - worth * efforts[place])
        least[:, j] += friction * np.minimum(price, 0.0)


@njit(cache=True, error_model="numpy")
def bracket(grid: FloatArray, price: float) -> tuple[int, float]:
    """Return the number of the grid's price below a price, and the share of the way from there to the next."""
    g = min(max(int(np.searchsorted(grid, price)) - 1, 0), grid.shape[0] - 2)
    share = (price - grid[g]) / (grid[g + 1] - grid[g])
    return g, min(max(share, 0.0), 1.0)
