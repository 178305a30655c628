"""A whole line with its stations: the distribution of the running time over its legs, and the energy of each.

The optimum of a line is one problem: the speed is zero at each station, and one multiplier, the price of time,
distributes the running time so that a further second saves the same energy on every leg. Two rules of timetable
practice are compared with it, supplements in proportion to the shortest times and equal supplements on all legs, and
the timetable of the stations' `arrival_s`. A station with a binding window of arrival divides the line into two parts
with a multiplier each, see `railjoule.core.strategies.line_parts`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from railjoule.core.arrays import FloatArray, IntArray
from railjoule.core.compilation import require_compiled
from railjoule.core.errors import ScenarioError
from railjoule.core.scenario import Scenario
from railjoule.core.strategies.arrival_windows import (
    Windows,
    arrival_windows,
    bound_within,
    optimum_within,
    timed_line,
)
from railjoule.core.strategies.line_parts import (
    LineParts,
    cut_part,
    inner_stations,
    joined,
    parts_between,
    shortest_times_s,
    station_name,
    stop_nodes,
)
from railjoule.core.strategies.optimal import unwindowed_optimum
from railjoule.core.studies.table import StudyTable
from railjoule.core.task import Task, prepare_task
from railjoule.core.trajectory import Trajectory
from railjoule.core.units import J_PER_KWH, J_PER_WH

if TYPE_CHECKING:
    import pandas

Sharing = Literal["optimum", "proportional", "equal", "given"]


@dataclass(frozen=True)
class Leg:
    """The section from one station to the next.

    Parameters
    ----------
    departs_from, arrives_at : str
        Names of the stations.
    start_m, end_m : float
        Their positions [m].
    departure_s, arrival_s : float
        Times of departure and arrival [s].
    shortest_time_s : float
        Shortest possible running time [s].
    energy_j : float
        Net energy at the line while the train runs, auxiliaries included [J].
    price_of_time_w : float
        Decrease of that energy if the leg takes a second longer [J/s], negative for an increase; NaN where unknown.
    """

    departs_from: str
    arrives_at: str
    start_m: float
    end_m: float
    departure_s: float
    arrival_s: float
    shortest_time_s: float
    energy_j: float
    price_of_time_w: float

    @property
    def running_time_s(self) -> float:
        """Time between the stations [s]."""
        return self.arrival_s - self.departure_s

    @property
    def supplement_s(self) -> float:
        """Running time beyond the shortest one [s]."""
        return self.running_time_s - self.shortest_time_s


@dataclass(frozen=True, eq=False)
class WholeLine:
    """A run over a line with stations.

    Parameters
    ----------
    sharing : str
        How the running time is distributed: by the optimum, in proportion to the shortest times, in equal supplements,
        or by the stations' `arrival_s`.
    run : Trajectory
        All legs with the dwells between them.
    legs : tuple of Leg
    """

    sharing: Sharing
    run: Trajectory
    legs: tuple[Leg, ...]

    def to_dataframe(self) -> "pandas.DataFrame":
        """Return the legs as a table."""
        import pandas  # noqa: PLC0415  (slow to import, and rarely needed)

        rows: list[dict[str, Any]] = [
            {
                "sharing": self.sharing,
                "from": leg.departs_from,
                "to": leg.arrives_at,
                "from_m": leg.start_m,
                "to_m": leg.end_m,
                "departure_s": leg.departure_s,
                "arrival_s": leg.arrival_s,
                "running_time_s": leg.running_time_s,
                "shortest_time_s": leg.shortest_time_s,
                "supplement_s": leg.supplement_s,
                "energy_kwh": leg.energy_j / J_PER_KWH,
                "price_of_time_wh_per_s": leg.price_of_time_w / J_PER_WH,
            }
            for leg in self.legs
        ]
        return pandas.DataFrame(rows)


def whole_line(
    scenario: Scenario, sharing: Sharing = "optimum", arrivals_s: Mapping[int, float] | None = None
) -> WholeLine:
    """Return the run of least energy over a line whose running time is distributed in one of four ways.

    Parameters
    ----------
    scenario : Scenario
        Its line may have stations between its ends; their dwells count. The optimum keeps their windows of arrival, the
        two rules keep those with equal ends, and a given timetable is kept unchanged.
    sharing : str
        'optimum', 'proportional', 'equal' or 'given'.
    arrivals_s : mapping of int to float, optional
        Fixed arrivals [s] by the number of the station between the ends, counted from 0; they replace the windows of
        these stations.

    Raises
    ------
    ScenarioError
        If a station with a fixed arrival does not exist or cannot be reached in time, or no station has a given
        arrival.
    TimetableError
        If the timetable cannot be kept.
    SolverError
        As in `railjoule.core.strategies.optimal.optimal`.
    """
    return shared_line(prepare_task(scenario), sharing, arrivals_s)


def shared_line(task: Task, sharing: Sharing, arrivals_s: Mapping[int, float] | None = None) -> WholeLine:
    """Return the run of a prepared task; as in `whole_line`."""
    task.require_timetable()
    arrivals_s, inner = arrivals_s or {}, len(inner_stations(task))
    unknown = [number for number in arrivals_s if not 0 <= number < inner]
    if unknown:
        raise ScenarioError(f"There is no station {unknown[0]} between the ends of a line with {inner} stations there.")
    # each leg is solved many times
    require_compiled()
    windows = {**arrival_windows(task), **{number: (at, at) for number, at in arrivals_s.items()}}
    if sharing == "optimum":
        line = optimum_within(task, windows, unwindowed_optimum)
    else:
        arrivals = _given_arrivals(task) if sharing == "given" else _arrivals_by_rule(task, windows, sharing)
        line = timed_line(task, arrivals, unwindowed_optimum)
        windows = {number: (at, at) for number, at in arrivals.items()}
    run = joined(task, line, bound_within(task, line, windows))
    return WholeLine(sharing, run, _legs(task, run, line))


def _given_arrivals(task: Task) -> dict[int, float]:
    """Return the arrivals of the stations' timetable."""
    line = task.scenario.line.in_running_order()
    given = {number: one.arrival_s for number, one in enumerate(line.inner_stations) if one.arrival_s is not None}
    if not given:
        raise ScenarioError("No station between the ends has an arrival_s: there is no timetable to compare with.")
    if line.end_station is not None and line.end_station.arrival_s is not None:
        given[len(line.inner_stations)] = line.end_station.arrival_s
    return given


def _arrivals_by_rule(task: Task, windows: Windows, sharing: Sharing) -> dict[int, float]:
    """Return the arrivals of a rule of practice, between the windows with equal ends."""
    stops, arrivals, ready_s = stop_nodes(task), dict[int, float](), 0.0
    for first, last, running_s in parts_between(task, {k: low for k, (low, high) in windows.items() if low == high}):
        inside = [stop for stop in stops if first <= stop <= last]
        shortest_s = shortest_times_s(task, inside)
        if sharing == "proportional":
            times_s = shortest_s * (running_s / shortest_s.sum())
        else:
            times_s = shortest_s + (running_s - shortest_s.sum()) / len(shortest_s)
        for node, time_s in zip(inside[1:], times_s.tolist(), strict=True):
            number = stops.index(node) - 1
            arrivals[number] = ready_s + time_s
            ready_s = arrivals[number] + float(task.mesh.dwell_s[node])
    end = len(stops) - 2
    if end not in windows:
        # without a window, the end is reached within the travel time
        del arrivals[end]
    return arrivals


def nodes_at_stops(run: Trajectory, places_m: FloatArray) -> tuple[IntArray, IntArray]:
    """Return the nodes of arrival and of departure at places [m]."""
    # a station with a dwell has two nodes: the train arrives at the first and leaves from the second
    return np.searchsorted(run.position_m, places_m - 1e-6), np.searchsorted(run.position_m, places_m + 1e-6) - 1


def _legs(task: Task, run: Trajectory, line: LineParts) -> tuple[Leg, ...]:
    stops = stop_nodes(task)
    places, shortest = task.mesh.position_m[stops], shortest_times_s(task, stops)
    arrives, leaves = nodes_at_stops(run, places)
    stations = task.scenario.line.in_running_order().stations
    # to a millimetre, as places of the mesh are sums
    named = {round(station.position_m, 3): station.name for station in stations}
    names = [station_name(named.get(round(float(place), 3), ""), number) for number, place in enumerate(places)]
    prices = np.full(len(stops) - 1, np.nan)
    for timed in line:
        first, last, _ = timed.part
        inside = [first <= a and b <= last for a, b in pairwise(stops)]
        if timed.price_of_time_w is not None:
            # the price of such a part excludes the auxiliaries, which take their power for a second more, too
            auxiliary_w = task.mesh.data.auxiliary_power_w if timed.takes_exactly else 0.0
            prices[inside] = timed.price_of_time_w - auxiliary_w
    return tuple(
        Leg(
            departs_from=names[k],
            arrives_at=names[k + 1],
            start_m=float(places[k]),
            end_m=float(places[k + 1]),
            departure_s=float(run.time_s[leaves[k]]),
            arrival_s=float(run.time_s[arrives[k + 1]]),
            shortest_time_s=float(shortest[k]),
            energy_j=float(run.supply_energy_j[arrives[k + 1]] - run.supply_energy_j[leaves[k]]),
            price_of_time_w=float(prices[k]),
        )
        for k in range(len(stops) - 1)
    )


def leg_tables(task: Task, supplements_s: Sequence[float]) -> tuple[StudyTable, ...]:
    """Return energy and price of time of each leg over its supplement, in running order, to share it out by hand.

    Each value is the optimum of a leg by itself, from rest to rest. The sum of the energies is least where the prices
    of all legs are equal: this price is the multiplier of `whole_line`. The columns are `energy_kwh` and
    `price_of_time_wh_per_s`, NaN where it is unknown; the attribute `shortest_time_s` is the shortest running time.

    Parameters
    ----------
    task : Task
        Its line may have stations between its ends; windows of arrival and the travel time do not count.
    supplements_s : sequence of float
        Supplements to the shortest time of a leg [s], above 0.

    Raises
    ------
    ScenarioError
        If a supplement is not above 0.
    TimetableError, SolverError
        As in `railjoule.core.strategies.optimal.optimal`.
    """
    wrong = next((supplement for supplement in supplements_s if not supplement > 0), None)
    if wrong is not None:
        raise ScenarioError(f"supplements_s has {wrong:g}: each must be above 0 s.")
    stops = stop_nodes(task)
    tables = []
    for ends, shortest_s in zip(pairwise(stops), shortest_times_s(task, stops).tolist(), strict=True):
        runs = [unwindowed_optimum(cut_part(task, *ends, shortest_s + more_s)) for more_s in supplements_s]
        prices_w = np.array([run.price_of_time_w for run in runs], dtype=float)
        columns = {
            "energy_kwh": np.array([run.energy_kwh for run in runs]),
            "price_of_time_wh_per_s": prices_w / J_PER_WH,
        }
        tables.append(
            StudyTable(task.scenario, {"supplement_s": supplements_s}, columns, {"shortest_time_s": shortest_s})
        )
    return tuple(tables)
