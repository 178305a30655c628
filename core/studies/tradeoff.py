"""The trade-off of energy and time: the least energy of one run over its travel time.

Each point is an optimum of `railjoule.core.bounds`; only the time changes, so mesh and fastest run are
made once. The slope of the frontier is minus the price of a second, which each optimum tells.
"""

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.bounds import certify
from railjoule.core.continuous_bound.refinement import refined_optimum
from railjoule.core.errors import SolverError, StrategyRefusedError, TimetableError
from railjoule.core.scenario.options import EnocOptions
from railjoule.core.strategies import prepare_task, run_strategy
from railjoule.core.strategies.arrival_windows import arrival_windows
from railjoule.core.studies.sweep.rows import RowByRow
from railjoule.core.studies.sweep.running import all_rows
from railjoule.core.task import LEAST_SLACK, Task
from railjoule.core.units import J_PER_KWH, J_PER_WH

if TYPE_CHECKING:
    import pandas

TOLERANCE = 1e-6
"""Relative gap of each point, far below what a figure can show."""
# Forty optima over 350 cells take some 20 ms. Measured on the suburban preset, 1006 cells: coarsening moves the
# energies by 2e-5; the figures show a thousandth.
MOST_CELLS = 350
"""A course with more cells gets a mesh of longer ones: the frontier is redrawn while a slider moves."""
# at the shortest time itself the slope is infinite and the solver has no inside
FIRST_SLACK = 0.004
"""The first travel time of `frontier_times` exceeds the shortest one by this share."""


@dataclass(frozen=True, eq=False)
class Frontier:
    """Energy over travel time; arrays of shape (m,), NaN where a time cannot be kept.

    Parameters
    ----------
    strategy : str
        Whose energy it is.
    travel_time_s : array
        Times of the whole run, dwells included [s].
    energy_j : array
        Net energy at the line, auxiliaries included [J].
    price_of_time_w : array
        By how much the energy falls if the time is a second longer [J/s]; NaN where the strategy does not know.
    bound_j : array
        Energy that no run with this time undercuts [J]; NaN where no bound was asked for.
    shortest_travel_time_s : float
        Shortest possible time, dwells included [s].
    cell_count : int
        Cells of the mesh.
    refused : tuple of (float, str)
        The times [s] without an energy, each with the reason in one sentence.
    notes : tuple of str
        Sentences on what was simplified: a coarser mesh than the scenario's.
    """

    strategy: str
    travel_time_s: FloatArray
    energy_j: FloatArray
    price_of_time_w: FloatArray
    bound_j: FloatArray
    shortest_travel_time_s: float
    cell_count: int
    refused: tuple[tuple[float, str], ...]
    notes: tuple[str, ...] = ()

    @property
    def energy_kwh(self) -> FloatArray:
        """Net energy at the line [kWh]; shape (m,)."""
        return self.energy_j / J_PER_KWH

    @property
    def price_of_time_wh_per_s(self) -> FloatArray:
        """Price of a second [Wh/s]; shape (m,)."""
        return self.price_of_time_w / J_PER_WH

    def energy_kwh_at(self, travel_time_s: float) -> float:
        """Return the energy at a time between those of the points [kWh]: a cubic with their slopes; NaN beyond them.

        A straight line between two points lies above the frontier, by as much as a per cent.
        """
        known = np.isfinite(self.energy_j) & np.isfinite(self.price_of_time_w)
        times = self.travel_time_s[known]
        if len(times) < 2 or not times[0] <= travel_time_s <= times[-1]:
            return float("nan")
        # its slopes are known without further runs: each optimum tells the price of time
        cubic = scipy.interpolate.CubicHermiteSpline(
            times, self.energy_kwh[known], -self.price_of_time_w[known] / J_PER_KWH
        )
        return float(cubic(travel_time_s))

    def plot(self, axes: Any = None) -> Any:
        """Draw energy over travel time with matplotlib; return the axes. As `railjoule.core.plots.plot_frontier`."""
        from railjoule.core.plots import plot_frontier  # noqa: PLC0415  (matplotlib is an extra)

        return plot_frontier(self, axes)

    def to_dataframe(self) -> "pandas.DataFrame":
        """Return the frontier as a table, one row a travel time."""
        import pandas  # noqa: PLC0415  (slow to import, and seldom needed)

        columns: dict[str, Any] = {
            "travel_time_s": self.travel_time_s,
            "energy_kwh": self.energy_kwh,
            "price_of_time_wh_per_s": self.price_of_time_wh_per_s,
            "lower_bound_kwh": self.bound_j / J_PER_KWH,
        }
        return pandas.DataFrame(columns)


def frontier_times(task: Task, count: int = 40, longest_share: float = 2.0) -> FloatArray:
    """Return travel times for a frontier, denser where it is steep; shape (count,).

    Parameters
    ----------
    task : Task
        Its running time does not matter.
    count : int
        How many, at least 2.
    longest_share : float
        The longest running time over the shortest possible one, above 1.004.
    """
    slack = np.geomspace(FIRST_SLACK, longest_share - 1, count)
    return frozen_array(task.shortest_time_s * (1 + slack) + task.dwell_s)


def energy_time_frontier(
    task: Task,
    travel_times_s: FloatArray,
    most_cells: int = MOST_CELLS,
    executor: Executor | None = None,
) -> Frontier:
    """Return the least energy over travel times.

    Parameters
    ----------
    task : Task
        What is asked for, but for its time.
    travel_times_s : array of shape (m,)
        Times of the whole run, dwells included [s].
    most_cells : int
        A finer mesh is replaced by one with about this many cells.
    executor : Executor, optional
        What finds the points; by default this thread.
    """
    if task.course.drive.jumps_at_no_effort:
        # its optimum with free switching is a bound, and no run
        return strategy_frontier(task, travel_times_s, "optimal", most_cells, executor)
    coarse = coarsened(task, most_cells)

    def point(timed: Task) -> tuple[float, float, float]:
        found = refined_optimum(timed)
        bound = certify(found.task, found.solution.optimum, found.bound).energy_j
        return found.solution.energy_j, found.solution.optimum.price_of_time_w, bound

    return _frontier(coarse, "optimal", travel_times_s, point, _notes(task, coarse), executor)


def strategy_frontier(
    task: Task,
    travel_times_s: FloatArray,
    strategy: str,
    most_cells: int = MOST_CELLS,
    executor: Executor | None = None,
) -> Frontier:
    """Return the energy of any strategy over travel times; NaN where it refuses one.

    Parameters
    ----------
    task, travel_times_s, most_cells, executor
        As in `energy_time_frontier`.
    strategy : str
        Which one.
    """

    def point(timed: Task) -> tuple[float, float, float]:
        run = run_strategy(timed, strategy)
        price = np.nan if run.price_of_time_w is None else run.price_of_time_w
        return run.energy.net_j, price, np.nan if run.gap is None or run.bound is None else run.bound.energy_j

    coarse = coarsened(task, most_cells)
    return _frontier(coarse, strategy, travel_times_s, point, _notes(task, coarse), executor)


def enoc_frontier(task: Task, travel_times_s: FloatArray, most_cells: int = MOST_CELLS) -> Frontier:
    """Return the energy of ENOC with the best acceleration time for each travel time; arguments as above."""
    # without the acceleration time of the scenario, which is the best one for no other travel time
    free = task.scenario.model_copy(update={"enoc": EnocOptions()})
    return strategy_frontier(replace(task, scenario=free), travel_times_s, "enoc", most_cells)


def coarsened(task: Task, most_cells: int) -> Task:
    """Return the task over a mesh of about `most_cells` cells, or itself if it has no more."""
    count = task.course.cell_count
    if count <= most_cells:
        return task
    # nodes at borders stay, so the count falls a little less than the length of the cells grows
    longer = task.scenario.replace(**{"solver.mesh_m": task.scenario.solver.mesh_m * count / most_cells})
    return prepare_task(longer, *task.end_speeds_ms)


def _notes(task: Task, coarse: Task) -> tuple[str, ...]:
    """Return the sentences on windows of arrival, and on a mesh that is coarser than the one asked for."""
    windows = ("Windows of arrival do not count here.",) if arrival_windows(task) else ()
    if coarse is task:
        return windows
    return (
        *windows,
        f"Computed over {coarse.course.cell_count:,} cells of at most {coarse.scenario.solver.mesh_m:.3g} m instead of "
        f"the {task.course.cell_count:,} of the mesh of {task.scenario.solver.mesh_m:g} m.",
    )


def _frontier(
    task: Task,
    strategy: str,
    travel_times_s: FloatArray,
    point: Callable[[Task], tuple[float, float, float]],
    notes: tuple[str, ...],
    executor: Executor | None,
) -> Frontier:
    times = np.asarray(travel_times_s, dtype=float)
    shortest_s = task.shortest_time_s

    def run(sample: Sequence[float]) -> tuple[float, float, float]:
        (time,) = sample
        # the course and its fastest run do not depend on the time: they are made once for all points
        timed = replace(task, running_time_s=time - task.dwell_s)
        if not timed.running_time_s > shortest_s * (1 + LEAST_SLACK):
            raise TimetableError(time, task.shortest_travel_time_s)
        return point(timed)

    work = RowByRow(run, 3, (TimetableError, StrategyRefusedError, SolverError))
    rows = all_rows(work, times[:, None], executor)
    values, refused = rows.values.T, [(float(times[row]), reason) for row, reason in rows.reasons.items()]
    return Frontier(
        strategy=strategy,
        travel_time_s=frozen_array(times),
        energy_j=frozen_array(values[0]),
        price_of_time_w=frozen_array(values[1]),
        bound_j=frozen_array(values[2]),
        shortest_travel_time_s=task.shortest_travel_time_s,
        cell_count=task.course.cell_count,
        refused=tuple(refused),
        notes=notes,
    )
