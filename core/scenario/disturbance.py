"""Distributions of random quantities, and the disturbances of a run."""

from typing import Annotated, ClassVar, Literal, Self

from pydantic import Field, model_validator

from railjoule.core.scenario._base import Number, Part
from railjoule.core.scenario.line import RailCondition, SpeedLimit
from railjoule.core.scenario.vehicle import MAX_LOAD_FACTOR


class Fixed(Part):
    """Always the same value."""

    distribution: Literal["fixed"]
    value: Number = Field(description="The value.")


class Uniform(Part):
    """Any value of an interval, all equally likely."""

    distribution: Literal["uniform"]
    low: Number = Field(description="The least value.")
    high: Number = Field(description="The greatest value.")

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        if self.high <= self.low:
            raise ValueError(f"high = {self.high:g} must be above low = {self.low:g}")
        return self


class Triangular(Part):
    """A most likely value between two ends."""

    distribution: Literal["triangular"]
    low: Number = Field(description="The least value.")
    mode: Number = Field(description="The most likely value.")
    high: Number = Field(description="The greatest value.")

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        if not (self.low <= self.mode <= self.high and self.low < self.high):
            raise ValueError(
                f"low = {self.low:g}, mode = {self.mode:g}, high = {self.high:g} must be in this order, and low "
                "below high"
            )
        return self


class Normal(Part):
    """Around a mean."""

    distribution: Literal["normal"]
    mean: Number | None = Field(None, description="The mean; by default the planned value.")
    standard_deviation: Number = Field(gt=0, le=1e6, description="The standard deviation.")


class LogNormal(Part):
    """Around a median, by factors."""

    distribution: Literal["log_normal"]
    median: Number = Field(gt=0, le=1e6, description="The median.")
    # at 10 one standard deviation is a factor of 22,000: any more is a slip of units
    log_standard_deviation: Number = Field(gt=0, le=10, description="The standard deviation of the logarithm.")


class Exponential(Part):
    """Mostly small, rarely large, never negative."""

    distribution: Literal["exponential"]
    mean: Number = Field(gt=0, le=1e6, description="The mean.")


Distribution = Annotated[
    Fixed | Uniform | Triangular | Normal | LogNormal | Exponential, Field(discriminator="distribution")
]
"""Any kind of distribution; the key `distribution` names it."""


Reaction = Literal["driver", "computer", "known"]


class Event(Part):
    """Something that is not in the timetable; by default the train learns of it at its start."""

    # None is the start: what is known by then can be planned for as a whole
    noticed_at_m: Number | None = Field(None, ge=0, le=1e7, description="Where the train learns of it [m].")
    noticed_at_s: Number | None = Field(None, ge=0, le=86400, description="When the train learns of it [s].")
    reaction: Reaction = Field("computer", description="Reaction (computer: replanning; known: in advance).")

    ends_at: ClassVar[tuple[str, str] | None] = None
    """The key of the place by which the train has learned of it, and what is there."""

    @model_validator(mode="after")
    def _noticed_in_time(self) -> Self:
        if self.noticed_at_m is not None and self.noticed_at_s is not None:
            raise ValueError("noticed_at_m and noticed_at_s cannot both be given")
        if self.noticed_at_m is not None and self.ends_at is not None:
            key, words = self.ends_at
            if self.noticed_at_m > getattr(self, key):
                raise ValueError(
                    f"noticed_at_m = {self.noticed_at_m:g} is after {key} = {getattr(self, key):g}, {words}"
                )
        return self


class UnplannedStop(Event):
    """A stop that is not in the timetable."""

    position_m: Number = Field(gt=0, le=1e7, description="Where the train must stop [m].")
    duration_s: Number = Field(ge=0, le=86400, description="Duration of the stop [s].")
    # How far before is not checked here: whether it can still brake depends on its speed, and the simulation reports a
    # missed stop.
    ends_at = ("position_m", "where the train must stop")


class UnplannedLimit(Event, SpeedLimit):
    """A speed limit that is not in the timetable."""

    # the end of the limit and not its start, as a train may learn of a limit while it is inside
    ends_at = ("to_m", "where it ends")


class VoltageChange(Event):
    """Another supply voltage, from when it is noticed."""

    line_voltage_factor: Number = Field(gt=0, le=2, description="Supply voltage over its nominal value.")


class RecuperationChange(Event):
    """Another recuperated share of the generated energy, from when it is noticed."""

    recuperation_factor: Number = Field(ge=0, le=1, description="Share of the generated energy that is recuperated.")


class Disturbance(Part):
    """All that differs from the plan in one run."""

    coordinate_error_m: Number = Field(
        0.0, ge=-10_000, le=10_000, description="Position error: the train assumes it is this much farther on [m]."
    )
    actual_load_factor: Number | None = Field(
        None, ge=0, le=MAX_LOAD_FACTOR, description="Actual share of the capacity on board."
    )
    actual_load_t: Number | None = Field(
        None, ge=0, le=1e5, description="Actual load on board [t], instead of its share."
    )
    stops: tuple[UnplannedStop, ...] = Field((), max_length=100)
    speed_limits: tuple[UnplannedLimit, ...] = Field((), max_length=100)
    voltage_changes: tuple[VoltageChange, ...] = Field((), max_length=100)
    recuperation_changes: tuple[RecuperationChange, ...] = Field((), max_length=100)
    accepted_delay_s: Number = Field(
        0.0, ge=0, le=86400, description="How much later than planned the train can arrive after an event [s]."
    )
    resistance_factor: Number = Field(
        1.0, ge=0, le=10, description="Running resistance over the planned one, as in a head wind."
    )
    line_voltage_factor: Number = Field(1.0, gt=0, le=2, description="Supply voltage over its nominal value.")
    rail_condition: RailCondition | None = Field(None, description="Actual rail condition; if empty, as planned.")
    departure_delay_s: Number = Field(0.0, ge=0, le=86400, description="Departure delay [s].")

    @model_validator(mode="after")
    def _one_load(self) -> Self:
        if self.actual_load_factor is not None and self.actual_load_t is not None:
            raise ValueError("needs only one of actual_load_t and actual_load_factor: both are the actual load")
        return self

    @property
    def has_load(self) -> bool:
        """Whether it contains a load of its own."""
        return self.actual_load_factor is not None or self.actual_load_t is not None

    @property
    def events(self) -> tuple[Event, ...]:
        """All events that the train learns of before or during the run."""
        return (*self.stops, *self.speed_limits, *self.voltage_changes, *self.recuperation_changes)
