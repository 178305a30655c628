"""A vehicle: masses, running resistance, limits of traction and braking, drive."""

from collections.abc import Iterable
from importlib import import_module
from itertools import pairwise
from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from railjoule.core.scenario._base import Count, Name, Number, Part, PresetPart
from railjoule.core.scenario.assumed import Assumed, require_known_keys, value_at
from railjoule.core.scenario.drive import Drive
from railjoule.core.scenario.resistance import Resistance, SpecificResistance
from railjoule.core.units import KG_PER_T

# standing passengers may be twice the seats of a metro car; more than three times is a number of passengers
MAX_LOAD_FACTOR = 3.0
"""Maximum for all vehicles: the capacity may count only seats, and standing passengers come on top."""
CurvePoint = tuple[Annotated[Number, Field(ge=0, le=600)], Annotated[Number, Field(ge=0, le=1e4)]]
DecelerationStep = tuple[Annotated[Number, Field(ge=0, le=600)], Annotated[Number, Field(gt=0, le=20)]]


def _require_rising_speeds(name: str, points: Iterable[tuple[float, float]]) -> None:
    # interpolation needs rising speeds, and a jump of the effort would leave its value there open
    if any(later[0] <= earlier[0] for earlier, later in pairwise(points)):
        raise ValueError(f"{name} must have rising speeds")


def _require_possible_steps(curve: Iterable[tuple[float, float]]) -> None:
    points = tuple(curve)
    if any(later[0] < earlier[0] for earlier, later in pairwise(points)):
        raise ValueError("curve must have rising speeds; two points at the same speed are a step")
    if any(last[0] == first[0] for first, _, last in zip(points, points[1:], points[2:], strict=False)):
        raise ValueError("curve has more than two points at the same speed: a step has one on each side")
    if len(points) > 1 and points[0][0] == points[1][0]:
        raise ValueError("curve begins with a step: nothing lies before it")


def _require_usable_curve(limits: "Traction | Braking") -> None:
    """Refuse a curve of effort that is none, and a breakdown of an effort that nothing limits."""
    _require_possible_steps(limits.curve or ())
    # a curve of zeros is a train that cannot start, or a brake that is none: that has a key of its own
    if limits.curve is not None and not any(effort > 0 for _, effort in limits.curve):
        raise ValueError("curve must have an effort above 0")
    # what falls with the square of the speed is the effort that these give at the breakdown
    given = (limits.max_effort_kn, limits.max_power_kw, limits.curve)
    if limits.breakdown_speed_kmh is not None and all(one is None for one in given):
        raise ValueError("breakdown_speed_kmh needs max_effort_kn, max_power_kw or curve")


class Traction(Part):
    """Limits while driving."""

    max_effort_kn: Number | None = Field(None, gt=0, le=1e4, description="Largest tractive effort [kN].")
    max_power_kw: Number | None = Field(None, gt=0, le=1e5, description="Largest power at the wheel [kW].")
    max_speed_kmh: Number = Field(gt=0, le=600, description="Largest speed of the vehicle [km/h].")
    # None is no limit of its own: effort, adhesion and passengers are then all in max_effort_kn
    max_acceleration_ms2: Number | None = Field(None, gt=0, le=20, description="Largest dv/dt [m/s2].")
    curve: tuple[CurvePoint, ...] | None = Field(
        None,
        min_length=2,
        max_length=1000,
        description="Largest tractive effort over speed, [[km/h, kN], ...]; beyond the last point its power goes on, "
        "two points at one speed are a step, at which the lower one holds.",
    )
    breakdown_speed_kmh: Number | None = Field(
        None, gt=0, le=600, description="From this speed on the effort falls with the square of the speed [km/h]."
    )

    @model_validator(mode="after")
    def _curve_can_be_followed(self) -> Self:
        _require_usable_curve(self)
        return self


class Braking(Part):
    """Limits while braking; effort and power are those of the electric brake."""

    # 0 is a train without an electric brake; None leaves the limit to the drive, which may have one
    max_effort_kn: Number | None = Field(None, ge=0, le=1e4, description="Largest electric braking effort [kN].")
    max_power_kw: Number | None = Field(None, gt=0, le=1e5, description="Largest electric braking power [kW].")
    friction_effort_kn: Number = Field(0.0, ge=0, le=1e4, description="Largest effort of the friction brakes [kN].")
    max_deceleration_ms2: Number | None = Field(None, gt=0, le=20, description="Largest -dv/dt [m/s2].")
    curve: tuple[CurvePoint, ...] | None = Field(
        None,
        min_length=2,
        max_length=1000,
        description="Largest electric braking effort over speed, [[km/h, kN], ...]; beyond the last point its power "
        "goes on, two points at one speed are a step, at which the lower one holds.",
    )
    breakdown_speed_kmh: Number | None = Field(
        None,
        gt=0,
        le=600,
        description="From this speed on the electric effort falls with the square of the speed [km/h].",
    )
    # what train protection supervises, whatever the brakes can do: no limit of the brakes but one of speed over place
    permitted_deceleration: tuple[DecelerationStep, ...] | None = Field(
        None,
        min_length=1,
        max_length=100,
        description="Braking curve before lower limits and stops, [[from km/h, m/s2], ...]: the deceleration with "
        "which it is computed from each speed up.",
    )

    @model_validator(mode="after")
    def _curves_can_be_followed(self) -> Self:
        _require_usable_curve(self)
        steps = self.permitted_deceleration or ()
        _require_rising_speeds("permitted_deceleration", steps)
        if steps and steps[0][0] != 0:
            raise ValueError(f"permitted_deceleration begins at {steps[0][0]:g} km/h, but must begin at 0")
        return self


class Adhesion(Part):
    """Masses on the axles that transmit forces to the rails; in force where the line has a `rail_condition`."""

    # no default: a train with trailing cars whose axles all counted as driven would pull more than it can
    driven_mass_share: Number | None = Field(
        None, gt=0, le=1, description="Mass on the driven axles, as a share of the total mass."
    )
    braked_mass_share: Number = Field(
        1.0, gt=0, le=1, description="Mass on the braked axles, as a share of the total mass."
    )
    # Koffman 1948; core/physics/adhesion.py names the source
    wet_share: Number = Field(0.6, gt=0, le=1, description="Adhesion on wet rails, as a share of that on dry rails.")

    @model_validator(mode="after")
    def _driven_axles_are_braked(self) -> Self:
        if self.driven_mass_share is not None and self.driven_mass_share > self.braked_mass_share:
            raise ValueError(
                f"driven_mass_share = {self.driven_mass_share:g} must be at most braked_mass_share = "
                f"{self.braked_mass_share:g}: the driven axles have the electric brake"
            )
        return self


class Vehicle(PresetPart):
    """One electric rail vehicle with its load."""

    preset_kind = "vehicles"
    name: Name = Field(max_length=200, description="Name of the vehicle.")
    tare_kg: Number = Field(gt=0, le=1e7, description="Mass of the empty vehicle [kg].")
    capacity_passengers: Number = Field(0, ge=0, le=1e5, description="Passengers that the vehicle can carry.")
    passenger_mass_kg: Number = Field(75.0, ge=0, le=500, description="Mass of one passenger [kg].")
    # of a freight train, instead of passengers
    max_load_t: Number | None = Field(None, gt=0, le=1e5, description="Capacity for freight [t].")
    load_factor: Number = Field(0.0, ge=0, le=MAX_LOAD_FACTOR, description="Share of the capacity on board.")
    load_t: Number | None = Field(None, ge=0, le=1e5, description="Load on board [t], instead of its share.")
    crush_load_factor: Number = Field(
        1.0, ge=1, le=MAX_LOAD_FACTOR, description="Largest load factor: above 1, crush load."
    )
    # two ways to say one thing, so exactly one of them: data sheets have either
    rotating_mass_factor: Number | None = Field(
        None, ge=0, le=5, description="Inertia of the rotating parts, as a share of the total mass."
    )
    inertial_mass_kg: Number | None = Field(
        None, gt=0, le=1e8, description="Inertia of the empty train, rotating parts included [kg]."
    )
    auxiliary_power_kw: Number = Field(0.0, ge=0, le=1e4, description="Power of light, heating and so on [kW].")
    line_voltage_v: Number | None = Field(
        None, gt=0, le=100_000, description="Nominal voltage of the supply, from which its current follows [V]."
    )
    # EN 13452-1 and suppliers of metros have 0.5 to 1.5 m/s3 in service braking, comfort of standing passengers less;
    # above some 10 a limit is none
    max_jerk_ms3: Number | None = Field(
        None, ge=0.05, le=10, description="Limit of the rate at which efforts change, over the inertia [m/s3]."
    )
    length_m: Number | None = Field(None, gt=0, le=5000, description="Length of the train [m]; if empty, a point.")
    car_count: Count | None = Field(None, ge=1, le=200, description="Equal cars that share the weight.")
    gradient_at: Literal["whole_train", "front", "middle"] = Field(
        "whole_train",
        description="Place where gradient, curve and tunnel act: under the whole train, or at one point.",
    )
    resistance: Resistance
    traction: Traction
    braking: Braking
    adhesion: Adhesion = Adhesion()
    drive: Drive
    # data and no comments, which would be lost when a scenario is saved
    assumed: tuple[Assumed, ...] = Field(
        (), max_length=100, description="Values that are assumed, with their formula and source."
    )

    @classmethod
    def from_data_sheet(cls, **sheet: Any) -> "Vehicle":
        """Return a vehicle of the values of a data sheet; all others are assumed and listed in `assumed`.

        Parameters
        ----------
        **sheet
            `mass_t`, `power_kw`, `max_speed_kmh`, `length_m`, one of `max_effort_kn` and `max_acceleration_ms2`, and
            what else the sheet gives: the fields of `railjoule.core.scenario.data_sheet.DataSheet`.

        Raises
        ------
        ScenarioError
            If a value is missing, unknown, of a wrong type or out of bounds, or has no effect.
        """
        # Data sheets import vehicles; after an import statement all kernels would depend on their formulas.
        module = import_module("railjoule.core.scenario.data_sheet")
        vehicle: Vehicle = module.DataSheet(**sheet).to_vehicle()
        return vehicle

    @model_validator(mode="after")
    def _assumed_values_are_of_known_keys(self) -> Self:
        require_known_keys(self)
        return self

    @property
    def assumptions(self) -> tuple[Assumed, ...]:
        """The assumed values that are in force: one that was replaced by another value is assumed no more."""
        return tuple(one for one in self.assumed if value_at(self, one.key) == one.value)

    @model_validator(mode="after")
    def _fits_together(self) -> Self:
        self._require_possible_load()
        if (self.rotating_mass_factor is None) == (self.inertial_mass_kg is None):
            raise ValueError("needs exactly one of rotating_mass_factor and inertial_mass_kg")
        if self.inertial_mass_kg is not None and self.inertial_mass_kg < self.tare_kg:
            raise ValueError(
                f"inertial_mass_kg = {self.inertial_mass_kg:g} is below tare_kg = {self.tare_kg:g}, which it includes"
            )
        if self.car_count is not None and self.length_m is None:
            raise ValueError("car_count needs length_m")
        if self.gradient_at != "whole_train" and self.length_m is None:
            raise ValueError(f"gradient_at = '{self.gradient_at}' needs length_m: without it the train is a point")
        # Kinds share the specific terms of the train in proportion to their cars, so they must make up all of it; a
        # train without kinds needs no number of cars.
        cars = sum(kind.cars for kind in self.resistance.car_kinds)
        if cars and cars != self.car_count:
            raise ValueError(f"resistance.car_kinds have {cars} cars, but car_count is {self.car_count or 'not given'}")
        return self

    def _require_possible_load(self) -> None:
        if self.max_load_t is not None and self.capacity_passengers > 0:
            raise ValueError("needs only one of max_load_t and capacity_passengers: both are the capacity")
        if self.load_t is not None and self.load_factor > 0:
            raise ValueError("needs only one of load_t and load_factor: both are the load")
        if self.load_factor > self.crush_load_factor:
            raise ValueError(
                f"load_factor = {self.load_factor:g} must be at most {self.crush_load_factor:g}, the crush_load_factor"
            )
        if self.load_factor > 0 and self.capacity_kg == 0:
            raise ValueError(
                f"load_factor = {self.load_factor:g} has no effect: it needs capacity_passengers and "
                "passenger_mass_kg above 0, or max_load_t; load_t is a load in tonnes"
            )
        most_t = self.crush_load_factor * self.capacity_kg / KG_PER_T
        # rounding: a share of the capacity, written in tonnes, is that share
        if self.load_t is not None and self.load_t > most_t * (1 + 1e-9):
            raise ValueError(
                f"load_t = {self.load_t:g} must be at most {most_t:g}, the capacity with crush_load_factor"
            )

    def with_load(self, share: float | None = None, tonnes: float | None = None) -> "Vehicle":
        """Return the vehicle with another load: a share of its capacity or a mass [t], which is not checked."""
        if tonnes is None:
            # a share refers to the planned load where no capacity is given
            capacity = {} if self.has_capacity or self.load_t is None else {"max_load_t": self.load_t or None}
            return self.model_copy(update={"load_factor": share or 0.0, "load_t": None, **capacity})
        return self.model_copy(update={"load_factor": 0.0, "load_t": tonnes})

    @property
    def specific_resistance(self) -> SpecificResistance:
        """Running resistance over the weight of the whole train: the mean over its equally heavy cars and its load."""
        resistance, load_share = self.resistance, self.load_mass_kg / self.total_mass_kg
        terms = {}
        for name, common in zip(SpecificResistance.model_fields, resistance.specific, strict=True):
            own = common + sum(kind.cars * getattr(kind, name) for kind in resistance.car_kinds) / (self.car_count or 1)
            of_load = getattr(resistance.load, name)
            terms[name] = own if of_load is None else own + load_share * (of_load - own)
        return SpecificResistance.model_construct(**terms)

    @property
    def has_capacity(self) -> bool:
        """Whether the capacity is given."""
        return self.max_load_t is not None or self.capacity_passengers * self.passenger_mass_kg > 0

    @property
    def capacity_kg(self) -> float:
        """Mass of the load whose share is 1 [kg]; a load in tonnes is its own capacity where no other is known."""
        if self.max_load_t is not None:
            return self.max_load_t * KG_PER_T
        if self.capacity_passengers * self.passenger_mass_kg > 0:
            return self.capacity_passengers * self.passenger_mass_kg
        return (self.load_t or 0.0) * KG_PER_T

    @property
    def load_share(self) -> float:
        """Load over capacity, however it is given; 0 without a capacity."""
        if self.load_t is None:
            return self.load_factor
        return self.load_mass_kg / self.capacity_kg if self.capacity_kg > 0 else 0.0

    @property
    def load_mass_kg(self) -> float:
        """Mass of passengers or freight on board [kg]."""
        return self.load_factor * self.capacity_kg if self.load_t is None else self.load_t * KG_PER_T

    @property
    def total_mass_kg(self) -> float:
        """Mass of vehicle and load [kg]."""
        return self.tare_kg + self.load_mass_kg

    @property
    def total_inertia_kg(self) -> float:
        """Mass that resists acceleration [kg]; a load does not turn, but a factor is one of the whole mass."""
        if self.inertial_mass_kg is not None:
            return self.inertial_mass_kg + self.load_mass_kg
        assert self.rotating_mass_factor is not None
        return (1 + self.rotating_mass_factor) * self.total_mass_kg
