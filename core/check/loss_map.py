"""Losses of a motor with its inverter from a map of efficiencies, as the scenario format defines them.

At the points: driving, loss = M w (1 / eta - 1); braking, M w (1 - eta). Without torque or speed, and in braking with
an efficiency of 0, these determine no loss: there the format extrapolates it, first to smaller torques, then to smaller
speeds, as the parabola through the next three points, between 0 and the nearest of them. Between the points the loss is
a cubic in each direction with the slopes of Fritsch and Carlson along each line, SIAM Journal on Numerical Analysis 17,
1980; the slope across is itself interpolated so along the other line. It is never below 0. The map ends at its last
torque.
"""

from functools import cached_property
from typing import NamedTuple

import numpy as np
import scipy

from railjoule.core.arrays import FloatArray
from railjoule.core.check.loss_model import EDGE, GearedModel, Losses


class LossSurface(NamedTuple):
    """Losses over a grid of torques and speeds, both rising from 0.

    Parameters
    ----------
    torque_nm : array of shape (n,)
        Without sign [N m].
    speed_rads : array of shape (m,)
        [rad/s].
    loss_w : array of shape (n, m)
        [W].
    """

    torque_nm: FloatArray
    speed_rads: FloatArray
    loss_w: FloatArray

    def at(self, torque_nm: FloatArray, speed_rads: FloatArray) -> FloatArray:
        """Return the loss at torques and speeds within the grid [W]; NaN beyond it; all of shape (k,)."""
        torques, speeds, losses = self
        # The interpolant of the format, written with SciPy: first the values along torque with their slopes across,
        # then a cubic along speed. The product evaluates one table of coefficients; the two share no line.
        pchip, hermite = scipy.interpolate.PchipInterpolator, scipy.interpolate.CubicHermiteSpline
        along_torque = pchip(torques, losses, axis=0).derivative()(torques)
        along_speed = pchip(speeds, losses, axis=1).derivative()(speeds)
        across = pchip(speeds, along_torque, axis=1).derivative()(speeds)
        value = hermite(torques, losses, along_torque, axis=0)(torque_nm)
        slope = hermite(torques, along_speed, across, axis=0)(torque_nm)
        j = np.clip(np.searchsorted(speeds, speed_rads, side="right") - 1, 0, len(speeds) - 2)
        k, step = np.arange(len(torque_nm)), np.diff(speeds)[j]
        s = (speed_rads - speeds[j]) / step
        # the cubic through both values with both slopes
        loss = value[k, j] * (1 + 2 * s) * (1 - s) ** 2 + value[k, j + 1] * s**2 * (3 - 2 * s)
        loss += step * (slope[k, j] * s * (1 - s) ** 2 - slope[k, j + 1] * s**2 * (1 - s))
        # A map has no values beyond its last torque or speed, so a run there breaks a rule.
        inside = (torque_nm <= torques[-1] * (1 + EDGE)) & (speed_rads <= speeds[-1] * (1 + EDGE))
        # A cubic keeps between its data along one direction; across both it may fall below 0, and a loss must not
        # generate.
        return np.where(inside, np.maximum(loss, 0.0), np.nan)


class MapModel(GearedModel, model="efficiency_map"):
    """The losses of a map of efficiencies, and the gears."""

    @cached_property
    def surfaces(self) -> tuple[LossSurface, LossSurface]:
        """Driving and braking; braking mirrors driving where the map has no negative torque."""
        points = np.array(self.parameters.points)
        driving, braking = points[points[:, 0] >= 0], points[points[:, 0] <= 0] * [-1.0, 1.0, 1.0]
        # a map without braking has the same efficiency for the same torque in braking, as the format states
        return _surface(driving, False), _surface(braking if braking[:, 0].max() > 0 else driving, True)

    def losses_w(self, effort_n: FloatArray, speed_ms: FloatArray) -> Losses:
        """Return the losses by kind [W]; NaN beyond the map."""
        torque, speed = self.shaft_torque_nm(effort_n), self.turns_per_metre * speed_ms
        driving, braking = (surface.at(np.abs(torque), speed) for surface in self.surfaces)
        of_all = self.parameters.motors * np.where(torque >= 0, driving, braking)
        return {"motors_and_inverters": of_all, "gear": self.gear_loss_w(effort_n, speed_ms)}

    def max_torque_nm(self, speed_rads: FloatArray, braking: bool) -> FloatArray:
        """Return the last torque of the map [N m]."""
        return np.full(len(speed_rads), self.surfaces[braking].torque_nm[-1])


def _surface(points: FloatArray, braking: bool) -> LossSurface:
    torques, speeds = np.unique(points[:, 0]), np.unique(points[:, 1])
    order = np.lexsort((points[:, 1], points[:, 0]))
    efficiency = points[order, 2].reshape(len(torques), len(speeds))
    shaft = np.outer(torques, speeds)
    with np.errstate(divide="ignore", invalid="ignore"):
        loss = shaft * ((1 - efficiency) if braking else (1 / efficiency - 1))
    # 0 / 0: without torque or speed there is no output to be a share of, and the loss is extrapolated below
    loss[(shaft == 0) | (efficiency == 0)] = np.nan
    # torque first, and from the second speed on: at standstill the whole line is unknown until the other direction
    # fills it
    for j in range(1, len(speeds)):
        loss[:, j] = _extrapolated(torques, loss[:, j])
    for i in range(len(torques)):
        loss[i] = _extrapolated(speeds, loss[i])
    return LossSurface(torques, speeds, loss)


def _extrapolated(places: FloatArray, loss: FloatArray) -> FloatArray:
    """Return the losses along a line, those before the first known one continued."""
    known = np.flatnonzero(np.isfinite(loss))
    if not len(known) or known[0] == 0:
        return loss
    first, nearest = known[0], known[:3]
    # about the first known place, so that the fit has small numbers; through fewer points where there are only one or
    # two
    parabola = np.polyfit(places[nearest] - places[first], loss[nearest], len(nearest) - 1)
    before = np.clip(np.polyval(parabola, places[:first] - places[first]), 0.0, loss[first])
    return np.concatenate([before, loss[first:]])
