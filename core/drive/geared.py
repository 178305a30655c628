"""A drive of several motors whose gears lose a share of the power at the wheels."""

from dataclasses import dataclass

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.drive.drive import Drive
from railjoule.core.drive.line_power import resistor_power

# what rounding and the solver's tolerance of 1e-8 leave of an effort where a run coasts is less than this share of a
# large one: the motors are off, and take no idle power
NEGLIGIBLE_SHARE = 1e-7


@dataclass(frozen=True, eq=False)
class GearedDrive(Drive):
    """A drive whose account tells the gears' losses from those of motors and inverters.

    Parameters
    ----------
    gear_loss_share : float
        Lost in the gears, over the power at the wheels.
    """

    gear_loss_share: float

    def losses_w(self, effort_n: FloatArray, speed_ms: FloatArray) -> dict[str, FloatArray]:
        """Return the losses by kind [W]: of motors with their inverters, of gears, and of brake resistors."""
        power = self.electrical_power_w(effort_n, speed_ms)
        work = np.multiply(effort_n, speed_ms)
        gear = np.where(power == 0, 0.0, self.gear_loss_share * np.abs(work))
        return {
            self.loss_kind: power - work - gear,
            "gear": gear,
            "brake_resistors": resistor_power(power, self.recuperation_factor),
        }
