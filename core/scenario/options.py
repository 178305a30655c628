"""Settings of the ways to solve and to simulate a scenario."""

from typing import Annotated, Literal

from pydantic import Field

from railjoule.core.scenario._base import Number, Part


class SolverOptions(Part):
    """How finely the line is cut."""

    mesh_m: Number = Field(5.0, ge=0.001, le=1000, description="Largest length of a cell [m].")


class SearchOptions(Part):
    """How the strategy `speed_limits` searches."""

    regulator: Literal["literal", "brake", "coast"] = Field("coast", description="Who drives under the limits.")
    boundaries_m: tuple[Annotated[Number, Field(gt=0, le=1e7)], ...] = Field((), max_length=50)
    free_boundaries: bool = Field(False, strict=True, description="The search may move the boundaries.")
    limits_kmh: tuple[Annotated[Number, Field(gt=0, le=600)], ...] | None = Field(None, max_length=51)
    time_window: Number = Field(0.01, gt=0, le=0.5, description="Allowed share of early or late arrival.")
    stop_deceleration_ms2: Number = Field(0.8, gt=0, le=20, description="Deceleration of look-ahead braking [m/s2].")


class SimulationOptions(Part):
    """What `railjoule simulate` does with the plan."""

    kind: Literal["following", "field_oriented"] = Field("following", description="Which simulation.")
    precompensator: bool = Field(True, strict=True, description="Cancel the lag of the position control.")


class EocOptions(Part):
    """Which of Ftorek's energy optimal controls is meant."""

    variant: Literal["optimal", "as_printed"] = Field(
        "optimal", description="With the whole cost, or without the work of drag as the printed results have it."
    )


class EnocOptions(Part):
    """How Ftorek's near-optimal control accelerates."""

    acceleration_time_s: Number | None = Field(
        None, gt=0, le=43200, description="Time of the ramps [s]; the best one where absent."
    )
