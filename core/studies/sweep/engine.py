"""Solve and certify the rows of a sweep: a scenario's numbers are patched, and only what they touch is made again.

An optimum of a smooth drive is the one over the scenario's own mesh, which `solve` would refine: for speed, at the cost
of a few ten-thousandths of its energy, which its bound shows. It has none of what a table has no column for: phases,
notes, arrays over distance. All else, another strategy, a drive that takes power without effort, windows of arrival,
and the few optima that are not found in the first attempt, is left to `solve` itself.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.bounds import OPTIMUM, certify, minimise
from railjoule.core.budget import Budget
from railjoule.core.compilation import require_compiled
from railjoule.core.energy import Energy, net_energy
from railjoule.core.errors import RailjouleError, SolverError
from railjoule.core.interior_point.solver import Optimum
from railjoule.core.motion.course import CourseParts, course_of, drive_of, limits_of, line_of
from railjoule.core.physics.account import RunAccount, account_of_run
from railjoule.core.scenario import Scenario
from railjoule.core.strategies import solve
from railjoule.core.strategies.arrival_windows import arrival_windows
from railjoule.core.studies.sweep.columns import COLUMNS
from railjoule.core.studies.sweep.fields import Field, Patch
from railjoule.core.studies.sweep.rows import RowByRow, Rows
from railjoule.core.studies.sweep.version import solver_version
from railjoule.core.task import Task, task_over
from railjoule.core.trajectory import LATE_SHARE, Trajectory, durations_s, energy_account, line_energies_j
from railjoule.core.units import J_PER_KWH, MS_PER_KMH

# What is not named here makes a part of a course anew, so that a field that is forgotten costs time alone
SPARES_BOTH = (
    "timetable.",
    "disturbance.",
    "vehicle.drive.recuperation_factor",
    "vehicle.resistance.",
    "vehicle.tare_kg",
    "vehicle.capacity_passengers",
    "vehicle.passenger_mass_kg",
    "vehicle.load_factor",
    "vehicle.rotating_mass_factor",
    "vehicle.inertial_mass_kg",
    "vehicle.auxiliary_power_kw",
)
"""Fields, or beginnings of their paths, that leave a line over its mesh and the limits of effort as they are."""
SPARES_LINE = (*SPARES_BOTH, "line.head_wind_kmh", "vehicle.drive.", "vehicle.traction.", "vehicle.braking.")
"""Those that leave the line."""
SPARES_LIMITS = (*SPARES_BOTH, "line.", "solver.", "vehicle.length_m", "vehicle.car_count")
"""Those that leave the limits of effort, and the drive but for its recuperation factor."""


@dataclass(frozen=True)
class Plan:
    """What the rows of a sweep have in common; other processes take it whole.

    Parameters
    ----------
    key : str
        Tells it from other plans: a process that gets it again, with each chunk, knows it by this.
    solver : str
        The version of all that computes rows, which must be the worker's own.
    scenario : Scenario
    fields : tuple of Field
        What varies.
    strategy : str
    columns : tuple of str
        What is told of each run.
    patched : bool
        Whether values within the ranges need no further check.
    budget : Budget
        What each run may take.
    """

    key: str
    solver: str = field(compare=False)
    scenario: Scenario = field(compare=False)
    fields: tuple[Field, ...] = field(compare=False)
    strategy: str = field(compare=False)
    columns: tuple[str, ...] = field(compare=False)
    patched: bool = field(compare=False)
    budget: Budget = field(compare=False)


class VersionError(RailjouleError):
    """A worker whose results would not be those of who asks it."""


def solve_rows(plan: Plan, samples: FloatArray) -> Rows:
    """Return what comes out for samples of the fields' values of shape (rows, fields).

    Raises
    ------
    VersionError
        If it is asked for by another version than this one, as a cluster may have.
    """
    engine, columns = _engine_of(plan), [COLUMNS[name] for name in plan.columns]

    def told(sample: Sequence[float]) -> list[float | None]:
        run = engine.run(sample)
        return [column(run) for column in columns]

    return RowByRow(told, len(columns), budget=plan.budget)(samples)


@lru_cache(maxsize=4)
def _engine_of(plan: Plan) -> "Engine":
    """Return the engine of a plan; all threads of a process share it."""
    if plan.solver != solver_version():
        raise VersionError(
            f"a worker of the study has another version ({solver_version()}) than who asks it ({plan.solver}): install "
            "the same railjoule, numba, numpy and scipy on both."
        )
    # a worker of a cluster may be the first process of its machine
    require_compiled()
    return Engine(plan)


@dataclass(frozen=True, eq=False)
class MeshOptimum:
    """The numbers of an optimum over the mesh of its task, named as in `Trajectory`.

    Parameters
    ----------
    task : Task
        What is asked for.
    optimum : Optimum
        The point and its multipliers.
    cells : RunAccount
        The accounts of its cells.
    net_j : float
        Net energy at the line [J].
    travel_time_s : float
        Time of the whole run, dwells included [s].
    """

    task: Task
    optimum: Optimum
    cells: RunAccount
    net_j: float
    travel_time_s: float

    @cached_property
    def energy(self) -> Energy:
        """The account of the whole run, which takes longer than its net energy alone."""
        return energy_account(self.task.course, self.optimum.speed2, self.cells)

    @property
    def energy_kwh(self) -> float:
        """Net energy at the line, auxiliaries included [kWh]."""
        return self.net_j / J_PER_KWH

    @property
    def price_of_time_w(self) -> float:
        """By how much the optimum falls if the timetable is a second longer [J/s]."""
        return self.optimum.price_of_time_w

    @cached_property
    def lower_bound_kwh(self) -> float:
        """Energy that no run undercuts [kWh], which takes longer than the optimum itself."""
        return certify(self.task, self.optimum).energy_j / J_PER_KWH

    @property
    def max_speed_kmh(self) -> float:
        """Greatest speed [km/h]."""
        return math.sqrt(float(self.optimum.speed2.max())) / MS_PER_KMH


class Engine:
    """Makes runs of a plan from samples of its fields' values.

    Parameters
    ----------
    plan : Plan
    """

    def __init__(self, plan: Plan) -> None:
        self._plan, self._scenario = plan, plan.scenario
        self._patch = Patch(plan.scenario, plan.fields)
        names = [".".join(field.path) for field in plan.fields]
        self._keeps_line = all(name.startswith(SPARES_LINE) for name in names)
        # by adhesion the limits depend on the mass
        by_adhesion = plan.scenario.line.rail_condition is not None
        self._keeps_limits = not by_adhesion and all(name.startswith(SPARES_LIMITS) for name in names)
        # other threads may find neither and make both as well: they are the same
        self._kept: CourseParts | None = None
        self._windows: bool | None = None

    def run(self, sample: Sequence[float]) -> MeshOptimum | Trajectory:
        """Return the run for a sample, one value a field; errors as `solve`."""
        scenario = self._scenario_at(sample)
        if self._plan.strategy == OPTIMUM:
            task = task_over(scenario, course_of(scenario, self._parts(scenario)))
            task.require_timetable()
            if not task.course.drive.jumps_at_no_effort and not self._has_windows(task):
                run = mesh_optimum(task)
                if run is not None:
                    return run
        return solve(scenario, self._plan.strategy)

    def _scenario_at(self, sample: Sequence[float]) -> Scenario:
        if self._plan.patched:
            return self._patch(sample)
        pairs = zip(self._plan.fields, sample, strict=True)
        return self._scenario.replace(**{field.name: field.value(value) for field, value in pairs})

    def _parts(self, scenario: Scenario) -> CourseParts:
        """Return the parts of a scenario's course: those of an earlier one where no field touches them."""
        kept = self._kept
        if kept is None:
            drive = drive_of(scenario)
            self._kept = CourseParts(line_of(scenario), drive, *limits_of(scenario, drive))
            return self._kept
        line = kept.line if self._keeps_line else line_of(scenario)
        if not self._keeps_limits:
            drive = drive_of(scenario)
            return CourseParts(line, drive, *limits_of(scenario, drive))
        # no limit asks for it, and no drive is made of it
        drive = replace(kept.drive, recuperation_factor=scenario.vehicle.drive.recuperation_factor)
        return CourseParts(line, drive, kept.traction, kept.braking)

    def _has_windows(self, task: Task) -> bool:
        """Return whether stations have windows of arrival, which no field of a sweep can change."""
        if self._windows is None:
            self._windows = bool(arrival_windows(task))
        return self._windows


def mesh_optimum(task: Task) -> MeshOptimum | None:
    """Return the optimum of a smooth drive over a task's mesh; None where `solve` would go on looking for it.

    Parameters
    ----------
    task : Task
        Its timetable has slack, and no station a window of arrival.
    """
    try:
        optimum = minimise(task).optimum
    except SolverError:
        return None
    course = task.course
    cells = account_of_run(course.data, optimum.speed2)
    net_j = net_energy(*line_energies_j(course, cells))
    time_s = float(np.cumsum(durations_s(course, cells))[-1])
    # a bound covers no run that is later
    if time_s > task.travel_time_s * (1 + LATE_SHARE):
        return None
    return MeshOptimum(task, optimum, cells, net_j, time_s)
