"""Simple advice: the best run whose driver changes the regime seldom, and what that costs against the optimum.

A driver gets few orders: full power, a speed to hold, coast, brake. With at most k changes of regime between two stops
the best run is found by `railjoule.core.dynamic_programming.regimes`, for each k, until it needs hardly more than the
optimum. Regimes change at nodes of the mesh, but for the end of one stretch of power, which brings the run in time.
All regimes are driven beneath the greatest possible speeds: to brake for a limit or a stop and to keep to a limit is no
change, so that on a line with limits a run has more orders than changes.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import scipy

from railjoule.core.arrays import FloatArray, IntArray
from railjoule.core.compilation import require_compiled
from railjoule.core.dynamic_programming.grid import speed_band
from railjoule.core.dynamic_programming.labels import regime_labels
from railjoule.core.dynamic_programming.power_table import NO_POWERS
from railjoule.core.dynamic_programming.recursion import roll_out, sweep_back
from railjoule.core.dynamic_programming.regimes import drive_regimes
from railjoule.core.dynamic_programming.search import log_price_range
from railjoule.core.dynamic_programming.steps import POWER, tabulate_steps
from railjoule.core.errors import SolverError, StrategyRefusedError
from railjoule.core.motion import running_time
from railjoule.core.physics.course_data import CourseData
from railjoule.core.strategies.arrival_windows import missed_windows
from railjoule.core.strategies.optimal import known_optimum
from railjoule.core.strategies.switching import line_energy_j
from railjoule.core.task import Task
from railjoule.core.trajectory import Trajectory, make_trajectory

FEWEST_CHANGES, MOST_CHANGES = 2, 9
"""Power, coast, brake; and more orders than one between two stations could be called simple."""
# speeds of the grid at each node: see the tests for what half and double of it change
POINTS = 120
# a run that needs so much more than the optimum gains nothing that a driver could notice from more orders
FREE_SHARE = 1e-3
# Of the logarithm of the price: regimes change at nodes, so that the time jumps and narrower brackets find nothing; and
# by how much the bracket of the next number of changes is wider
PRICE_WIDTH, NEXT_WIDTH = 2e-3, 0.5
# of the runs that are found on the way, late and early, so many are brought in time
NEAREST = 6
# in cells: less than a millimetre
PLACE_TOLERANCE = 1e-5
MOST_CELLS = 4000


@dataclass(frozen=True, eq=False)
class SimpleRun:
    """The best run with few changes of regime.

    Parameters
    ----------
    changes_allowed : int
        How often the regime may change between two stops.
    changes : int
        How often it does at most.
    run : Trajectory
        The run; its advice has one order for each regime, and one where a limit is braked for or kept to.
    """

    changes_allowed: int
    changes: int
    run: Trajectory


@dataclass(frozen=True, eq=False)
class SimpleAdvice:
    """Runs with ever more changes of regime, beside the optimum.

    Parameters
    ----------
    optimum : Trajectory or None
        The optimum, where it is known.
    runs : tuple of SimpleRun
        From the fewest changes on; each needs less than the one before.
    refused : tuple of (int, str)
        Numbers of changes with which no run keeps the timetable, and why.
    """

    optimum: Trajectory | None
    runs: tuple[SimpleRun, ...]
    refused: tuple[tuple[int, str], ...]

    def price_kwh(self, simple: SimpleRun) -> float:
        """Return what a simple run needs beyond the optimum [kWh]; NaN where that is not known."""
        return math.nan if self.optimum is None else simple.run.energy_kwh - self.optimum.energy_kwh


def simple_advice(task: Task, most_changes: int = MOST_CHANGES) -> SimpleAdvice:
    """Return the best runs with 2, 3, ... changes of regime, up to a number or until more gain nothing.

    Parameters
    ----------
    task : Task
        The task; its windows of arrival do not count, and a run's notes name those that it misses.
    most_changes : int
        The most changes between two stops that are tried.

    Raises
    ------
    TimetableError
        If the timetable cannot be kept.
    StrategyRefusedError
        If the mesh has too many cells, or no run with so few changes keeps the timetable.
    """
    task.require_timetable()
    task.require_few_cells(MOST_CELLS)
    require_compiled()
    optimum = known_optimum(task)
    table = _Table(task)
    runs: list[SimpleRun] = []
    refused: list[tuple[int, str]] = []
    for changes in range(FEWEST_CHANGES, most_changes + 1):
        try:
            found = table.run(changes)
        except SolverError as failure:
            refused.append((changes, str(failure)))
            continue
        # the grid rounds: a run that more changes do not improve is the one that there is
        if not runs or found.run.energy.net_j < runs[-1].run.energy.net_j:
            runs.append(found)
        if found.changes < changes:
            # more would not be used either
            break
        if optimum is not None and runs[-1].run.energy.net_j <= optimum.energy.net_j * (1 + FREE_SHARE):
            break
    if not runs:
        raise StrategyRefusedError(f"finds no run with at most {most_changes} changes of regime that is in time.")
    return SimpleAdvice(optimum, tuple(runs), tuple(refused))


class _Table:
    """The steps of a task over one grid of speeds, and the runs found with them."""

    def __init__(self, task: Task) -> None:
        self.task, self.data = task, task.course.data
        greatest = task.greatest_speed2
        self.grid = speed_band(self.data, greatest, 0.25 * greatest, math.sqrt(greatest.max()), POINTS)
        self.steps = tabulate_steps(self.data, self.grid, NO_POWERS, by_regime=True)
        self.prices = log_price_range(self.data, task.running_time_s)

    def run(self, changes: int) -> SimpleRun:
        """Return the cheapest run with so many changes that is in time; raises SolverError where there is none."""
        found = self._nearest(changes)
        # the last ones, late and early, are nearest to the timetable: each is brought there by its own power
        on_time = [run for driven in found for run in self._in_time(driven)]
        if not on_time:
            raise SolverError(f"no run with at most {changes} changes of regime is in time.")
        best = min(on_time, key=lambda driven: driven.energy_j)
        run = make_trajectory(self.task.scenario, self.task.course, "advised", best.speed2)
        run = replace(run, notes=missed_windows(self.task, run))
        return SimpleRun(changes, best.changes(self.data), run)

    def _nearest(self, changes: int) -> list["_Driven"]:
        """Return runs at prices that close in on the timetable, the nearest last."""
        least, most = self.prices
        found: list[_Driven] = []
        while most - least > PRICE_WIDTH:
            price = 0.5 * (least + most)
            driven = self._at_price(price, changes)
            late = driven is None or self._time_s(driven.speed2) > self.task.running_time_s
            least, most = (price, most) if late else (least, price)
            if driven is not None:
                found.append(driven)
        # more changes hardly move the price
        whole = log_price_range(self.data, self.task.running_time_s)
        self.prices = max(least - NEXT_WIDTH, whole[0]), min(most + NEXT_WIDTH, whole[1])
        return found[-NEAREST:]

    def _at_price(self, log_price: float, changes: int) -> "_Driven | None":
        price = math.exp(log_price)
        labels = regime_labels(self.data.fixed_speed2, changes)
        cost, _, _ = sweep_back(self.steps, self.grid, price, labels, keeps_cost=True)
        speed2, regimes = roll_out(self.data, self.grid, cost, price, labels, 0)
        return None if speed2[-1] < 0.0 else _Driven(speed2, regimes, 0.0)

    def _in_time(self, driven: "_Driven") -> Iterator["_Driven"]:
        """Yield runs of the same regimes in which one stretch of power is longer or shorter, until they are in time."""
        regimes = driven.regimes
        ends = [int(i) for i in np.flatnonzero((regimes[:-1] == POWER) & (regimes[1:] != POWER))]
        for end in ends:
            run = self._with_power_until(driven, end)
            if run is not None:
                yield run

    def _with_power_until(self, driven: "_Driven", end: int) -> "_Driven | None":
        """Return the run whose power ends where it makes it be in time, in place of the end of a cell."""
        regimes, after = driven.regimes, driven.regimes[end + 1]
        first = end - int(np.argmax(np.append(regimes[end::-1] != POWER, True))) + 1
        # as far as the next regime reaches: beyond, it would be gone
        last = end + int(np.argmax(np.append(regimes[end + 1 :] != after, True)))

        def drive(place: float) -> tuple[FloatArray, IntArray]:
            cell = min(int(place), last)
            changed = regimes.copy()
            changed[first : cell + 1] = POWER
            changed[cell + 1 : last + 1] = after
            share = place - cell
            return drive_regimes(self.data, self.task.greatest_speed2, driven.speed2, changed, cell, share), changed

        def late_s(place: float) -> float:
            speed2 = drive(place)[0]
            # one that comes to a stand is too slow
            return self._time_s(speed2) - self.task.running_time_s if speed2[-1] >= 0.0 else self.task.running_time_s

        low, high = float(first), float(last + 1)
        if late_s(high) > 0.0 or late_s(low) <= 0.0:
            return None
        place = float(scipy.optimize.brentq(late_s, low, high, xtol=PLACE_TOLERANCE))
        # to the early side of the root: never late
        while late_s(place) > 0.0:
            place += PLACE_TOLERANCE
        speed2, changed = drive(place)
        return _Driven(speed2, changed, line_energy_j(self.task, speed2))

    def _time_s(self, speed2: FloatArray) -> float:
        return running_time(self.data.cell_length_m, speed2)


@dataclass(frozen=True, eq=False)
class _Driven:
    """A run, what each of its cells is driven in, and its energy [J] where it is known."""

    speed2: FloatArray
    regimes: IntArray
    energy_j: float

    def changes(self, data: CourseData) -> int:
        """Return the most changes of regime between two stops."""
        changed = np.append(False, self.regimes[1:] != self.regimes[:-1])
        # a train that leaves a stop changes nothing
        stops = np.flatnonzero(data.fixed_speed2[:-1] == 0.0)
        changed[stops] = False
        legs = np.split(changed, stops[stops > 0])
        return max(int(leg.sum()) for leg in legs)
