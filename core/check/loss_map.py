"""Losses of a motor with its inverter from a map of efficiencies, as the scenario format defines them.

At the points: driving, loss = M w (1 / eta - 1); braking, M w (1 - eta). Where an efficiency tells nothing - without
torque or speed, and in braking where it is 0 - the format extrapolates the loss, first to smaller torques, then to
smaller speeds, as the parabola through the next three points, between 0 and the nearest of them. Between the points the
loss is a cubic in each direction with the slopes of Fritsch and Carlson along each line, SIAM Journal on Numerical
Analysis 17, 1980; the slope across is itself interpolated so along the other line. It is never below 0. The map ends at
its last torque.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy

from railjoule.core.arrays import FloatArray
from railjoule.core.check.loss_model import (
    EDGE,
    EXACT,
    Losses,
    effort_of_torque_n,
    geared_losses_w,
    shaft_torque_nm,
    turns_per_metre,
)
from railjoule.core.scenario.drive import EfficiencyMap


@dataclass(frozen=True, eq=False)
class LossSurface:
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
        torques, speeds = self.torque_nm, self.speed_rads
        # The interpolant of the format, written with SciPy: first the values along torque with their slopes across,
        # then a cubic along speed. The product evaluates one table of coefficients; the two share no line.
        along_torque = scipy.interpolate.PchipInterpolator(torques, self.loss_w, axis=0).derivative()(torques)
        along_speed = scipy.interpolate.PchipInterpolator(speeds, self.loss_w, axis=1).derivative()(speeds)
        across = scipy.interpolate.PchipInterpolator(speeds, along_torque, axis=1).derivative()(speeds)
        value = scipy.interpolate.CubicHermiteSpline(torques, self.loss_w, along_torque, axis=0)(torque_nm)
        slope = scipy.interpolate.CubicHermiteSpline(torques, along_speed, across, axis=0)(torque_nm)
        j = np.clip(np.searchsorted(speeds, speed_rads, side="right") - 1, 0, len(speeds) - 2)
        k, step = np.arange(len(torque_nm)), np.diff(speeds)[j]
        s = (speed_rads - speeds[j]) / step
        # the cubic through both values with both slopes
        loss = value[k, j] * (1 + 2 * s) * (1 - s) ** 2 + value[k, j + 1] * s**2 * (3 - 2 * s)
        loss += step * (slope[k, j] * s * (1 - s) ** 2 - slope[k, j + 1] * s**2 * (1 - s))
        # beyond its last torque or speed a map knows nothing, so a run there breaks a rule instead of following a
        # guess
        inside = (torque_nm <= torques[-1] * (1 + EDGE)) & (speed_rads <= speeds[-1] * (1 + EDGE))
        # a cubic keeps between its data along one direction; across both it may dip below 0, and a loss must not
        # generate
        known: FloatArray = np.where(inside, np.maximum(loss, 0.0), np.nan)
        return known


@dataclass(frozen=True)
class MapLosses:
    """The losses that a map of efficiencies means, and the gears."""

    parameters: EfficiencyMap
    accuracy = EXACT

    @cached_property
    def surfaces(self) -> tuple[LossSurface, LossSurface]:
        """Driving and braking; braking mirrors driving where the map has no negative torque."""
        points = np.array(self.parameters.points)
        driving, braking = points[points[:, 0] >= 0], points[points[:, 0] <= 0] * [-1.0, 1.0, 1.0]
        # a map of driving alone stands for both directions, as the format says: the same efficiency for the same
        # torque
        return _surface(driving, False), _surface(braking if braking[:, 0].max() > 0 else driving, True)

    def losses_w(self, effort_n: FloatArray, speed_ms: FloatArray) -> Losses:
        """Return the losses by kind [W]; NaN beyond the map."""
        torque, speed = shaft_torque_nm(self.parameters, effort_n), turns_per_metre(self.parameters) * speed_ms
        driving, braking = (surface.at(np.abs(torque), speed) for surface in self.surfaces)
        return geared_losses_w(self.parameters, effort_n, speed_ms, np.where(torque >= 0, driving, braking))

    def largest_effort_n(self, speed_ms: FloatArray, braking: bool) -> FloatArray:
        """Return the effort at which the map ends [N]."""
        last = np.full(len(speed_ms), self.surfaces[1 if braking else 0].torque_nm[-1])
        return effort_of_torque_n(self.parameters, last, braking)

    def current_a(self, effort_n: FloatArray, speed_ms: FloatArray) -> FloatArray | None:
        """Return None: a map knows no current."""
        return None


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
