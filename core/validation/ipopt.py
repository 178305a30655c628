"""The optimum of another solver: the same problem over the same mesh, formulated in CasADi and solved by IPOPT.

References: Andersson et al., CasADi, Mathematical Programming Computation 11, 2019; Waechter and Biegler, On the
implementation of an interior-point filter line-search algorithm, Mathematical Programming 106, 2006.
"""

import importlib.util
import time
from dataclasses import dataclass
from typing import Any

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.errors import SolverError
from railjoule.core.interior_point.start import SLOWEST_SPEED2, start_speeds
from railjoule.core.task import Task
from railjoule.core.validation._program import DRIVES, Program

# quiet, and with a tolerance below the 1e-7 to which energies of two solvers are compared
OPTIONS: dict[str, Any] = {
    "print_time": False,
    "ipopt.print_level": 0,
    "ipopt.sb": "yes",
    "ipopt.tol": 1e-9,
    # by default bounds are relaxed by 1e-8, which buys an energy about 2e-7 lower than there is
    "ipopt.bound_relax_factor": 0.0,
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
        data, timetable_start = task.mesh.data, _start_of_own_method(task)
        reachable = np.full_like(timetable_start, np.inf) if textbook else task.fastest_speed2
        first = _one_speed(task) if textbook else timetable_start
        # infinite reachable speeds leave all limits over speed in, as a textbook would have them
        program = Program(data, task.running_time_s, reachable, own_braking=textbook)
        self._task, self._free = task, program.free
        self._solver = program.solver(OPTIONS)
        # the floor of our own method, so that crests taken at walking pace mean the same
        self._arguments = program.bounds(np.minimum(SLOWEST_SPEED2, 0.25 * timetable_start))
        self._arguments["x0"] = program.start(first, task.mesh.net_force_n(first))

    def solve(self) -> IpoptRun:
        """Return IPOPT's optimum, from the same start each time."""
        started = time.perf_counter()
        solution = self._solver(**self._arguments)
        solve_time = time.perf_counter() - started
        stats, data = self._solver.stats(), self._task.mesh.data
        # the program has only the free speeds; the others are as prescribed
        speed2 = data.fixed_speed2.copy()
        speed2[self._free] = np.array(solution["x"]).ravel()[: self._free.sum()]
        return IpoptRun(
            # the program is scaled by the largest effort, and has no dwells
            energy_j=float(solution["f"]) * data.traction.constant_n + self._task.dwell_energy_j,
            speed2=frozen_array(speed2),
            iterations=int(stats["iter_count"]),
            solve_time_s=solve_time,
            status=str(stats["return_status"]),
            converged=bool(stats["success"]),
        )


def _start_of_own_method(task: Task) -> FloatArray:
    """Return the start of our own method: squares of speed [m2/s2], shape (n + 1,)."""
    speed2 = np.empty(len(task.fastest_speed2))
    start_speeds(task.mesh.data, task.fastest_speed2, task.shortest_time_s, task.running_time_s, speed2)
    return speed2


def _one_speed(task: Task) -> FloatArray:
    """Return the square of the mean speed wherever it is allowed [m2/s2], shape (n + 1,)."""
    data, mean = task.mesh.data, task.mesh.length_m / task.running_time_s
    return np.where(np.isnan(data.fixed_speed2), np.minimum(mean**2, data.limit_speed2), data.fixed_speed2)
