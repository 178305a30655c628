"""Settings of the ways to solve and to simulate a scenario."""

from itertools import pairwise
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from railjoule.core.scenario._base import Count, Number, Part, require_effect
from railjoule.core.scenario.disturbance import Distribution, Fixed, LogNormal, Normal

LOOP_STEP_S = 0.001
"""Step of the integration in closed loop where a scenario names none [s]."""
# currents that follow noise never come to rest between two steps, so with longer ones the two energy balances differ
MAX_NOISY_STEP_S = 0.0005
"""The longest step where the measured speed is noisy [s]."""
LITERAL_KEYS = (
    "dead_zone_kmh",
    "regulation_speed_kmh",
    "full_effort_time_s",
    "effort_rate_share",
    "time_step_s",
)
"""Keys of a search that only the literal regulator reads."""
TARGET_BRAKING_KEYS = (
    "target_deceleration_ms2",
    "reset_sensor_m",
    "calibration_length_m",
    "stop_sensor_m",
    "sensor_errors_m",
)
"""Keys of a simulation that belong to target braking: its curve and the sensors along it."""

SENSOR_ERROR = Normal(distribution="normal", standard_deviation=0.5)
"""Of the place of a braking sensor [m], assumed: where it is mounted, and how far the train drives until it is read."""


class SolverOptions(Part):
    """How finely the line is cut."""

    mesh_m: Number = Field(5.0, ge=0.001, le=1000, description="Largest length of a cell [m].")
    tolerance: Number = Field(
        5e-4, ge=1e-5, le=0.1, description="Share of the energy by which an optimum may exceed its lower bound."
    )


class SearchOptions(Part):
    """How the strategy `speed_limits` searches.

    `boundaries_m` are the borders between the sections of a trip [m], and `limits_kmh` the limits of these sections
    [km/h]: given, there is no search.
    """

    regulator: Literal["literal", "brake", "coast"] = Field("coast", description="Regulator under the limits.")
    boundaries_m: tuple[Annotated[Number, Field(gt=0, le=1e7)], ...] = Field((), max_length=50)
    free_boundaries: bool = Field(False, strict=True, description="The search can move the section ends.")
    inter_station_runs: Literal["together", "separate"] = Field(
        "together", description="Inter-station runs are searched together, or each by itself at the average speed."
    )
    limits_kmh: tuple[Annotated[Number, Field(gt=0, le=600)], ...] | None = Field(None, max_length=51)
    time_window: Number = Field(0.01, gt=0, le=0.5, description="Allowed early or late arrival, share of the time.")
    stop_deceleration_ms2: Number = Field(0.8, gt=0, le=20, description="Deceleration of look-ahead braking [m/s2].")
    dead_zone_kmh: Number = Field(
        1.0, gt=0, le=50, description="Literal regulator: no effort this close to a limit [km/h]."
    )
    regulation_speed_kmh: Number = Field(
        5.0, ge=0, le=100, description="Literal regulator: effort changes fastest up to this speed [km/h]."
    )
    full_effort_time_s: Number = Field(
        2.0, gt=0, le=60, description="Literal regulator: shortest time from zero to full effort [s]."
    )
    effort_rate_share: Number = Field(
        0.5, gt=0, le=1, description="Literal regulator: rate of effort at higher speed over the fastest."
    )
    time_step_s: Number = Field(0.05, ge=0.0005, le=1, description="Time step of the literal regulator [s].")

    @model_validator(mode="after")
    def _fits_together(self) -> Self:
        if any(later <= earlier for earlier, later in pairwise(self.boundaries_m)):
            raise ValueError("boundaries_m must rise")
        if self.limits_kmh is not None and self.boundaries_m and len(self.limits_kmh) != len(self.boundaries_m) + 1:
            raise ValueError(
                f"limits_kmh has {len(self.limits_kmh)} entries for the {len(self.boundaries_m) + 1} sections "
                "between boundaries_m"
            )
        if self.regulator != "literal":
            require_effect(self, LITERAL_KEYS, f"with regulator = '{self.regulator}', only with 'literal'")
        if self.limits_kmh is not None:
            no_search = "beside limits_kmh: with given limits there is no search"
            require_effect(self, ("free_boundaries", "inter_station_runs"), no_search)
        return self


class SimulationOptions(Part):
    """What `railjoule simulate` does with the plan."""

    kind: Literal["following", "field_oriented"] = Field("following", description="Kind of simulation.")
    precompensator: bool = Field(True, strict=True, description="Cancel the lag of the position control.")
    bandwidth_rads: Number = Field(10.0, ge=1, le=50, description="Threefold pole of the closed position loop [rad/s].")
    rotor_resistance_factor: Number = Field(
        1.0, ge=0.2, le=5, description="Rotor resistance that the motor controller assumes, over the true one."
    )
    flux: Literal["constant", "min_loss"] = Field(
        "constant", description="Rated flux as long as the voltage allows it, or the flux of least loss."
    )
    speed_noise_rads: Number = Field(
        0.0, ge=0, le=100, description="Standard deviation of the measured motor speed [rad/s]."
    )
    noise_seed: Count = Field(1, ge=0, le=2**63, description="The same seed gives the same noise.")
    time_step_s: Number | None = Field(
        None,
        ge=0.00005,
        le=0.002,
        description=f"Step of the integration in closed loop [s]; by default {LOOP_STEP_S:g}, and at most "
        f"{MAX_NOISY_STEP_S:g} with noise.",
    )
    reference_window_s: Number = Field(
        0.2, ge=0.02, le=5, description="Time over which the corners of the planned speed are rounded [s]."
    )
    response_length_m: Number = Field(
        5.0,
        ge=0,
        le=1000,
        description="Distance over which an error of speed squared falls to 1/e [m].",
    )
    speed_error: Number = Field(0.0, gt=-0.5, lt=0.5, description="Measured speed over the true one, minus 1.")
    target_braking: bool = Field(True, strict=True, description="Brake along the target curve before each stop.")
    target_deceleration_ms2: Number = Field(0.6, gt=0, le=10, description="Deceleration of the target curve [m/s2].")
    reset_sensor_m: Number | None = Field(300.0, gt=0, le=1e5, description="D1, resets position: before the stop [m].")
    calibration_length_m: Number | None = Field(
        120.0, gt=0, le=1e5, description="From D1 to D2, over which the measured speed is calibrated [m]."
    )
    stop_sensor_m: Number | None = Field(15.0, gt=0, le=1e5, description="D3, resets position: before the stop [m].")
    sensor_errors_m: tuple[Number, Number, Number] = Field(
        (0.0, 0.0, 0.0), description="By how much D1, D2, D3 are farther on than assumed [m]."
    )

    @model_validator(mode="after")
    def _fits_together(self) -> Self:
        if self.calibration_length_m is not None and self.reset_sensor_m is None:
            raise ValueError("calibration_length_m needs reset_sensor_m, where the calibration begins")
        places = [self.reset_sensor_m, self.stop_sensor_m]
        if self.reset_sensor_m is not None and self.calibration_length_m is not None:
            places.insert(1, self.reset_sensor_m - self.calibration_length_m)
        known = [place for place in places if place is not None]
        if any(later >= earlier for earlier, later in pairwise(known)) or min(known, default=1.0) <= 0:
            raise ValueError(
                "the sensors must be in the order D1, D2, D3 before the stop: reset_sensor_m above "
                "reset_sensor_m - calibration_length_m above stop_sensor_m"
            )
        if not self.target_braking:
            require_effect(self, TARGET_BRAKING_KEYS, "with target_braking = false")
        if self.speed_noise_rads > 0 and self.time_step_s is not None and self.time_step_s > MAX_NOISY_STEP_S:
            raise ValueError(
                f"time_step_s = {self.time_step_s:g} must be at most {MAX_NOISY_STEP_S:g} with speed_noise_rads above 0"
            )
        return self

    @property
    def loop_step_s(self) -> float:
        """Step of the integration in closed loop [s]."""
        if self.time_step_s is not None:
            return self.time_step_s
        return MAX_NOISY_STEP_S if self.speed_noise_rads > 0 else LOOP_STEP_S


class MonteCarloOptions(Part):
    """The distributions of a Monte Carlo study; the defaults are assumed."""

    runs: Count = Field(2000, ge=1, le=1_000_000, description="Number of runs.")
    seed: Count = Field(1, ge=0, le=2**63, description="The same seed draws the same runs.")
    load_factor: Distribution = Field(
        Normal(distribution="normal", standard_deviation=0.18), description="Actual load, 0 to 1."
    )
    coordinate_error_m: Distribution = Field(
        Normal(distribution="normal", standard_deviation=5.0), description="Position error [m]."
    )
    resistance_factor: Distribution = Field(
        LogNormal(distribution="log_normal", median=1.0, log_standard_deviation=0.08),
        description="Running resistance over the planned one.",
    )
    line_voltage_factor: Distribution = Field(
        Normal(distribution="normal", standard_deviation=0.03), description="Supply voltage over its nominal value."
    )
    departure_delay_s: Distribution = Field(Fixed(distribution="fixed", value=0.0), description="Departure delay [s].")
    dwell_delay_s: Distribution = Field(
        Fixed(distribution="fixed", value=0.0), description="Dwell at each station less the planned one [s]."
    )
    speed_error: Distribution = Field(
        Normal(distribution="normal", standard_deviation=0.005),
        description="Measured speed over the true one, minus 1.",
    )
    d1_error_m: Distribution = Field(SENSOR_ERROR, description="By how much D1 is farther on than assumed [m].")
    d2_error_m: Distribution = Field(SENSOR_ERROR, description="By how much D2 is farther on than assumed [m].")
    d3_error_m: Distribution = Field(SENSOR_ERROR, description="By how much D3 is farther on than assumed [m].")


class EocOptions(Part):
    """Which of Ftorek's energy optimal controls is meant."""

    variant: Literal["optimal", "as_printed"] = Field(
        "optimal", description="With the whole cost, or without the work of drag as in the published results."
    )


class PhasesOptions(Part):
    """Which start / cruise / coast / brake runs the strategy `phases` chooses from."""

    starting_current_a: Number | None = Field(
        None, gt=0, le=1e5, description="Starting current of a motor [A]; by default the largest one."
    )
    free_starting_current: bool = Field(False, strict=True, description="The starting current is optimised.")
    cruise: bool = Field(True, strict=True, description="The run can hold its speed.")
    coast: bool = Field(True, strict=True, description="The run can coast.")
    cycles: Count = Field(1, ge=1, le=20, description="Number of starts between two stops, with coasting in between.")

    @model_validator(mode="after")
    def _has_a_choice(self) -> Self:
        if self.free_starting_current and self.starting_current_a is not None:
            raise ValueError("free_starting_current = true excludes starting_current_a")
        if not self.cruise and not self.coast:
            raise ValueError("cruise and coast cannot both be false: no run would meet the time")
        if not self.coast and self.cycles > 1:
            raise ValueError("coast = false needs cycles = 1")
        return self


class EnocOptions(Part):
    """How Ftorek's near-optimal control accelerates."""

    acceleration_time_s: Number | None = Field(
        None, gt=0, le=43200, description="Time of the ramps [s]; by default the best one."
    )
