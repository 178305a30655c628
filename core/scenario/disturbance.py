"""What goes otherwise than planned."""

from typing import Literal

from pydantic import Field

from railjoule.core.scenario._base import Number, Part
from railjoule.core.scenario.line import SpeedLimit


class UnplannedStop(Part):
    """A stop that the timetable does not know."""

    position_m: Number = Field(ge=0, le=1e7, description="Where the train must stop [m].")
    duration_s: Number = Field(ge=0, le=86400, description="How long it must stand [s].")
    noticed_at_m: Number | None = Field(None, ge=0, le=1e7, description="Where the train learns of it [m].")
    reaction: Literal["driver", "computer", "known"] = Field("computer", description="Who plans the rest.")


class UnplannedLimit(SpeedLimit):
    """A speed limit that the timetable does not know."""

    noticed_at_m: Number | None = Field(None, ge=0, le=1e7, description="Where the train learns of it [m].")


class Disturbance(Part):
    """All that goes otherwise than planned in one run."""

    coordinate_error_m: Number = Field(
        0.0, ge=-10_000, le=10_000, description="The train believes it is this much further on [m]."
    )
    actual_load_factor: Number | None = Field(None, ge=0, le=1, description="Share of the capacity really on board.")
    stops: tuple[UnplannedStop, ...] = Field((), max_length=100)
    speed_limits: tuple[UnplannedLimit, ...] = Field((), max_length=100)
    resistance_factor: Number = Field(
        1.0, ge=0, le=10, description="Running resistance over the planned one, as head wind makes it."
    )
    line_voltage_factor: Number = Field(1.0, gt=0, le=2, description="Line voltage over its nominal value.")
    departure_delay_s: Number = Field(0.0, ge=0, le=86400, description="How much later the train leaves [s].")
