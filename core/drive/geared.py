"""Drives of several motors behind gears, each with its own inverter; and drives whose power or loss is one formula.

Power by a formula: constant efficiency, and copper loss. Source of the copper loss: Ftorek et al. 2025, (11), with
i_q = effort / (motors * torque per ampere * gear ratio / wheel radius).

A shaft has the share of the effort and of the power at the wheels that its gear needs in driving, F v (1 + g) / motors,
and the share that the gear leaves in braking, F v (1 - g) / motors. Without effort the inverters are off: no power, no
drag. A motor that is on has idle losses, so power jumps at no effort.

Loss polynomial of one motor that is on, with its inverter: p0 + k1 w + k2 w^2 + c1 M + c2 M^2, w its speed [rad/s], M
its torque [N m]. The polynomial is railjoule's.

Source: Shtompel, Khvorost 2025, (8)-(12), with the sign of the gear's loss in braking corrected.
"""

from dataclasses import dataclass

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.compiled import njit
from railjoule.core.drive.drive import Drive
from railjoule.core.drive.kinds import CONSTANT_EFFICIENCY, COPPER_LOSS, LOSS_POLYNOMIAL, PowerTerms
from railjoule.core.drive.line_power import resistor_power
from railjoule.core.scenario.drive import ConstantEfficiency, CopperLoss, GearedMotors, Induction, LossPolynomial

MOTORS, TURNS, DRIVING_SHARE, BRAKING_SHARE, NEGLIGIBLE, FRICTION, STANDSTILL_BRAKE, LOSSES = range(8)
"""The parameters of all these drives begin so; those of a motor's losses follow from `LOSSES` on.

Number of motors; angle of a motor over the distance of the train [1/m]; power of the shafts over power at the wheels in
driving and in braking; effort up to which the drive is off [N]; torque of friction that counts as work of a shaft
[N m]; whether another brake takes over where the motors would need supply power to brake.
"""
NO_LOAD, BY_SPEED, BY_SPEED2, BY_TORQUE, BY_TORQUE2 = range(LOSSES, LOSSES + 5)
# Rounding and the solver's tolerance of 1e-8 leave an effort below this share of a large one where a run coasts: the
# motors are off, and take no idle power.
NEGLIGIBLE_SHARE = 1e-7


def turns_per_metre(drive: CopperLoss | Induction | GearedMotors) -> float:
    """Return the angle of a motor over the distance of the train, gear ratio over wheel radius [1/m]."""
    return drive.gear_ratio / (0.5 * drive.wheel_diameter_m)


def geared_head(drive: GearedMotors, large_effort_n: float) -> list[float]:
    """Return the first parameters of a drive; `large_effort_n` is the effort beside which others are rounding."""
    gear = drive.gear_loss_share
    return [drive.motors, turns_per_metre(drive), 1 + gear, 1 - gear, NEGLIGIBLE_SHARE * large_effort_n, 0.0, 0.0]


@dataclass(frozen=True, eq=False)
class GearedDrive(Drive):
    """A drive whose energy balance separates the losses of gears from those of motors and inverters."""

    def losses_w(self, effort_n: FloatArray, speed_ms: FloatArray) -> dict[str, FloatArray]:
        """Return the losses by kind [W]: of motors with their inverters, of gears, and of brake resistors."""
        power = self.electrical_power_w(effort_n, speed_ms)
        work = np.multiply(effort_n, speed_ms)
        gear = np.where(power == 0, 0.0, (self.parameters[DRIVING_SHARE] - 1) * np.abs(work))
        return {
            self.loss_kind: power - work - gear,
            "gear": gear,
            "brake_resistors": resistor_power(power, self.recuperation_factor),
        }


@njit(cache=True)
def polynomial_loss(parameters: FloatArray, torque: float, rads: float) -> PowerTerms:
    """Return the loss of one motor that is on, with its inverter [W], and its derivatives by torque and speed."""
    loss = parameters[NO_LOAD] + (parameters[BY_SPEED] + parameters[BY_SPEED2] * rads) * rads
    return (
        loss + (parameters[BY_TORQUE] + parameters[BY_TORQUE2] * torque) * torque,
        parameters[BY_TORQUE] + 2.0 * parameters[BY_TORQUE2] * torque,
        parameters[BY_SPEED] + 2.0 * parameters[BY_SPEED2] * rads,
        2.0 * parameters[BY_TORQUE2],
        0.0,
        2.0 * parameters[BY_SPEED2],
    )


def make_loss_polynomial(parameters: LossPolynomial) -> GearedDrive:
    """Return a drive whose motors have a loss polynomial."""
    # a polynomial has no largest torque: a traction motor of 100 N m would be a small one
    large_effort_n = 100 * parameters.motors * turns_per_metre(parameters)
    losses = [
        parameters.no_load_loss_w,
        parameters.speed_loss_w_per_rads,
        parameters.speed_loss_w_per_rads2,
        parameters.torque_loss_w_per_nm,
        parameters.torque_loss_w_per_nm2,
    ]
    return GearedDrive(
        kind=LOSS_POLYNOMIAL,
        parameters=frozen_array([*geared_head(parameters, large_effort_n), *losses]),
        recuperation_factor=parameters.recuperation_factor,
        loss_kind="motors_and_inverters",
    )


TRACTION_EFFICIENCY, BRAKING_EFFICIENCY = range(2)
LOSS_COEFFICIENT = 0


@njit(cache=True)
def constant_efficiency_power(parameters: FloatArray, braking: bool, effort: float, speed: float) -> PowerTerms:
    """Return F v / efficiency in driving, - F v * efficiency in braking [W], and the derivatives."""
    share = -parameters[BRAKING_EFFICIENCY] if braking else 1.0 / parameters[TRACTION_EFFICIENCY]
    return share * effort * speed, share * speed, share * effort, 0.0, share, 0.0


def make_constant_efficiency(parameters: ConstantEfficiency) -> Drive:
    """Return a drive of constant efficiency; braking has the efficiency of driving if its own is not given."""
    driving, braking = parameters.traction_efficiency, parameters.braking_efficiency
    return Drive(
        kind=CONSTANT_EFFICIENCY,
        parameters=frozen_array([driving, driving if braking is None else braking]),
        recuperation_factor=parameters.recuperation_factor,
        loss_kind="drive",
    )


@njit(cache=True)
def copper_loss_power(parameters: FloatArray, braking: bool, effort: float, speed: float) -> PowerTerms:
    """Return F v in driving, - F v in braking, and coefficient * F^2 on top [W], with the derivatives.

    Near standstill, braking needs more for the windings than the wheels give.
    """
    sign, loss = -1.0 if braking else 1.0, parameters[LOSS_COEFFICIENT] * effort
    power = (sign * speed + loss) * effort
    return power, sign * speed + 2.0 * loss, sign * effort, 2.0 * parameters[LOSS_COEFFICIENT], sign, 0.0


def make_copper_loss(parameters: CopperLoss) -> Drive:
    """Return a drive whose motors lose R i^2 each, with F = motors * torque per ampere * turns * i."""
    amperes_per_newton = 1 / (parameters.motors * parameters.torque_per_amp_nm * turns_per_metre(parameters))
    return Drive(
        kind=COPPER_LOSS,
        parameters=frozen_array([parameters.motors * parameters.resistance_ohm * amperes_per_newton**2]),
        recuperation_factor=parameters.recuperation_factor,
        loss_kind="copper",
        amperes_per_newton=amperes_per_newton,
    )
