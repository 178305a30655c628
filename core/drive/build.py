"""Make a drive from the parameters of a scenario."""

from railjoule.core.arrays import frozen_array
from railjoule.core.drive.drive import Drive
from railjoule.core.drive.induction.drive import make_induction_drive
from railjoule.core.drive.kernels import CONSTANT_EFFICIENCY, COPPER_LOSS
from railjoule.core.scenario.drive import ConstantEfficiency, CopperLoss, Induction


def make_drive(parameters: ConstantEfficiency | CopperLoss | Induction) -> Drive:
    """Return the drive that the validated `parameters` of a scenario describe."""
    if isinstance(parameters, ConstantEfficiency):
        return _constant_efficiency(parameters)
    if isinstance(parameters, Induction):
        return make_induction_drive(parameters)
    return _copper_loss(parameters)


def _constant_efficiency(parameters: ConstantEfficiency) -> Drive:
    driving = parameters.traction_efficiency
    braking = parameters.braking_efficiency if parameters.braking_efficiency is not None else driving
    return Drive(
        kind=CONSTANT_EFFICIENCY,
        parameters=frozen_array([driving, braking]),
        recuperation_factor=parameters.recuperation_factor,
        loss_kind="drive",
        amperes_per_newton=None,
    )


def _copper_loss(parameters: CopperLoss) -> Drive:
    """One motor carries i = effort / (motors k x) and loses R i^2; x = gear ratio over wheel radius."""
    turns_per_metre = parameters.gear_ratio / (0.5 * parameters.wheel_diameter_m)
    amperes_per_newton = 1 / (parameters.motors * parameters.torque_per_amp_nm * turns_per_metre)
    return Drive(
        kind=COPPER_LOSS,
        parameters=frozen_array([parameters.motors * parameters.resistance_ohm * amperes_per_newton**2]),
        recuperation_factor=parameters.recuperation_factor,
        loss_kind="copper",
        amperes_per_newton=amperes_per_newton,
    )
