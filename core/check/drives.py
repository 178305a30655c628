"""The loss models of drives, each from its formula: what the line gives for an effort at a speed, and what is lost.

Power at the drive's terminals = F v + losses, F < 0 in electric braking; the line takes back the share kr of what is
generated, and a draw in braking counts in full. With x = gear ratio over wheel radius, n motors, speed w = x v:

    constant efficiency   driving F v / eta, braking F v eta_b
    copper loss           R i^2 in each motor, i = F / (n k x), k its torque per ampere
    loss polynomial       p0 + k1 w + k2 w^2 + c1 M + c2 M^2 in each motor that is on, and g |F v| in the gears;
                          M = |F| (1 + g) / (n x) driving, |F| (1 - g) / (n x) braking

Maps, induction and synchronous machines have files of their own.
Sources: Ftorek et al. 2025, (11); Shtompel, Khvorost 2025, (8)-(12); the polynomial is the scenario format's.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.check.induction import InductionLosses
from railjoule.core.check.loss_map import MapLosses
from railjoule.core.check.loss_model import (
    EXACT,
    Losses,
    LossModel,
    geared_losses_w,
    shaft_torque_nm,
    turns_per_metre,
)
from railjoule.core.check.synchronous import SynchronousLosses
from railjoule.core.errors import ScenarioError
from railjoule.core.scenario.drive import (
    ConstantEfficiency,
    CopperLoss,
    DriveParameters,
    EfficiencyMap,
    Induction,
    LossPolynomial,
    Synchronous,
)


# Written from the formulas with numpy alone. The kernels of `core/drive` would be quicker and would repeat their own
# errors: a wrong sign there could never be found here.
class _WithoutMotorLimit:
    """A model that sets no limit of its own."""

    accuracy = EXACT

    def largest_effort_n(self, speed_ms: FloatArray, braking: bool) -> FloatArray:
        return np.full(len(speed_ms), np.inf)

    def current_a(self, effort_n: FloatArray, speed_ms: FloatArray) -> FloatArray | None:
        return None


@dataclass(frozen=True)
class ConstantEfficiencyLosses(_WithoutMotorLimit):
    """A fixed share of the power."""

    parameters: ConstantEfficiency

    def losses_w(self, effort_n: FloatArray, speed_ms: FloatArray) -> Losses:
        """Return the losses by kind [W]."""
        driving = self.parameters.traction_efficiency
        braking = self.parameters.braking_efficiency or driving
        work = effort_n * speed_ms
        # eta stands on the side of the line when driving, P = F v / eta, and on that of the wheel when braking, P = F
        # v eta
        return {"drive": np.where(work > 0, work * (1 / driving - 1), -work * (1 - braking))}


@dataclass(frozen=True)
class CopperLosses(_WithoutMotorLimit):
    """The windings alone."""

    parameters: CopperLoss

    def losses_w(self, effort_n: FloatArray, speed_ms: FloatArray) -> Losses:
        """Return the losses by kind [W]."""
        return {
            "copper": self.parameters.motors * self.parameters.resistance_ohm * self.current_a(effort_n, speed_ms) ** 2
        }

    def current_a(self, effort_n: FloatArray, speed_ms: FloatArray) -> FloatArray:
        """Return the current of a motor [A], negative in braking."""
        drive = self.parameters
        # torque of all motors over effort of the train: no loss in the gear in this model, as its source has none
        lever = drive.gear_ratio / (0.5 * drive.wheel_diameter_m)
        return effort_n / (drive.motors * drive.torque_per_amp_nm * lever)


@dataclass(frozen=True)
class PolynomialLosses(_WithoutMotorLimit):
    """A polynomial of torque and speed, and the gears."""

    parameters: LossPolynomial

    def losses_w(self, effort_n: FloatArray, speed_ms: FloatArray) -> Losses:
        """Return the losses by kind [W]."""
        drive, torque = self.parameters, np.abs(shaft_torque_nm(self.parameters, effort_n))
        speed = turns_per_metre(drive) * speed_ms
        by_speed = drive.speed_loss_w_per_rads * speed + drive.speed_loss_w_per_rads2 * speed**2
        by_torque = drive.torque_loss_w_per_nm * torque + drive.torque_loss_w_per_nm2 * torque**2
        return geared_losses_w(drive, effort_n, speed_ms, drive.no_load_loss_w + by_speed + by_torque)


LOSS_MODELS: dict[type[DriveParameters], Callable[[Any], LossModel]] = {
    ConstantEfficiency: ConstantEfficiencyLosses,
    CopperLoss: CopperLosses,
    Induction: InductionLosses,
    LossPolynomial: PolynomialLosses,
    EfficiencyMap: MapLosses,
    Synchronous: SynchronousLosses,
}
"""The loss model of each kind of drive, by its parameters."""


def loss_model(parameters: DriveParameters) -> LossModel:
    """Return the loss model of a drive.

    Raises
    ------
    ScenarioError
        If the check has no formula for this kind of drive.
    """
    model = LOSS_MODELS.get(type(parameters))
    if model is None:
        raise ScenarioError(
            f"drive.model = '{getattr(parameters, 'model', '')}' has no formula in the check: it needs an entry in "
            "LOSS_MODELS in core/check/drives.py. Solve without the check until then."
        )
    return model(parameters)
