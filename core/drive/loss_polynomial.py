"""Losses of a motor that are a polynomial of its torque and speed.

Loss of one motor that is on, with its inverter: p0 + k1 w + k2 w^2 + c1 M + c2 M^2, w its speed [rad/s], M its torque
[N m]. The polynomial is ours.
"""

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.drive.geared_parameters import LOSSES
from railjoule.core.drive.power_terms import PowerTerms

PARAMETERS = (
    *("no_load_loss_w", "speed_loss_w_per_rads", "speed_loss_w_per_rads2"),
    *("torque_loss_w_per_nm", "torque_loss_w_per_nm2"),
)
"""What follows the parameters of all geared motors, in order."""

NO_LOAD, BY_SPEED, BY_SPEED2, BY_TORQUE, BY_TORQUE2 = range(LOSSES, LOSSES + len(PARAMETERS))


@njit(cache=True)
def motor_loss(parameters: FloatArray, torque: float, rads: float) -> PowerTerms:
    """Return the losses of one motor that is on, with its inverter [W], and their derivatives by torque and speed."""
    loss = parameters[NO_LOAD] + (parameters[BY_SPEED] + parameters[BY_SPEED2] * rads) * rads
    loss += (parameters[BY_TORQUE] + parameters[BY_TORQUE2] * torque) * torque
    return (
        loss,
        parameters[BY_TORQUE] + 2.0 * parameters[BY_TORQUE2] * torque,
        parameters[BY_SPEED] + 2.0 * parameters[BY_SPEED2] * rads,
        2.0 * parameters[BY_TORQUE2],
        0.0,
        2.0 * parameters[BY_SPEED2],
    )
