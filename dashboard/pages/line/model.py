"""What the page Line asks for: dwells and fixed arrivals of the stations between the ends."""

from typing import Any

import param

from railjoule.core import Scenario
from railjoule.dashboard.pages.line.compute import LineRuns
from railjoule.dashboard.state.numbers import TypedNumber, TypedParameters
from railjoule.dashboard.state.page_model import PageModel, result

# as core/scenario/timetable.py bounds the travel time
LATEST_S = 86_400.0
OTHERS = ("proportional", "equal")


class StationModel(TypedParameters):
    """A station between the ends."""

    kept = ("number", "station", "position_m", "dwell_s", "fixed", "arrival_s")

    number = param.Integer(default=0, bounds=(0, None), doc="Number, counted from 0.")
    station = param.String(default="", doc="Name.")
    position_m = param.Number(default=0.0, bounds=(0, None), doc="Where the train stops, m")
    dwell_s = TypedNumber("Dwell, s", "s", default=0.0, bounds=(0, LATEST_S))
    fixed = param.Boolean(default=False, doc="Whether the timetable fixes the arrival.")
    arrival_s = TypedNumber("Arrives after, s", "s", 1, default=0.0, bounds=(0, LATEST_S))


class LineModel(TypedParameters, PageModel):
    """The stations and the runs over the line."""

    kept = ("stations", "other")

    stations = param.List(default=[], item_type=StationModel, doc="The stations between the ends, in running order.")
    other = param.Selector(default="proportional", objects=list(OTHERS), doc="Rule to compare the optimum with.")
    runs = result(LineRuns, "The last good runs.")

    def take(self, scenario: Scenario) -> None:
        """Take over the stations of a scenario; those that stay where they are keep their fixed arrivals."""
        inner = scenario.line.in_running_order().inner_stations
        if [(s.name, s.position_m) for s in inner] != [(s.station, s.position_m) for s in self.stations]:
            self.stations = [
                StationModel(number=k, station=s.name, position_m=s.position_m, dwell_s=s.dwell_s)
                for k, s in enumerate(inner)
            ]
            return
        for station, given in zip(self.stations, inner, strict=True):
            station.dwell_s = given.dwell_s

    @property
    def arrivals_s(self) -> tuple[tuple[int, float], ...]:
        """The fixed arrivals [s] by the numbers of their stations."""
        return tuple((station.number, float(station.arrival_s)) for station in self.stations if station.fixed)

    def dwell_changes(self, scenario: Scenario) -> dict[str, Any]:
        """Return the keys of the file that give the scenario's stations the dwells of the page."""
        line = scenario.line
        # by rounded places, as those of a line in reverse are differences
        dwells = {round(station.position_m, 6): float(station.dwell_s) for station in self.stations}

        def place(position_m: float) -> float:
            return round(line.length_m - position_m if line.reverse else position_m, 6)

        return {
            "line.stations": [
                {
                    "name": station.name,
                    "position_m": station.position_m,
                    "dwell_s": dwells.get(place(station.position_m), station.dwell_s),
                }
                for station in line.stations
            ]
        }
