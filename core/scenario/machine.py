"""The induction machine of a drive with only copper loss, for runs in closed loop."""

from typing import Annotated, Self

from pydantic import Field, model_validator

from railjoule.core.scenario._base import Count, Number, Part
from railjoule.core.units import H_PER_MH

Resistance = Annotated[Number, Field(gt=0, le=100)]


class InductionMachine(Part):
    """One induction machine, its T circuit seen from the stator; currents and voltages are amplitudes per phase."""

    pole_pairs: Count = Field(ge=1, le=50, description="Pole pairs of a motor.")
    stator_resistance_ohm: Resistance = Field(description="Resistance of a stator phase [ohm].")
    rotor_resistance_ohm: Resistance = Field(description="Resistance of a rotor phase, seen from the stator [ohm].")
    mutual_inductance_mh: Number = Field(gt=0, le=1e5, description="Inductance between stator and rotor [mH].")
    stator_leakage_mh: Number = Field(gt=0, le=1e4, description="Leakage inductance of a stator phase [mH].")
    rotor_leakage_mh: Number = Field(gt=0, le=1e4, description="Leakage inductance of a rotor phase [mH].")
    rotor_flux_vs: Number = Field(gt=0, le=1000, description="Rated flux linkage of the rotor [V s].")
    rated_frequency_hz: Number = Field(gt=0, le=1000, description="Frequency at which the iron losses are given [Hz].")
    hysteresis_loss_w: Number = Field(0.0, ge=0, le=1e6, description="Of one motor at rated flux and frequency [W].")
    eddy_loss_w: Number = Field(0.0, ge=0, le=1e6, description="Of one motor at rated flux and frequency [W].")
    max_current_a: Number = Field(gt=0, le=1e5, description="Largest current of the inverter in a phase [A].")
    max_phase_voltage_v: Number = Field(gt=0, le=1e5, description="Largest voltage of the inverter in a phase [V].")

    @model_validator(mode="after")
    def _carries_its_flux(self) -> Self:
        # torque needs sqrt(I^2 - Imu^2) beside the flux; the control weakens the flux for the voltage, never to start
        if self.max_current_a <= self.magnetising_current_a:
            raise ValueError(
                f"max_current_a = {self.max_current_a:g} must be above rotor_flux_vs / mutual_inductance_mh = "
                f"{self.magnetising_current_a:.4g} A, which produces the rated flux"
            )
        return self

    @property
    def stator_inductance_mh(self) -> float:
        """Self inductance of a stator phase [mH]."""
        return self.mutual_inductance_mh + self.stator_leakage_mh

    @property
    def rotor_inductance_mh(self) -> float:
        """Self inductance of a rotor phase [mH]."""
        return self.mutual_inductance_mh + self.rotor_leakage_mh

    @property
    def magnetising_current_a(self) -> float:
        """Current that makes the rated flux [A]."""
        # in steady state the rotor has no current along its flux, so flux = M i: the leakage plays no part
        return self.rotor_flux_vs / (self.mutual_inductance_mh * H_PER_MH)
