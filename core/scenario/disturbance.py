"""What goes otherwise than planned."""

from typing import Literal, Self

from pydantic import Field, model_validator

from railjoule.core.scenario._base import Number, Part
from railjoule.core.scenario.line import SpeedLimit
from railjoule.core.scenario.vehicle import MOST_LOAD_FACTOR

Reaction = Literal["driver", "computer", "known"]


class Event(Part):
    """Something that the timetable does not know; the train learns of it at its start where nothing else is given."""

    noticed_at_m: Number | None = Field(None, ge=0, le=1e7, description="Where the train learns of it [m].")
    noticed_at_s: Number | None = Field(None, ge=0, le=86400, description="When the train learns of it [s].")
    reaction: Reaction = Field("computer", description="Who plans the rest.")

    @model_validator(mode="after")
    def _noticed_once(self) -> Self:
        if self.noticed_at_m is not None and self.noticed_at_s is not None:
            raise ValueError("noticed_at_m and noticed_at_s cannot both be given")
        return self


class UnplannedStop(Event):
    """A stop that the timetable does not know."""

    position_m: Number = Field(gt=0, le=1e7, description="Where the train must stop [m].")
    duration_s: Number = Field(ge=0, le=86400, description="How long it must stand [s].")

    @model_validator(mode="after")
    def _noticed_before(self) -> Self:
        if self.noticed_at_m is not None and self.noticed_at_m > self.position_m:
            raise ValueError(
                f"noticed_at_m = {self.noticed_at_m:g} lies behind position_m = {self.position_m:g}, where it must stop"
            )
        return self


class UnplannedLimit(Event, SpeedLimit):
    """A speed limit that the timetable does not know."""

    @model_validator(mode="after")
    def _noticed_before(self) -> Self:
        if self.noticed_at_m is not None and self.noticed_at_m > self.to_m:
            raise ValueError(f"noticed_at_m = {self.noticed_at_m:g} lies behind to_m = {self.to_m:g}, where it ends")
        return self


class VoltageChange(Event):
    """Another line voltage, from when it is noticed on."""

    line_voltage_factor: Number = Field(gt=0, le=2, description="Line voltage over its nominal value.")


class RecuperationChange(Event):
    """Another share of the generated energy that the line takes back, from when it is noticed on."""

    recuperation_factor: Number = Field(ge=0, le=1, description="Share that the line takes back.")


class Disturbance(Part):
    """All that goes otherwise than planned in one run."""

    coordinate_error_m: Number = Field(
        0.0, ge=-10_000, le=10_000, description="The train believes it is this much further on [m]."
    )
    actual_load_factor: Number | None = Field(
        None, ge=0, le=MOST_LOAD_FACTOR, description="Share of the capacity really on board."
    )
    stops: tuple[UnplannedStop, ...] = Field((), max_length=100)
    speed_limits: tuple[UnplannedLimit, ...] = Field((), max_length=100)
    voltage_changes: tuple[VoltageChange, ...] = Field((), max_length=100)
    recuperation_changes: tuple[RecuperationChange, ...] = Field((), max_length=100)
    accepted_delay_s: Number = Field(
        0.0, ge=0, le=86400, description="How much later than planned the train may arrive after an event [s]."
    )
    resistance_factor: Number = Field(
        1.0, ge=0, le=10, description="Running resistance over the planned one, as head wind makes it."
    )
    line_voltage_factor: Number = Field(1.0, gt=0, le=2, description="Line voltage over its nominal value.")
    departure_delay_s: Number = Field(0.0, ge=0, le=86400, description="How much later the train leaves [s].")

    @property
    def events(self) -> tuple[Event, ...]:
        """All that the train learns of on its way, or before it."""
        return (*self.stops, *self.speed_limits, *self.voltage_changes, *self.recuperation_changes)
