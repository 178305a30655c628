"""Distributions from which uncertain quantities are drawn; the drawing is in `railjoule.core.studies.montecarlo`."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from railjoule.core.scenario._base import Number, Part


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
    """Mostly small, seldom large, never negative."""

    distribution: Literal["exponential"]
    mean: Number = Field(gt=0, le=1e6, description="The mean.")


Distribution = Annotated[
    Fixed | Uniform | Triangular | Normal | LogNormal | Exponential, Field(discriminator="distribution")
]
"""Any kind of distribution; the key `distribution` tells which."""
