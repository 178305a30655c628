"""The loss models of drives, each from its formula: the supply power for an effort at a speed, and the losses.

Power at the drive's terminals = F v + losses, F < 0 in electric braking; the supply takes back the share kr of the
generated power, and a draw in braking counts in full. With x = gear ratio over wheel radius, n motors, speed w = x v:

    constant efficiency   driving F v / eta, braking F v eta_b
    copper loss           R i^2 in each motor, i = F / (n k x), k its torque per ampere
    loss polynomial       p0 + k1 w + k2 w^2 + c1 M + c2 M^2 in each motor that is on, and g |F v| in the gears;
                          M = |F| (1 + g) / (n x) driving, |F| (1 - g) / (n x) braking

Maps, induction and synchronous machines have files of their own.
Sources: Ftorek et al. 2025, (11); Shtompel, Khvorost 2025, (8)-(12); the polynomial is the scenario format's.
"""

import numpy as np

from railjoule.core.arrays import FloatArray

# the imported modules add their models to `LOSS_MODELS`
from railjoule.core.check import induction as _induction  # noqa: F401
from railjoule.core.check import loss_map as _loss_map  # noqa: F401
from railjoule.core.check import synchronous as _synchronous  # noqa: F401
from railjoule.core.check.loss_model import LOSS_MODELS, GearedModel, Losses, LossModel
from railjoule.core.errors import ScenarioError
from railjoule.core.scenario.drive import DriveParameters


class ConstantEfficiencyModel(LossModel, model="constant_efficiency"):
    """A fixed share of the power."""

    def losses_w(self, effort_n: FloatArray, speed_ms: FloatArray) -> Losses:
        """Return the losses by kind [W]."""
        driving = self.parameters.traction_efficiency
        braking = self.parameters.braking_efficiency or driving
        work = effort_n * speed_ms
        # eta is on the side of the supply in driving, P = F v / eta, and on that of the wheel in braking, P = F v eta
        return {"drive": np.where(work > 0, work * (1 / driving - 1), -work * (1 - braking))}


class CopperModel(LossModel, model="copper_loss"):
    """Losses in the windings only."""

    def losses_w(self, effort_n: FloatArray, speed_ms: FloatArray) -> Losses:
        """Return the losses by kind [W]."""
        drive = self.parameters
        return {"copper": drive.motors * drive.resistance_ohm * self.current_a(effort_n, speed_ms) ** 2}

    def current_a(self, effort_n: FloatArray, speed_ms: FloatArray) -> FloatArray:
        """Return the current of a motor [A]."""
        drive = self.parameters
        # the gear has no loss in this model, as its source has none
        lever = drive.gear_ratio / (0.5 * drive.wheel_diameter_m)
        return np.asarray(effort_n / (drive.motors * drive.torque_per_amp_nm * lever))


class PolynomialModel(GearedModel, model="loss_polynomial"):
    """A polynomial of torque and speed, and the gears."""

    def losses_w(self, effort_n: FloatArray, speed_ms: FloatArray) -> Losses:
        """Return the losses by kind [W]."""
        drive, torque = self.parameters, np.abs(self.shaft_torque_nm(effort_n))
        speed = self.turns_per_metre * speed_ms
        by_speed = drive.speed_loss_w_per_rads * speed + drive.speed_loss_w_per_rads2 * speed**2
        by_torque = drive.torque_loss_w_per_nm * torque + drive.torque_loss_w_per_nm2 * torque**2
        of_one = drive.no_load_loss_w + by_speed + by_torque
        return {"motors_and_inverters": drive.motors * of_one, "gear": self.gear_loss_w(effort_n, speed_ms)}


def loss_model(parameters: DriveParameters) -> LossModel:
    """Return the loss model of a drive.

    Raises
    ------
    ScenarioError
        If the check has no formula for this kind of drive.
    """
    name = getattr(parameters, "model", "")
    if name not in LOSS_MODELS:
        raise ScenarioError(
            f"drive.model = '{name}' has no formula in the check: it needs a class in core/check/drives.py. Solve "
            "without the check until then."
        )
    return LOSS_MODELS[name](parameters)
