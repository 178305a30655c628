"""The numbers with which the parameters of every drive of geared motors begin."""

from railjoule.core.scenario.drive import CopperLoss, GearedMotors, Induction

PARAMETERS = ("motors", "turns_per_metre", "gear_loss_share", "negligible_effort_n")
"""What they are, in order; those of the losses of a motor follow."""

MOTORS, TURNS, GEAR_LOSS, NEGLIGIBLE = range(len(PARAMETERS))
LOSSES = len(PARAMETERS)
"""Where those of the losses begin."""


def turns_per_metre(drive: CopperLoss | Induction | GearedMotors) -> float:
    """Return the angle of a motor over the distance of the train, gear ratio over wheel radius [1/m]."""
    return drive.gear_ratio / (0.5 * drive.wheel_diameter_m)
