"""The parameters of a vehicle's drive, one model a kind; the physics is in `railjoule.core.drive`."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from railjoule.core.scenario._base import Count, Number, Part

Efficiency = Annotated[Number, Field(gt=0, le=1)]
Resistance = Annotated[Number, Field(gt=0, le=100)]
Inductance = Annotated[Number, Field(gt=0, le=1e5)]
Current = Annotated[Number, Field(gt=0, le=1e5)]


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


class Induction(DriveParameters):
    """Induction machines under vector control; currents and voltages are amplitudes per phase, losses per motor."""

    model: Literal["induction"]
    motors: Count = Field(ge=1, le=200, description="Number of traction motors of the train.")
    gear_ratio: Number = Field(gt=0, le=50, description="Turns of the motor in one turn of the wheel.")
    wheel_diameter_m: Number = Field(gt=0, le=5, description="Mean diameter of the driving wheels [m].")
    gear_efficiency: Efficiency = Field(description="What the gear lets through of the power, either way.")
    pole_pairs: Count = Field(ge=1, le=50, description="Pole pairs of a motor.")
    stator_resistance_ohm: Resistance = Field(description="Resistance of a stator phase [ohm].")
    rotor_resistance_ohm: Resistance = Field(description="Resistance of a rotor phase, seen from the stator [ohm].")
    stator_inductance_mh: Inductance = Field(description="Self inductance of a stator phase [mH].")
    rotor_inductance_mh: Inductance = Field(description="Self inductance of a rotor phase [mH].")
    mutual_inductance_mh: Inductance = Field(description="Inductance between stator and rotor [mH].")
    rated_magnetising_current_a: Current = Field(description="Current that makes the rated flux [A].")
    rated_frequency_hz: Number = Field(gt=0, le=1000, description="Frequency at which the iron losses hold [Hz].")
    hysteresis_loss_w: Number = Field(ge=0, le=1e6, description="Of one motor at rated flux and frequency [W].")
    eddy_loss_w: Number = Field(ge=0, le=1e6, description="Of one motor at rated flux and frequency [W].")
    mechanical_loss_torque_nm: Number = Field(ge=0, le=1e5, description="Torque that friction in a motor takes [N m].")
    max_phase_voltage_v: Number = Field(gt=0, le=1e5, description="Largest voltage of a phase [V].")
    starting_current_a: Current = Field(description="Largest current of a motor in driving [A].")
    braking_current_a: Current = Field(description="Largest current of a motor in braking [A].")
    standstill_brake: bool = Field(
        False, strict=True, description="A mechanical brake does what the motors could only do with power of the line."
    )

    @model_validator(mode="after")
    def _is_a_machine(self) -> Self:
        for side in ("stator", "rotor"):
            own = getattr(self, f"{side}_inductance_mh")
            if self.mutual_inductance_mh >= own:
                raise ValueError(
                    f"mutual_inductance_mh = {self.mutual_inductance_mh:g} must be below "
                    f"{side}_inductance_mh = {own:g}, which includes it"
                )
        for way in ("starting", "braking"):
            current = getattr(self, f"{way}_current_a")
            if current <= self.rated_magnetising_current_a:
                raise ValueError(
                    f"{way}_current_a = {current:g} must be above "
                    f"rated_magnetising_current_a = {self.rated_magnetising_current_a:g}"
                )
        return self


Drive = Annotated[ConstantEfficiency | CopperLoss | Induction, Field(discriminator="model")]
"""Any kind of drive; the key `model` tells which."""
