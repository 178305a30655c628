"""Losses of a motor that stand in two tables, one for driving and one for braking.

Outside the map its last piece goes on: `MapDrive` refuses to ask there.
"""

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.drive.geared_parameters import LOSSES
from railjoule.core.drive.loss_map.table import loss_at
from railjoule.core.drive.power_terms import PowerTerms

PARAMETERS = ("start of the table of braking",)
"""What follows the parameters of all geared motors, before the tables of driving and of braking."""

BRAKING_TABLE, DRIVING_TABLE = LOSSES, LOSSES + len(PARAMETERS)


@njit(cache=True)
def motor_loss(parameters: FloatArray, braking: bool, torque: float, rads: float) -> PowerTerms:
    """Return the losses of one motor that is on, with its inverter [W], and their derivatives by torque and speed."""
    table = int(parameters[BRAKING_TABLE]) if braking else DRIVING_TABLE
    return loss_at(parameters, table, torque, rads)
