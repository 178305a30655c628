"""A line: sections of gradient, curve and limit, limits by place, neutral sections, stations, passing points."""

from collections.abc import Mapping, Sequence
from importlib import import_module
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Self, TypeVar

from pydantic import Field, model_validator

from railjoule.core.scenario._base import Name, Number, Part, PresetPart

if TYPE_CHECKING:
    import pandas

SHORTEST_DISTANCE_M = 1.0
"""Neither a line nor the distance between two stations is shorter."""
AT_END_M = 1e-6
"""A station this close to an end of the line lies there: lengths are sums of sections."""
STRETCHES = ("speed_limits", "neutral_sections", "traction_limits", "rail_conditions")
"""The tables of a line whose entries lie between two places."""
TIMES_OF_A_STOP = ("dwell_s", "arrival_s", "earliest_arrival_s", "latest_arrival_s")
"""Keys of a station that need an arrival, and a departure after it."""


RailCondition = Literal["dry", "wet"]


class Section(Part):
    """A piece of line over which gradient, curve and limit stay the same."""

    # 10,000 km is longer than any railway line
    length_m: Number = Field(gt=0, le=1e7, description="Length of the section [m].")
    # The steepest lines with adhesion have about 140 per mille. Beyond 200 the small-angle form weight x gradient,
    # without the cosine, would be wrong by 2 per cent and more.
    gradient_permille: Number = Field(0.0, ge=-200, le=200, description="Gradient, uphill positive [per mille].")
    # above the 575 km/h that trains on wheels have reached
    speed_limit_kmh: Number | None = Field(None, gt=0, le=600, description="Speed limit [km/h].")
    curve_radius_m: Number = Field(0.0, ge=0, le=1e6, description="Radius of the curve [m]; 0 means straight.")
    # it multiplies only the part quadratic in speed, as the air in a tunnel changes nothing about bearings
    tunnel_factor: Number = Field(1.0, ge=0.1, le=20, description="Factor on quadratic resistance; 1 means no tunnel.")


class Stretch(Part):
    """A piece of line between two places."""

    from_m: Number = Field(ge=0, le=1e7, description="Where it begins for the front of the train [m].")
    to_m: Number = Field(gt=0, le=1e7, description="Where it ends [m].")

    @model_validator(mode="after")
    def _has_length(self) -> Self:
        if self.to_m <= self.from_m:
            raise ValueError(f"to_m = {self.to_m:g} is not beyond from_m = {self.from_m:g}")
        return self


class SpeedLimit(Stretch):
    """A speed limit between two places."""

    limit_kmh: Number = Field(gt=0, le=600, description="The limit [km/h].")


class NeutralSection(Stretch):
    """A piece of line without traction power.

    As long as the front of the train is in it, where the pantograph is taken to be, the drive neither pulls nor brakes;
    friction brakes work. The auxiliaries stay on, and count the same: their battery is charged again later.
    """


class TractionLimit(Stretch):
    """A piece of line on which the train may pull, or feed back, less than elsewhere.

    It holds as long as the front of the train is in it, where the pantograph is taken to be. The lowest limit of each
    kind holds where several overlap.
    """

    max_effort_kn: Number | None = Field(None, gt=0, le=10_000, description="Largest tractive effort [kN].")
    effort_factor: Number = Field(
        1.0, gt=0, le=1, description="Share of the largest tractive effort at every speed that is left."
    )
    max_power_kw: Number | None = Field(
        None, gt=0, le=100_000, description="Largest power at the wheels while driving [kW]."
    )
    max_current_a: Number | None = Field(
        None, gt=0, le=100_000, description="Largest current from the supply while driving, auxiliaries included [A]."
    )
    recuperation_factor: Number = Field(
        1.0, ge=0, le=1, description="Share of the generated energy that the supply takes back; 0 for none."
    )

    @model_validator(mode="after")
    def _limits_something(self) -> Self:
        largest = self.max_effort_kn, self.max_power_kw, self.max_current_a
        if self.effort_factor == 1 and self.recuperation_factor == 1 and all(value is None for value in largest):
            raise ValueError(
                "limits nothing: give max_effort_kn, effort_factor, max_power_kw, max_current_a or recuperation_factor"
            )
        return self


class RailStretch(Stretch):
    """A piece of line with a rail condition of its own."""

    condition: RailCondition = Field(description="Rail condition there.")


class Station(Part):
    """A planned stop."""

    name: Name = Field("", max_length=200, description="Name of the station.")
    position_m: Number = Field(ge=0, le=1e7, description="Where the front of the train stops [m].")
    dwell_s: Number = Field(0.0, ge=0, le=86400, description="Dwell time [s]; 0 at the ends of the line.")
    arrival_s: Number | None = Field(
        None, gt=0, le=86400, description="Arrival in a given timetable, from the start of the run [s]."
    )
    # a window and not one time: two equal ends fix the arrival, and an absent one leaves its side free
    earliest_arrival_s: Number | None = Field(
        None, ge=0, le=86400, description="Earliest arrival, from the start of the run [s]."
    )
    latest_arrival_s: Number | None = Field(
        None, gt=0, le=86400, description="Latest arrival, from the start of the run [s]."
    )

    @model_validator(mode="after")
    def _window_is_one(self) -> Self:
        earliest, latest = self.earliest_arrival_s, self.latest_arrival_s
        if earliest is not None and latest is not None and latest < earliest:
            raise ValueError(f"latest_arrival_s = {latest:g} lies before earliest_arrival_s = {earliest:g}")
        return self

    @property
    def window_s(self) -> tuple[float, float]:
        """Earliest and latest arrival [s]; 0 and infinite where they are free."""
        latest = self.latest_arrival_s
        return self.earliest_arrival_s or 0.0, float("inf") if latest is None else latest


class PassingPoint(Part):
    """A place that the train passes at a given speed, as a signal or a junction may ask for."""

    name: Name = Field("", max_length=200, description="Name of the place.")
    position_m: Number = Field(gt=0, le=1e7, description="Where the front of the train has the speed [m].")
    # above 0: a train that stands there makes a stop, which is a station
    speed_kmh: Number = Field(gt=0, le=600, description="Speed of the train there [km/h].")


AnyStretch = TypeVar("AnyStretch", bound=Stretch)


def _turned(stretch: AnyStretch, length_m: float) -> AnyStretch:
    """Return a stretch as a train meets it that runs the line from its end."""
    # max: a stretch up to the very end may begin a rounding error before the start once it is turned round
    ends = {"from_m": max(length_m - stretch.to_m, 0.0), "to_m": length_m - stretch.from_m}
    return stretch.model_copy(update=ends)


def _require_apart(key: str, points: Sequence[Station | PassingPoint]) -> None:
    """Raise ValueError if positions do not rise by the shortest distance at least."""
    if any(later.position_m - earlier.position_m < SHORTEST_DISTANCE_M for earlier, later in pairwise(points)):
        raise ValueError(f"{key} must have rising positions, at least {SHORTEST_DISTANCE_M:g} m apart")


class Line(PresetPart):
    """A line as it is described in its forward direction.

    `reverse` turns the whole of it, limits and stations included.
    """

    preset_kind = "lines"
    name: Name = Field("", max_length=200, description="Name of the line.")
    reverse: bool = Field(False, strict=True, description="Run the line from its end to its start.")
    sections: tuple[Section, ...] = Field(min_length=1, max_length=100_000)
    speed_limits: tuple[SpeedLimit, ...] = Field((), max_length=10_000)
    neutral_sections: tuple[NeutralSection, ...] = Field(
        (), max_length=10_000, description="Where the drive neither pulls nor brakes, for want of traction power."
    )
    traction_limits: tuple[TractionLimit, ...] = Field(
        (), max_length=1000, description="Where tractive effort, power, current or recuperation is limited."
    )
    rail_conditions: tuple[RailStretch, ...] = Field(
        (), max_length=1000, description="Where the rail condition is another than `rail_condition`."
    )
    stations: tuple[Station, ...] = Field((), max_length=1000)
    passing_points: tuple[PassingPoint, ...] = Field((), max_length=1000)
    limits_hold_for: Literal["front", "whole_train"] = Field(
        "front", description="Whether a limit ends with the front of the train or once its rear has left, too."
    )
    limit_margin_m: Number = Field(
        0.0, ge=0, le=10_000, description="How far before its beginning a lower speed limit holds already [m]."
    )
    # no line is driven in a gale of more than 150 km/h; a wind from behind would turn the sign of v + wind near rest
    head_wind_kmh: Number = Field(
        0.0, ge=0, le=150, description="Wind against the train, whichever way it runs [km/h]."
    )
    rail_condition: RailCondition | None = Field(
        None, description="Rail condition, by which adhesion limits the efforts; if empty, it does not."
    )

    @classmethod
    def from_tables(
        cls,
        *,
        gradients: "str | Path | pandas.DataFrame | None" = None,
        heights: "str | Path | pandas.DataFrame | None" = None,
        limits: "str | Path | pandas.DataFrame | None" = None,
        curves: "str | Path | pandas.DataFrame | None" = None,
        tunnels: "str | Path | pandas.DataFrame | None" = None,
        neutral: "str | Path | pandas.DataFrame | None" = None,
        stations: "str | Path | pandas.DataFrame | Sequence[Station]" = (),
        settings: Mapping[str, str] | None = None,
        begin_m: float | None = None,
        end_m: float | None = None,
        reverse: bool = False,
        name: str = "",
    ) -> "Line":
        """Return the line that tables of intervals over one chainage describe.

        A warning is issued for each assumption, and for each row that is not used.

        Parameters
        ----------
        gradients, limits, curves, tunnels, neutral : str, Path or DataFrame, optional
            A CSV file, a workbook or a data frame, with columns such as "from [m]", "to [m]", "gradient [permille]". At
            least one table is needed.
        heights : str, Path or DataFrame, optional
            Heights over position, or a track in GPX, from which gradients are found, if there is no table of them.
        stations : str, Path, DataFrame or sequence of Station
            A table of stations, with columns such as "name", "position [m]", "dwell [s]", "arrival", "departure",
            "earliest arrival [s]"; or the stations at their chainage [m]. A warning names the travel time that an
            arrival at the last station gives.
        settings : mapping of str to str, optional
            Columns and units that the tables do not name, such as {"gradients.value_unit": "permille"} or
            {"limits.from": "begins at"}.
        begin_m, end_m : float, optional
            The chainage between which the line lies [m]; by default from the first to the last station of a table, or
            row of gradients and limits.
        reverse : bool
            Run it in falling chainage: positions are mirrored, and gradients change their signs.
        name : str
            Name of the line.

        Raises
        ------
        ScenarioError
            If a table cannot be read, or its units are in doubt.
        """
        # by name: imports make lines, and compiled kernels depend on lines and must not depend on all that imports use
        module = import_module("railjoule.core.imports.line")
        tables: dict[Any, Any] = {
            "gradients": gradients,
            "heights": heights,
            "limits": limits,
            "curves": curves,
            "tunnels": tunnels,
            "neutral": neutral,
            "stations": stations,
        }
        line: Line = module.line_from_tables(tables, settings or {}, begin_m, end_m, reverse, name)
        return line

    @model_validator(mode="after")
    def _is_one_line(self) -> Self:
        length = self.length_m
        if length < SHORTEST_DISTANCE_M:
            raise ValueError(f"is {length:g} m long, and must be at least {SHORTEST_DISTANCE_M:g} m")
        for key in STRETCHES:
            for index, one in enumerate(getattr(self, key)):
                self._require_on_line(f"{key}[{index}].to_m", one.to_m)
        # two stations closer than a cell would share a node of the mesh, at which the train could stand only once
        _require_apart("stations", self.stations)
        for index, station in enumerate(self.stations[-1:], len(self.stations) - 1):
            self._require_on_line(f"stations[{index}].position_m", station.position_m)
        # a run lasts from the departure at one end of the line to the arrival at the other
        self._require_no_times(self.start_station, TIMES_OF_A_STOP, "begins when the train leaves this station")
        self._require_no_times(self.end_station, ("dwell_s",), "ends when the train arrives at this station")
        self._require_passes_between_stops()
        return self

    def _require_on_line(self, key: str, place_m: float) -> None:
        # the length is a sum of sections, whose last digits need not be those of a limit that ends with it
        if place_m > self.length_m + 1e-9:
            raise ValueError(f"{key} = {place_m:g} lies beyond the end of the line at {self.length_m:g} m")

    def _require_no_times(self, station: Station | None, keys: tuple[str, ...], reason: str) -> None:
        """Raise ValueError if a station at an end of the line has a time that only counts between the ends."""
        key = next((key for key in keys if getattr(station, key, None)), None)
        if station is not None and key is not None:
            # by place: two stations may be equal in all else
            index = [other.position_m for other in self.stations].index(station.position_m)
            value = getattr(station, key)
            raise ValueError(f"stations[{index}].{key} = {value:g} has no effect, as the run {reason}: remove the key")

    def _require_passes_between_stops(self) -> None:
        length = self.length_m
        # each of them is a node of the mesh, at which a speed can be prescribed only once
        _require_apart("passing_points", self.passing_points)
        for index, point in enumerate(self.passing_points):
            key, place = f"passing_points[{index}].position_m", point.position_m
            if place > length - SHORTEST_DISTANCE_M:
                raise ValueError(
                    f"{key} = {place:g} must lie at least {SHORTEST_DISTANCE_M:g} m before the end of the line at "
                    f"{length:g} m"
                )
            if any(abs(place - station.position_m) < SHORTEST_DISTANCE_M for station in self.stations):
                raise ValueError(f"{key} = {place:g} lies at a station, where the train stands")

    @property
    def length_m(self) -> float:
        """Length of the line [m]."""
        return float(sum(section.length_m for section in self.sections))

    def in_running_order(self) -> "Line":
        """Return the line as the train meets it, with `reverse` carried out."""
        if not self.reverse:
            return self
        length = self.length_m
        return self.model_copy(
            update={
                "reverse": False,
                "sections": tuple(
                    section.model_copy(update={"gradient_permille": -section.gradient_permille})
                    for section in reversed(self.sections)
                ),
                **{key: tuple(_turned(one, length) for one in reversed(getattr(self, key))) for key in STRETCHES},
                "stations": tuple(
                    station.model_copy(update={"position_m": max(length - station.position_m, 0.0)})
                    for station in reversed(self.stations)
                ),
                "passing_points": tuple(
                    point.model_copy(update={"position_m": length - point.position_m})
                    for point in reversed(self.passing_points)
                ),
            }
        )

    @property
    def all_rail_conditions(self) -> frozenset[RailCondition | None]:
        """The rail conditions of all places."""
        return frozenset((self.rail_condition, *(one.condition for one in self.rail_conditions)))

    @property
    def inner_stations(self) -> tuple[Station, ...]:
        """The stations that lie neither at the start nor at the end of the line."""
        length = self.length_m
        return tuple(station for station in self.stations if AT_END_M < station.position_m < length - AT_END_M)

    @property
    def stops_m(self) -> tuple[float, ...]:
        """Places where the front of the train stands, from one end of the line to the other [m]."""
        return 0.0, *(station.position_m for station in self.inner_stations), self.length_m

    @property
    def start_station(self) -> Station | None:
        """The station where the run begins, if the line has one there."""
        return self._station_at(end=self.reverse)

    @property
    def end_station(self) -> Station | None:
        """The station where the run ends, if the line has one there."""
        return self._station_at(end=not self.reverse)

    def _station_at(self, end: bool) -> Station | None:
        """Return the station at the end of the line as it is described, or at its start."""
        if not self.stations:
            return None
        station = self.stations[-1 if end else 0]
        distance_m = self.length_m - station.position_m if end else station.position_m
        return station if distance_m <= AT_END_M else None
