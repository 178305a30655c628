"""A drive with an efficiency map over torque and speed, and its losses where efficiency does not determine them.

Driving, loss = M w (1 / eta - 1); braking, loss = M w (1 - eta). Without torque or speed the efficiency does not
determine the loss, nor in braking where it is zero because the motor takes power. There the loss continues from the
next three points as the parabola through them, kept between zero and the nearest of them: a choice, not a measurement.
"""

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.drive.loss_map import LossMap, MapDrive, map_fields
from railjoule.core.errors import ScenarioError
from railjoule.core.scenario.drive import EfficiencyMap


def make_efficiency_map(parameters: EfficiencyMap) -> MapDrive:
    """Return the drive of a validated map; braking mirrors driving if the map has no braking."""
    points = np.array(parameters.points)
    below = points[points[:, 0] <= 0] * np.array([-1.0, 1.0, 1.0])
    driving = _loss_map(points[points[:, 0] >= 0], False)
    braking = _loss_map(below if (below[:, 0] > 0).any() else points, True)
    # the limit of a rectangular map is constant over speed
    ends = driving.speed_rads[[0, -1]]
    most = np.full(2, driving.torque_nm[-1]), np.full(2, braking.torque_nm[-1])
    return MapDrive(**map_fields(parameters, driving, braking, ends, most))


def _loss_map(points: FloatArray, braking: bool) -> LossMap:
    torque, speed = np.unique(points[:, 0]), np.unique(points[:, 1])
    efficiency = np.empty((len(torque), len(speed)))
    efficiency[np.searchsorted(torque, points[:, 0]), np.searchsorted(speed, points[:, 1])] = points[:, 2]
    shaft = torque[:, None] * speed[None, :]
    # eta = 0 in braking may be any loss above the shaft's power, and without shaft power any loss at all
    known = (shaft > 0) & (efficiency > 0)
    share = 1 - efficiency if braking else 1 / np.where(known, efficiency, 1.0) - 1
    loss = np.where(known, shaft * share, np.nan)
    # along the torque first: no loss at rest is known, and those are filled from the finished rows
    _continue_down(torque, loss[:, 1:])
    _continue_down(speed, loss.T)
    if np.isnan(loss).any():
        raise ScenarioError("drive.points leave the losses open: too many of the efficiencies are 0.")
    return LossMap(torque, speed, loss)


def _continue_down(places: FloatArray, loss: FloatArray) -> None:
    """Fill unknown values before the first known points of each column, in place."""
    for column in loss.T:
        known = np.flatnonzero(~np.isnan(column))
        if len(known) == 0 or known[0] == 0:
            continue
        nearest = known[:3]
        parabola = np.polynomial.Polynomial.fit(places[nearest], column[nearest], len(nearest) - 1)
        column[: known[0]] = np.clip(parabola(places[: known[0]]), 0.0, column[known[0]])
