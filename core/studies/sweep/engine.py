"""Solve and certify the rows of a sweep: numbers of a scenario are replaced, and only the dependent parts are rebuilt.

The optimum of a smooth drive is solved over the mesh of the scenario, which `solve` would refine. This is faster and
costs a few ten-thousandths of the energy, which the lower bound shows. A row has no data that a table has no column
for: phases, notes, arrays over distance. Everything else goes through `solve`: other strategies, drives with idle
losses, windows of arrival, and the few optima that are not found in the first attempt.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.bounds import OPTIMUM, certify, minimise
from railjoule.core.compilation import require_compiled
from railjoule.core.energy import Energy, net_energy
from railjoule.core.errors import RailjouleError, SolverError
from railjoule.core.interior_point.solver import Optimum
from railjoule.core.lower_bound import LATE_SHARE
from railjoule.core.motion.meshed_line import (
    MeshedLineParts,
    assemble_meshed_line,
    build_drive,
    build_limits,
    build_line,
)
from railjoule.core.physics.energy_balance import CellBalance, run_balance
from railjoule.core.scenario import Scenario
from railjoule.core.strategies import solve
from railjoule.core.strategies.arrival_windows import arrival_windows
from railjoule.core.studies.rows import RowByRow, Rows
from railjoule.core.studies.sweep.fields import corners_hold, patched
from railjoule.core.studies.sweep.study import COLUMNS, Study, solver_version
from railjoule.core.task import Task, task_over
from railjoule.core.trajectory import Trajectory, durations_s, energy_balance, supply_energies_j
from railjoule.core.units import J_PER_KWH, MS_PER_KMH

# A field that is missing here only costs time, as its part of a meshed line is rebuilt.
SPARES_BOTH = (
    "timetable.",
    "disturbance.",
    "vehicle.drive.recuperation_factor",
    "vehicle.resistance.",
    "vehicle.tare_kg",
    "vehicle.capacity_passengers",
    "vehicle.passenger_mass_kg",
    "vehicle.max_load_t",
    "vehicle.load_factor",
    "vehicle.load_t",
    "vehicle.rotating_mass_factor",
    "vehicle.inertial_mass_kg",
    "vehicle.auxiliary_power_kw",
)
"""Fields, or beginnings of their paths, that change neither the meshed line nor the limits of effort."""
SPARES_LINE = (*SPARES_BOTH, "line.head_wind_kmh", "vehicle.drive.", "vehicle.traction.", "vehicle.braking.")
"""Fields that do not change the meshed line."""
SPARES_LIMITS = (*SPARES_BOTH, "line.", "solver.", "vehicle.length_m", "vehicle.car_count")
"""Fields that do not change the limits of effort, nor the drive except for its recuperation factor."""


MAX_ENGINES = 4
_ENGINES: dict[str, "Engine"] = {}


class VersionError(RailjouleError):
    """A worker whose version is not the one of the study."""


def solve_rows(study: Study, samples: FloatArray) -> Rows:
    """Return the results for samples of the fields, of shape (rows, fields); the study is sent to other processes.

    Raises
    ------
    VersionError
        If the study was made by another version, as a cluster may have.
    """
    engine, columns = _shared_engine(study), [COLUMNS[name] for name in study.columns]

    def numbers(sample: Sequence[float]) -> list[float | None]:
        run = engine.run(sample)
        return [column(run) for column in columns]

    return RowByRow(numbers, len(columns), budget=study.budget)(samples)


def _shared_engine(study: Study) -> "Engine":
    """Return the engine of a study, which all threads of a process and all chunks share."""
    engine = _ENGINES.get(study.fingerprint)
    if engine is None:
        if study.solver != solver_version():
            raise VersionError(
                f"a worker of the study has another version ({solver_version()}) than who asks it ({study.solver}): "
                "install the same railjoule, numba, numpy and scipy on both."
            )
        # a worker of a cluster may be the first process of its machine
        require_compiled()
        for old in list(_ENGINES)[: 1 - MAX_ENGINES]:
            _ENGINES.pop(old, None)
        engine = _ENGINES[study.fingerprint] = Engine(study)
    return engine


@dataclass(frozen=True, eq=False)
class MeshOptimum:
    """The numbers of an optimum over the mesh of its task, with the names of `Trajectory`.

    Parameters
    ----------
    task : Task
    optimum : Optimum
        The point and its multipliers.
    cells : CellAccount
        The accounts of its cells.
    energy_kwh : float
        Net energy at the line, auxiliaries included [kWh].
    travel_time_s : float
        Time of the whole run, dwells included [s].
    price_of_time_w : float
        Decrease of the optimum if the timetable is one second longer [J/s].
    """

    task: Task
    optimum: Optimum
    cells: CellBalance
    energy_kwh: float
    travel_time_s: float
    price_of_time_w: float

    @cached_property
    def energy(self) -> Energy:
        """The account of the whole run, which takes longer than its net energy."""
        return energy_balance(self.task.mesh, self.optimum.speed2, self.cells)

    @cached_property
    def lower_bound_kwh(self) -> float:
        """Lower bound of the energy [kWh], which takes longer than the optimum itself."""
        return certify(self.task, self.optimum).energy_j / J_PER_KWH

    @property
    def max_speed_kmh(self) -> float:
        """Maximum speed [km/h]."""
        return math.sqrt(float(self.optimum.speed2.max())) / MS_PER_KMH


class Engine:
    """Compute runs of a study from samples of its fields.

    Parameters
    ----------
    study : Study
    """

    def __init__(self, study: Study) -> None:
        self._study = study
        # values within the ranges need no further check
        self._is_box_valid = corners_hold(study.scenario, study.fields)
        names = [".".join(field.path) for field in study.fields]
        self._keeps_line = all(name.startswith(SPARES_LINE) for name in names)
        # limits by adhesion depend on the mass
        line = study.scenario.line
        # and those by place on recuperation factor and auxiliaries
        by_place = line.all_rail_conditions != {None} or bool(line.traction_limits)
        self._keeps_limits = not by_place and all(name.startswith(SPARES_LIMITS) for name in names)
        # several threads may find neither and compute both, with equal results
        self._kept: MeshedLineParts | None = None
        self._windows: bool | None = None

    def run(self, sample: Sequence[float]) -> MeshOptimum | Trajectory:
        """Return the run for a sample, one value for each field; errors as in `solve`."""
        scenario = self._scenario_at(sample)
        if self._study.strategy == OPTIMUM:
            task = task_over(scenario, assemble_meshed_line(scenario, self._parts(scenario)))
            task.require_timetable()
            if self._windows is None:
                # no field of a sweep changes the windows of arrival
                self._windows = bool(arrival_windows(task))
            has_jerk_limit = scenario.vehicle.max_jerk_ms3 is not None
            if not task.mesh.drive.has_idle_losses and not self._windows and not has_jerk_limit:
                run = mesh_optimum(task)
                if run is not None:
                    return run
        return solve(scenario, self._study.strategy)

    def _scenario_at(self, sample: Sequence[float]) -> Scenario:
        if self._is_box_valid:
            return patched(self._study.scenario, self._study.fields, sample)
        pairs = zip(self._study.fields, sample, strict=True)
        return self._study.scenario.replace(**{field.name: field.value(value) for field, value in pairs})

    def _parts(self, scenario: Scenario) -> MeshedLineParts:
        """Return the parts of the meshed line of a scenario: earlier ones where no field changes them."""
        kept = self._kept
        line = kept.line if kept is not None and self._keeps_line else build_line(scenario)
        if kept is not None and self._keeps_limits:
            # no limit depends on the recuperation factor
            drive = replace(kept.drive, recuperation_factor=scenario.vehicle.drive.recuperation_factor)
            return kept._replace(line=line, drive=drive)
        drive = build_drive(scenario)
        parts = MeshedLineParts(line, drive, *build_limits(scenario, line, drive))
        self._kept = kept or parts
        return parts


def mesh_optimum(task: Task) -> MeshOptimum | None:
    """Return the optimum of a smooth drive over the mesh of a task; None where `solve` must search further.

    Parameters
    ----------
    task : Task
        A task with slack and without windows of arrival.
    """
    try:
        optimum = minimise(task).optimum
    except SolverError:
        return None
    mesh = task.mesh
    cells = run_balance(mesh.data, optimum.speed2)
    time_s = float(np.cumsum(durations_s(mesh, cells))[-1])
    # a bound does not cover later runs
    if time_s > task.travel_time_s * (1 + LATE_SHARE):
        return None
    energy_kwh = net_energy(*supply_energies_j(mesh, cells)) / J_PER_KWH
    return MeshOptimum(task, optimum, cells, energy_kwh, time_s, optimum.price_of_time_w)
