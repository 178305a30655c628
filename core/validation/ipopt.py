"""The optimum of another solver: the same problem over the same mesh, formulated in CasADi and solved by IPOPT.

The power of a drive comes from the kernels' own formula, so that the energies of two solvers are comparable.

References: Andersson et al., CasADi, Mathematical Programming Computation 11, 2019; Waechter and Biegler, On the
implementation of an interior-point filter line-search algorithm, Mathematical Programming 106, 2006.
"""

import importlib
import importlib.util
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.drive.geared import constant_efficiency_power, copper_loss_power
from railjoule.core.drive.kernels import may_draw_while_braking
from railjoule.core.drive.kinds import CONSTANT_EFFICIENCY, COPPER_LOSS
from railjoule.core.drive.line_power import smooth_supply_power
from railjoule.core.errors import SolverError
from railjoule.core.interior_point.start import SLOWEST_SPEED2, start_speeds
from railjoule.core.physics.cell import duration, mean_speed, needed_force
from railjoule.core.physics.effort_limit import EffortLimit
from railjoule.core.physics.mesh_data import all_cells
from railjoule.core.physics.place_limits import NO_PLACE
from railjoule.core.task import Task

# Formulas that are plain arithmetic take symbols as they are. Induction and map drives search or look up, which CasADi
# cannot trace: they have no outside oracle here.
DRIVES = {CONSTANT_EFFICIENCY: constant_efficiency_power, COPPER_LOSS: copper_loss_power}
# quiet, and with a tolerance below the 1e-7 to which energies of two solvers are compared
OPTIONS: dict[str, Any] = {
    "print_level": 0,
    "sb": "yes",
    "tol": 1e-9,
    # by default bounds are relaxed by 1e-8, which buys an energy about 2e-7 lower than there is
    "bound_relax_factor": 0.0,
}


@dataclass(frozen=True, eq=False)
class IpoptRun:
    """The result of IPOPT.

    Parameters
    ----------
    energy_j : float
        Net energy at the line, auxiliaries included [J].
    speed2 : array of shape (n + 1,)
        Squares of speed at the nodes [m2/s2].
    iterations : int
    solve_time_s : float
        Time of the solution, without building the problem [s].
    status : str
        IPOPT's return status.
    converged : bool
        Whether it reports an optimum.
    """

    energy_j: float
    speed2: FloatArray
    iterations: int
    solve_time_s: float
    status: str
    converged: bool


def is_installed() -> bool:
    """Return whether CasADi, which brings IPOPT, can be imported."""
    return importlib.util.find_spec("casadi") is not None


def is_known(task: Task) -> bool:
    """Return whether a task's drive can be written in symbols; one that searches for its flux cannot."""
    return task.mesh.data.drive_kind in DRIVES


class IpoptProblem:
    """A task as a nonlinear program, built once and solved as often as wanted.

    Efforts are scaled by the maximum of the traction, and the objective as well.

    Parameters
    ----------
    task : Task
        Must have slack in its timetable.
    textbook : bool
        Whether it is written down as anybody would: braking efforts as variables, all limits, and one speed everywhere
        as a start. Else IPOPT gets what our own method has found out: braking eliminated, limits that no run
        reaches left out, and a start close to the timetable, which saves it a third of its time.

    Raises
    ------
    SolverError
        If CasADi is not installed, or the drive is none that it takes.
    """

    def __init__(self, task: Task, textbook: bool = False) -> None:
        if not is_installed():
            raise SolverError("IPOPT needs CasADi: pip install casadi.")
        if not is_known(task):
            raise SolverError("this drive has no symbolic formula for IPOPT, because it searches for its flux.")
        if np.any(task.mesh.data.place != NO_PLACE):
            raise SolverError("IPOPT's program has no limits by place (line.traction_limits, line.rail_conditions).")
        self._task, self._casadi = task, importlib.import_module("casadi")
        self._data, self._scale = task.mesh.data, task.mesh.data.traction.constant_n
        # prescribed speeds are numbers in the program and no variables with equal bounds, which have no inside
        self._free = np.isnan(self._data.fixed_speed2)
        self._opti = self._casadi.Opti()
        # the start of our own method, and one speed wherever it is allowed
        timetable_start, mean = np.empty(len(task.fastest_speed2)), task.mesh.length_m / task.running_time_s
        start_speeds(self._data, task.fastest_speed2, task.shortest_time_s, task.running_time_s, timetable_start)
        one_speed = np.where(self._free, np.minimum(mean**2, self._data.limit_speed2), self._data.fixed_speed2)
        start = one_speed if textbook else timetable_start
        # the floor of our own method, so that crests taken at walking pace mean the same
        floor = np.minimum(SLOWEST_SPEED2, 0.25 * timetable_start)
        # infinite reachable speeds leave all limits over speed in, as a textbook would have them
        reachable = np.full_like(start, np.inf) if textbook else task.fastest_speed2
        self._opti.minimize(self._formulate(start, floor, np.sqrt(reachable), textbook))
        # a table is looked up at an index that the point decides, which CasADi cannot expand into scalars
        # expanded programs are evaluated faster, so they are where that is possible
        tables = len(self._data.traction.table) + len(self._data.braking.table)
        options = {"print_time": False, "record_time": True, "expand": tables == 0, "detect_simple_bounds": True}
        self._opti.solver("ipopt", options, OPTIONS)

    def solve(self) -> IpoptRun:
        """Return IPOPT's optimum, from the same start each time."""
        solution, stats = self._opti.solve_limited(), self._opti.stats()
        # the program has only the free speeds; the others are as prescribed
        speed2 = self._data.fixed_speed2.copy()
        speed2[self._free] = solution.value(self._speed2)
        return IpoptRun(
            # the program has no dwells
            energy_j=float(solution.value(self._opti.f)) * self._scale + self._task.dwell_energy_j,
            speed2=frozen_array(speed2),
            iterations=int(stats["iter_count"]),
            solve_time_s=float(stats["t_wall_total"]),
            status=str(stats["return_status"]),
            converged=bool(stats["success"]),
        )

    def _formulate(self, start: FloatArray, floor: FloatArray, reachable_speed: FloatArray, own_braking: bool) -> Any:
        """Add variables and constraints, and return the scaled energy.

        Parameters
        ----------
        start, floor : array of shape (n + 1,)
            Squares of speed at the nodes to begin with, and their lower bounds [m2/s2].
        reachable_speed : array of shape (n + 1,)
            No run is faster [m/s]; limits over speed that only faster runs reach are left out.
        own_braking : bool
            Whether the braking effort is a variable even where no friction brake makes it one.
        """
        data, scale, sum_of = self._data, self._scale, self._casadi.sum1
        force_start = self._task.mesh.net_force_n(start) / scale
        driving = np.maximum(force_start, 0.0)
        # IPOPT moves a start inside of its bounds anyway; a little effort everywhere keeps driving and braking off
        # their corners
        traction_start = np.minimum(driving + 0.1 * np.maximum(1 - driving, 0.0), 1.0)
        braking_limit = data.supply_share * (data.braking.constant_n / scale)
        self._speed2 = self._variable(start[self._free], floor[self._free], data.limit_speed2[self._free])
        traction = self._variable(traction_start, 0.0, data.supply_share)
        w = self._speed2_at_nodes()
        speed = self._casadi.sqrt(w)
        v = mean_speed(speed[:-1], speed[1:])
        cells = all_cells(data)
        acceleration_force = cells.inertia / scale * (w[1:] - w[:-1])
        force = needed_force(cells, w[:-1], w[1:], v) / scale
        top_speed = 0.5 * (reachable_speed[1:] + reachable_speed[:-1])
        if own_braking or data.friction_effort_n > 0:
            braking = self._variable(np.maximum(traction_start - force_start, 0.0) / 2, 0.0, braking_limit)
            self._keep(traction - force - braking, 0.0, data.friction_effort_n / scale)
        else:
            # without friction brakes the balance of forces gives the braking effort: one variable and one equation
            # fewer a cell
            braking = traction - force
            self._keep(braking, 0.0, braking_limit)
        self._limit_over_speed(traction, data.traction, v, top_speed)
        self._limit_over_speed(braking, data.braking, v, top_speed)
        if np.isfinite([data.max_acceleration_ms2, data.max_deceleration_ms2]).any():
            inertia = 2 * data.half_inertia_kg / scale
            self._keep(acceleration_force, -inertia * data.max_deceleration_ms2, inertia * data.max_acceleration_ms2)
        # an inequality and no equation, as in our own formulation: an optimum that is early would show in both
        running_time = sum_of(duration(data.cell_length_m, v))
        self._keep(running_time, -np.inf, self._task.running_time_s)
        energy = sum_of(data.cell_length_m * self._energy_per_metre(v, traction, braking))
        return energy + data.auxiliary_power_w / scale * running_time

    def _variable(self, start: FloatArray, low: FloatArray | float, high: FloatArray | float) -> Any:
        """Return a variable with a start and bounds."""
        variable = self._opti.variable(len(start))
        self._opti.set_initial(variable, start)
        self._keep(variable, low, high)
        return variable

    def _keep(self, expression: Any, low: FloatArray | float, high: FloatArray | float) -> None:
        self._opti.subject_to(self._opti.bounded(low, expression, high))

    def _speed2_at_nodes(self) -> Any:
        """Return the squares of speed at all nodes, the prescribed ones as numbers."""
        ca, place = self._casadi, np.flatnonzero(self._free)
        pattern = ca.Sparsity.triplet(len(self._free), len(place), place.tolist(), list(range(len(place))))
        return ca.mtimes(ca.DM(pattern, 1.0), self._speed2) + ca.DM(np.where(self._free, 0.0, self._data.fixed_speed2))

    def _energy_per_metre(self, v: Any, traction: Any, braking: Any) -> Any:
        """Return the line energy of the cells over their length, without auxiliaries."""
        data, kernel = self._data, DRIVES[self._data.drive_kind]
        # the Python function behind a compiled one: arithmetic, which takes symbols as well; numba keeps it
        power: Callable[..., Any] = getattr(kernel, "py_func", kernel)
        taken = power(data.drive_parameters, False, traction * self._scale, v)[0] / v / self._scale
        generated = -power(data.drive_parameters, True, braking * self._scale, v)[0] / v / self._scale
        drawn = 0.0
        if may_draw_while_braking(data.drive_kind) and data.recuperation_factor < 1:
            # the start is above 0, as it is a slack of the draw in braking and must not begin at its bound
            drawn = self._variable(np.full(len(data.cell_length_m), 1e-2), 0.0, np.inf)
            self._keep(drawn + generated, 0.0, np.inf)
        return smooth_supply_power(taken, generated, drawn, data.recuperation_factor)

    def _limit_over_speed(self, effort: Any, limit: EffortLimit, v: Any, top_speed: FloatArray) -> None:
        """Keep an effort under its limit that varies with speed."""
        if len(limit.table):
            self._keep(self._tabulated(limit, v) / self._scale - effort, 0.0, np.inf)
            return
        # v appears in the denominator: where the limit cannot bind, leaving it out spares IPOPT a nonlinear row
        binding = np.flatnonzero(limit.power_w < limit.constant_n * top_speed).tolist()
        if binding:
            self._keep(limit.power_w / self._scale / v[binding] - effort[binding], 0.0, np.inf)

    def _tabulated(self, limit: EffortLimit, v: Any) -> Any:
        """Return a tabulated limit [N], piece by piece a cubic."""
        ca = self._casadi
        piece = ca.low(limit.table[:, 0].tolist(), v)
        start, c0, c1, c2, c3 = (ca.MX(ca.DM(np.ascontiguousarray(column))).nz[piece] for column in limit.table.T)
        x = v - start
        return ((c3 * x + c2) * x + c1) * x + c0
