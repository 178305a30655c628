"""The trade-off of energy and time: the least energy of one run over its travel time.

Each point is an optimum of `railjoule.core.bounds`. Only the time changes, so mesh and fastest run are computed once.
The slope of the frontier is the negative price of time, which each optimum returns.
"""

from collections.abc import Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
import scipy

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.bounds import OPTIMUM, certify
from railjoule.core.continuous_bound.refinement import refined_optimum
from railjoule.core.errors import SolverError, StrategyRefusedError, TimetableError
from railjoule.core.scenario import Scenario
from railjoule.core.scenario.options import EnocOptions
from railjoule.core.strategies import prepare_task, run_strategy
from railjoule.core.strategies.arrival_windows import arrival_windows
from railjoule.core.strategies.fastest import fastest
from railjoule.core.studies.rows import RowByRow, all_rows
from railjoule.core.studies.table import StudyTable
from railjoule.core.task import MIN_SLACK, Task
from railjoule.core.trajectory import Trajectory
from railjoule.core.units import J_PER_KWH, J_PER_WH

TOLERANCE = 1e-6
"""Relative gap of each point, far below what a figure can show."""
# Forty optima over 350 cells take some 20 ms. Measured on the suburban preset, 1006 cells: coarsening moves the
# energies by 2e-5; the figures show a thousandth.
MAX_CELLS = 350
"""A meshed line with more cells gets a mesh of longer ones: the frontier is redrawn while a slider moves."""
# at the shortest time itself the slope is infinite and the solver has no inside
FIRST_SLACK = 0.004
"""The first travel time of `frontier_times` exceeds the shortest one by this share."""
TIME_TOLERANCE = 1e-9
"""Tolerance of the speed of `one_speed_run`: the time then differs by less than the check of a run permits."""
SLOWEST_KMH = 1.0
"""Walking pace, at which a run is late for any real timetable: the lower end of the bracket of the speed."""


@dataclass(frozen=True, eq=False)
class Frontier(StudyTable):
    """Energy over travel time; NaN where a time cannot be kept.

    The columns over `travel_time_s` (dwells included) are `energy_kwh`, net energy at the line with auxiliaries,
    `price_of_time_wh_per_s`, the decrease of that energy for a second more, and `lower_bound_kwh`; the last two are NaN
    where the strategy has none. The attribute `notes` is a tuple of sentences on simplifications.

    Parameters
    ----------
    strategy : str
        The strategy that drives.
    shortest_travel_time_s : float
        Shortest possible time, dwells included [s].
    cell_count : int
        Cells of the mesh.
    refused : tuple of (float, str)
        The times [s] without an energy, each with the reason in one sentence.
    """

    strategy: str = ""
    shortest_travel_time_s: float = 0.0
    cell_count: int = 0
    refused: tuple[tuple[float, str], ...] = ()

    def energy_kwh_at(self, travel_time_s: float) -> float:
        """Return the energy at a time between the points [kWh]: a cubic with their slopes; NaN beyond the points.

        A straight line between two points is above the frontier by up to one per cent.
        """
        energy_kwh, price_kwh_per_s = self["energy_kwh"], self["price_of_time_wh_per_s"] * J_PER_WH / J_PER_KWH
        known = np.isfinite(energy_kwh) & np.isfinite(price_kwh_per_s)
        times = self.labels["travel_time_s"][known]
        if len(times) < 2 or not times[0] <= travel_time_s <= times[-1]:
            return float("nan")
        return float(
            scipy.interpolate.CubicHermiteSpline(times, energy_kwh[known], -price_kwh_per_s[known])(travel_time_s)
        )

    def plot(self, axes: Any = None) -> Any:
        """Draw energy over travel time with matplotlib; return the axes. As `railjoule.core.plots.plot_frontier`."""
        from railjoule.core.plots import plot_frontier  # noqa: PLC0415  (matplotlib is an extra)

        return plot_frontier(self, axes)


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
    strategy: str = OPTIMUM,
    max_cells: int = MAX_CELLS,
    executor: Executor | None = None,
) -> Frontier:
    """Return the energy over travel times, by default the least one; NaN where the strategy refuses a time.

    Parameters
    ----------
    task : Task
        The task; its time does not matter.
    travel_times_s : array of shape (m,)
        Times of the whole run, dwells included [s].
    strategy : str
        The strategy that drives.
    max_cells : int
        A finer mesh is replaced by one with about this many cells.
    executor : Executor, optional
        Executor of the points; by default this thread.
    """
    coarse, times = coarsened(task, max_cells), np.asarray(travel_times_s, dtype=float)
    notes = ["Windows of arrival do not count here."] if arrival_windows(task) else []
    if coarse is not task:
        notes.append(
            f"Computed over {coarse.mesh.cell_count:,} cells of at most {coarse.scenario.solver.mesh_m:.3g} m instead "
            f"of the {task.mesh.cell_count:,} of the mesh of {task.scenario.solver.mesh_m:g} m."
        )
    # the optimum of a drive with idle losses by free switching is a bound, and no run
    point = _optimum if strategy == OPTIMUM and not task.mesh.drive.has_idle_losses else partial(_run, strategy)

    def at(sample: Sequence[float]) -> tuple[float, float | None, float | None]:
        (time,) = sample
        # the meshed line and its fastest run do not depend on the time: they are made once for all points
        timed = replace(coarse, running_time_s=time - coarse.dwell_s)
        if not timed.running_time_s > coarse.shortest_time_s * (1 + MIN_SLACK):
            raise TimetableError(time, coarse.shortest_travel_time_s)
        return point(timed)

    work = RowByRow(at, 3, (TimetableError, StrategyRefusedError, SolverError))
    rows = all_rows(work, times[:, None], executor)
    energy_j, price_w, bound_j = rows.values.T
    columns = {
        "energy_kwh": energy_j / J_PER_KWH,
        "price_of_time_wh_per_s": price_w / J_PER_WH,
        "lower_bound_kwh": bound_j / J_PER_KWH,
    }
    return Frontier(
        coarse.scenario,
        {"travel_time_s": frozen_array(times)},
        columns,
        {"notes": tuple(notes)},
        len(times),
        strategy=strategy,
        shortest_travel_time_s=coarse.shortest_travel_time_s,
        cell_count=coarse.mesh.cell_count,
        refused=tuple((float(times[row]), reason) for row, reason in rows.reasons.items()),
    )


def _optimum(task: Task) -> tuple[float, float, float]:
    """Return energy [J], price of time [W] and lower bound [J] of the optimum."""
    found = refined_optimum(task)
    bound = certify(found.task, found.solution.optimum, found.bound)
    return found.solution.energy_j, found.solution.optimum.price_of_time_w, bound.energy_j


def _run(strategy: str, task: Task) -> tuple[float, float | None, float | None]:
    """Return energy [J], price of time [W] and lower bound [J] of the run of a strategy."""
    run = run_strategy(task, strategy)
    return run.energy.net_j, run.price_of_time_w, None if run.gap is None or run.bound is None else run.bound.energy_j


def enoc_frontier(task: Task, travel_times_s: FloatArray, max_cells: int = MAX_CELLS) -> Frontier:
    """Return the energy of ENOC with the best acceleration time for each travel time; arguments as above."""
    # without the acceleration time of the scenario, which is the best one for no other travel time
    free = task.scenario.model_copy(update={"enoc": EnocOptions()})
    return energy_time_frontier(replace(task, scenario=free), travel_times_s, "enoc", max_cells)


def coarsened(task: Task, max_cells: int) -> Task:
    """Return the task over a mesh of about `max_cells` cells, or itself if it has no more."""
    count = task.mesh.cell_count
    if count <= max_cells:
        return task
    # nodes at borders stay, so the count falls a little less than the length of the cells grows
    longer = task.scenario.replace(**{"solver.mesh_m": task.scenario.solver.mesh_m * count / max_cells})
    return prepare_task(longer, *task.end_speeds_ms)


def one_speed_run(scenario: Scenario) -> Trajectory:
    """Return the run in the timetable's time that saves no energy: full effort, one speed held, full braking.

    Parameters
    ----------
    scenario : Scenario
        Its timetable and all its limits count.

    Raises
    ------
    TimetableError
        If the timetable cannot be kept.
    """
    task = prepare_task(scenario)
    task.require_timetable()
    top_kmh = scenario.vehicle.traction.max_speed_kmh

    def limited(speed_kmh: float) -> Task:
        return prepare_task(scenario.replace(**{"vehicle.traction.max_speed_kmh": float(speed_kmh)}))

    # the shortest time falls steadily with the maximum speed, so there is one root
    speed_kmh = scipy.optimize.brentq(
        lambda speed_kmh: limited(speed_kmh).shortest_time_s - task.running_time_s,
        min(SLOWEST_KMH, top_kmh / 2),
        top_kmh,
        rtol=TIME_TOLERANCE,
    )
    return fastest(limited(speed_kmh))
