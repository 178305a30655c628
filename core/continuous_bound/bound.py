"""A lower bound of the energy of every driving of a train, from prices along the line.

For any driving that keeps its limits, with w = v^2 over the place s, half the inertia K and the price p = -K y,

    E + lambda T = integral of [e + lambda / v + (p w)'] ds - [p w] between the ends
                >= sum over pieces of integral of c(s) ds + sum over their ends of min(0, (p+ - p-) w_max) - [p w],
    c(s) = least over v and efforts of H, see `hamiltonian`.

No mesh occurs in it. Within a piece y and p' w are affine in s, and so is H for each speed and effort: their least c is
concave, so that the mean of its two ends times the length is at most its integral.

References: the inequality is that of Hamilton, Jacobi and Bellman with a potential that is linear in w; derived here.
"""

from typing import NamedTuple

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.continuous_bound.drive_rows import PlaceRows, drive_rows, rows_at
from railjoule.core.continuous_bound.hamiltonian import piece_values
from railjoule.core.continuous_bound.prices import SAME_PLACE_M, Pieces, price_pieces
from railjoule.core.interior_point.solver import Optimum
from railjoule.core.motion.meshed_line import MeshedLine
from railjoule.core.physics.mesh_data import MeshData


class ContinuousBound(NamedTuple):
    """A bound that prices along a line prove.

    Parameters
    ----------
    energy_j : float
        No driving of the train needs less [J], dwells not included.
    pieces : Pieces
        The prices.
    shares_j : array of shape (k,)
        Share of each piece in energy and priced time [J].
    price_of_time_w : float
        The price of a second, without auxiliaries [J/s]: by so much the bound falls with each second more.
    """

    energy_j: float
    pieces: Pieces
    shares_j: FloatArray
    price_of_time_w: float


def continuous_bound(mesh: MeshedLine, optimum: Optimum, running_time_s: float) -> ContinuousBound:
    """Return the bound that the multipliers of an optimum prove for every driving within a time."""
    data = mesh.data
    rows = tabulate_drive(mesh)
    price_of_time = max(optimum.price_of_time_w, 0.0)
    pieces = price_pieces(mesh, optimum, rows, price_of_time + data.auxiliary_power_w)
    shares = piece_shares(mesh, rows, pieces, price_of_time + data.auxiliary_power_w)
    energy = float(shares.sum() + sum_of_ends(mesh, pieces) - price_of_time * running_time_s)
    return ContinuousBound(energy, pieces, shares, float(price_of_time))


def tabulate_drive(mesh: MeshedLine) -> PlaceRows:
    """Return the tables of a meshed line's drive up to the greatest speed of the meshed line."""
    return drive_rows(mesh.data, float(mesh.cell_limit_ms.max()))


def piece_shares(mesh: MeshedLine, rows: PlaceRows, pieces: Pieces, price_of_time: float) -> FloatArray:
    """Return at most what each piece adds to energy and priced time [J]; shape (k,)."""
    length, ceiling2 = np.diff(pieces.position_m), pieces.ceiling2
    # where the price of a curve cuts speeds off, none is left out beside
    has_price = pieces.curve.max(axis=0) > 0.0
    limit = np.where(has_price, mesh.cell_limit_ms[pieces.cell], np.sqrt(ceiling2.max(axis=0)))
    values = piece_values(mesh.data, rows, pieces, limit, price_of_time)
    shares: FloatArray = 0.5 * length * (values[0] + values[1])
    # the integral of price times ceiling, both linear
    (c0, c1), (w0, w1) = pieces.curve, ceiling2
    shares -= length / 6.0 * (c0 * (2.0 * w0 + w1) + c1 * (w0 + 2.0 * w1))
    _replace_at_rest(mesh.data, rows, pieces, limit, price_of_time, shares)
    return shares


def _replace_at_rest(
    data: MeshData,
    rows: PlaceRows,
    pieces: Pieces,
    limit_ms: FloatArray,
    price_of_time: float,
    shares: FloatArray,
) -> None:
    """Replace the shares of the pieces that end at rest, in place, by what holds for any motion there.

    Over a length d between rest and a square of speed w, with an acceleration of at most a, w <= 2 a d and the time is
    at least sqrt(2 d / a). The work at the wheels is N = +-K w + (A + G) d or more, and costs at least the greater of
    eta N and eta_b r N, the least per work of driving and the most returned per work of braking.
    """
    inertia = data.half_inertia_kg
    places = np.searchsorted(pieces.position_m, np.append(0.0, np.cumsum(data.cell_length_m)) - SAME_PLACE_M)
    for place in places[data.fixed_speed2 == 0.0]:
        for piece, side, most in (
            (place, 1.0, data.max_acceleration_ms2),
            (place - 1, -1.0, data.max_deceleration_ms2),
        ):
            if not 0 <= piece < len(shares):
                continue
            length = pieces.position_m[piece + 1] - pieces.position_m[piece]
            cell = pieces.cell[piece]
            table = rows_at(rows, data.place[cell])
            driving, braking, taken, returned = table.at_rest
            resisted = data.resistance_constant_n + data.line_force_n[cell]
            powered = 1.0 if data.supply_share[cell] >= 1.0 else 0.0
            effort = powered * driving - resisted if side > 0.0 else powered * braking + table.friction_n + resisted
            if side < 0.0:
                effort += data.starting_n
                # resistance helps, too: that at the limit of speed bounds the speed at the start, and so itself
                linear, quadratic, limit = data.resistance_linear, data.resistance_quadratic[cell], limit_ms[piece]
                fastest2 = length * (effort + linear * limit + quadratic * limit**2) / inertia
                effort += linear * fastest2**0.5 + quadratic * fastest2
            acceleration = min(effort / (2.0 * inertia), most)
            if side < 0.0 and pieces.ceiling2[1, piece] == 0.0:
                # a braking curve ends here
                acceleration = min(acceleration, 0.5 * pieces.ceiling2[0, piece] / length)
            if acceleration <= 0.0:
                continue
            fastest2 = 2.0 * length * acceleration
            price = pieces.motion[1 if side > 0.0 else 0, piece]
            level = resisted * length
            # convex in w: least at an end, or where no work is needed
            squares = np.clip(np.array([0.0, fastest2, -side * level / inertia]), 0.0, fastest2)
            work = side * inertia * squares + level
            cost = (
                np.maximum(taken * work, returned * table.recuperation_factor * work) - side * price * inertia * squares
            )
            shares[piece] = price_of_time * (2.0 * length / acceleration) ** 0.5 + cost.min()


def sum_of_ends(mesh: MeshedLine, pieces: Pieces) -> float:
    """Return at most what the prices at the ends of the line and their jumps add [J]."""
    data = mesh.data
    price = -data.half_inertia_kg * pieces.motion
    # the first piece that begins at each node, and the one before
    after = np.searchsorted(pieces.cell, np.arange(1, mesh.cell_count))
    # what depends on w at a node is affine in it: its least is that of a prescribed speed, or at an end of the range
    slope = np.concatenate([[price[0, 0]], price[0, after] - price[1, after - 1], [-price[1, -1]]])
    fixed = data.fixed_speed2
    start2, end2 = pieces.ceiling2
    most2 = np.concatenate([start2[:1], np.minimum(end2[after - 1], start2[after]), end2[-1:]])
    worth = np.where(fixed >= 0.0, slope * np.maximum(fixed, 0.0), np.minimum(0.0, slope * most2))
    return float(worth.sum())
