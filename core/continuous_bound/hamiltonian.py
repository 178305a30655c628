"""The least of the Hamiltonian over all speeds and efforts at one place, rigorous between the rows of its table.

At a place with line force G and limit of speed v_m, with the price of force y of `pieces`,

    H(v) = h(y, v) + y (A + G + B v + S(v)) + lambda / v + q v^2,      q = y C + p',

with h of `drive_rows` and the starting resistance S, which is linear between its rows. Between two rows h lies above
its linear interpolant, and what is added is a function of v only: its second derivative is 2 lambda / v^3 + 2 q. If
that is positive, a strip's least lies between its ends: the tangent at a point close to it is a bound. Otherwise the
ends decide. Near rest the price of time outweighs all.
"""

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.continuous_bound.drive_rows import DriveRows, PlaceRows, bracket, rows_at
from railjoule.core.continuous_bound.prices import Pieces
from railjoule.core.physics.mesh_data import MeshData

NEWTON_STEPS = 3
"""Steps towards the least of a convex strip: what they leave is subtracted."""


@njit(cache=True, error_model="numpy")
def min_hamiltonian(
    rows: DriveRows,
    bend: FloatArray,
    price: float,
    by_speed2: float,
    constant: float,
    linear: float,
    limit: float,
    price_of_time: float,
    powered: bool,
) -> float:
    """Return at most the least Hamiltonian [J/m].

    Parameters
    ----------
    rows : DriveRows
        The table of the drive.
    bend : array of shape (3, m)
        Of each row: 1 / v, and what a strip that ends there may sag by lambda and by q, see `strip_bends`.
    price : float
        Price of force y.
    by_speed2 : float
        q [J s2/m3].
    constant : float
        A + G [N].
    linear : float
        B [N s/m].
    limit : float
        Greatest speed [m/s].
    price_of_time : float
        lambda, auxiliary power included [W].
    powered : bool
        Whether the drive has power; else there are only friction brakes.
    """
    speed = rows.speed_ms
    g, share = bracket(rows.price, price)
    count = min(max(np.searchsorted(speed, limit), 1), speed.shape[0] - 1)
    level = price * constant
    beyond = price - min(max(price, rows.price[0]), rows.price[-1])
    terms = price, beyond, by_speed2, level, linear, price_of_time
    worth, first = _slowest_row(rows, share, g, count, powered, terms)
    v = speed[first:count]
    h = (1.0 - share) * rows.least[g, first : count + 1] + share * rows.least[g + 1, first : count + 1]
    if beyond != 0.0:
        h = h - abs(beyond) * (rows.driving_n if beyond > 0.0 else rows.braking_n)[first : count + 1]
    if not powered:
        h = 0.0 * h + rows.friction_n * min(price, 0.0)
    if rows.starting_at_rest_n > 0.0:
        h = h + price * rows.starting_n[first : count + 1]
    total = h[:-1] + (level + price * linear * v) + price_of_time * bend[0, first:count] + by_speed2 * v * v
    # the last strip ends at the limit
    before, width = v[-1], speed[count] - v[-1]
    last_h = h[-2] + (h[-1] - h[-2]) * (limit - before) / width
    last = last_h + level + price * linear * limit + price_of_time / limit + by_speed2 * limit * limit
    falling = min(price * linear, 0.0) * v[0] + min(by_speed2, 0.0) * v[0] * v[0]
    least: float = min(total.min(), last, worth + level + price_of_time * bend[0, first] + falling)
    convex = max(by_speed2, 0.0)
    sag = price_of_time * bend[1, first + 1 : count] + convex * bend[2, first + 1 : count]
    for j in np.flatnonzero(np.minimum(total[:-1], total[1:]) - sag < least):
        slope = (h[j + 1] - h[j]) / (v[j + 1] - v[j]) + price * linear
        ends = v[j], v[j + 1], total[j], total[j + 1]
        least = min(least, _min_of_strip(ends, slope, by_speed2, price_of_time))
    if limit > before:
        slope = (last_h - h[-2]) / (limit - before) + price * linear
        ends = before, limit, total[-1], last
        least = min(least, _min_of_strip(ends, slope, by_speed2, price_of_time))
    return least


@njit(cache=True, error_model="numpy")
def _slowest_row(
    rows: DriveRows,
    share: float,
    g: int,
    count: int,
    powered: bool,
    terms: tuple[float, float, float, float, float, float],
) -> tuple[float, int]:
    """Return the greatest worth of any effort near rest, negative [J/m], and the first row that has to be asked.

    Below it the price of time outweighs that: H is more than at a row somewhere in the middle.
    """
    price, beyond, by_speed2, level, linear, price_of_time = terms
    driving, braking, taken, returned = rows.at_rest
    braked = rows.friction_n * min(price, 0.0)
    worth = braked + (min(0.0, (taken - price) * driving, (price - returned) * braking) if powered else 0.0)
    # where the price of force is negative, the starting resistance is worth something, at most that at rest
    worth += rows.starting_at_rest_n * min(price, 0.0)
    if beyond != 0.0:
        return worth, 0
    known = np.inf
    for tenth in (3, 6, 9):
        j = count * tenth // 10
        v = rows.speed_ms[j]
        h = (1.0 - share) * rows.least[g, j] + share * rows.least[g + 1, j] if powered else braked
        h += price * rows.starting_n[j]
        if j < count:
            known = min(known, h + level + price * linear * v + price_of_time / v + by_speed2 * v * v)
    room = known - worth - level
    if not room > 0.0:
        return worth, 0
    first = min(max(int(np.searchsorted(rows.speed_ms, price_of_time / room)) - 1, 0), count - 1)
    while first > 0:
        v = rows.speed_ms[first]
        if worth + level + price_of_time / v + min(by_speed2, 0.0) * v * v >= known:
            break
        first -= 1
    return worth, first


@njit(cache=True, error_model="numpy")
def _min_of_strip(
    ends: tuple[float, float, float, float], slope: float, by_speed2: float, price_of_time: float
) -> float:
    """Return at most the least of slope v + lambda / v + q v^2 + constant between two speeds with known values."""
    v1, v2, first, last = ends
    by_time = price_of_time
    start = slope - by_time / (v1 * v1) + 2.0 * by_speed2 * v1
    end = slope - by_time / (v2 * v2) + 2.0 * by_speed2 * v2
    if 2.0 * by_time / (v2 * v2 * v2) + 2.0 * by_speed2 < 0.0:
        # not convex in all of the strip: concave up to a part that lambda bends
        width = v2 - v1
        return min(first, last) - 0.25 * by_time / (v1 * v1 * v1) * width * width
    if start >= 0.0:
        return first
    if end <= 0.0:
        return last
    v = v1 + (v2 - v1) * start / (start - end)
    for _ in range(NEWTON_STEPS):
        derivative = slope - by_time / (v * v) + 2.0 * by_speed2 * v
        v = min(max(v - derivative / (2.0 * by_time / (v * v * v) + 2.0 * by_speed2), v1), v2)
    derivative = slope - by_time / (v * v) + 2.0 * by_speed2 * v
    step = v - v1
    value = first + slope * step + by_time * (1.0 / v - 1.0 / v1) + by_speed2 * (v * v - v1 * v1)
    return value - abs(derivative) * (v2 - v1)


@njit(cache=True, error_model="numpy")
def strip_bends(speed: FloatArray) -> FloatArray:
    """Return 1 / v of each row, and the sag of the strip that ends there by 1 / v and by v^2; shape (3, m)."""
    bend = np.zeros((3, speed.shape[0]))
    bend[0] = 1.0 / speed
    width = speed[1:] - speed[:-1]
    # an eighth of the second derivative times the square of the width
    bend[1, 1:] = 0.25 * width * width * bend[0, :-1] ** 3
    bend[2, 1:] = 0.25 * width * width
    return bend


@njit(cache=True, error_model="numpy", nogil=True)
def piece_values(
    mesh: MeshData, rows: PlaceRows, pieces: Pieces, limit_ms: FloatArray, price_of_time: float
) -> FloatArray:
    """Return at most the least Hamiltonians at both ends of pieces [J/m]; shape (2, k).

    Parameters
    ----------
    mesh : MeshData
    rows : PlaceRows
        The tables of the drive.
    pieces : Pieces
        The prices.
    limit_ms : array of shape (k,)
        Greatest speed in each piece [m/s].
    price_of_time : float
        Price of a second, auxiliary power included [W].
    """
    bend, half_inertia, values = strip_bends(rows.speed_ms), mesh.half_inertia_kg, np.empty_like(pieces.motion)
    for i in range(values.shape[1]):
        cell, length = pieces.cell[i], pieces.position_m[i + 1] - pieces.position_m[i]
        table = rows_at(rows, mesh.place[cell])
        slope = -half_inertia * (pieces.motion[1, i] - pieces.motion[0, i]) / length
        for side in range(2):
            motion, force = pieces.motion[side, i], pieces.force[side, i]
            value = min_hamiltonian(
                table,
                bend,
                force,
                force * mesh.resistance_quadratic[cell] + slope + pieces.curve[side, i],
                mesh.resistance_constant_n + mesh.line_force_n[cell],
                mesh.resistance_linear,
                limit_ms[i],
                price_of_time,
                mesh.supply_share[cell] >= 1.0,
            )
            # beyond the price of force, K w' is held only by its limits
            more = motion - force
            if more != 0.0:
                limit = mesh.max_acceleration_ms2 if more > 0.0 else mesh.max_deceleration_ms2
                value -= 2.0 * half_inertia * abs(more) * limit
            values[side, i] = value
    return values
