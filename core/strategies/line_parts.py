"""A line in parts between fixed arrivals: the times of the parts, their runs, and the run that they make together.

Between two fixed arrivals one multiplier, the price of a second, shares the running time; on either side of a fixed
arrival it has a value of its own. A part that ends at a fixed arrival takes exactly its time. With T its time, E its
energy and N what of that is not auxiliary power P,

    E = P T + N,

where P T is a constant, so that such a part is solved without auxiliaries: the time that they make expensive is not
the solver's to choose. If more time saves nothing of N either, the train leaves the last stop before the arrival
later, which costs only the auxiliaries.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.errors import RailjouleError, ScenarioError
from railjoule.core.interior_point.start import SLOWEST_SPEED2
from railjoule.core.lower_bound import ON_TIME_S, Bound
from railjoule.core.motion import running_time
from railjoule.core.motion.driving import drive
from railjoule.core.physics.mesh_data import data_between
from railjoule.core.scenario import Station
from railjoule.core.task import MIN_SLACK, Task
from railjoule.core.trajectory import Trajectory, make_trajectory

Solver = Callable[[Task], Trajectory]
"""The best run of a task without windows."""
# The reward only has to exceed what a second costs: more of it gives the same run, in more iterations
SLOWING_FACTORS = (0.0, 1.0, 10.0, 100.0)
"""Rewards for a second that are tried, in shares of the greatest kinetic energy over the running time."""
# a decision where the drive is on leaves a millionth, see `railjoule.core.bounds.minimum`
LEFT_SHARE = 1e-5
"""Of the time of a part: so much is left over by rounding, not because more time saves nothing."""


class Part(NamedTuple):
    """First node, last node and running time of a part of a line."""

    first: int
    last: int
    running_time_s: float


@dataclass(frozen=True, eq=False)
class TimedRun:
    """The run of a part of a line.

    Parameters
    ----------
    part : Part
    run : Trajectory
        Without auxiliaries where the part takes exactly its time.
    takes_exactly : bool
        Whether it takes exactly its time; else it takes no more.
    wait_s : float
        How much longer the train stands at the last stop before the end of the part than planned [s].
    price_of_time_w : float or None
        Energy saved by a second more, without auxiliaries where the part takes exactly its time [J/s].
    bound : Bound or None
        Of the part, as `run`.
    """

    part: Part
    run: Trajectory
    takes_exactly: bool
    wait_s: float
    price_of_time_w: float | None
    bound: Bound | None


LineParts = tuple[TimedRun, ...]
"""Parts of a line that follow one another, each with its run."""


def inner_stations(task: Task) -> tuple[Station, ...]:
    """Return the stations of a task between the ends of its line, in running order."""
    return task.scenario.line.in_running_order().inner_stations


def stop_nodes(task: Task) -> list[int]:
    """Return the nodes at which the train stands: the start, the stations, the end."""
    # the mesh has a node at each station, but for the rounding of its sums
    inner = [int(np.argmin(np.abs(task.mesh.position_m - s.position_m))) for s in inner_stations(task)]
    return [0, *inner, task.mesh.cell_count]


def arrival_name(task: Task, number: int) -> str:
    """Return the name of a place of arrival by its number, counted from 0 behind the start: the last is the end."""
    inner = inner_stations(task)
    if number < len(inner):
        return station_name(inner[number].name, number + 1)
    end = task.scenario.line.end_station
    return "the end" if end is None or not end.name else end.name


def shortest_times_s(task: Task, stops: Sequence[int]) -> FloatArray:
    """Return the shortest running time from each stop to the next [s]; shape (k - 1,) for k stops."""
    length, speed2 = task.mesh.data.cell_length_m, task.fastest_speed2
    return np.array([running_time(length[a:b], speed2[a : b + 1]) for a, b in pairwise(stops)])


def longest_time_s(task: Task, stop: int) -> float:
    """Return a time that no run from the start to a node exceeds without a stop in between [s].

    The train brakes fully from the start down to the lowest speed of a run, and keeps that.
    """
    data = data_between(task.mesh.data, 0, stop)
    brake_fully = np.full(stop + 1, -np.inf)
    speed2, _ = drive(data, brake_fully, float(data.fixed_speed2[0]), pace_speed2=SLOWEST_SPEED2)
    speed2[-1] = np.nan_to_num(data.fixed_speed2[-1])
    return running_time(data.cell_length_m, speed2)


def cut_part(task: Task, first: int, last: int, running_time_s: float) -> Task:
    """Return the task between two nodes at which the train stands, over the same mesh.

    Parameters
    ----------
    task : Task
    first, last : int
        Nodes at which the train stands.
    running_time_s : float
        Time allowed, without the dwells between them [s].
    """
    part, speed2 = task.mesh.between(first, last), task.fastest_speed2[first : last + 1]
    shortest_s = running_time(part.data.cell_length_m, speed2)
    return Task(task.scenario, part, speed2, shortest_s, running_time_s, can_be_remeshed=False)


def with_auxiliaries(task: Task, power_w: float) -> Task:
    """Return a task with another power of its auxiliaries [W]."""
    mesh = task.mesh
    return replace(task, mesh=replace(mesh, data=mesh.data._replace(auxiliary_power_w=power_w)))


def parts_between(task: Task, arrivals_s: Mapping[int, float]) -> tuple[Part, ...]:
    """Return the parts of a line between fixed arrivals.

    Parameters
    ----------
    task : Task
    arrivals_s : mapping of int to float
        Fixed arrivals [s] by the number of the station, counted from 0 behind the start. That at the end of the line
        is the time of the task where it is not given.

    Raises
    ------
    ScenarioError
        If a station cannot be reached in time.
    """
    inner, stops = len(inner_stations(task)), stop_nodes(task)
    dwell, shortest = task.mesh.dwell_s[stops], np.append(shortest_times_s(task, stops), 0.0)
    parts: list[Part] = []
    first, departed_s = 0, 0.0
    for number, arrival in sorted({inner: task.travel_time_s, **arrivals_s}.items()):
        stop = number + 1
        standing = float(dwell[first + 1 : stop].sum())
        running, least = arrival - departed_s - standing, float(shortest[first:stop].sum())
        # at the shortest time itself the optimum has no inside to search
        if running <= least * (1 + MIN_SLACK):
            where, earliest = arrival_name(task, number), departed_s + least + standing
            raise ScenarioError(f"The arrival at {where} after {arrival:.1f} s must be later than {earliest:.1f} s.")
        parts.append(Part(stops[first], stops[stop], running))
        first, departed_s = stop, arrival + float(dwell[stop])
    return tuple(parts)


def timed_run(task: Task, part: Part, optimum: Solver, takes_exactly: bool) -> TimedRun:
    """Return the run of least energy of a part; arguments as for `TimedRun`, errors as `optimum`."""
    whole = cut_part(task, *part)
    if not takes_exactly:
        run = optimum(whole)
        return TimedRun(part, run, False, 0.0, run.price_of_time_w, run.bound)
    without_auxiliaries = with_auxiliaries(whole, 0.0)
    run = _in_time(without_auxiliaries, optimum)
    early_s = without_auxiliaries.travel_time_s - run.travel_time_s
    if early_s <= ON_TIME_S:
        return TimedRun(part, run, True, 0.0, run.price_of_time_w, run.bound)
    # only the first part of a line may begin in motion
    if task.mesh.data.fixed_speed2[_last_stop(task, part)] == 0.0:
        return TimedRun(part, run, True, early_s, 0.0, run.bound)
    return _slowed(part, without_auxiliaries, run, optimum)


def _last_stop(task: Task, part: Part) -> int:
    """Return the node of the last stop before the end of a part."""
    return max(node for node in stop_nodes(task) if node < part.last)


def _slowed(part: Part, without_auxiliaries: Task, early: Trajectory, optimum: Solver) -> TimedRun:
    """Return the run of a part that begins in motion and would be early: it has no stop to wait at, and runs slower.

    Its price of a second is negative. A constant that is paid for each second makes the price that the solver finds
    positive, and changes nothing else: all runs take the same time.
    """
    max_j = without_auxiliaries.mesh.data.half_inertia_kg * float(without_auxiliaries.fastest_speed2.max())
    for factor in SLOWING_FACTORS:
        reward_w = factor * max_j / without_auxiliaries.running_time_s
        try:
            run = _in_time(with_auxiliaries(without_auxiliaries, -reward_w), optimum)
        except RailjouleError:
            continue
        if abs(without_auxiliaries.travel_time_s - run.travel_time_s) <= ON_TIME_S:
            price = None if run.price_of_time_w is None else run.price_of_time_w - reward_w
            return TimedRun(part, run, True, 0.0, price, early.bound)
    # the window is missed, and the run's notes say so
    return TimedRun(part, early, True, 0.0, 0.0, early.bound)


def _in_time(task: Task, optimum: Solver) -> Trajectory:
    """Return the best run of a task, with the time that a solver leaves over to keep its limits used up, too."""
    run = optimum(task)
    left_s = task.travel_time_s - run.travel_time_s
    if ON_TIME_S < left_s < LEFT_SHARE * task.running_time_s:
        longer = optimum(replace(task, running_time_s=task.running_time_s + left_s))
        if longer.travel_time_s <= task.travel_time_s + ON_TIME_S:
            return longer
    return run


def arrival_times_s(task: Task, line: LineParts) -> list[float]:
    """Return when the train arrives at each station behind the start, and at the end [s]."""
    arrivals, departed_s = [], 0.0
    stops = stop_nodes(task)
    for timed in line:
        first, last, _ = timed.part
        inside = [stop for stop in stops if first < stop <= last]
        arrivals += [departed_s + timed.run.arrival_s(place) for place in task.mesh.position_m[inside].tolist()]
        # the train waits at the last stop before the end
        arrivals[-1] += timed.wait_s
        departed_s = arrivals[-1] + float(task.mesh.dwell_s[last])
    return arrivals


def joined(task: Task, line: LineParts, bound: Bound | None) -> Trajectory:
    """Return runs that follow one another as one, with the dwells and waits between them."""
    if len(line) == 1 and not line[0].takes_exactly:
        return line[0].run
    dwell_s = task.mesh.dwell_s.copy()
    for timed in line:
        dwell_s[_last_stop(task, timed.part)] += timed.wait_s
    runs = [timed.run for timed in line]
    speed2 = [run.node_speed_ms**2 for run in runs]
    run = make_trajectory(
        task.scenario,
        replace(task.mesh, dwell_s=dwell_s),
        "optimal",
        # the last node of a part is the first of the next, a stop: it counts once
        np.concatenate([speed2[0], *(values[1:] for values in speed2[1:])]),
        iterations=sum(run.iterations for run in runs),
        notes=tuple(dict.fromkeys(note for run in runs for note in run.notes)),
    )
    # none where it misses a window
    return run.with_bound(bound)


def station_name(name: str, number: int) -> str:
    """Return the name of a station, or its number where it has none."""
    return name or f"station {number + 1}"
