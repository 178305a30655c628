"""Make a drive from the parameters of a scenario."""

from collections.abc import Callable
from functools import lru_cache
from typing import Any

from railjoule.core.arrays import frozen_array
from railjoule.core.drive.drive import Drive
from railjoule.core.drive.efficiency_map import make_efficiency_map_drive
from railjoule.core.drive.geared import NEGLIGIBLE_SHARE, GearedDrive
from railjoule.core.drive.geared_parameters import turns_per_metre
from railjoule.core.drive.induction.drive import make_induction_drive
from railjoule.core.drive.kinds import CONSTANT_EFFICIENCY, COPPER_LOSS, LOSS_POLYNOMIAL
from railjoule.core.drive.synchronous.drive import make_synchronous_drive
from railjoule.core.scenario.drive import (
    ConstantEfficiency,
    CopperLoss,
    DriveParameters,
    EfficiencyMap,
    Induction,
    LossPolynomial,
    Synchronous,
)


def _constant_efficiency(parameters: ConstantEfficiency) -> Drive:
    # a vehicle of which one efficiency is known has it both ways
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
    turns = turns_per_metre(parameters)
    # F = motors k x i, and the losses of all motors are motors R i^2
    amperes_per_newton = 1 / (parameters.motors * parameters.torque_per_amp_nm * turns)
    return Drive(
        kind=COPPER_LOSS,
        parameters=frozen_array([parameters.motors * parameters.resistance_ohm * amperes_per_newton**2]),
        recuperation_factor=parameters.recuperation_factor,
        loss_kind="copper",
        amperes_per_newton=amperes_per_newton,
    )


def _loss_polynomial(parameters: LossPolynomial) -> GearedDrive:
    """Return a drive whose effort counts as rounding beside that of a hundred newton metres of each motor."""
    turns = turns_per_metre(parameters)
    # a polynomial of losses names no largest torque: a traction motor of 100 N m would be a small one
    large_effort_n = 100 * parameters.motors * turns
    return GearedDrive(
        kind=LOSS_POLYNOMIAL,
        parameters=frozen_array(
            [
                parameters.motors,
                turns,
                parameters.gear_loss_share,
                NEGLIGIBLE_SHARE * large_effort_n,
                parameters.no_load_loss_w,
                parameters.speed_loss_w_per_rads,
                parameters.speed_loss_w_per_rads2,
                parameters.torque_loss_w_per_nm,
                parameters.torque_loss_w_per_nm2,
            ]
        ),
        recuperation_factor=parameters.recuperation_factor,
        loss_kind="motors_and_inverters",
        amperes_per_newton=None,
        gear_loss_share=parameters.gear_loss_share,
    )


MAKERS: dict[type[DriveParameters], Callable[[Any], Drive]] = {
    ConstantEfficiency: _constant_efficiency,
    CopperLoss: _copper_loss,
    Induction: make_induction_drive,
    LossPolynomial: _loss_polynomial,
    EfficiencyMap: make_efficiency_map_drive,
    Synchronous: make_synchronous_drive,
}
"""What makes a drive of the parameters of each kind."""


@lru_cache(maxsize=32)
def make_drive(parameters: DriveParameters) -> Drive:
    """Return the drive that the validated `parameters` of a scenario describe; kept for the next call."""
    return MAKERS[type(parameters)](parameters)
