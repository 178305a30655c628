"""Drives whose power is one formula of effort and speed: constant efficiency, and copper loss.

Source of the copper loss: Ftorek et al. 2025, (11), with i_q = effort / (motors * torque per ampere * gear ratio /
wheel radius).
"""

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.compiled import njit
from railjoule.core.drive.drive import Drive
from railjoule.core.drive.geared import turns_per_metre
from railjoule.core.drive.kinds import CONSTANT_EFFICIENCY, COPPER_LOSS, PowerTerms
from railjoule.core.scenario.drive import ConstantEfficiency, CopperLoss

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
