"""The stations between the ends of a line: their dwells and arrivals, which the page Line edits in the scenario."""

from collections.abc import Mapping
from typing import Any

import param

from railjoule.core.scenario import Line, Station
from railjoule.dashboard.state.kept import Kept
from railjoule.dashboard.state.numbers import TypedNumber, TypedParameters

# as core/scenario/timetable.py bounds the travel time
LATEST_S = 86_400.0
# as the pages write times: core/scenario/line.py takes only a latest arrival above 0
LEAST_S = 0.1
TIMES = ("dwell_s", "earliest_s", "latest_s", "given_s")
Row = dict[str, Any]


class LinkedStation(Kept):
    """A station in links of versions whose scenario could not fix an arrival."""

    kept = ("number", "station", "position_m", "dwell_s", "fixed", "arrival_s")

    number = param.Integer(default=0, bounds=(0, None), doc="Number, counted from 0.")
    station = param.String(default="", doc="Name.")
    position_m = param.Number(default=0.0, bounds=(0, None), doc="Position of the stop, m")
    dwell_s = param.Number(default=0.0, bounds=(0, LATEST_S), doc="Dwell, s")
    fixed = param.Boolean(default=False, doc="Whether the arrival is fixed.")
    arrival_s = param.Number(default=0.0, bounds=(0, LATEST_S), doc="Arrival, s")


class StationModel(TypedParameters):
    """A station between the ends, as the scenario has it."""

    passing = ("number", "station", "position_m", *TIMES)
    may_be_empty = ("earliest_s", "latest_s", "given_s")

    number = param.Integer(default=0, bounds=(0, None), doc="Number, counted from 0.")
    station = param.String(default="", doc="Name.")
    position_m = param.Number(default=0.0, bounds=(0, None), doc="Position of the stop, m")
    dwell_s = TypedNumber("Dwell, s", "s", default=0.0, bounds=(0, LATEST_S))
    earliest_s = TypedNumber("Earliest arrival, s", "s", 1, default=None, allow_None=True, bounds=(0, LATEST_S))
    latest_s = TypedNumber("Latest arrival, s", "s", 1, default=None, allow_None=True, bounds=(LEAST_S, LATEST_S))
    given_s = TypedNumber("Present arrival, s", "s", 1, default=None, allow_None=True, bounds=(LEAST_S, LATEST_S))

    @classmethod
    def of(cls, number: int, station: Station) -> "StationModel":
        """Return the model of a station."""
        made = cls(number=number, station=station.name, position_m=station.position_m)
        made.take(station)
        return made

    @property
    def name_or_number(self) -> str:
        """The name of the station, or its number."""
        # the number counts from 0 between the ends, and the start is station 1
        return self.station or f"Station {self.number + 2}"

    def take(self, station: Station) -> None:
        """Take over the times of the scenario."""
        self.param.update(
            dwell_s=station.dwell_s,
            earliest_s=station.earliest_arrival_s,
            latest_s=station.latest_arrival_s,
            given_s=station.arrival_s,
        )

    @property
    def row(self) -> Row:
        """The times by the keys of the file; None for what it does not name."""
        return {
            "dwell_s": float(self.dwell_s),
            "arrival_s": self.given_s,
            "earliest_arrival_s": self.earliest_s,
            "latest_arrival_s": self.latest_s,
        }

    def field_bounds(self, field: str) -> tuple[float | None, float | None]:
        """Return the least and the largest number that a field takes; neither end of a window passes the other."""
        low, high = super().field_bounds(field)
        if field == "earliest_s" and self.latest_s is not None:
            return low, self.latest_s
        if field == "latest_s" and self.earliest_s is not None:
            return max(self.earliest_s, LEAST_S), high
        return low, high


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
