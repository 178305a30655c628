"""The largest effort at a speed: a constant, and a power or a table over speed."""

from typing import NamedTuple

import numpy as np
from scipy.interpolate import PchipInterpolator

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit

NO_TABLE = np.zeros((0, 4))
TABLE_STEP_MS = 0.125


class EffortLimit(NamedTuple):
    """Limits of one direction of effort, in a form that compiled code takes.

    Parameters
    ----------
    constant_n : float
        The largest effort at any speed [N].
    power_w : float
        The largest effort times speed [W]; infinite where there is no such limit.
    table : array of shape (m, 4)
        Cubic pieces of the limit over equal steps of speed, from 0; it then stands for the power too.
    table_step_ms : float
        Length of a piece [m/s].
    """

    constant_n: float
    power_w: float
    table: FloatArray
    table_step_ms: float

    def effort_n(self, speed_ms: FloatArray) -> FloatArray:
        """Return the largest effort [N] at speeds above zero [m/s]; shape as the argument's."""
        if len(self.table) == 0:
            return np.minimum(self.constant_n, self.power_w / np.asarray(speed_ms))
        speed = np.asarray(speed_ms, dtype=float)
        effort = np.empty(speed.size)
        _fill_efforts(self, speed.ravel(), effort)
        return effort.reshape(speed.shape)


def table_speeds(top_speed_ms: float) -> FloatArray:
    """Return the speeds [m/s] at which a tabulated limit up to `top_speed_ms` is given; shape (m + 1,)."""
    return np.arange(0.0, top_speed_ms + 2 * TABLE_STEP_MS, TABLE_STEP_MS)


def tabulated_limit(constant_n: float, efforts_n: FloatArray) -> EffortLimit:
    """Return the limit through given points, joined by cubics that keep their shape.

    Parameters
    ----------
    constant_n : float
        The largest effort at any speed [N].
    efforts_n : array of shape (m + 1,)
        The limit at the speeds of `table_speeds` [N].
    """
    curve = PchipInterpolator(np.arange(len(efforts_n)) * TABLE_STEP_MS, efforts_n)
    return EffortLimit(constant_n, np.inf, np.ascontiguousarray(curve.c[::-1].T), TABLE_STEP_MS)


@njit(cache=True, error_model="numpy")
def limit_over_speed(limit: EffortLimit, speed: float) -> tuple[float, float, float]:
    """Return the limit that varies with speed [N] and its first and second derivative, without the constant."""
    pieces = limit.table.shape[0]
    if pieces == 0:
        effort = limit.power_w / speed
        return effort, -effort / speed, 2.0 * effort / (speed * speed)
    piece = min(int(speed / limit.table_step_ms), pieces - 1)
    x = speed - piece * limit.table_step_ms
    c = limit.table[piece]
    return (
        ((c[3] * x + c[2]) * x + c[1]) * x + c[0],
        (3.0 * c[3] * x + 2.0 * c[2]) * x + c[1],
        6.0 * c[3] * x + 2.0 * c[2],
    )


@njit(cache=True, error_model="numpy")
def largest_effort(limit: EffortLimit, speed: float) -> float:
    """Return the largest effort [N] at a speed above zero [m/s]."""
    if limit.table.shape[0] == 0:
        return min(limit.constant_n, limit.power_w / speed)
    return min(limit.constant_n, limit_over_speed(limit, speed)[0])


@njit(cache=True)
def _fill_efforts(limit: EffortLimit, speed: FloatArray, effort: FloatArray) -> None:
    for i in range(speed.shape[0]):
        effort[i] = largest_effort(limit, speed[i])
