"""The parameters of a vehicle's drive, one model a kind; the physics is in `railjoule.core.drive`."""

from typing import Annotated, Literal

from pydantic import Field

from railjoule.core.scenario._base import Count, Number, Part

Efficiency = Annotated[Number, Field(gt=0, le=1)]


class DriveParameters(Part):
    """What every kind of drive has."""

    recuperation_factor: Number = Field(
        0.0, ge=0, le=1, description="Share of the generated electrical energy that the line takes back."
    )


class ConstantEfficiency(DriveParameters):
    """A drive whose losses are a fixed share of its power."""

    model: Literal["constant_efficiency"]
    traction_efficiency: Efficiency = Field(description="Wheel power over line power when driving.")
    braking_efficiency: Efficiency | None = Field(
        None, description="Generated over wheel power when braking; as in traction where absent."
    )


class CopperLoss(DriveParameters):
    """A drive that loses power only in the windings of its motors."""

    model: Literal["copper_loss"]
    motors: Count = Field(ge=1, le=200, description="Number of traction motors of the train.")
    gear_ratio: Number = Field(gt=0, le=50, description="Turns of the motor in one turn of the wheel.")
    wheel_diameter_m: Number = Field(gt=0, le=5, description="Mean diameter of the driving wheels [m].")
    torque_per_amp_nm: Number = Field(gt=0, le=1e4, description="Torque of one motor per ampere [N m/A].")
    resistance_ohm: Number = Field(ge=0, le=100, description="Resistance that loses R i^2 in one motor [ohm].")


Drive = Annotated[ConstantEfficiency | CopperLoss, Field(discriminator="model")]
"""Any kind of drive; the key `model` tells which."""
