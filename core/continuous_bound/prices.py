"""The price of force along a line, piece by piece, from the multipliers of an optimum over a mesh.

The price y [without unit] of a change of K w, K half the inertia and w the square of speed, is the costate -p / K of
the continuous problem. A multiplier is its value at the middle of a cell; to the nodes it goes on with its own slope,

    K y' = dH/dw = 1 / (2 v) (dh/dv + y (B + 2 C v) - lambda / v^2),

h from `drive_rows`. Where both neighbours meet, a mean is taken; where a limit of speed binds at a node, y may rise
there at once. Where a limit is held over a cell, y is constant. Next to rest it diverges like 1 / v: there it is
traced along the run, over pieces whose lengths grow geometrically. Any prices prove a bound, these a tight one.

What a limit of acceleration is worth is part of the price of K w', not of that of force.
"""

from typing import NamedTuple

import numpy as np

from railjoule.core.arrays import BoolArray, FloatArray, IntArray
from railjoule.core.compiled import njit
from railjoule.core.continuous_bound.drive_rows import DriveRows
from railjoule.core.drive.kinds import CONSTANT_EFFICIENCY
from railjoule.core.interior_point.layout import ACCELERATION, DECELERATION
from railjoule.core.interior_point.solver import Optimum
from railjoule.core.physics.course_data import CourseData

NEAR_M, NEAREST_M = 25.0, 1e-6
"""Within the first of these of a place of rest y is traced, down to the second [m]."""
GROWTH, MOST_GROWTH = 0.05, 0.15
"""A piece at the distance d of rest is longer than the next nearer one by GROWTH (NEAR_M / d)^(1/4), up to the most."""
AT_LIMIT = 1e-5
"""Within this share of a limit a train keeps it."""
MARGINAL = 2e-2
"""A price this close to what a partial effort costs is that cost."""
PARTIAL = 1e-4
"""An effort is partial where it is this share away from none and from the largest."""


class Pieces(NamedTuple):
    """A line cut into pieces with a linear price.

    Parameters
    ----------
    position_m : array of shape (k + 1,)
        Their ends [m], rising.
    cell : array of shape (k,)
        The cell of the mesh that a piece lies in.
    motion : array of shape (2, k)
        Price of K w' at the start and at the end of each.
    force : array of shape (2, k)
        Price of force there.
    may_jump : array of shape (k + 1,)
        Whether the price may jump at an end that two pieces share.
    """

    position_m: FloatArray
    cell: IntArray
    motion: FloatArray
    force: FloatArray
    may_jump: BoolArray


def price_pieces(course: CourseData, optimum: Optimum, rows: DriveRows, price_of_time: float) -> Pieces:
    """Return the pieces of a course with the prices that the multipliers of an optimum give.

    Parameters
    ----------
    course : CourseData
        Over the optimum's mesh.
    optimum : Optimum
        Its point and multipliers.
    rows : DriveRows
        The table of the drive.
    price_of_time : float
        Price of a second, auxiliary power included [W].
    """
    length = course.cell_length_m
    node = np.append(0.0, np.cumsum(length))
    middle = 0.5 * (node[1:] + node[:-1])
    at_rest = course.fixed_speed2 == 0.0
    position = _positions(node, middle, node[at_rest])
    cell = np.clip(np.searchsorted(node, 0.5 * (position[1:] + position[:-1]), side="right") - 1, 0, len(length) - 1)
    motion, held_motion = _prices_of_cells(course, optimum)
    motion = _marginal_prices(course, optimum, motion)
    prices = np.empty((2, len(cell)))
    fill_prices(course, rows, optimum.speed2, node, position, cell, motion, held_motion, at_rest, price_of_time, prices)
    places = np.searchsorted(position, node - 1e-9)
    may_jump = np.zeros(len(position), dtype=bool)
    may_jump[places] = at_rest | (course.fixed_speed2 >= 0) | (optimum.speed2 >= course.largest_speed2 * (1 - AT_LIMIT))
    return Pieces(position, cell, prices, prices - held_motion[cell], may_jump)


def _positions(node: FloatArray, middle: FloatArray, rest_m: FloatArray) -> FloatArray:
    """Return where pieces end: nodes, middles, and near each place of rest a geometric row [m]."""
    away = [NEAR_M]
    while away[-1] > NEAREST_M:
        away.append(max(away[-1] / (1.0 + min(MOST_GROWTH, GROWTH * (NEAR_M / away[-1]) ** 0.25)), NEAREST_M))
    near = np.add.outer(rest_m, np.concatenate([away, -np.asarray(away)])).ravel()
    places = np.unique(np.concatenate([node, middle, near[(near > 0.0) & (near < node[-1])]]))
    # a place that all but falls on a node gives way to it
    apart = np.append(True, np.diff(places) > 1e-8)
    return places[apart | np.isin(places, node)]


def _prices_of_cells(course: CourseData, optimum: Optimum) -> tuple[FloatArray, FloatArray]:
    """Return the price of K w' in each cell, and which part of it limits of acceleration hold."""
    held = (optimum.multiplier[ACCELERATION] - optimum.multiplier[DECELERATION]) / course.cell_length_m
    return optimum.force_price / course.cell_length_m + held, held


def _marginal_prices(course: CourseData, optimum: Optimum, motion: FloatArray) -> FloatArray:
    """Return prices that are what a partial effort costs, where a drive of constant efficiency has one."""
    if course.drive_kind != CONSTANT_EFFICIENCY:
        return motion
    speed = np.sqrt(optimum.speed2)
    mean = np.maximum(0.5 * (speed[1:] + speed[:-1]), 1e-3)
    efficiency, generating = course.drive_parameters[:2]
    snapped = motion.copy()
    for effort, limit, cost in (
        (optimum.traction_n, course.traction, 1.0 / efficiency),
        (optimum.braking_n, course.braking, generating * course.recuperation_factor),
    ):
        share = effort / limit.effort_n(mean)
        partial = (share > PARTIAL) & (share < 1.0 - PARTIAL) & (np.abs(motion - cost) < MARGINAL)
        snapped[partial] = cost
    return snapped


@njit(cache=True, error_model="numpy", nogil=True)
def fill_prices(
    course: CourseData,
    rows: DriveRows,
    speed2: FloatArray,
    node: FloatArray,
    position: FloatArray,
    cell: IntArray,
    motion: FloatArray,
    held: FloatArray,
    at_rest: BoolArray,
    price_of_time: float,
    prices: FloatArray,
) -> None:
    """Fill the price of K w' at both ends of each piece, shape (2, k); arguments as in `price_pieces`."""
    n = motion.shape[0]
    at_limit = speed2 >= course.largest_speed2 * (1.0 - AT_LIMIT)
    # from the middle of each cell to its ends
    for i in range(n):
        level = at_limit[i] and at_limit[i + 1]
        first = int(np.searchsorted(cell, i))
        last = int(np.searchsorted(cell, i + 1)) - 1
        centre = 0.5 * (node[i] + node[i + 1])
        start = min(max(int(np.searchsorted(position, centre - 1e-9)), first), last + 1)
        y = motion[i]
        for piece in range(start, last + 1):
            prices[0, piece] = y
            y = y if level else _traced(course, rows, speed2, node, i, position, piece, 1.0, y, held[i], price_of_time)
            prices[1, piece] = y
        y = motion[i]
        for piece in range(start - 1, first - 1, -1):
            prices[1, piece] = y
            y = y if level else _traced(course, rows, speed2, node, i, position, piece, -1.0, y, held[i], price_of_time)
            prices[0, piece] = y
    # where neighbours meet
    for i in range(1, n):
        if at_rest[i] or course.fixed_speed2[i] >= 0.0:
            continue
        piece = np.searchsorted(cell, i)
        before, after = prices[1, piece - 1], prices[0, piece]
        if at_limit[i] and after > before:
            continue
        # the longer cell takes the greater part of the difference, or the shorter one's slope would be all of it
        share = (node[i] - node[i - 1]) / (node[i + 1] - node[i - 1])
        prices[1, piece - 1] = prices[0, piece] = before + share * (after - before)
    # next to rest, from afar
    for i in range(n + 1):
        if not at_rest[i]:
            continue
        place = np.searchsorted(position, node[i] - 1e-9)
        for side in (1, -1):
            reach = place
            while 0 <= reach + side < position.shape[0] and abs(position[reach + side] - position[place]) <= NEAR_M:
                reach += side
                nearest = np.searchsorted(node, position[reach] - 1e-9)
                if nearest != i and nearest <= n and abs(node[nearest] - position[reach]) < 1e-9 and at_rest[nearest]:
                    break
            # half of the way to another place of rest
            y = 0.0
            started = False
            at = reach
            while at != place:
                piece = at - 1 if side == 1 else at
                if not started:
                    y = prices[1, piece] if side == 1 else prices[0, piece]
                    started = True
                k = cell[piece]
                if side == 1:
                    prices[1, piece] = y
                else:
                    prices[0, piece] = y
                y = _traced(course, rows, speed2, node, k, position, piece, -float(side), y, held[k], price_of_time)
                if side == 1:
                    prices[0, piece] = y
                else:
                    prices[1, piece] = y
                at -= side


@njit(cache=True, error_model="numpy")
def _traced(
    course: CourseData,
    rows: DriveRows,
    speed2: FloatArray,
    node: FloatArray,
    i: int,
    position: FloatArray,
    piece: int,
    direction: float,
    price: float,
    held: float,
    price_of_time: float,
) -> float:
    """Return the price at the other end of a piece in cell i, by the midpoint rule."""
    length = position[piece + 1] - position[piece]
    width = node[i + 1] - node[i]
    share1, share2 = (position[piece] - node[i]) / width, (position[piece + 1] - node[i]) / width
    w1 = max(speed2[i] + (speed2[i + 1] - speed2[i]) * share1, 0.0)
    w2 = max(speed2[i] + (speed2[i + 1] - speed2[i]) * share2, 0.0)
    if w1 <= 0.0 or w2 <= 0.0:
        # the last piece at rest: its end has no finite price
        return price
    v = np.sqrt(np.sqrt(w1 * w2))
    slope = _slope(course, rows, i, price - held, v, price_of_time)
    half = price + 0.5 * direction * length * slope
    end: float = price + direction * length * _slope(course, rows, i, half - held, v, price_of_time)
    return end


@njit(cache=True, error_model="numpy")
def _slope(course: CourseData, rows: DriveRows, i: int, price: float, speed: float, price_of_time: float) -> float:
    """Return the slope of the price of K w' in a cell at a speed [1/m]."""
    j = min(max(np.searchsorted(rows.speed_ms, speed) - 1, 0), rows.speed_ms.shape[0] - 2)
    g = min(max(np.searchsorted(rows.price, price) - 1, 0), rows.price.shape[0] - 2)
    share = min(max((price - rows.price[g]) / (rows.price[g + 1] - rows.price[g]), 0.0), 1.0)
    low = (1.0 - share) * rows.least[g, j] + share * rows.least[g + 1, j]
    high = (1.0 - share) * rows.least[g, j + 1] + share * rows.least[g + 1, j + 1]
    by_speed = (high - low) / (rows.speed_ms[j + 1] - rows.speed_ms[j])
    resisted = price * (course.resistance_linear + 2.0 * course.resistance_quadratic[i] * speed)
    slope: float = (by_speed + resisted - price_of_time / (speed * speed)) / (2.0 * speed * course.half_inertia_kg)
    return slope
