"""Losses of one motor over torque and speed as patches with continuous first derivatives, in one row of numbers.

Between the lines of the grid a loss is a polynomial, cubic in each direction, that takes values and slopes of both
ends. Along each line the slopes are those that keep its shape (Fritsch, Carlson: Monotone piecewise cubic
interpolation, SIAM Journal on Numerical Analysis 17, 1980): where the given losses rise, so does the curve.

A row holds the number of torques and of speeds, these themselves, then the 16 coefficients of each patch.
"""

import numpy as np
import scipy

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.drive.power_terms import PowerTerms
from railjoule.core.hermite import HERMITE

# numbers of a row before the torques, and of a patch: 4 powers of torque times 4 of speed
HEAD = 2
PATCH = 16


def loss_table(torque_nm: FloatArray, speed_rads: FloatArray, loss_w: FloatArray) -> FloatArray:
    """Return the table of losses.

    Parameters
    ----------
    torque_nm : array of shape (n,)
        Torques of one motor, rising from 0 [N m].
    speed_rads : array of shape (m,)
        Its speeds, rising from 0 [rad/s].
    loss_w : array of shape (n, m)
        What it loses there while it is on [W].

    Returns
    -------
    array of shape (2 + n + m + 16 (n - 1) (m - 1),)
    """
    by_torque = scipy.interpolate.PchipInterpolator(torque_nm, loss_w, axis=0).derivative()(torque_nm)
    by_speed = scipy.interpolate.PchipInterpolator(speed_rads, loss_w, axis=1).derivative()(speed_rads)
    # the slope along one line must itself keep its shape along the other; the order does not matter but for rounding
    by_both = scipy.interpolate.PchipInterpolator(speed_rads, by_torque, axis=1).derivative()(speed_rads)
    dx, dy = np.diff(torque_nm)[:, None], np.diff(speed_rads)[None, :]

    def corners(values: FloatArray, factor: FloatArray | float) -> FloatArray:
        ends = [[values[:-1, :-1], values[:-1, 1:]], [values[1:, :-1], values[1:, 1:]]]
        return np.array(ends) * factor

    data = np.block(
        [
            [np.moveaxis(corners(loss_w, 1.0), (0, 1), (2, 3)), np.moveaxis(corners(by_speed, dy), (0, 1), (2, 3))],
            [
                np.moveaxis(corners(by_torque, dx), (0, 1), (2, 3)),
                np.moveaxis(corners(by_both, dx * dy), (0, 1), (2, 3)),
            ],
        ]
    )
    patches = np.einsum("pa,ijab,qb->ijpq", HERMITE, data, HERMITE)
    # from coordinates of a patch, 0 to 1, to torque and speed above its corner
    powers = np.arange(4)
    patches /= (dx[..., None, None] ** powers[:, None]) * (dy[..., None, None] ** powers[None, :])
    head = [float(len(torque_nm)), float(len(speed_rads))]
    return np.concatenate([head, torque_nm, speed_rads, patches.ravel()])


@njit(cache=True)
def piece_in(row: FloatArray, first: int, count: int, value: float) -> int:
    """Return the number of the piece of a rising sequence in which a value lies; the end pieces go on for ever."""
    low, high = 0, count - 1
    while high - low > 1:
        middle = (low + high) // 2
        if row[first + middle] <= value:
            low = middle
        else:
            high = middle
    return low


@njit(cache=True)
def loss_at(row: FloatArray, start: int, torque: float, speed: float) -> PowerTerms:
    """Return the loss [W] at a torque [N m] and speed [rad/s], and its derivatives by both; never below zero.

    Parameters
    ----------
    row : array
        Holds the table.
    start : int
        Where in it the table begins.
    torque, speed : float
        Of one motor, within the table [N m, rad/s].
    """
    torques, speeds = int(row[start]), int(row[start + 1])
    torque_first = start + HEAD
    speed_first = torque_first + torques
    i, j = piece_in(row, torque_first, torques, torque), piece_in(row, speed_first, speeds, speed)
    x, y = torque - row[torque_first + i], speed - row[speed_first + j]
    patch = speed_first + speeds + PATCH * (i * (speeds - 1) + j)
    p = p_x = p_y = p_xx = p_xy = p_yy = 0.0
    # Horner's rule in torque, whose coefficients q are cubics of speed; derivatives first: each takes the value before
    for power in range(3, -1, -1):
        c = patch + 4 * power
        q = ((row[c + 3] * y + row[c + 2]) * y + row[c + 1]) * y + row[c]
        q_y = (3.0 * row[c + 3] * y + 2.0 * row[c + 2]) * y + row[c + 1]
        q_yy = 6.0 * row[c + 3] * y + 2.0 * row[c + 2]
        p_xx = p_xx * x + 2.0 * p_x
        p_x = p_x * x + p
        p = p * x + q
        p_xy = p_xy * x + p_y
        p_y = p_y * x + q_y
        p_yy = p_yy * x + q_yy
    # the last piece goes on beyond the map, and there it may fall below zero: a motor never gains
    if p < 0.0:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    return p, p_x, p_y, p_xx, p_xy, p_yy
