"""What the check asks of a loss model, whatever the drive, and the gear of motors with inverters of their own."""

from typing import Protocol

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.scenario.drive import GearedMotors

EXACT = 0.0
# far above the rounding of a torque from an effort, far below what any limit is known to
EDGE = 1e-9
"""What rounding may put beyond the end of a map, or of what a current or a voltage allows, as a share."""

Losses = dict[str, FloatArray]


class LossModel(Protocol):
    """One kind of drive, for arrays of effort [N] and speed [m/s] of shape (k,)."""

    @property
    def accuracy(self) -> float:
        """How far the product's losses may be from these, as a share of them and a tenth of the run's largest.

        `EXACT` where the product evaluates the same formula, more where it tabulates one.
        """

    def losses_w(self, effort_n: FloatArray, speed_ms: FloatArray) -> Losses:
        """Return the losses of a drive that is on by kind [W]; NaN where its motors cannot do that."""

    def largest_effort_n(self, speed_ms: FloatArray, braking: bool) -> FloatArray:
        """Return the largest effort that the motors have [N]; infinite where the model sets no limit."""

    def current_a(self, effort_n: FloatArray, speed_ms: FloatArray) -> FloatArray | None:
        """Return the current of a motor [A], or None where the model has none."""


def turns_per_metre(parameters: GearedMotors) -> float:
    """Return the angle of a motor over the distance of the train [1/m]."""
    return parameters.gear_ratio / (0.5 * parameters.wheel_diameter_m)


def shaft_torque_nm(parameters: GearedMotors, effort_n: FloatArray) -> FloatArray:
    """Return the torque of each shaft, braking negative [N m]: the gear loses its share in both directions."""
    # the gear loses g |F v|: on top of the power at the wheels when driving, out of it when braking
    shaft_over_wheel = np.where(effort_n > 0, 1 + parameters.gear_loss_share, 1 - parameters.gear_loss_share)
    torque: FloatArray = effort_n * shaft_over_wheel / (parameters.motors * turns_per_metre(parameters))
    return torque


def effort_of_torque_n(parameters: GearedMotors, torque_nm: FloatArray, braking: bool) -> FloatArray:
    """Return the effort of the train [N] for a torque of each shaft [N m], both without sign."""
    shaft_over_wheel = 1 - parameters.gear_loss_share if braking else 1 + parameters.gear_loss_share
    return parameters.motors * turns_per_metre(parameters) * torque_nm / shaft_over_wheel


def geared_losses_w(
    parameters: GearedMotors, effort_n: FloatArray, speed_ms: FloatArray, motor_loss_w: FloatArray
) -> Losses:
    """Return the losses of all motors with their inverters and of the gears [W]."""
    return {
        "motors_and_inverters": parameters.motors * motor_loss_w,
        "gear": parameters.gear_loss_share * np.abs(effort_n * speed_ms),
    }
