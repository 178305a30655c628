"""The price of force along a line, piece by piece, from the multipliers of an optimum over a mesh.

The price y [without unit] of a change of K w, K half the inertia and w the square of speed, is the costate -p / K of
the continuous problem. A multiplier is its value at the middle of a cell; to the nodes it goes on with its own slope,

    K y' = dH/dw = 1 / (2 v) (dh/dv + y (B + 2 C v) - lambda / v^2),

h from `drive_rows`. The prices of two neighbours meet at their node in a mean, unless a limit of speed binds there:
then y may rise in a step. It is constant over a cell in which the run keeps a limit. Next to rest it diverges like
1 / v, so that it is traced along the run, over pieces whose lengths grow geometrically. Any prices prove a bound, these
a tight one.

The worth of a limit of acceleration is part of the price of K w', not of that of force. The price of a braking curve
makes the speed of the curve the one at which H is least.
"""

from typing import NamedTuple

import numpy as np

from railjoule.core.arrays import BoolArray, FloatArray, IntArray, midpoints
from railjoule.core.compiled import njit
from railjoule.core.continuous_bound.drive_rows import PlaceRows, bracket
from railjoule.core.drive.kinds import CONSTANT_EFFICIENCY
from railjoule.core.interior_point.layout import ACCELERATION, DECELERATION
from railjoule.core.interior_point.solver import Optimum
from railjoule.core.motion.meshed_line import MeshedLine
from railjoule.core.motion.permitted_speed import curve_at
from railjoule.core.physics.mesh_data import MeshData, electric_limit_n, recuperation_factors, tractive_limit_n

NEAR_M, NEAREST_M = 25.0, 1e-6
"""Within the first of these of a place of rest y is traced, down to the second [m]."""
GROWTH, MAX_GROWTH = 0.05, 0.15
"""A piece at the distance d of rest is longer than the next nearer one by GROWTH (NEAR_M / d)^(1/4), up to the most."""
SAME_PLACE_M = 1e-9
"""Rounding of places [m]."""
AT_LIMIT = 1e-5
"""Within this share of a limit a train keeps it."""
MARGINAL = 2e-2
"""A price this close to what a partial effort costs is that cost."""
MIN_HELD = 1e-6
"""Multipliers of limits of acceleration below this count as none."""
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
    curve : array of shape (2, k)
        Price there of the square of speed above a braking curve [J s2/m3]; 0 where the run keeps none.
    ceiling2 : array of shape (2, k)
        Squares of speed there that no run exceeds on the line between them [m2/s2].
    """

    position_m: FloatArray
    cell: IntArray
    motion: FloatArray
    force: FloatArray
    curve: FloatArray
    ceiling2: FloatArray


class Trace(NamedTuple):
    """A run and its line in pieces, along which prices are traced.

    Parameters
    ----------
    mesh : MeshData
        Of n cells.
    rows : PlaceRows
        The tables of the drive.
    speed2, node_m : array of shape (n + 1,)
        Squares of speed of the run [m2/s2], and the nodes [m].
    position_m, cell
        As in `Pieces`.
    force_price : array of shape (n,)
        Price of force in each cell where a limit of acceleration holds the rest of the price, else NaN.
    keeps_limit, keeps_curve : array of shape (n,)
        Whether the run keeps a limit of speed over all of a cell, and whether that is a braking curve.
    at_rest, at_limit, may_jump : array of shape (n + 1,)
        Whether the train stands at a node, keeps a limit of speed there, or has a given speed.
    price_of_time : float
        Price of a second, auxiliary power included [W].
    """

    mesh: MeshData
    rows: PlaceRows
    speed2: FloatArray
    node_m: FloatArray
    position_m: FloatArray
    cell: IntArray
    force_price: FloatArray
    keeps_limit: BoolArray
    keeps_curve: BoolArray
    at_rest: BoolArray
    at_limit: BoolArray
    may_jump: BoolArray
    price_of_time: float


def price_pieces(mesh: MeshedLine, optimum: Optimum, rows: PlaceRows, price_of_time: float) -> Pieces:
    """Return the pieces of a meshed line with the prices that the multipliers of an optimum give.

    Parameters
    ----------
    mesh : MeshedLine
        Over the optimum's mesh.
    optimum : Optimum
        Its point and multipliers.
    rows : PlaceRows
        The tables of the drive.
    price_of_time : float
        Price of a second, auxiliary power included [W].
    """
    data, speed2 = mesh.data, optimum.speed2
    length = data.cell_length_m
    node = np.append(0.0, np.cumsum(length))
    middle = midpoints(node)
    at_rest, fixed = data.fixed_speed2 == 0.0, data.fixed_speed2 >= 0.0
    at_limit = speed2 >= data.limit_speed2 * (1 - AT_LIMIT)
    has_curve = cells_with_curve(mesh)
    at_end = at_limit[1:] | (has_curve & fixed[1:])
    keeps_limit = at_limit[:-1] & at_end
    position = _positions(node, middle, node[at_rest])
    cell = np.clip(np.searchsorted(node, midpoints(position), side="right") - 1, 0, len(length) - 1)
    motion, force = _prices_of_cells(mesh.data, optimum)
    given = position, cell, force, keeps_limit, keeps_limit & has_curve, at_rest, at_limit, fixed, price_of_time
    trace = Trace(data, rows, speed2, node, *given)
    prices, curve = np.empty((2, len(cell))), np.zeros((2, len(cell)))
    fill_prices(trace, motion, prices)
    ceiling2 = ceilings2(mesh, position, cell)
    fill_curves(trace, prices, ceiling2, curve)
    return Pieces(position, cell, prices, _force_prices(data, prices, force[cell]), curve, ceiling2)


def _force_prices(mesh: MeshData, motion: FloatArray, force: FloatArray) -> FloatArray:
    """Return the prices of force at both ends of pieces: those of K w' but where a limit of acceleration holds them."""
    prices = np.where(np.isnan(force), motion, force)
    # a limit of acceleration that there is not holds nothing
    if np.isinf(mesh.max_deceleration_ms2):
        prices = np.minimum(prices, motion)
    if np.isinf(mesh.max_acceleration_ms2):
        prices = np.maximum(prices, motion)
    return prices


def cells_with_curve(mesh: MeshedLine) -> BoolArray:
    """Return in which cells a braking curve lies below the limit all the way; shape (n,)."""
    if not mesh.curve_steps.shape[1]:
        return np.zeros(mesh.cell_count, dtype=bool)
    lower: BoolArray = mesh.data.limit_speed2[:-1] < mesh.cell_limit_ms**2 * (1 - AT_LIMIT)
    return lower


def ceilings2(mesh: MeshedLine, position_m: FloatArray, cell: IntArray) -> FloatArray:
    """Return squares of speed at both ends of pieces that no run exceeds on the line between them; shape (2, k).

    Within a piece a braking curve may have corners. It is nowhere higher above its chord than a quarter of the length
    times the difference of its steepest and its flattest slope.
    """
    data, limit2 = mesh.data, mesh.cell_limit_ms**2
    if not mesh.curve_steps.shape[1]:
        return np.array([limit2[cell], limit2[cell]])
    node = np.append(0.0, np.cumsum(data.cell_length_m))
    to_end = np.clip(node[cell + 1] - np.array([position_m[:-1], position_m[1:]]), 0.0, data.cell_length_m[cell])
    squares = curve_at(data.cell_length_m, limit2, data.fixed_speed2, mesh.curve_steps, cell, to_end)
    length = np.diff(position_m)
    steps2, deceleration_ms2 = mesh.curve_steps
    first, last = (np.clip(np.searchsorted(steps2, squares[side], side="right") - 1, 0, None) for side in (1, 0))
    is_bent = first < last
    spread = np.zeros(len(cell))
    for piece in np.flatnonzero(is_bent):
        slopes = deceleration_ms2[first[piece] : last[piece] + 1]
        spread[piece] = 2.0 * (slopes.max() - slopes.min())
    # the slope is zero where the limit of the line holds
    meets_limit = (squares[0] >= limit2[cell]) & (squares[1] < limit2[cell])
    spread[meets_limit] = 2.0 * deceleration_ms2.max()
    return np.minimum(squares + 0.25 * length * spread, limit2[cell])


def _positions(node: FloatArray, middle: FloatArray, rest_m: FloatArray) -> FloatArray:
    """Return the ends of the pieces: nodes, middles, and near each place of rest a geometric row [m]."""
    away = [NEAR_M]
    while away[-1] > NEAREST_M:
        away.append(max(away[-1] / (1.0 + min(MAX_GROWTH, GROWTH * (NEAR_M / away[-1]) ** 0.25)), NEAREST_M))
    near = np.add.outer(rest_m, np.concatenate([away, -np.asarray(away)])).ravel()
    places = np.unique(np.concatenate([node, middle, near[(near > 0.0) & (near < node[-1])]]))
    # a place that all but falls on a node gives way to it
    is_distinct = np.append(True, np.diff(places) > 10.0 * SAME_PLACE_M)
    return places[is_distinct | np.isin(places, node)]


def _prices_of_cells(mesh: MeshData, optimum: Optimum) -> tuple[FloatArray, FloatArray]:
    """Return the price of K w' in each cell, and that of force where a limit of acceleration holds the rest of it."""
    held = (optimum.multiplier[ACCELERATION] - optimum.multiplier[DECELERATION]) / mesh.cell_length_m
    force = _marginal_prices(mesh, optimum, optimum.force_price / mesh.cell_length_m)
    return force + held, np.where(np.abs(held) > MIN_HELD, force, np.nan)


def _marginal_prices(mesh: MeshData, optimum: Optimum, price: FloatArray) -> FloatArray:
    """Return prices of force that are what a partial effort costs, where a drive of constant efficiency has one."""
    if mesh.drive_kind != CONSTANT_EFFICIENCY:
        return price
    speed = np.sqrt(optimum.speed2)
    mean = np.maximum(midpoints(speed), 1e-3)
    efficiency, generating = mesh.drive_parameters[:2]
    snapped = price.copy()
    for effort, limit_n, cost in (
        (optimum.traction_n, tractive_limit_n(mesh, mean), np.full(len(mean), 1.0 / efficiency)),
        (optimum.braking_n, electric_limit_n(mesh, mean), generating * recuperation_factors(mesh)),
    ):
        # a curve may end or begin at no effort
        share = effort / np.where(limit_n > 0.0, limit_n, np.inf)
        partial = (share > PARTIAL) & (share < 1.0 - PARTIAL) & (np.abs(price - cost) < MARGINAL)
        snapped[partial] = cost[partial]
    return snapped


@njit(cache=True, error_model="numpy", nogil=True)
def fill_prices(trace: Trace, middle_price: FloatArray, prices: FloatArray) -> None:
    """Fill the price of K w' at both ends of each piece.

    Parameters
    ----------
    trace : Trace
        The run, and the pieces.
    middle_price : array of shape (n,)
        Prices at the middles of the cells.
    prices : array of shape (2, k)
        To be filled.
    """
    _fill_from_middles(trace, middle_price, prices)
    _join_neighbours(trace, prices)
    for node in range(trace.node_m.shape[0]):
        if trace.at_rest[node]:
            _fill_next_to_rest(trace, node, 1, prices)
            _fill_next_to_rest(trace, node, -1, prices)


@njit(cache=True, error_model="numpy")
def _fill_from_middles(trace: Trace, middle_price: FloatArray, prices: FloatArray) -> None:
    """Fill the prices of each cell from its middle to its ends."""
    first = 0
    for i in range(middle_price.shape[0]):
        held_limit = trace.keeps_limit[i]
        centre = 0.5 * (trace.node_m[i] + trace.node_m[i + 1]) - SAME_PLACE_M
        price, piece = middle_price[i], first
        # the pieces before the middle come after those behind it, in the other direction
        while piece < trace.cell.shape[0] and trace.cell[piece] == i and trace.position_m[piece] < centre:
            piece += 1
        start = piece
        while piece < trace.cell.shape[0] and trace.cell[piece] == i:
            prices[0, piece] = price
            price = price if held_limit else _traced(trace, piece, 1.0, price)
            prices[1, piece] = price
            piece += 1
        price, last = middle_price[i], piece
        for before in range(start - 1, first - 1, -1):
            prices[1, before] = price
            price = price if held_limit else _traced(trace, before, -1.0, price)
            prices[0, before] = price
        first = last


@njit(cache=True, error_model="numpy")
def _join_neighbours(trace: Trace, prices: FloatArray) -> None:
    """Make the prices of neighbouring cells meet at their node, unless they may jump there."""
    node = trace.node_m
    for piece in range(1, trace.cell.shape[0]):
        i = trace.cell[piece]
        if trace.cell[piece - 1] == i or trace.may_jump[i]:
            continue
        before, after = prices[1, piece - 1], prices[0, piece]
        if trace.at_limit[i] and after > before:
            continue
        # the longer cell takes the greater part of the difference, or the shorter one's slope would be all of it
        share = (node[i] - node[i - 1]) / (node[i + 1] - node[i - 1])
        prices[1, piece - 1] = prices[0, piece] = before + share * (after - before)


@njit(cache=True, error_model="numpy")
def _fill_next_to_rest(trace: Trace, node: int, side: int, prices: FloatArray) -> None:
    """Fill the prices on one side of a place of rest, 1 behind it and -1 before it, from afar towards it."""
    position = trace.position_m
    rest = int(np.searchsorted(position, trace.node_m[node] - SAME_PLACE_M))
    # half of the way to the next place of rest at most
    other = node + side
    while 0 <= other < trace.node_m.shape[0] - 1 and not trace.at_rest[other]:
        other += side
    reach_m = NEAR_M
    if 0 <= other < trace.node_m.shape[0]:
        reach_m = min(reach_m, 0.5 * abs(trace.node_m[other] - trace.node_m[node]))
    far = rest
    while 0 <= far + side < position.shape[0] and abs(position[far + side] - position[rest]) <= reach_m:
        far += side
    if side == -1 and node > 0 and trace.keeps_curve[node - 1]:
        # there the curve holds the run, not its brakes, and the price stays what it is
        return
    outer, inner = (1, 0) if side == 1 else (0, 1)
    place = far
    price = 0.0
    while place != rest:
        piece = place - 1 if side == 1 else place
        price = prices[outer, piece] if place == far else price
        prices[outer, piece] = price
        price = _traced(trace, piece, -float(side), price)
        prices[inner, piece] = price
        place -= side


@njit(cache=True, error_model="numpy")
def _traced(trace: Trace, piece: int, direction: float, price: float) -> float:
    """Return the price at the other end of a piece, by the midpoint rule."""
    i = trace.cell[piece]
    start, end = trace.position_m[piece], trace.position_m[piece + 1]
    width, rise = trace.node_m[i + 1] - trace.node_m[i], trace.speed2[i + 1] - trace.speed2[i]
    w1 = trace.speed2[i] + rise * (start - trace.node_m[i]) / width
    w2 = trace.speed2[i] + rise * (end - trace.node_m[i]) / width
    if w1 <= 0.0 or w2 <= 0.0:
        # the last piece at rest: its end has no finite price
        return price
    speed, step = np.sqrt(np.sqrt(w1 * w2)), direction * (end - start)
    half = price + 0.5 * step * _slope(trace, i, price, speed)
    after: float = price + step * _slope(trace, i, half, speed)
    return after


@njit(cache=True, error_model="numpy")
def _slope(trace: Trace, i: int, motion_price: float, speed: float) -> float:
    """Return the slope of the price of K w' in a cell at a speed [1/m]."""
    rows, mesh = trace.rows, trace.mesh
    held = trace.force_price[i]
    price = motion_price if np.isnan(held) else held
    j = min(max(int(np.searchsorted(rows.speed_ms, speed)) - 1, 0), rows.speed_ms.shape[0] - 2)
    g, share = bracket(rows.price, price)
    place = mesh.place[i]
    low = (1.0 - share) * rows.least[place, g, j] + share * rows.least[place, g + 1, j]
    high = (1.0 - share) * rows.least[place, g, j + 1] + share * rows.least[place, g + 1, j + 1]
    by_speed = (high - low) / (rows.speed_ms[j + 1] - rows.speed_ms[j])
    if mesh.supply_share[i] < 1.0:
        by_speed = 0.0
    resisted = price * (mesh.resistance_linear + 2.0 * mesh.resistance_quadratic[i] * speed)
    if speed < mesh.starting_ends_ms:
        resisted -= price * mesh.starting_n / mesh.starting_ends_ms
    changed = by_speed + resisted - trace.price_of_time / (speed * speed)
    slope: float = changed / (2.0 * speed * mesh.half_inertia_kg)
    return slope


@njit(cache=True, error_model="numpy", nogil=True)
def fill_curves(trace: Trace, prices: FloatArray, ceiling2: FloatArray, curve: FloatArray) -> None:
    """Fill what braking curves cost at both ends of the pieces where the run keeps one: what makes H least there."""
    for piece in range(trace.cell.shape[0]):
        i = trace.cell[piece]
        if not trace.keeps_curve[i]:
            continue
        length = trace.position_m[piece + 1] - trace.position_m[piece]
        rise = (prices[1, piece] - prices[0, piece]) / length
        for side in range(2):
            if ceiling2[side, piece] > 0.0:
                falls = rise - _slope(trace, i, prices[side, piece], np.sqrt(ceiling2[side, piece]))
                curve[side, piece] = max(trace.mesh.half_inertia_kg * falls, 0.0)
