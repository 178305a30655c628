"""The parameters of a vehicle's drive, one model a kind; the physics is in `railjoule.core.drive`."""

from typing import Annotated, ClassVar, Literal, Self

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


Efficiency = Annotated[Number, Field(gt=0, le=1)]
Inductance = Annotated[Number, Field(gt=0, le=1e5)]
Current = Annotated[Number, Field(gt=0, le=1e5)]
MapPoint = tuple[
    Annotated[Number, Field(ge=-1e6, le=1e6)],
    Annotated[Number, Field(ge=0, le=1e5)],
    Annotated[Number, Field(ge=0, le=1)],
]
# Losses are extrapolated to no torque and no speed by a parabola through the next three points, and a torque or speed
# of 0 is one of the values.
MIN_MAP_POINTS = 3
"""Torques and speeds that an efficiency map has at least."""
MIN_POINTS = MIN_MAP_POINTS**2


class DriveParameters(Part):
    """The keys of every kind of drive."""

    recuperation_factor: Number = Field(
        0.0, ge=0, le=1, description="Share of the generated electrical energy that is recuperated."
    )

    voltage_key: ClassVar[str | None] = None
    """The key of a voltage that goes with that of the line and limits the effort."""

    @property
    def has_voltage_limit(self) -> bool:
        """Whether the line voltage limits the effort of this kind of drive."""
        return self.voltage_key is not None

    @property
    def stays_for_s(self) -> float:
        """For how long the drive stays on or off at least [s]; 0 where nothing is saved by switching it."""
        return getattr(self, "least_switching_s", 0.0)

    def at_voltage(self, factor: float) -> Self:
        """Return the drive at a line voltage that is `factor` times the nominal one; itself where it has none."""
        if self.voltage_key is None:
            return self
        return self.model_copy(update={self.voltage_key: factor * getattr(self, self.voltage_key)})


class MotorDrive(DriveParameters):
    """The keys of drives with motors behind gears."""

    motors: Count = Field(ge=1, le=200, description="Number of traction motors of the train.")
    gear_ratio: Number = Field(gt=0, le=50, description="Turns of the motor in one turn of the wheel.")
    wheel_diameter_m: Number = Field(gt=0, le=5, description="Mean diameter of the driving wheels [m].")


class IdlingDrive(DriveParameters):
    """The keys of drives with idle losses, which save energy by being on for a part of the time."""

    # Assumed: within the jerk that passengers bear, about 1 m/s3, an effort for 1 m/s2 takes a second to build up and
    # as long to take back, so that less than this is hardly there. Against switching in any cell it costs the shipped
    # trams 0.01 % and the metros 0.1 % at most; 5 s cost 0.26 %
    least_switching_s: Number = Field(
        2.0, ge=0, le=60, description="For how long the drive stays on or off at least; 0 for as short as a cell [s]."
    )


class ConstantEfficiency(DriveParameters):
    """A drive whose losses are a fixed share of its power."""

    model: Literal["constant_efficiency"]
    traction_efficiency: Efficiency = Field(description="Wheel power over supply power when driving.")
    braking_efficiency: Efficiency | None = Field(
        None, description="Generated over wheel power when braking; by default as in traction."
    )


class CopperLoss(MotorDrive):
    """A drive that loses power only in the windings of its motors."""

    model: Literal["copper_loss"]
    torque_per_amp_nm: Number = Field(gt=0, le=1e4, description="Torque of one motor per ampere [N m/A].")
    resistance_ohm: Number = Field(ge=0, le=100, description="Resistance that loses R i^2 in one motor [ohm].")
    machine: InductionMachine | None = Field(
        None, description="The machine itself, for runs in closed loop; the loss model does not use it."
    )

    def at_voltage(self, factor: float) -> Self:
        """Return the drive with the machine's voltage times a factor: it limits the effort only in closed loop."""
        if self.machine is None:
            return self
        limit = factor * self.machine.max_phase_voltage_v
        return self.model_copy(update={"machine": self.machine.model_copy(update={"max_phase_voltage_v": limit})})


class Induction(MotorDrive, IdlingDrive):
    """Induction machines under vector control; currents and voltages are amplitudes per phase, losses per motor."""

    model: Literal["induction"]
    voltage_key = "max_phase_voltage_v"
    gear_efficiency: Efficiency = Field(description="Gear efficiency, in both directions.")
    pole_pairs: Count = Field(ge=1, le=50, description="Pole pairs of a motor.")
    stator_resistance_ohm: Resistance = Field(description="Resistance of a stator phase [ohm].")
    rotor_resistance_ohm: Resistance = Field(description="Resistance of a rotor phase, seen from the stator [ohm].")
    stator_inductance_mh: Inductance = Field(description="Self inductance of a stator phase [mH].")
    rotor_inductance_mh: Inductance = Field(description="Self inductance of a rotor phase [mH].")
    # Bounds of numbers in this file are wide: they stop slips of units, as of ohm for milliohm or watt for kilowatt,
    # and numbers whose squares would overflow, not unusual machines.
    mutual_inductance_mh: Inductance = Field(description="Inductance between stator and rotor [mH].")
    rated_magnetising_current_a: Current = Field(description="Current that produces the rated flux [A].")
    rated_frequency_hz: Number = Field(gt=0, le=1000, description="Frequency at which the iron losses are given [Hz].")
    hysteresis_loss_w: Number = Field(ge=0, le=1e6, description="Of one motor at rated flux and frequency [W].")
    eddy_loss_w: Number = Field(ge=0, le=1e6, description="Of one motor at rated flux and frequency [W].")
    mechanical_loss_torque_nm: Number = Field(ge=0, le=1e5, description="Torque that friction in a motor takes [N m].")
    max_phase_voltage_v: Number = Field(gt=0, le=1e5, description="Largest voltage of a phase [V].")
    starting_current_a: Current = Field(description="Largest current of a motor in driving [A].")
    braking_current_a: Current = Field(description="Largest current of a motor in braking [A].")
    standstill_brake: bool = Field(
        False, strict=True, description="A mechanical brake replaces motor braking that would draw power."
    )

    @model_validator(mode="after")
    def _is_a_machine(self) -> Self:
        for side in ("stator", "rotor"):
            own = getattr(self, f"{side}_inductance_mh")
            # the leakage Ls - M is what limits the voltage and thus the pull-out torque: at 0 there would be no limit
            # at all
            if self.mutual_inductance_mh >= own:
                raise ValueError(
                    f"mutual_inductance_mh = {self.mutual_inductance_mh:g} must be below "
                    f"{side}_inductance_mh = {own:g}, which includes it"
                )
        for regime in ("starting", "braking"):
            current = getattr(self, f"{regime}_current_a")
            # torque needs sqrt(I^2 - Imu^2) beside the rated flux: below this no start would have any torque
            if current <= self.rated_magnetising_current_a:
                raise ValueError(
                    f"{regime}_current_a = {current:g} must be above "
                    f"rated_magnetising_current_a = {self.rated_magnetising_current_a:g}"
                )
        return self


class GearedMotors(MotorDrive, IdlingDrive):
    """The keys of drives with known losses of each motor with its inverter."""

    # below 1, as braking passes F v (1 - g) on to the shaft: at 1 the electric brake would have nothing to work with
    gear_loss_share: Number = Field(0.0, ge=0, lt=1, description="Gear loss over the power at the wheels.")


class LossPolynomial(GearedMotors):
    """A drive whose losses are a polynomial of torque and speed of a motor, zero when it is off."""

    model: Literal["loss_polynomial"]
    no_load_loss_w: Number = Field(0.0, ge=0, le=1e6, description="Of one motor that is on [W].")
    speed_loss_w_per_rads: Number = Field(0.0, ge=0, le=1e5, description="Loss over speed of the motor [W/(rad/s)].")
    speed_loss_w_per_rads2: Number = Field(0.0, ge=0, le=1e4, description="Loss over squared motor speed [W/(rad/s)2].")
    torque_loss_w_per_nm: Number = Field(0.0, ge=0, le=1e5, description="Loss over torque of the motor [W/(N m)].")
    torque_loss_w_per_nm2: Number = Field(0.0, ge=0, le=1e4, description="Loss over squared motor torque [W/(N m)2].")


class EfficiencyMap(GearedMotors):
    """A drive whose efficiency is known over torque and speed of a motor, from zero; negative torque brakes."""

    model: Literal["efficiency_map"]
    points: tuple[MapPoint, ...] = Field(
        min_length=MIN_POINTS, max_length=100_000, description="Torque [N m], speed [rad/s], efficiency; rising."
    )

    @model_validator(mode="after")
    def _has_no_holes(self) -> Self:
        # Each test relies on those before it: with rising points, none of them twice, a point for each pair of values
        # is a full grid; only then do its first values and its efficiencies mean something.
        places = [(torque, speed) for torque, speed, _ in self.points]
        if places != sorted(places) and places != sorted(places, key=lambda place: place[::-1]):
            raise ValueError("points must rise in torque_nm and then in speed_rads, or the other way round")
        torques, speeds = sorted({torque for torque, _ in places}), sorted({speed for _, speed in places})
        there = set(places)
        if len(there) < len(places):
            raise ValueError("points has one point twice")
        for torque in torques:
            for speed in speeds:
                if (torque, speed) not in there:
                    raise ValueError(f"points has no value at torque_nm = {torque:g}, speed_rads = {speed:g}")
        if 0 not in torques or speeds[0] != 0:
            raise ValueError("points must begin at torque_nm = 0 and speed_rads = 0, where a train starts")
        for first, least in (("torque_nm", [t for t in torques if t >= 0]), ("speed_rads", speeds)):
            if len(least) < MIN_MAP_POINTS:
                raise ValueError(f"points need {MIN_MAP_POINTS} values of {first} from 0 on")
        for torque, speed, efficiency in self.points:
            # driving loss is M w (1 / eta - 1); in braking an efficiency of 0 is a machine that generates nothing,
            # which exists
            if efficiency <= 0 < torque * speed:
                raise ValueError(
                    f"points has efficiency = {efficiency:g} at torque_nm = {torque:g}, speed_rads = {speed:g}; "
                    "it must be above 0 in driving"
                )
        return self


class Synchronous(GearedMotors):
    """Permanent-magnet-assisted synchronous reluctance machines, each with its inverter; amplitudes per phase."""

    model: Literal["synchronous"]
    voltage_key = "link_voltage_v"
    pole_pairs: Count = Field(ge=1, le=50, description="Pole pairs of a motor.")
    magnet_flux_vs: Number = Field(gt=0, le=100, description="Flux linkage of the magnets in a phase [V s].")
    direct_inductance_mh: Inductance = Field(description="Inductance along the magnets [mH].")
    quadrature_inductance_mh: Inductance = Field(description="Inductance across the magnets [mH].")
    stator_resistance_ohm: Resistance = Field(description="Resistance of a stator phase to direct current [ohm].")
    conductor_height_mm: Number = Field(gt=0, le=50, description="Height of a conductor in its slot [mm].")
    conductor_layers: Count = Field(ge=1, le=100, description="Conductors stacked in a slot.")
    max_current_a: Current = Field(description="Largest current of a phase [A].")
    max_speed_rads: Number = Field(gt=0, le=1e4, description="Largest speed of the motor [rad/s].")
    rated_frequency_hz: Number = Field(gt=0, le=1000, description="Frequency at which the iron losses are given [Hz].")
    rated_flux_vs: Number = Field(gt=0, le=100, description="Flux linkage at which the iron losses are given [V s].")
    hysteresis_loss_w: Number = Field(ge=0, le=1e6, description="Of one motor at rated flux and frequency [W].")
    eddy_loss_w: Number = Field(ge=0, le=1e6, description="Of one motor at rated flux and frequency [W].")
    mechanical_loss_torque_nm: Number = Field(ge=0, le=1e5, description="Torque that friction in a motor takes [N m].")
    ventilation_loss_w_per_rads3: Number = Field(0.0, ge=0, le=1, description="Loss over the cube of speed.")
    modulation: Literal["space_vector", "six_step"] = Field(
        "six_step", description="Space vectors only, or block operation where they do not give enough voltage."
    )
    link_voltage_v: Number = Field(gt=0, le=1e5, description="Voltage of the direct-current link [V].")
    # from 50 Hz on: far below, side bands of the carrier fall on the fundamental and are no harmonics any more
    switching_frequency_hz: Number = Field(ge=50, le=1e5, description="Carrier of the modulation [Hz].")
    device_threshold_v: Number = Field(ge=0, le=100, description="Voltage of a conducting device at no current [V].")
    device_resistance_ohm: Number = Field(ge=0, le=1, description="Rise of that voltage with current [ohm].")
    switching_energy_j: Number = Field(ge=0, le=100, description="Turn-on, turn-off and recovery of one leg [J].")
    switching_current_a: Current = Field(description="Current at which that energy is given [A].")
    switching_voltage_v: Number = Field(gt=0, le=1e5, description="Voltage at which that energy is given [V].")
    harmonic_losses: bool = Field(
        True, strict=True, description="The harmonics of the inverter heat the windings; if false, they are left out."
    )

    @model_validator(mode="after")
    def _is_a_machine(self) -> Self:
        # The formulas take the reluctance torque -(Lq - Ld) id iq with id <= 0. Without saliency, or with one of the
        # other sign, the current of least loss lies elsewhere.
        if self.quadrature_inductance_mh <= self.direct_inductance_mh:
            raise ValueError(
                f"quadrature_inductance_mh = {self.quadrature_inductance_mh:g} must be above "
                f"direct_inductance_mh = {self.direct_inductance_mh:g}"
            )
        return self


Drive = Annotated[
    ConstantEfficiency | CopperLoss | Induction | LossPolynomial | EfficiencyMap | Synchronous,
    Field(discriminator="model"),
]
"""Any kind of drive, by the key `model`."""
