"""A whole line with its stations: how the running time is shared among the legs between them, and what that costs.

The optimum of a line is one solve: the speed is zero at each station, and one multiplier, the price of a second,
shares the running time so that a second more saves alike on every leg. Beside it stand the two rules of timetable
practice: supplements in proportion to the shortest times, and the same supplement on every leg. A station with a
fixed arrival parts the line: on either side of it a multiplier of its own holds.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.errors import ScenarioError
from railjoule.core.motion import running_time
from railjoule.core.scenario import Scenario
from railjoule.core.strategies.optimal import optimal
from railjoule.core.task import Task, prepare_task
from railjoule.core.trajectory import Bound, Trajectory, make_trajectory
from railjoule.core.units import J_PER_KWH, J_PER_WH

if TYPE_CHECKING:
    import pandas

Sharing = Literal["optimum", "proportional", "equal"]


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
        By how much that energy falls if the leg takes a second longer [J/s]; NaN where it is not known.
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
        How the running time is shared: by the optimum, in proportion to the shortest times, or in equal supplements.
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
    """Return the run of least energy over a line whose running time is shared in one of three ways.

    Parameters
    ----------
    scenario : Scenario
        Its line may have stations between its ends; their dwells count.
    sharing : str
        'optimum', 'proportional' or 'equal'.
    arrivals_s : mapping of int to float, optional
        Fixed arrivals [s] by the number of the station between the ends, counted from 0; the others are free.

    Raises
    ------
    ScenarioError
        If a station with a fixed arrival does not exist or cannot be reached in time.
    TimetableError
        If the timetable cannot be kept.
    SolverError
        As `railjoule.core.strategies.optimal.optimal`.
    """
    return shared_line(prepare_task(scenario), sharing, arrivals_s)


def shared_line(task: Task, sharing: Sharing, arrivals_s: Mapping[int, float] | None = None) -> WholeLine:
    """Return as `whole_line` the run of a task that is prepared already."""
    task.require_timetable()
    stops = stop_nodes(task)
    parts = _parts_between_fixed_arrivals(task, stops, arrivals_s or {})
    if sharing != "optimum":
        parts = [leg for part_of_line in parts for leg in _shared(task, stops, part_of_line, sharing)]
    runs = [optimal(part_of(task, first, last, time)) for first, last, time in parts]
    run = runs[0] if len(runs) == 1 else _joined(task, runs, sharing)
    return WholeLine(sharing, run, _legs(task, stops, run, parts, runs))


def stop_nodes(task: Task) -> list[int]:
    """Return the nodes at which the train stands: the start, the stations, the end."""
    places = [station.position_m for station in task.scenario.line.in_running_order().inner_stations]
    # the mesh has a node at each station, but for the rounding of its sums
    inner = [int(np.argmin(np.abs(task.course.position_m - place))) for place in places]
    return [0, *inner, task.course.cell_count]


def shortest_times_s(task: Task, stops: Sequence[int]) -> FloatArray:
    """Return the shortest running time from each stop to the next [s]; shape (k - 1,) for k stops."""
    length, speed2 = task.course.data.cell_length_m, task.greatest_speed2
    return np.array([running_time(length[a:b], speed2[a : b + 1]) for a, b in pairwise(stops)])


def part_of(task: Task, first: int, last: int, running_time_s: float) -> Task:
    """Return the task between two nodes at which the train stands, over the same mesh.

    Parameters
    ----------
    task : Task
    first, last : int
        Nodes at which the train stands.
    running_time_s : float
        Time allowed, without the dwells between them [s].
    """
    part, speed2 = task.course.between(first, last), task.greatest_speed2[first : last + 1]
    return Task(task.scenario, part, speed2, running_time(part.data.cell_length_m, speed2), running_time_s)


def _parts_between_fixed_arrivals(
    task: Task, stops: list[int], arrivals_s: Mapping[int, float]
) -> list[tuple[int, int, float]]:
    """Return first node, last node and running time [s] of each part of the line."""
    stations = task.scenario.line.in_running_order().inner_stations
    unknown = [number for number in arrivals_s if not 0 <= number < len(stations)]
    if unknown:
        raise ScenarioError(
            f"There is no station {unknown[0]} between the ends of a line with {len(stations)} stations there."
        )
    dwell, shortest = task.course.dwell_s[stops], np.append(shortest_times_s(task, stops), 0.0)
    parts, first, departed_s = [], 0, 0.0
    # the end of the line is the last fixed arrival: the timetable fixes it
    for number, arrival in [*sorted((n + 1, s) for n, s in arrivals_s.items()), (len(stops) - 1, task.travel_time_s)]:
        running = arrival - departed_s - float(dwell[first + 1 : number].sum())
        least = float(shortest[first:number].sum())
        # as `task.LEAST_SLACK`: at the shortest time itself the optimum has no inside to search
        if running <= least * (1 + 1e-9):
            where = _name(stations[number - 1].name, number) if number <= len(stations) else "the end"
            earliest = departed_s + least + float(dwell[first + 1 : number].sum())
            raise ScenarioError(f"The arrival at {where} after {arrival:.1f} s must be later than {earliest:.1f} s.")
        parts.append((stops[first], stops[number], running))
        first, departed_s = number, arrival + float(dwell[number])
    return parts


def _shared(
    task: Task, stops: list[int], part_of_line: tuple[int, int, float], sharing: Sharing
) -> list[tuple[int, int, float]]:
    """Share the running time of a part of the line among its legs."""
    first, last, running = part_of_line
    inside = [stop for stop in stops if first <= stop <= last]
    shortest = shortest_times_s(task, inside)
    # the two rules of practice beside which the optimum is shown: so many per cent, or so many seconds a leg
    if sharing == "proportional":
        times = shortest * (running / shortest.sum())
    else:
        times = shortest + (running - shortest.sum()) / len(shortest)
    return [(a, b, float(time)) for (a, b), time in zip(pairwise(inside), times, strict=True)]


def _joined(task: Task, runs: list[Trajectory], sharing: Sharing) -> Trajectory:
    """Return runs that follow one another as one, with the dwells between them."""
    moving = [np.diff(run.position_m) > 0 for run in runs]
    speed2 = [run.speed_ms[np.append(True, moves)] ** 2 for run, moves in zip(runs, moving, strict=True)]
    bounds = [run.bound for run in runs if run.bound is not None]
    bound = None
    if len(bounds) == len(runs):
        # dwells between two parts belong to neither, so their time and their auxiliaries are added here
        standing_s = task.dwell_s - sum(_standing_s(run) for run in runs)
        standing_j = task.course.data.auxiliary_power_w * standing_s
        statement = (
            f"This is the sum of the bounds of {len(bounds)} parts of the line, and covers runs that take each of them "
            f"in the same time; that of the first reads: {bounds[0].statement}"
        )
        energy_j = sum(part.energy_j for part in bounds) + standing_j
        time_s = sum(part.travel_time_s for part in bounds) + standing_s
        floors = [np.broadcast_to(part.slowest_ms, part.position_m.shape) for part in bounds]
        slowest = np.append(floors[0][:1], np.concatenate([floor[1:] for floor in floors]))
        bound = Bound(energy_j, statement, task.course.position_m, time_s, slowest)
    return make_trajectory(
        task.scenario,
        task.course,
        "optimal",
        # the last node of a part is the first of the next, a stop: it counts once
        np.concatenate([speed2[0], *(values[1:] for values in speed2[1:])]),
        bound=bound,
        iterations=sum(run.iterations for run in runs),
        notes=tuple(dict.fromkeys(note for run in runs for note in run.notes)),
    )


def _standing_s(run: Trajectory) -> float:
    return float(np.sum(np.diff(run.time_s)[np.diff(run.position_m) == 0]))


def _legs(
    task: Task, stops: list[int], run: Trajectory, parts: list[tuple[int, int, float]], runs: list[Trajectory]
) -> tuple[Leg, ...]:
    places, shortest = task.course.position_m[stops], shortest_times_s(task, stops)
    # a station has two nodes where the train stands for a while: it arrives at the first and leaves from the second
    arrives = np.searchsorted(run.position_m, places - 1e-6)
    leaves = np.searchsorted(run.position_m, places + 1e-6) - 1
    stations = task.scenario.line.in_running_order().stations
    # to a millimetre, as places of the mesh are sums
    named = {round(station.position_m, 3): station.name for station in stations}
    names = [_name(named.get(round(float(place), 3), ""), number) for number, place in enumerate(places)]
    prices = np.full(len(stops) - 1, np.nan)
    for (first, last, _), part in zip(parts, runs, strict=True):
        inside = [first <= a and b <= last for a, b in pairwise(stops)]
        prices[inside] = np.nan if part.price_of_time_w is None else part.price_of_time_w
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


def _name(name: str, number: int) -> str:
    return name or f"station {number + 1}"
