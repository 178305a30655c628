"""Running time reserve: the travel time that follows from the shortest running times of train, load and line.

Two units are in use: per cent of the shortest running time, and minutes per 100 km (UIC 451-1), each for the whole
line or for a part of it. Dwells have no reserve.
"""

from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.scenario import Line, Scenario, Timetable, Vehicle
from railjoule.core.scenario.options import SolverOptions
from railjoule.core.task import Task, prepare_task

SECONDS_PER_METRE = 60 / 100_000
"""One minute per 100 km."""
LONGEST_S = 86400.0
"""A time that every run keeps, while the shortest is computed."""


@dataclass(frozen=True, eq=False)
class ReservedTime:
    """The travel time of a timetable with a reserve; arrays of shape (parts,), in running order.

    Parameters
    ----------
    borders_m : array of shape (parts + 1,)
        Borders of the parts of the line [m].
    shortest_s, reserve_s : array
        Shortest running times and their reserves [s].
    dwell_s : float
        Time at the stations [s].
    """

    borders_m: FloatArray
    shortest_s: FloatArray
    reserve_s: FloatArray
    dwell_s: float

    @property
    def travel_time_s(self) -> float:
        """Time for the whole run, dwells included [s]."""
        return float(self.shortest_s.sum() + self.reserve_s.sum()) + self.dwell_s

    @property
    def sentence(self) -> str:
        """Shortest time, reserve, dwells and their sum in one sentence."""
        shortest, reserve = self.shortest_s.sum(), self.reserve_s.sum()
        dwell = f" and dwells of {self.dwell_s:.1f} s" if self.dwell_s > 0 else ""
        return (
            f"Travel time {self.travel_time_s:.1f} s: shortest running time of {shortest:.1f} s, a reserve of "
            f"{reserve:.1f} s ({100 * reserve / shortest:.3g} %){dwell}."
        )


def reserved_time(scenario: Scenario) -> ReservedTime:
    """Return the travel time of a scenario whose timetable has a reserve; errors as `prepare_task`."""
    return _reserved_time(scenario.vehicle, scenario.line, scenario.timetable, scenario.solver)


# by these parts only: the rest of a scenario, as the load really carried, does not change its timetable
@lru_cache(maxsize=64)
def _reserved_time(vehicle: Vehicle, line: Line, timetable: Timetable, solver: SolverOptions) -> ReservedTime:
    free = timetable.with_travel_time(LONGEST_S)
    task = prepare_task(Scenario(vehicle, line, timetable=free, solver=solver))
    parts = timetable.reserve_parts
    borders = np.unique([0.0, *(place for part in parts for place in (part.from_m, part.to_m)), line.length_m])
    rules = [
        next((part for part in parts if part.from_m < 0.5 * (begin + end) < part.to_m), timetable)
        for begin, end in pairwise(borders.tolist())
    ]
    # parts lie on the line as it is described
    if line.reverse:
        borders, rules = (line.length_m - borders)[::-1], rules[::-1]
    shortest, lengths = times_between(task, task.fastest_speed2, borders), np.diff(borders)
    reserve = [
        0.01 * rule.reserve_percent * time
        if rule.reserve_percent is not None
        else SECONDS_PER_METRE * (rule.reserve_min_per_100km or 0.0) * length
        for rule, time, length in zip(rules, shortest, lengths, strict=True)
    ]
    return ReservedTime(frozen_array(borders), frozen_array(shortest), frozen_array(np.array(reserve)), task.dwell_s)


def times_between(task: Task, speed2: FloatArray, borders_m: FloatArray) -> FloatArray:
    """Return the running times of a run between places [s]; shape (k - 1,) for k places.

    Parameters
    ----------
    task : Task
    speed2 : array of shape (n + 1,)
        Squares of its speeds at the nodes [m2/s2].
    borders_m : array of shape (k,)
        Places in running order [m]; one within a cell divides its time as its length.
    """
    speed = np.sqrt(speed2)
    times = np.append(0.0, np.cumsum(2 * task.mesh.data.cell_length_m / (speed[:-1] + speed[1:])))
    return np.diff(np.interp(borders_m, task.position_m, times))
