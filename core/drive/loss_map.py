"""Drives with a map of losses over torque and speed of a motor: patches with continuous first derivatives.

Between the lines of the grid a loss is a polynomial, cubic in each direction, with the values and slopes of both ends.
Along each line the slopes are those that keep its shape (Fritsch, Carlson: Monotone piecewise cubic interpolation, SIAM
Journal on Numerical Analysis 17, 1980): where the given losses rise, so does the curve. Outside the map its last piece
continues; `MapDrive` refuses such efforts and speeds.

A table holds the number of torques and of speeds, these themselves, then the 16 coefficients of each patch. The tables
of driving and of braking follow one another behind the parameters of all geared drives.
"""

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import scipy

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.compiled import njit
from railjoule.core.drive.geared import LOSSES, TURNS, GearedDrive, geared_head, turns_per_metre
from railjoule.core.drive.kinds import LOSS_MAP, PowerTerms
from railjoule.core.errors import DriveRangeError
from railjoule.core.scenario.drive import GearedMotors
from railjoule.core.units import MS_PER_KMH, N_PER_KN, distinct_numbers

# f = a + b x + c x^2 + d x^3: a = f0, b = s0, and f1 = a + b + c + d with s1 = b + 2 c + 3 d give the other two
HERMITE = np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [-3.0, 3.0, -2.0, -1.0], [2.0, -2.0, 1.0, 1.0]])
"""Coefficients of 1, x, x^2, x^3 from the values at 0 and 1 and the slopes there."""


BRAKING_TABLE, DRIVING_TABLE = LOSSES, LOSSES + 1
"""The parameter with the start of the table of braking, and the start of that of driving."""
# numbers of a table before the torques, and of a patch: 4 powers of torque times 4 of speed
HEAD = 2
PATCH = 16
ROUNDING = 1e-9
# runs use the largest effort to the last digit, and tabulated limits miss it by up to 1e-6
ALLOWED_EXCESS = 1e-6


class LossMap(NamedTuple):
    """Losses of one motor with its inverter while it is on.

    Parameters
    ----------
    torque_nm : array of shape (n,)
        Rising from 0 [N m].
    speed_rads : array of shape (m,)
        Rising from 0 [rad/s].
    loss_w : array of shape (n, m)
        The losses [W].
    """

    torque_nm: FloatArray
    speed_rads: FloatArray
    loss_w: FloatArray


@dataclass(frozen=True, eq=False, kw_only=True)
class MapDrive(GearedDrive):
    """A drive with losses within a map, and no values beyond it.

    Parameters
    ----------
    max_speed_ms : float
        Speed of the train at the end of the map [m/s].
    limit_speed_ms : array of shape (m,)
        Speeds of the train at which the limits of effort are given [m/s].
    driving_n : array
        Largest tractive efforts of the train there [N].
    braking_n : array
        Largest braking efforts of the train there [N].
    """

    max_speed_ms: float
    limit_speed_ms: FloatArray
    driving_n: FloatArray
    braking_n: FloatArray

    def electrical_power_w(self, effort_n: FloatArray, speed_ms: FloatArray) -> FloatArray:
        """Return the power at the terminals of the drive [W]; shape as the arguments'.

        Raises
        ------
        DriveRangeError
            If an effort or a speed lies beyond the map.
        """
        self.require_speed(float(np.max(speed_ms, initial=0.0)))
        for sign, limit, action in ((1, self.driving_n, "drive"), (-1, self.braking_n, "brake")):
            most, largest = float(np.max(sign * np.asarray(effort_n), initial=0.0)), float(limit.max())
            if most > largest * (1 + ALLOWED_EXCESS):
                end, asked = distinct_numbers(largest / N_PER_KN, most / N_PER_KN)
                raise DriveRangeError(f"the map of the drive ends at {end} kN to {action} with, below {asked} kN.")
        return super().electrical_power_w(effort_n, speed_ms)

    def effort_limit_n(self, speed_ms: FloatArray, braking: bool = False) -> FloatArray:
        """Return the largest effort [N] within the map; shape as the argument's."""
        return np.interp(speed_ms, self.limit_speed_ms, self.braking_n if braking else self.driving_n)

    def weakening_limit_n(self, speed_ms: FloatArray, braking: bool = False) -> FloatArray:
        """Return the part of that limit that varies with speed [N]; infinite where none does."""
        limit = self.braking_n if braking else self.driving_n
        return np.full(np.shape(speed_ms), np.inf) if np.ptp(limit) == 0 else self.effort_limit_n(speed_ms, braking)

    def limit_corners_ms(self, braking: bool = False) -> FloatArray:
        """Return the speeds at which the limit is given [m/s]: between them it is straight."""
        return self.limit_speed_ms

    def require_speed(self, speed_ms: float) -> None:
        """Raise DriveRangeError if the map ends below a speed [m/s]."""
        if speed_ms > self.max_speed_ms * (1 + ROUNDING):
            turns = self.parameters[TURNS]
            raise DriveRangeError(
                f"the map of the drive ends at {self.max_speed_ms * turns:.4g} rad/s of the motor, below the "
                f"{speed_ms * turns:.4g} rad/s of {speed_ms / MS_PER_KMH:.4g} km/h."
            )


def map_fields(
    parameters: GearedMotors,
    driving: LossMap,
    braking: LossMap,
    limit_rads: FloatArray,
    max_nm: tuple[FloatArray, FloatArray],
) -> dict[str, Any]:
    """Return the fields of a `MapDrive`.

    Parameters
    ----------
    parameters : GearedMotors
        Of the scenario.
    driving, braking : LossMap
        Over the size of the torque, with the same last speed.
    limit_rads : array of shape (m,)
        Speeds of a motor at which its largest torques are given [rad/s].
    max_nm : tuple of arrays of shape (m,)
        Largest torques in driving and braking [N m].
    """
    turns, gear = turns_per_metre(parameters), parameters.gear_loss_share
    wheel = parameters.motors * turns
    pulling, slowing = wheel * max_nm[0] / (1 + gear), wheel * max_nm[1] / (1 - gear)
    tables = [loss_table(*part) for part in (driving, braking)]
    head = [*geared_head(parameters, float(pulling.max())), DRIVING_TABLE + len(tables[0])]
    return {
        "kind": LOSS_MAP,
        "parameters": frozen_array(np.concatenate([head, *tables])),
        "recuperation_factor": parameters.recuperation_factor,
        "loss_kind": "motors_and_inverters",
        "max_speed_ms": float(driving.speed_rads[-1] / turns),
        "limit_speed_ms": frozen_array(limit_rads / turns),
        "driving_n": frozen_array(pulling),
        "braking_n": frozen_array(slowing),
    }


def loss_table(torque_nm: FloatArray, speed_rads: FloatArray, loss_w: FloatArray) -> FloatArray:
    """Return the table of losses, shape (2 + n + m + 16 (n - 1) (m - 1),); arguments as in `LossMap`."""
    slope = scipy.interpolate.PchipInterpolator
    by_torque = slope(torque_nm, loss_w, axis=0).derivative()(torque_nm)
    by_speed = slope(speed_rads, loss_w, axis=1).derivative()(speed_rads)
    # the slope along one line must itself keep its shape along the other; the order matters only for rounding
    by_both = slope(speed_rads, by_torque, axis=1).derivative()(speed_rads)
    dx, dy = np.diff(torque_nm)[:, None], np.diff(speed_rads)[None, :]

    def corners(values: FloatArray, factor: FloatArray | float) -> FloatArray:
        ends = [[values[:-1, :-1], values[:-1, 1:]], [values[1:, :-1], values[1:, 1:]]]
        return np.moveaxis(np.array(ends) * factor, (0, 1), (2, 3))

    data = np.block(
        [[corners(loss_w, 1.0), corners(by_speed, dy)], [corners(by_torque, dx), corners(by_both, dx * dy)]]
    )
    patches = np.einsum("pa,ijab,qb->ijpq", HERMITE, data, HERMITE)
    # from coordinates of a patch, 0 to 1, to torque and speed above its corner
    powers = np.arange(4)
    patches /= (dx[..., None, None] ** powers[:, None]) * (dy[..., None, None] ** powers[None, :])
    head = [float(len(torque_nm)), float(len(speed_rads))]
    return np.concatenate([head, torque_nm, speed_rads, patches.ravel()])


@njit(cache=True)
def piece_in(row: FloatArray, first: int, count: int, value: float) -> int:
    """Return the index of the piece of a rising sequence in which a value lies; the end pieces have no end."""
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
        Numbers with the table among them.
    start : int
        Index of the first number of the table.
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
    # the last piece continues beyond the map, and there it may fall below zero: a motor never gains
    if p < 0.0:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    return p, p_x, p_y, p_xx, p_xy, p_yy
