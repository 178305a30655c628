"""What the page Line edits in the scenario: dwells and arrivals of the stations between the ends."""

from collections.abc import Mapping, Sequence
from typing import Any

import param

from railjoule.core import RailjouleError, Scenario
from railjoule.core.scenario import Line, Station
from railjoule.core.studies.whole_line import Sharing
from railjoule.dashboard.pages.line.compute import LineRuns
from railjoule.dashboard.state.kept import Kept
from railjoule.dashboard.state.numbers import TypedNumber, TypedParameters
from railjoule.dashboard.state.page_model import PageModel, result
from railjoule.dashboard.state.scenario import ScenarioModel

# as core/scenario/timetable.py bounds the travel time
LATEST_S = 86_400.0
# as the pages write times: core/scenario/line.py takes a latest arrival above 0 alone
LEAST_S = 0.1
OTHERS: tuple[Sharing, ...] = ("proportional", "equal", "given")
ARRIVALS = ("free", "fixed", "window")
STATIONS_KEY = "line.stations"
FIRST_WINDOW_S = 5.0
"""How far a window that is opened reaches to both sides of the present arrival: at first it changes nothing."""
Row = dict[str, Any]


class LinkedStation(Kept):
    """A station as links had it before the scenario itself could fix an arrival."""

    kept = ("number", "station", "position_m", "dwell_s", "fixed", "arrival_s")

    number = param.Integer(default=0, bounds=(0, None), doc="Number, counted from 0.")
    station = param.String(default="", doc="Name.")
    position_m = param.Number(default=0.0, bounds=(0, None), doc="Where the train stops, m")
    dwell_s = param.Number(default=0.0, bounds=(0, LATEST_S), doc="Dwell, s")
    fixed = param.Boolean(default=False, doc="Whether the arrival is fixed.")
    arrival_s = param.Number(default=0.0, bounds=(0, LATEST_S), doc="Arrival, s")


class StationModel(TypedParameters):
    """A station between the ends, as the scenario has it."""

    passing = (
        "number",
        "station",
        "position_m",
        "dwell_s",
        "arrival",
        "arrival_s",
        "earliest_s",
        "latest_s",
        "given_s",
    )
    may_be_empty = ("earliest_s", "latest_s", "given_s")

    number = param.Integer(default=0, bounds=(0, None), doc="Number, counted from 0.")
    station = param.String(default="", doc="Name.")
    position_m = param.Number(default=0.0, bounds=(0, None), doc="Where the train stops, m")
    dwell_s = TypedNumber("Dwell, s", "s", default=0.0, bounds=(0, LATEST_S))
    arrival = param.Selector(default="free", objects=list(ARRIVALS), doc="Whether the optimum may choose the arrival.")
    arrival_s = TypedNumber("Arrives after, s", "s", 1, default=LEAST_S, bounds=(LEAST_S, LATEST_S))
    earliest_s = TypedNumber("Earliest arrival, s", "s", 1, default=None, allow_None=True, bounds=(0, LATEST_S))
    latest_s = TypedNumber("Latest arrival, s", "s", 1, default=None, allow_None=True, bounds=(LEAST_S, LATEST_S))
    given_s = TypedNumber("Given arrival, s", "s", 1, default=None, allow_None=True, bounds=(LEAST_S, LATEST_S))

    @classmethod
    def of(cls, number: int, station: Station) -> "StationModel":
        """Return the model of a station."""
        made = cls(number=number, station=station.name, position_m=station.position_m)
        made.take(station)
        return made

    @property
    def name_or_number(self) -> str:
        """What the station is called."""
        # the number counts from 0 between the ends, and the start is station 1
        return self.station or f"Station {self.number + 2}"

    def take(self, station: Station, keep_kind: bool = False) -> None:
        """Take over the times of the scenario.

        Parameters
        ----------
        station : Station
        keep_kind : bool
            Whether a window that is just typed stays one, though for now it is open or closed at both sides.
        """
        earliest, latest = station.earliest_arrival_s, station.latest_arrival_s
        fixed = earliest is not None and earliest == latest
        kind = "fixed" if fixed else "free" if earliest is latest is None else "window"
        self.param.update(
            dwell_s=station.dwell_s,
            arrival=self.arrival if keep_kind else kind,
            earliest_s=earliest,
            latest_s=latest,
            given_s=station.arrival_s,
            **({"arrival_s": latest} if fixed else {}),
        )

    @property
    def row(self) -> Row:
        """The times by the keys of the file; None for what it does not name."""
        window = {"free": (None, None), "fixed": (self.arrival_s, self.arrival_s)}
        earliest, latest = window.get(self.arrival, (self.earliest_s, self.latest_s))
        return {
            "dwell_s": float(self.dwell_s),
            "arrival_s": self.given_s,
            "earliest_arrival_s": earliest,
            "latest_arrival_s": latest,
        }

    def begin_kind(self, arrival_s: float) -> None:
        """Begin a fixed arrival or a window with the present arrival [s], so that nothing changes at first."""
        if self.arrival == "fixed":
            self.arrival_s = round(arrival_s, 1)
        elif self.arrival == "window":
            first, last = round(arrival_s - FIRST_WINDOW_S, 1), round(arrival_s + FIRST_WINDOW_S, 1)
            self.param.update(earliest_s=max(first, 0.0), latest_s=min(last, LATEST_S))

    def bounds_of(self, field: str) -> tuple[float | None, float | None]:
        """Return the least and the largest number that a field takes; neither end of a window passes the other."""
        low, high = super().bounds_of(field)
        if field == "earliest_s" and self.latest_s is not None:
            return low, self.latest_s
        if field == "latest_s" and self.earliest_s is not None:
            return max(self.earliest_s, LEAST_S), high
        return low, high


class LineModel(TypedParameters, PageModel):
    """The stations and the runs over the line; the stations' times stand in the scenario, which it edits."""

    kept = ("stations", "other")
    passing = ("inner_stations", "moving", "moved")

    stations = param.List(
        default=[], item_type=LinkedStation, doc="What a link of an earlier version says; never of this page."
    )
    inner_stations = param.List(
        default=[], item_type=StationModel, doc="The stations between the ends, as they are run."
    )
    other = param.Selector(default="proportional", objects=list(OTHERS), doc="What to compare the optimum with.")
    moving = param.Boolean(default=False, doc="Whether a station is being dragged.")
    moved = param.Tuple(default=None, length=2, allow_None=True, doc="Its number, and the arrival where it is now, s.")
    runs = result(LineRuns, "The last good runs.")

    def __init__(self, scenario: ScenarioModel, **params: Any) -> None:
        super().__init__(**params)
        self.scenario = scenario

    def take(self, scenario: Scenario, keep_kind: bool = False) -> None:
        """Take over the stations of a scenario; `keep_kind` as for `StationModel.take`."""
        inner = scenario.line.in_running_order().inner_stations
        if [(s.name, s.position_m) for s in inner] != [(s.station, s.position_m) for s in self.inner_stations]:
            self.inner_stations = [StationModel.of(number, station) for number, station in enumerate(inner)]
            return
        for model, station in zip(self.inner_stations, inner, strict=True):
            model.take(station, keep_kind)

    @property
    def shown_other(self) -> Sharing:
        """What the optimum is compared with: a given timetable only where there is one."""
        there = self.runs is not None and self.other in self.runs.runs
        return self.other if there else OTHERS[0]

    def edit(self, times: Mapping[int, Mapping[str, Any]]) -> None:
        """Lay times of stations over the scenario, so that every page, a file and a command have them.

        Parameters
        ----------
        times : mapping of int to mapping
            What changes, by the keys of the file and the number of the station; None takes a key away.

        Raises
        ------
        RailjouleError
            If a time is out of its bounds; then nothing changes.
        """
        model = self.scenario
        rows = station_rows(model.edited.line, times)
        others = {key: value for key, value in model.edits.items() if key != STATIONS_KEY}
        if rows == station_rows(model.base.replace(**others).line, {}):
            model.take_back(STATIONS_KEY)
        else:
            model.edit({STATIONS_KEY: rows})

    def take_over(self, sharing: Sharing | None) -> None:
        """Make the arrivals of a shown run the given timetable, or tell why not; without a run, give none."""
        arrivals: list[float | None] = [None] * len(self.inner_stations)
        if sharing is not None:
            if self.runs is None:
                return
            arrivals = [round(leg.arrival_s, 1) for leg in self.runs.runs[sharing].legs[:-1]]
        try:
            self.edit({number: {"arrival_s": arrival} for number, arrival in enumerate(arrivals)})
        except RailjouleError as error:
            self.failure = error

    def lay(self, values: Mapping[str, Any]) -> None:
        """Take over checked values by field; arrivals that a link of an earlier version fixes go into the scenario.

        Raises
        ------
        ValueError
            If such a link fixes an arrival at a station that is not there.
        RailjouleError
            If the arrival is out of its bounds.
        """
        super().lay({field: value for field, value in values.items() if field != "stations"})
        fixed = [station for station in values.get("stations", ()) if station.get("fixed")]
        if fixed:
            self.edit(self._fixed_by(fixed))

    def _fixed_by(self, stations: Sequence[Mapping[str, Any]]) -> dict[int, Row]:
        inner = self.scenario.edited.line.in_running_order().inner_stations
        numbers = {(s.name, round(s.position_m, 6)): number for number, s in enumerate(inner)}
        times = {}
        for station in stations:
            place = float(station.get("position_m", 0.0))
            number = numbers.get((station.get("station", ""), round(place, 6)))
            if number is None:
                raise ValueError(f"there is no station at {place:g} m to fix an arrival at")
            at = station.get("arrival_s", 0.0)
            times[number] = {"earliest_arrival_s": at, "latest_arrival_s": at}
        return times


def station_rows(line: Line, times: Mapping[int, Mapping[str, Any]]) -> list[Row]:
    """Return the stations of a line as they stand in its file, with other times.

    Parameters
    ----------
    line : Line
    times : mapping of int to mapping
        Times by the keys of the file and by the number of the station between the ends, in running order.
    """
    # by rounded places, as those of a line in reverse are differences
    running = line.in_running_order().inner_stations
    changes = {round(station.position_m, 6): times.get(number, {}) for number, station in enumerate(running)}

    def place(position_m: float) -> float:
        return round(line.length_m - position_m if line.reverse else position_m, 6)

    rows = [
        {**station.model_dump(exclude_none=True), **changes.get(place(station.position_m), {})}
        for station in line.stations
    ]
    return [{key: value for key, value in row.items() if value is not None} for row in rows]
