"""A whole line with its stations: how the running time is shared among the legs between them, and what that costs.

The optimum of a line is one solve: the speed is zero at each station, and one multiplier, the price of a second,
shares the running time so that a second more saves alike on every leg. Beside it stand the two rules of timetable
practice, supplements in proportion to the shortest times and the same supplement on every leg, and the timetable that
the stations' `arrival_s` give. A station whose window of arrival binds parts the line: on either side of it a
multiplier of its own holds, see `railjoule.core.strategies.line_parts`.
"""

from collections.abc import Mapping
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
    Part,
    inner_stations,
    joined,
    parts_between,
    shortest_times_s,
    station_name,
    stop_nodes,
)
from railjoule.core.strategies.optimal import unwindowed_optimum
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
        Where they lie [m].
    departure_s, arrival_s : float
        When the train leaves one and reaches the other [s].
    shortest_time_s : float
        Shortest possible running time [s].
    energy_j : float
        Net energy at the line while it runs, auxiliaries included [J].
    price_of_time_w : float
        By how much that energy falls if the leg takes a second longer [J/s], negative where it rises; NaN where it is
        not known.
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
        """What the running time exceeds the shortest one by [s]."""
        return self.running_time_s - self.shortest_time_s


@dataclass(frozen=True, eq=False)
class WholeLine:
    """A run over a line with stations.

    Parameters
    ----------
    sharing : str
        How the running time is shared: by the optimum, in proportion to the shortest times, in equal supplements, or as
        the stations' `arrival_s` say.
    run : Trajectory
        All legs with the dwells between them.
    legs : tuple of Leg
    """

    sharing: Sharing
    run: Trajectory
    legs: tuple[Leg, ...]

    def to_dataframe(self) -> "pandas.DataFrame":
        """Return the legs as a table."""
        import pandas  # noqa: PLC0415  (slow to import, and seldom needed)

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
    """Return the run of least energy over a line whose running time is shared in one of four ways.

    Parameters
    ----------
    scenario : Scenario
        Its line may have stations between its ends; their dwells count. The optimum keeps their windows of arrival; the
        two rules keep those whose ends are equal, and a given timetable is kept as it is.
    sharing : str
        'optimum', 'proportional', 'equal' or 'given'.
    arrivals_s : mapping of int to float, optional
        Fixed arrivals [s] by the number of the station between the ends, counted from 0; they take the place of the
        stations' windows.

    Raises
    ------
    ScenarioError
        If a station with a fixed arrival does not exist or cannot be reached in time, or no station has a given
        arrival.
    TimetableError
        If the timetable cannot be kept.
    SolverError
        As `railjoule.core.strategies.optimal.optimal`.
    """
    return shared_line(prepare_task(scenario), sharing, arrivals_s)


def shared_line(task: Task, sharing: Sharing, arrivals_s: Mapping[int, float] | None = None) -> WholeLine:
    """Return as `whole_line` the run of a task that is prepared already."""
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
        windows = _arrivals_by_rule(task, windows, sharing)
        line = timed_line(task, {number: low for number, (low, _) in windows.items()}, unwindowed_optimum)
    run = joined(task, line, bound_within(task, line, windows))
    return WholeLine(sharing, run, _legs(task, run, line))


def _arrivals_by_rule(task: Task, windows: Windows, sharing: Sharing) -> dict[int, tuple[float, float]]:
    """Return the arrivals that a rule or a timetable fixes, as windows with equal ends."""
    line, end = task.scenario.line.in_running_order(), len(inner_stations(task))
    if sharing == "given":
        given = {k: s.arrival_s for k, s in enumerate(line.inner_stations) if s.arrival_s is not None}
        if not given:
            raise ScenarioError("No station between the ends has an arrival_s: there is no timetable to compare with.")
        if line.end_station is not None and line.end_station.arrival_s is not None:
            given[end] = line.end_station.arrival_s
        return {number: (at, at) for number, at in given.items()}
    stops = stop_nodes(task)
    numbers = {node: number for number, node in enumerate(stops[1:])}
    arrivals, ready_s = {}, 0.0
    for part in parts_between(task, {number: low for number, (low, high) in windows.items() if low == high}):
        for _, node, running_s in _shared(task, stops, part, sharing):
            arrivals[numbers[node]] = ready_s + running_s
            ready_s = arrivals[numbers[node]] + float(task.course.dwell_s[node])
    if end not in windows:
        # without a window there, the end is reached within the time
        del arrivals[end]
    return {number: (at, at) for number, at in arrivals.items()}


def _shared(task: Task, stops: list[int], part_of_line: Part, sharing: Sharing) -> list[Part]:
    """Share the running time of a part of the line among its legs."""
    first, last, running = part_of_line
    inside = [stop for stop in stops if first <= stop <= last]
    shortest = shortest_times_s(task, inside)
    # the two rules of practice beside which the optimum is shown: so many per cent, or so many seconds a leg
    if sharing == "proportional":
        times = shortest * (running / shortest.sum())
    else:
        times = shortest + (running - shortest.sum()) / len(shortest)
    return [Part(a, b, float(time)) for (a, b), time in zip(pairwise(inside), times, strict=True)]


def nodes_at_stops(run: Trajectory, places_m: FloatArray) -> tuple[IntArray, IntArray]:
    """Return the nodes of a run at which the train arrives at places [m], and those from which it leaves them."""
    # a station has two nodes where the train stands for a while: it arrives at the first and leaves from the second
    return np.searchsorted(run.position_m, places_m - 1e-6), np.searchsorted(run.position_m, places_m + 1e-6) - 1


def _legs(task: Task, run: Trajectory, line: LineParts) -> tuple[Leg, ...]:
    stops = stop_nodes(task)
    places, shortest = task.course.position_m[stops], shortest_times_s(task, stops)
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
            # that of a part without auxiliaries: they take their power for a second more, too
            auxiliary_w = task.course.data.auxiliary_power_w if timed.takes_exactly else 0.0
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
            energy_j=float(run.line_energy_j[arrives[k + 1]] - run.line_energy_j[leaves[k]]),
            price_of_time_w=float(prices[k]),
        )
        for k in range(len(stops) - 1)
    )
