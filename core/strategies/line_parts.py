"""A line in parts whose running times are fixed: by arrivals that are given, or by windows that bind the optimum.

Between two fixed arrivals one multiplier, the price of a second, shares the running time; on either side of a fixed
arrival it has a value of its own. Windows of arrival are inequalities on the sums of the legs' times. The optimum under
them is found by an active set: the window that is missed most is fixed at the end that it misses, until none is
missed; one whose fixing costs energy instead of keeping the window is let go. Its price tells: where a window's end
binds as the latest arrival, a second is worth more before the station than after it, and less where it binds as the
earliest.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.errors import ScenarioError, SolverError
from railjoule.core.motion import running_time
from railjoule.core.scenario import Station
from railjoule.core.task import LEAST_SLACK, Task
from railjoule.core.trajectory import Bound, Trajectory, make_trajectory

Windows = Mapping[int, tuple[float, float]]
"""Earliest and latest arrival [s] by the number of a station between the ends, counted from 0."""
Part = tuple[int, int, float]
"""First node, last node and running time [s] of a part of a line."""
# what a solver's time misses: an arrival so close to its window keeps it
ON_TIME_S = 1e-5
# Of the shortest time between two stations: with less, the optimum between two fixed arrivals has hardly an inside, and
# with more, windows would be narrower than they are
SPARE_SHARE = 1e-4
# of the price: by less, both sides of a station value a second alike
SAME_PRICE = 1e-6


@dataclass(frozen=True, eq=False)
class LineParts:
    """Parts of a line that follow one another, each with its run.

    Parameters
    ----------
    parts : tuple of Part
    runs : tuple of Trajectory
    """

    parts: tuple[Part, ...]
    runs: tuple[Trajectory, ...]


def arrival_windows(task: Task) -> dict[int, tuple[float, float]]:
    """Return the windows of arrival of a task's stations between the ends, where they have one."""
    stations = inner_stations(task)
    return {k: s.window_s for k, s in enumerate(stations) if s.window_s != (0.0, np.inf)}


def inner_stations(task: Task) -> tuple[Station, ...]:
    """Return the stations of a task between the ends of its line, in running order."""
    return task.scenario.line.in_running_order().inner_stations


def stop_nodes(task: Task) -> list[int]:
    """Return the nodes at which the train stands: the start, the stations, the end."""
    # the mesh has a node at each station, but for the rounding of its sums
    inner = [int(np.argmin(np.abs(task.course.position_m - s.position_m))) for s in inner_stations(task)]
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


def parts_between(task: Task, arrivals_s: Mapping[int, float]) -> tuple[Part, ...]:
    """Return the parts of a line between fixed arrivals.

    Parameters
    ----------
    task : Task
    arrivals_s : mapping of int to float
        Fixed arrivals [s] by the number of the station between the ends, counted from 0.

    Raises
    ------
    ScenarioError
        If there is no such station, or it cannot be reached in time.
    """
    stations, stops = inner_stations(task), stop_nodes(task)
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
        # at the shortest time itself the optimum has no inside to search
        if running <= least * (1 + LEAST_SLACK):
            where = station_name(stations[number - 1].name, number) if number <= len(stations) else "the end"
            earliest = departed_s + least + float(dwell[first + 1 : number].sum())
            raise ScenarioError(f"The arrival at {where} after {arrival:.1f} s must be later than {earliest:.1f} s.")
        parts.append((stops[first], stops[number], running))
        first, departed_s = number, arrival + float(dwell[number])
    return tuple(parts)


def _tightened(task: Task, windows: Windows) -> Windows:
    """Return windows whose ends lie far enough apart for the legs between them; errors as `require_windows`.

    Any two ends can then be fixed at once: the search may fix one that another one leaves no time for.
    """
    require_windows(task, windows)
    stops = stop_nodes(task)
    dwell, least = task.course.dwell_s[stops], (1 + SPARE_SHARE) * shortest_times_s(task, stops)
    low, high = np.zeros(len(stops)), np.full(len(stops), np.inf)
    for number, (earliest, latest) in windows.items():
        low[number + 1], high[number + 1] = earliest, latest
    high[-1] = task.travel_time_s
    for k in range(1, len(stops)):
        low[k] = max(low[k], low[k - 1] + dwell[k - 1] + least[k - 1])
    for k in range(len(stops) - 2, 0, -1):
        high[k] = min(high[k], high[k + 1] - dwell[k] - least[k])
    # so close to the shortest times that the spare is more than there is: what was asked for stands
    return {
        number: (float(low[number + 1]), float(high[number + 1])) if low[number + 1] <= high[number + 1] else window
        for number, window in windows.items()
    }


def require_windows(task: Task, windows: Windows) -> None:
    """Raise ScenarioError if no train keeps all windows: the first one that fails is named."""
    stations, stops = inner_stations(task), stop_nodes(task)
    dwell, shortest = task.course.dwell_s[stops], shortest_times_s(task, stops)
    ready_s = 0.0
    # as early as possible at each station: who is late then, is always late
    for number, least in enumerate(shortest, start=1):
        reached_s = ready_s + float(least)
        last = number == len(shortest)
        earliest, latest = (0.0, task.travel_time_s) if last else windows.get(number - 1, (0.0, np.inf))
        if reached_s * (1 + LEAST_SLACK) >= latest:
            where = "the end" if last else station_name(stations[number - 1].name, number)
            waited = ready_s > float(dwell[:number].sum() + shortest[: number - 1].sum())
            kept = " with the windows of arrival before it" if waited else ""
            raise ScenarioError(
                f"The arrival at {where} must be no later than {latest:.1f} s, and is possible after "
                f"{reached_s:.1f} s{kept}."
            )
        ready_s = max(reached_s, earliest) + float(dwell[number])


def optimum_within(task: Task, windows: Windows, optimum: Callable[[Task], Trajectory]) -> LineParts:
    """Return the runs of least energy of a line whose windows of arrival are kept.

    Parameters
    ----------
    task : Task
    windows : mapping of int to (float, float)
        Earliest and latest arrival [s] by the number of the station.
    optimum : callable
        The best run of a task without windows.

    Raises
    ------
    ScenarioError
        If no train keeps them.
    SolverError
        If the search for the windows that bind does not end.
    """
    windows = _tightened(task, windows)
    # two equal ends are no choice
    fixed = {number: low for number, (low, high) in windows.items() if low == high}
    solved: dict[Part, Trajectory] = {}

    def runs_of(parts: tuple[Part, ...]) -> tuple[Trajectory, ...]:
        for part in parts:
            if part not in solved:
                solved[part] = optimum(part_of(task, *part))
        return tuple(solved[part] for part in parts)

    # each window is fixed at most once at each of its ends, and let go as often
    for _ in range(4 * len(windows) + 1):
        parts = parts_between(task, fixed)
        line = LineParts(parts, runs_of(parts))
        missed = _most_missed(task, line, windows, fixed)
        if missed is not None:
            number, arrival = missed
            fixed[number] = arrival
            continue
        free = _needlessly_fixed(line, windows, fixed)
        if free is None:
            return line
        del fixed[free]
    raise SolverError("the windows of arrival that bind the optimum were not found.")


def _most_missed(task: Task, line: LineParts, windows: Windows, fixed: Mapping[int, float]) -> tuple[int, float] | None:
    """Return the free station that misses its window by most, and the end that it misses; None where none does."""
    arrivals = arrivals_of(task, line)
    missed = []
    for number, (low, high) in windows.items():
        if number not in fixed:
            nearest = min(max(arrivals[number], low), high)
            missed.append((abs(arrivals[number] - nearest), number, nearest))
    worst = max(missed, default=(0.0, 0, 0.0))
    return (worst[1], worst[2]) if worst[0] > ON_TIME_S else None


def _needlessly_fixed(line: LineParts, windows: Windows, fixed: Mapping[int, float]) -> int | None:
    """Return a station fixed at an end of its window that the optimum leaves to the inside, if there is one."""
    prices = [run.price_of_time_w for run in line.runs]
    for order, number in enumerate(sorted(fixed)):
        low, high = windows[number]
        before, after = prices[order], prices[order + 1]
        if low == high or before is None or after is None:
            continue
        # a later arrival gives the part before a second and takes it from the part after
        gain = (before - after) / max(abs(before), abs(after), 1.0)
        if (fixed[number] == low and gain > SAME_PRICE) or (fixed[number] == high and gain < -SAME_PRICE):
            return number
    return None


def missed_windows(task: Task, run: Trajectory) -> tuple[str, ...]:
    """Return a sentence on each window of arrival that a run misses: only `optimal` keeps them."""
    windows = arrival_windows(task)
    if not windows:
        return ()
    stations, notes = inner_stations(task), []
    for number, (low, high) in windows.items():
        station = stations[number]
        arrival = float(run.time_s[np.searchsorted(run.position_m, station.position_m - 1e-6)])
        if not low - ON_TIME_S <= arrival <= high + ON_TIME_S:
            asked = f"no earlier than {low:.1f} s" if arrival < low else f"no later than {high:.1f} s"
            where = station_name(station.name, number + 1)
            notes.append(f"It arrives at {where} after {arrival:.1f} s, and was to arrive {asked}.")
    return tuple(notes)


def arrivals_of(task: Task, line: LineParts) -> list[float]:
    """Return when the train arrives at each station between the ends [s]."""
    arrivals, departed_s = [], 0.0
    stops = stop_nodes(task)
    for (first, last, _), run in zip(line.parts, line.runs, strict=True):
        places = task.course.position_m[[stop for stop in stops if first < stop <= last]]
        # a station has two nodes where the train stands for a while: it arrives at the first
        nodes = np.searchsorted(run.position_m, places - 1e-6)
        arrivals += (departed_s + run.time_s[nodes]).tolist()
        departed_s = arrivals[-1] + float(task.course.dwell_s[last])
    return arrivals[:-1]


def joined(task: Task, line: LineParts) -> Trajectory:
    """Return runs that follow one another as one, with the dwells between them."""
    runs = line.runs
    if len(runs) == 1:
        return runs[0]
    moving = [np.diff(run.position_m) > 0 for run in runs]
    speed2 = [run.speed_ms[np.append(True, moves)] ** 2 for run, moves in zip(runs, moving, strict=True)]
    return make_trajectory(
        task.scenario,
        task.course,
        "optimal",
        # the last node of a part is the first of the next, a stop: it counts once
        np.concatenate([speed2[0], *(values[1:] for values in speed2[1:])]),
        bound=_joined_bound(task, runs),
        iterations=sum(run.iterations for run in runs),
        notes=tuple(dict.fromkeys(note for run in runs for note in run.notes)),
    )


def _joined_bound(task: Task, runs: Sequence[Trajectory]) -> Bound | None:
    """Return the sum of the bounds of runs that follow one another, if each has one."""
    bounds = [run.bound for run in runs if run.bound is not None]
    if len(bounds) < len(runs):
        return None
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
    return Bound(energy_j, statement, task.course.position_m, time_s, slowest)


def _standing_s(run: Trajectory) -> float:
    return float(np.sum(np.diff(run.time_s)[np.diff(run.position_m) == 0]))


def station_name(name: str, number: int) -> str:
    """Return the name of a station, or its number where it has none."""
    return name or f"station {number + 1}"
