"""The time that the run may take, and the speeds with which it begins and ends.

An average speed counts over the way of the train's front, the length of the line. Shtompel, Khvorost 2025, (15), count
it over the length of an inter-station run less that of the train, (X_sum - X_tr) / v_sr: `deduct_train_length`.
"""

from typing import Self

from pydantic import Field, model_validator

from railjoule.core.scenario._base import Number, Part, require_effect
from railjoule.core.units import MS_PER_KMH


class Timetable(Part):
    """The time for the whole run, dwells included: given itself or as an average speed; and the speeds at its ends."""

    # a day at most: a run that takes longer is a timetable in minutes or milliseconds
    travel_time_s: Number | None = Field(None, gt=0, le=86400, description="Time for the whole run [s].")
    average_speed_kmh: Number | None = Field(None, gt=0, le=600, description="Length over travel time [km/h].")
    deduct_train_length: bool = Field(
        False, strict=True, description="The average speed counts over each inter-station run less the train's length."
    )
    # a part of a longer journey begins and ends in motion; published benchmarks do so with 1 m/s
    entry_speed_kmh: Number = Field(0.0, ge=0, le=600, description="Speed at the start of the line [km/h].")
    exit_speed_kmh: Number = Field(0.0, ge=0, le=600, description="Speed at the end of the line [km/h].")

    @model_validator(mode="after")
    def _one_definition(self) -> Self:
        # both would contradict each other as soon as the line changes, and none leaves the time open
        if (self.travel_time_s is None) == (self.average_speed_kmh is None):
            raise ValueError("needs exactly one of travel_time_s and average_speed_kmh")
        if self.average_speed_kmh is None:
            require_effect(self, ("deduct_train_length",), "with travel_time_s, only with average_speed_kmh")
        return self

    @property
    def end_speeds_ms(self) -> tuple[float, float]:
        """Speeds at the start and at the end of the line [m/s]."""
        return self.entry_speed_kmh * MS_PER_KMH, self.exit_speed_kmh * MS_PER_KMH

    def travel_time_over(self, length_m: float) -> float:
        """Return the time for a line of `length_m` [m], in s."""
        if self.travel_time_s is not None:
            return self.travel_time_s
        assert self.average_speed_kmh is not None
        return length_m / (self.average_speed_kmh * MS_PER_KMH)
