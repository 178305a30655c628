"""Where a run's energy goes: from the line through the drive to the wheels, and back."""

from dataclasses import dataclass

import numpy as np

from railjoule.core.energy import Energy
from railjoule.core.trajectory import Trajectory

BRAKES = ("brake_resistors", "friction_brakes")
"""Losses that do not arise in the drive."""


@dataclass(frozen=True)
class EnergyFlow:
    """The energy account of a run, with what passes the wheels [J].

    Parameters
    ----------
    energy : Energy
        The account.
    wheel_traction_j : float
        Given to the wheels by the drive.
    wheel_braking_j : float
        Taken from the wheels by the electric brake.
    """

    energy: Energy
    wheel_traction_j: float
    wheel_braking_j: float

    @property
    def driving_loss_j(self) -> float:
        """Lost in the drive between line and wheels [J]."""
        return self.energy.traction_j - self.wheel_traction_j

    @property
    def braking_loss_j(self) -> float:
        """Lost in the drive between wheels, and line or brake resistors [J]."""
        return self.wheel_braking_j - self.energy.recuperated_j - self.brake_resistors_j

    @property
    def brake_resistors_j(self) -> float:
        """Dissipated in resistors [J]."""
        return self.energy.losses_j.get("brake_resistors", 0.0)

    @property
    def friction_brakes_j(self) -> float:
        """Dissipated in friction brakes [J]."""
        return self.energy.losses_j.get("friction_brakes", 0.0)

    @property
    def imbalance(self) -> float:
        """Losses of the drive both ways less those of the account, over the energy that moved; 0 if it closes."""
        # from both ends: what goes in less what comes out of the drive must be the losses that its formulas tell
        drive_j = sum(joules for kind, joules in self.energy.losses_j.items() if kind not in BRAKES)
        moved_j = max(self.energy.traction_j + self.energy.recuperated_j, 1.0)
        # the fields of the motors lie between the supply and the wheels, too
        drive_j += self.energy.magnetic_field_j
        return (self.driving_loss_j + self.braking_loss_j - drive_j) / moved_j


def energy_flow(run: Trajectory) -> EnergyFlow:
    """Return a run's account with what passes the wheels."""
    # 0 where the train stands, so that dwells do no work at the wheels
    length = np.diff(run.position_m)
    return EnergyFlow(
        energy=run.energy,
        wheel_traction_j=float(np.sum(run.tractive_effort_n * length)),
        wheel_braking_j=float(np.sum(run.electric_braking_n * length)),
    )
