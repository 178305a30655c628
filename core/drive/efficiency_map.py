"""From a map of efficiencies over torque and speed to a drive: losses, and what they are where efficiency says nothing.

Driving, loss = M w (1 / eta - 1); braking, loss = M w (1 - eta). Without torque or speed efficiency says nothing of
the loss, in braking neither where it is zero because the motor draws power. There the loss goes on from the next three
points as the parabola through them, kept between zero and the nearest of them: a choice, not a measurement.
"""

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.drive.geared_parameters import turns_per_metre
from railjoule.core.drive.loss_map.drive import LossMap, MapDrive, make_map_drive
from railjoule.core.errors import ScenarioError
from railjoule.core.scenario.drive import EfficiencyMap


def make_efficiency_map_drive(parameters: EfficiencyMap) -> MapDrive:
    """Return the drive that the validated map of a scenario describes; braking mirrors driving if it is not given."""
    points = np.array(parameters.points)
    driving = _loss_map(points[points[:, 0] >= 0], False)
    below = points[points[:, 0] <= 0] * np.array([-1.0, 1.0, 1.0])
    braking = _loss_map(below if (below[:, 0] > 0).any() else points, True)
    return make_map_drive(
        driving,
        braking,
        parameters.motors,
        turns_per_metre(parameters),
        parameters.gear_loss_share,
        parameters.recuperation_factor,
    )


def _loss_map(points: FloatArray, braking: bool) -> LossMap:
    torque, speed = np.unique(points[:, 0]), np.unique(points[:, 1])
    efficiency = np.empty((len(torque), len(speed)))
    efficiency[np.searchsorted(torque, points[:, 0]), np.searchsorted(speed, points[:, 1])] = points[:, 2]
    shaft = torque[:, None] * speed[None, :]
    # eta = 0 while braking may mean any loss above the shaft's power, without shaft power any loss at all
    known = (shaft > 0) & (efficiency > 0)
    share = 1 - efficiency if braking else 1 / np.where(known, efficiency, 1.0) - 1
    loss = np.where(known, shaft * share, np.nan)
    # along the torque first: the column at rest is unknown whole, and is filled from the finished rows
    _continue_down(torque, loss[:, 1:])
    _continue_down(speed, loss.T)
    if np.isnan(loss).any():
        raise ScenarioError("drive.points leave the losses open: too many of the efficiencies are 0.")
    return LossMap(torque, speed, loss)


def _continue_down(places: FloatArray, loss: FloatArray) -> None:
    """Fill what is unknown before the first known points of each column, in place."""
    for column in loss.T:
        known = np.flatnonzero(~np.isnan(column))
        if len(known) == 0 or known[0] == 0:
            continue
        nearest = known[:3]
        parabola = np.polynomial.Polynomial.fit(places[nearest], column[nearest], len(nearest) - 1)
        before = slice(0, known[0])
        column[before] = np.clip(parabola(places[before]), 0.0, column[known[0]])
