"""Simple advice: the best run with few changes of the driving regime, and its cost against the optimum.

A driver gets few instructions: full power, a speed to hold, coast, brake. For each number k of changes between two
stops, `railjoule.core.dynamic_programming.regimes` finds the best run with at most k changes, until a run needs hardly
more than the optimum. Regimes change at nodes of the mesh, except for the end of one stretch of power, which sets the
running time. All regimes stay below the maximum possible speeds: braking for a limit or a stop and keeping to a limit
is no change, so that a run on a line with limits has more instructions than changes.
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
from railjoule.core.dynamic_programming.search import log_price_range, supply_energy_j
from railjoule.core.dynamic_programming.steps import POWER, tabulate_steps
from railjoule.core.errors import SolverError, StrategyRefusedError
from railjoule.core.motion import running_time
from railjoule.core.physics.mesh_data import MeshData
from railjoule.core.strategies.arrival_windows import missed_windows
from railjoule.core.strategies.optimal import known_optimum
from railjoule.core.task import Task
from railjoule.core.trajectory import Trajectory, make_trajectory

FEWEST_CHANGES, MAX_CHANGES = 2, 9
"""Power, coast, brake; and more instructions than anybody calls simple between two stations."""
POINTS = 120
"""Speeds of the grid at each node; the tests show the effect of half and twice as many."""
FREE_SHARE = 1e-3
"""A run within this share of the optimum gains nothing from further changes that a driver could notice."""
PRICE_WIDTH, NEXT_WIDTH = 2e-3, 0.5
"""Of the logarithm of the price of time: the final bracket, since times jump with changes at nodes and a narrower one
finds nothing; and how much wider the first bracket is for the next number of changes, which hardly moves the price."""
NEAREST = 6
"""The last runs of the search, late and early, are nearest to the timetable; this many are adjusted to it."""
PLACE_TOLERANCE = 1e-5
"""In cells: less than a millimetre."""
MAX_CELLS = 4000
Driven = tuple[FloatArray, IntArray]
"""Squared speeds of a run, and the regime of each cell."""


@dataclass(frozen=True, eq=False)
class SimpleRun:
    """The best run with few changes of regime.

    Parameters
    ----------
    changes_allowed : int
        Permitted changes of regime between two stops.
    changes : int
        Most changes between two stops.
    run : Trajectory
        The run; its advice has an instruction for each regime, and for each limit that is braked for or kept to.
    """

    changes_allowed: int
    changes: int
    run: Trajectory


@dataclass(frozen=True, eq=False)
class SimpleAdvice:
    """Runs with an increasing number of changes of regime, beside the optimum.

    Parameters
    ----------
    optimum : Trajectory or None
        The optimum, where it is known.
    runs : tuple of SimpleRun
        From the fewest changes on; each needs less energy than the one before.
    refused : tuple of (int, str)
        Numbers of changes with which no run keeps the timetable, and why.
    """

    optimum: Trajectory | None
    runs: tuple[SimpleRun, ...]
    refused: tuple[tuple[int, str], ...]

    def price_kwh(self, simple: SimpleRun) -> float:
        """Return the extra energy of a simple run against the optimum [kWh]; NaN where that is unknown."""
        return math.nan if self.optimum is None else simple.run.energy_kwh - self.optimum.energy_kwh


def simple_advice(task: Task, max_changes: int = MAX_CHANGES) -> SimpleAdvice:
    """Return the best runs with 2, 3, ... changes of regime, up to a number or until more gain nothing.

    Parameters
    ----------
    task : Task
        The task; its windows of arrival do not count, and the notes of a run list those that it misses.
    max_changes : int
        The most changes between two stops that are tried.

    Raises
    ------
    TimetableError
        If the timetable cannot be kept.
    StrategyRefusedError
        If the mesh has too many cells, or no run with so few changes keeps the timetable.
    """
    task.require_timetable()
    task.require_few_cells(MAX_CELLS)
    require_compiled()
    optimum, search = known_optimum(task), _Search(task)
    enough_j = -math.inf if optimum is None else optimum.energy.net_j * (1 + FREE_SHARE)
    runs: list[SimpleRun] = []
    refused: list[tuple[int, str]] = []
    for changes in range(FEWEST_CHANGES, max_changes + 1):
        try:
            found = search.best_run(changes)
        except SolverError as failure:
            refused.append((changes, str(failure)))
            continue
        # the grid rounds: a run with more changes may need more energy
        if not runs or found.run.energy.net_j < runs[-1].run.energy.net_j:
            runs.append(found)
        # with unused changes, more would not be used either
        if found.changes < changes or runs[-1].run.energy.net_j <= enough_j:
            break
    if not runs:
        raise StrategyRefusedError(f"finds no run with at most {max_changes} changes of regime that is in time.")
    return SimpleAdvice(optimum, tuple(runs), tuple(refused))


class _Search:
    """A search for runs over one grid of speeds, whose steps are computed once for all numbers of changes."""

    def __init__(self, task: Task) -> None:
        self.task, self.data = task, task.mesh.data
        greatest = task.fastest_speed2
        self.grid = speed_band(self.data, greatest, 0.25 * greatest, math.sqrt(greatest.max()), POINTS)
        self.steps = tabulate_steps(self.data, self.grid, NO_POWERS, by_regime=True)
        self.log_prices = self.first_log_prices = log_price_range(self.data, task.running_time_s)

    def best_run(self, changes: int) -> SimpleRun:
        """Return the run of least energy with so many changes that is in time; raises SolverError if there is none."""
        in_time = [run for driven in self._nearest_runs(changes) for run in self._adjusted_to_time(*driven)]
        if not in_time:
            raise SolverError(f"no run with at most {changes} changes of regime is in time.")
        speed2, regimes = min(in_time, key=lambda driven: supply_energy_j(self.task.mesh.data, driven[0]))
        run = make_trajectory(self.task.scenario, self.task.mesh, "advised", speed2)
        return SimpleRun(changes, _max_changes(self.data, regimes), replace(run, notes=missed_windows(self.task, run)))

    def _nearest_runs(self, changes: int) -> list[Driven]:
        """Return runs at prices that close in on the timetable, the nearest last."""
        low, high = self.log_prices
        found: list[Driven] = []
        while high - low > PRICE_WIDTH:
            log_price = 0.5 * (low + high)
            price = math.exp(log_price)
            labels = regime_labels(self.data.fixed_speed2, changes)
            cost, _, _ = sweep_back(self.steps, self.grid, price, labels, keeps_cost=True)
            speed2, regimes = roll_out(self.data, self.grid, cost, price, labels, 0)
            arrives = speed2[-1] >= 0.0
            if arrives:
                found.append((speed2, regimes))
            is_late = not arrives or self._lateness_s(speed2) > 0.0
            low, high = (log_price, high) if is_late else (low, log_price)
        first, last = self.first_log_prices
        self.log_prices = max(low - NEXT_WIDTH, first), min(high + NEXT_WIDTH, last)
        return found[-NEAREST:]

    def _adjusted_to_time(self, speed2: FloatArray, regimes: IntArray) -> Iterator[Driven]:
        """Yield runs of the same regimes that are in time, each by the end of another stretch of power."""
        for end in np.flatnonzero((regimes[:-1] == POWER) & (regimes[1:] != POWER)).tolist():
            run = self._with_power_until(speed2, regimes, end)
            if run is not None:
                yield run

    def _with_power_until(self, speed2: FloatArray, regimes: IntArray, end: int) -> Driven | None:
        """Return the run in time whose power ends within a cell instead of at the end of the cell `end`."""
        after = regimes[end + 1]
        first = end - int(np.argmax(np.append(regimes[end::-1] != POWER, True))) + 1
        # the next regime must not vanish
        last = end + int(np.argmax(np.append(regimes[end + 1 :] != after, True)))

        def drive(place: float) -> Driven:
            cell, changed = min(int(place), last), regimes.copy()
            changed[first : cell + 1] = POWER
            changed[cell + 1 : last + 1] = after
            driven = drive_regimes(self.data, self.task.fastest_speed2, speed2, changed, cell, place - cell)
            return driven, changed

        def late_s(place: float) -> float:
            return self._lateness_s(drive(place)[0])

        low, high = float(first), float(last + 1)
        if late_s(high) > 0.0 or late_s(low) <= 0.0:
            return None
        place = float(scipy.optimize.brentq(late_s, low, high, xtol=PLACE_TOLERANCE))
        # the early side of the root
        while late_s(place) > 0.0:
            place += PLACE_TOLERANCE
        return drive(place)

    def _lateness_s(self, speed2: FloatArray) -> float:
        """Return running time minus that of the timetable [s]; a train that comes to a stand is late."""
        target_s = self.task.running_time_s
        return running_time(self.data.cell_length_m, speed2) - target_s if speed2[-1] >= 0.0 else target_s


def _max_changes(data: MeshData, regimes: IntArray) -> int:
    """Return the most changes of regime between two stops."""
    changed = np.append(False, regimes[1:] != regimes[:-1])
    # leaving a stop is no change
    stops = np.flatnonzero(data.fixed_speed2[:-1] == 0.0)
    changed[stops] = False
    return max(int(leg.sum()) for leg in np.split(changed, stops[stops > 0]))
