"""The time that the run may take."""

from typing import Self

from pydantic import Field, model_validator

from railjoule.core.scenario._base import Number, Part
from railjoule.core.units import MS_PER_KMH


class Timetable(Part):
    """The time for the whole run, dwells included: given itself or as an average speed."""

    # a day at most: a run that takes longer is a timetable in minutes or milliseconds
    travel_time_s: Number | None = Field(None, gt=0, le=86400, description="Time for the whole run [s].")
    average_speed_kmh: Number | None = Field(None, gt=0, le=600, description="Length over travel time [km/h].")

    @model_validator(mode="after")
    def _one_definition(self) -> Self:
        # both would contradict each other as soon as the line changes, and none leaves the time open
        if (self.travel_time_s is None) == (self.average_speed_kmh is None):
            raise ValueError("needs exactly one of travel_time_s and average_speed_kmh")
        return self

    def travel_time_over(self, length_m: float) -> float:
        """Return the time for a line of `length_m` [m], in s."""
        if self.travel_time_s is not None:
            return self.travel_time_s
        assert self.average_speed_kmh is not None
        return length_m / (self.average_speed_kmh * MS_PER_KMH)
