"""A scenario: everything that a strategy needs, as one frozen value; and its timetable.

An average speed counts over the way of the train's front, the length of the line. Shtompel, Khvorost 2025, (15), count
it over the length of an inter-station run less that of the train, (X_sum - X_tr) / v_sr: `deduct_train_length`.
"""

from collections.abc import Mapping
from importlib import import_module
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any, Self

from pydantic import Field, field_validator, model_validator

from railjoule.core.errors import ScenarioError
from railjoule.core.scenario._base import Name, Number, Part, require_effect
from railjoule.core.scenario.disturbance import Disturbance
from railjoule.core.scenario.line import Line, Stretch
from railjoule.core.scenario.options import (
    EnocOptions,
    EocOptions,
    MonteCarloOptions,
    PhasesOptions,
    SearchOptions,
    SimulationOptions,
    SolverOptions,
)
from railjoule.core.scenario.text_file import NESTED_TOO_DEEPLY
from railjoule.core.scenario.vehicle import Vehicle
from railjoule.core.strategy import require_strategy
from railjoule.core.units import KG_PER_T, MS_PER_KMH, W_PER_KW

if TYPE_CHECKING:
    from railjoule.core.reserve import ReservedTime

RESERVE_KEYS = ("reserve_percent", "reserve_min_per_100km")
"""Keys of a running time reserve, of which a timetable has one at most."""
TIME_KEYS = ("travel_time_s", "average_speed_kmh", *RESERVE_KEYS)
"""Keys of the time for the whole run, of which a timetable has exactly one."""
Percent = Annotated[Number | None, Field(None, gt=0, le=1000, description="Reserve, share of the shortest time [%].")]
PerDistance = Annotated[Number | None, Field(None, gt=0, le=1000, description="Reserve over distance [min/100 km].")]


class ReservePart(Stretch):
    """A part of the line with a running time reserve of its own."""

    reserve_percent: Percent = None
    reserve_min_per_100km: PerDistance = None

    @model_validator(mode="after")
    def _one_definition(self) -> Self:
        _require_one(self, RESERVE_KEYS)
        return self


def _require_one(table: Part, keys: tuple[str, ...]) -> None:
    """Raise ValueError unless a table has exactly one of some keys."""
    if sum(getattr(table, key) is not None for key in keys) != 1:
        raise ValueError(f"needs exactly one of {', '.join(keys[:-1])} and {keys[-1]}")


class Timetable(Part):
    """The time for the whole run, dwells included, and the speeds at its ends.

    The time is given itself, as an average speed, or as a reserve beyond the shortest running times, which vary with
    train, load and line.
    """

    # a day at most: a run that takes longer is a timetable in minutes or milliseconds
    travel_time_s: Number | None = Field(None, gt=0, le=86400, description="Time for the whole run [s].")
    average_speed_kmh: Number | None = Field(None, gt=0, le=600, description="Length over travel time [km/h].")
    deduct_train_length: bool = Field(
        False, strict=True, description="The average speed counts over each inter-station run less the train's length."
    )
    reserve_percent: Percent = None
    reserve_min_per_100km: PerDistance = None
    reserve_parts: tuple[ReservePart, ...] = Field(
        (), max_length=1000, description="Parts of the line with another reserve."
    )
    # a part of a longer journey begins and ends in motion; published benchmarks do so with 1 m/s
    entry_speed_kmh: Number = Field(0.0, ge=0, le=600, description="Speed at the start of the line [km/h].")
    exit_speed_kmh: Number = Field(0.0, ge=0, le=600, description="Speed at the end of the line [km/h].")

    @model_validator(mode="after")
    def _one_definition(self) -> Self:
        # two would contradict each other as soon as the line changes, and none leaves the time open
        _require_one(self, TIME_KEYS)
        given = next(key for key in TIME_KEYS if getattr(self, key) is not None)
        if self.average_speed_kmh is None:
            require_effect(self, ("deduct_train_length",), f"with {given}, only with average_speed_kmh")
        if self.reserve_parts and not self.has_reserve:
            raise ValueError(f"reserve_parts has no effect with {given}, only with a reserve for the rest of the line")
        for index, (before, after) in enumerate(pairwise(self.reserve_parts), 1):
            if after.from_m < before.to_m:
                raise ValueError(
                    f"reserve_parts[{index}].from_m = {after.from_m:g} lies before the end of the part before it at "
                    f"{before.to_m:g} m"
                )
        return self

    @property
    def has_reserve(self) -> bool:
        """Whether the time follows from the shortest running times and a reserve."""
        return any(getattr(self, key) is not None for key in RESERVE_KEYS)

    def with_travel_time(self, travel_time_s: float) -> "Timetable":
        """Return a timetable with the same speeds at its ends and this time for the whole run [s]."""
        others = dict.fromkeys(TIME_KEYS) | {"deduct_train_length": False, "reserve_parts": ()}
        return self.model_copy(update=others | {"travel_time_s": travel_time_s})

    @property
    def end_speeds_ms(self) -> tuple[float, float]:
        """Speeds at the start and at the end of the line [m/s]."""
        return self.entry_speed_kmh * MS_PER_KMH, self.exit_speed_kmh * MS_PER_KMH

    def time_at_average_speed(self, length_m: float) -> float:
        """Return the time for a line of `length_m` [m] at the average speed, in s."""
        assert self.average_speed_kmh is not None
        return length_m / (self.average_speed_kmh * MS_PER_KMH)


class Scenario(Part):
    """Vehicle, line, timetable and disturbances of one run, and how to solve it.

    Build one from its parts, from a file (`railjoule.load_scenario`), or from a nested dictionary
    (`railjoule.core.scenario.scenario_from_document`). The last two fill in presets.
    """

    title: Name = Field("", max_length=200, description="Title of the scenario.")
    strategy: str = Field("optimal", strict=True, description="Driving strategy.")
    vehicle: Vehicle
    line: Line
    timetable: Timetable
    disturbance: Disturbance = Disturbance()
    eoc: EocOptions = EocOptions()
    enoc: EnocOptions = EnocOptions()
    phases: PhasesOptions = PhasesOptions()
    search: SearchOptions = SearchOptions()
    simulation: SimulationOptions = SimulationOptions()
    montecarlo: MonteCarloOptions = MonteCarloOptions()
    solver: SolverOptions = SolverOptions()

    def __init__(
        self,
        vehicle: Vehicle | Mapping[str, Any] | None = None,
        line: Line | Mapping[str, Any] | None = None,
        *,
        travel_time_s: float | None = None,
        average_speed_kmh: float | None = None,
        **fields: Any,
    ) -> None:
        """Build a scenario from its parts.

        Parameters
        ----------
        vehicle : Vehicle
            The train.
        line : Line
            The track.
        travel_time_s, average_speed_kmh : float, optional
            Time for the whole run [s], or length over travel time [km/h]: one of them, or `timetable`.
        **fields
            All other tables and keys of a scenario file, such as `title` or `solver`.

        Raises
        ------
        ScenarioError
            If a key is unknown or missing, or a value of a wrong type or out of bounds.
        """
        times = {"travel_time_s": travel_time_s, "average_speed_kmh": average_speed_kmh}
        given = {key: value for key, value in times.items() if value is not None}
        if given and "timetable" in fields:
            raise ScenarioError(f"Scenario: {next(iter(given))} and timetable exclude each other; give one of them.")
        if not given and "timetable" not in fields:
            raise ScenarioError("Scenario: travel_time_s is missing; give it, average_speed_kmh or timetable.")
        if given:
            fields["timetable"] = given
        parts = {"vehicle": vehicle, "line": line}
        super().__init__(**{key: part for key, part in parts.items() if part is not None}, **fields)

    __init__.__pydantic_base_init__ = True  # type: ignore[attr-defined]

    @field_validator("strategy")
    @classmethod
    def _strategy_is_registered(cls, name: str) -> str:
        require_strategy(name)
        return name

    # checks that need two tables stand here, as the model of a table has no access to the others
    @model_validator(mode="after")
    def _tables_fit_together(self) -> Self:
        length, vehicle = self.line.length_m, self.vehicle
        for index, border in enumerate(self.search.boundaries_m):
            if border >= length:
                raise ValueError(
                    f"search.boundaries_m[{index}] = {border:g} must lie before the end of the line at {length:g} m"
                )
        if self.line.limits_hold_for == "whole_train" and vehicle.length_m is None:
            raise ValueError("line.limits_hold_for = 'whole_train' needs vehicle.length_m")
        if self.timetable.deduct_train_length:
            self._require_runs_longer_than_the_train()
        for index, part in enumerate(self.timetable.reserve_parts[-1:], len(self.timetable.reserve_parts) - 1):
            # the length is a sum of sections
            if part.to_m > length + 1e-9:
                raise ValueError(
                    f"timetable.reserve_parts[{index}].to_m = {part.to_m:g} lies beyond the end of the line at "
                    f"{length:g} m"
                )
        self._require_data_of_limits_by_place()
        if not self.line.inner_stations:
            default = MonteCarloOptions.model_fields["dwell_delay_s"].default
            if self.montecarlo.dwell_delay_s != default:
                raise ValueError("montecarlo.dwell_delay_s has no effect on a line without a station between its ends")
        self._require_possible_actual_load()
        return self

    def _require_possible_actual_load(self) -> None:
        # against the crush load and not 1: what a train really carries may exceed its nominal capacity
        vehicle, share, tonnes = self.vehicle, self.disturbance.actual_load_factor, self.disturbance.actual_load_t
        most = vehicle.crush_load_factor
        if share is not None and share > most:
            raise ValueError(
                f"disturbance.actual_load_factor = {share:g} must be at most {most:g}, the vehicle.crush_load_factor"
            )
        most_t = most * vehicle.capacity_kg / KG_PER_T
        if vehicle.has_capacity and tonnes is not None and tonnes > most_t * (1 + 1e-9):
            raise ValueError(
                f"disturbance.actual_load_t = {tonnes:g} must be at most {most_t:g}, the capacity with "
                "vehicle.crush_load_factor"
            )

    @property
    def actual_load_share(self) -> float:
        """Load really on board, as a share of the vehicle's capacity; the planned one where nothing else is said."""
        share, tonnes = self.disturbance.actual_load_factor, self.disturbance.actual_load_t
        if tonnes is not None:
            return tonnes * KG_PER_T / self.vehicle.capacity_kg if self.vehicle.capacity_kg > 0 else 0.0
        return self.vehicle.load_share if share is None else share

    def _require_data_of_limits_by_place(self) -> None:
        """Raise ValueError if the vehicle lacks what a limit of adhesion or of current counts with."""
        vehicle, line = self.vehicle, self.line
        conditions = {"line.rail_condition": line.rail_condition}
        conditions |= {
            f"line.rail_conditions[{k}].condition": one.condition for k, one in enumerate(line.rail_conditions)
        }
        conditions["disturbance.rail_condition"] = self.disturbance.rail_condition
        for key, condition in conditions.items():
            if condition is not None and vehicle.adhesion.driven_mass_share is None:
                raise ValueError(
                    f"{key} = '{condition}' needs vehicle.adhesion.driven_mass_share, the share of the mass on driven "
                    "axles; it is 1 where all axles are driven"
                )
        auxiliary_w, voltage = vehicle.auxiliary_power_kw * W_PER_KW, vehicle.line_voltage_v
        for index, limit in enumerate(line.traction_limits):
            if limit.max_current_a is None:
                continue
            key = f"line.traction_limits[{index}].max_current_a = {limit.max_current_a:g}"
            if voltage is None:
                raise ValueError(f"{key} needs vehicle.line_voltage_v, the voltage of the supply")
            if limit.max_current_a * voltage <= auxiliary_w:
                raise ValueError(
                    f"{key} must be above {auxiliary_w / voltage:.5g} A, the current of vehicle.auxiliary_power_kw"
                )

    def _require_runs_longer_than_the_train(self) -> None:
        train = self.vehicle.length_m
        if train is None:
            raise ValueError("timetable.deduct_train_length = true needs vehicle.length_m")
        shortest = min(later - earlier for earlier, later in pairwise(self.line.stops_m))
        if shortest <= train:
            raise ValueError(
                "timetable.deduct_train_length = true needs inter-station runs longer than the train: the shortest has "
                f"{shortest:g} m, and vehicle.length_m = {train:g}"
            )

    @property
    def travel_time_s(self) -> float:
        """Time for the whole run, dwells included [s]: no more than the latest arrival at the end of the line.

        Raises
        ------
        InfeasibleLineError
            If it follows from the shortest running times, and no run passes the line.
        """
        return min(self._timetabled_s, self._latest_arrival_s)

    @property
    def _timetabled_s(self) -> float:
        timetable = self.timetable
        if timetable.travel_time_s is not None:
            return timetable.travel_time_s
        if timetable.has_reserve:
            return self.reserved_time.travel_time_s
        return timetable.time_at_average_speed(self.timed_length_m)

    @property
    def reserved_time(self) -> "ReservedTime":
        """The shortest running times and their reserve, for a timetable with a reserve."""
        # by name: the shortest times need compiled kernels, which depend on scenarios
        reserved: ReservedTime = import_module("railjoule.core.reserve").reserved_time(self)
        return reserved

    def with_fixed_time(self) -> "Scenario":
        """Return a scenario whose time is that of now, also where it is a reserve and train or line change later."""
        if not self.timetable.has_reserve:
            return self
        return self.model_copy(update={"timetable": self.timetable.with_travel_time(self._timetabled_s)})

    @property
    def deducted_m(self) -> float:
        """Length by which an average speed shortens each inter-station run [m]: the train's by (15), or none."""
        return (self.vehicle.length_m or 0.0) if self.timetable.deduct_train_length else 0.0

    @property
    def timed_length_m(self) -> float:
        """Length over which an average speed counts [m]."""
        return self.line.length_m - (len(self.line.stops_m) - 1) * self.deducted_m

    @property
    def time_note(self) -> str:
        """Sentence on how the travel time follows from a reserve or a deducted length; empty where it is given."""
        if self.timetable.has_reserve:
            return self.reserved_time.sentence
        if not self.timetable.deduct_train_length:
            return ""
        whole_s = self.timetable.time_at_average_speed(self.line.length_m)
        return (
            f"Travel time by Shtompel (15): {self.timed_length_m:.6g} m, the line less the train's length of "
            f"{self.deducted_m:g} m for each inter-station run, at {self.timetable.average_speed_kmh:g} km/h take "
            f"{self.timetable.time_at_average_speed(self.timed_length_m):.1f} s; the whole line, {whole_s:.1f} s."
        )

    @property
    def travel_time_key(self) -> str:
        """The key that limits the time for the whole run."""
        if self._latest_arrival_s < self._timetabled_s:
            # at the start of a line that is run in reverse
            index = 0 if self.line.reverse else len(self.line.stations) - 1
            return f"line.stations[{index}].latest_arrival_s"
        # the time and not the reserve is what a refusal of a time compares
        return "the travel time by timetable.reserve" if self.timetable.has_reserve else "timetable.travel_time_s"

    @property
    def _latest_arrival_s(self) -> float:
        station = self.line.end_station
        return float("inf") if station is None else station.window_s[1]

    @property
    def limits_last_m(self) -> float:
        """How far beyond its end a speed limit still holds for the front of the train [m]."""
        return (self.vehicle.length_m or 0.0) if self.line.limits_hold_for == "whole_train" else 0.0

    def replace(self, changes: Mapping[str, Any] | None = None, /, **keys: Any) -> "Scenario":
        """Return a copy with changed keys, named by their path in the file.

        `scenario.replace({"vehicle.load_factor": 0.3, "drive.recuperation_factor": 1.0})`

        Parameters
        ----------
        changes : mapping, optional
            New values by dotted path; None takes a key away, so that its preset or default holds.
        **keys
            The same for keys without a dot.

        Raises
        ------
        ScenarioError
            If a key is unknown, its value of a wrong type or out of bounds, or two keys exclude each other.
        """
        # documents know scenarios, so they can only be asked for here
        from railjoule.core.scenario.document import (  # noqa: PLC0415
            change_document,
            scenario_from_document,
            to_document,
        )

        try:
            # Through the document and not `model_copy`, which checks nothing: so a change can name a preset, drop a
            # key by None and replace its alternative, as in a file.
            return scenario_from_document(change_document(to_document(self), {**(changes or {}), **keys}))
        except RecursionError:
            raise ScenarioError(f"scenario: {NESTED_TOO_DEEPLY}") from None
