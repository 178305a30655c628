"""The energy-optimal run, with a proof of how far it can be from the best.

References: the method is in `railjoule.core.interior_point.solver`, the proof in `...certificate` and `...proof`.
"""

from dataclasses import dataclass

from railjoule.core.drive.kernels import jumps_at_no_effort
from railjoule.core.errors import SolverError, StrategyRefusedError
from railjoule.core.interior_point.proof import prove
from railjoule.core.interior_point.solver import CONVERGED, Optimum, minimise_energy
from railjoule.core.strategies.task import Task
from railjoule.core.trajectory import Bound, Trajectory, make_trajectory
from railjoule.core.units import MS_PER_KMH

TOLERANCE = 1e-7
PROVEN_GAP = 1e-6
"""A run this close to its bound, relatively, counts as proven optimal."""
FIRST_ITERATIONS, SECOND_ITERATIONS = 40, 60
FREE_CENTRING, STEADY_CENTRING = 1e-6, 0.2
PROOF_BUDGET = 2_000_000
"""Boxes of speed that a proof may look at; a proof hardly ever needs more than one a cell."""


def can_prove(task: Task) -> bool:
    """Return whether the method and its bound hold for a task's drive: whether its power is continuous at no effort.

    That of induction motors, loss polynomials and maps is not. Taken as if it were always on, its optimum would cost
    more than the true one, and the bound would be none.
    """
    return not jumps_at_no_effort(task.course.data.drive_kind)


@dataclass(frozen=True, eq=False)
class Solution:
    """The optimum of a task in scaled numbers, before it becomes a trajectory.

    Parameters
    ----------
    optimum : Optimum
        Point and multipliers.
    iterations : int
        Of all attempts together.
    """

    optimum: Optimum
    iterations: int


def minimise(task: Task, tolerance: float = TOLERANCE) -> Solution:
    """Return the optimum of a task.

    Parameters
    ----------
    task : Task
        Must have slack in its timetable.
    tolerance : float
        Relative gap asked for.

    Raises
    ------
    StrategyRefusedError
        If the power of the drive jumps at zero effort.
    SolverError
        If neither of two attempts converges.
    """
    if not can_prove(task):
        raise StrategyRefusedError("needs a drive that takes no power when it is on without effort.")
    iterations = 0
    for allowed, centring in ((FIRST_ITERATIONS, FREE_CENTRING), (SECOND_ITERATIONS, STEADY_CENTRING)):
        optimum = minimise_energy(
            task.course.data,
            task.greatest_speed2,
            task.shortest_time_s,
            task.running_time_s,
            tolerance,
            allowed,
            centring,
            False,
        )
        iterations += optimum.iterations
        if optimum.status == CONVERGED:
            return Solution(optimum, iterations)
    raise SolverError(f"the optimum was not found within {iterations} iterations.")


def optimal(task: Task, proof_budget: int = PROOF_BUDGET) -> Trajectory:
    """Return the run that needs the least energy, with its bound, for drives whose power does not jump.

    Parameters
    ----------
    task : Task
        What is asked for.
    proof_budget : int
        Boxes of speed that the proof may look at beyond one a cell.

    Raises
    ------
    TimetableError
        If the timetable cannot be kept.
    StrategyRefusedError, SolverError
        As `minimise`.
    """
    task.require_timetable()
    solution = minimise(task)
    optimum, data = solution.optimum, task.course.data
    bound = certify(task, optimum, proof_budget)
    return make_trajectory(
        task.scenario,
        task.course,
        "optimal",
        optimum.speed2,
        optimum.braking * data.traction.constant_n if data.friction_effort_n > 0 else None,
        bound=bound,
        price_of_time_w=optimum.time_multiplier * data.traction.constant_n,
        iterations=solution.iterations,
    )


def certify(task: Task, optimum: Optimum, proof_budget: int = PROOF_BUDGET) -> Bound:
    """Return the lower bound that the multipliers of an optimum prove, and what it covers."""
    data = task.course.data
    proof = prove(data, optimum, task.greatest_speed2, task.running_time_s, 0.8 * PROVEN_GAP, proof_budget)
    energy = proof.bound * data.traction.constant_n + data.auxiliary_power_w * task.dwell_s
    return Bound(energy, bound_statement(task))


def bound_statement(task: Task) -> str:
    """Return in one sentence which runs a bound covers."""
    slowest = 0.1 / MS_PER_KMH
    return (
        f"No run over this mesh of {task.course.cell_count} cells, with one effort in each, that keeps all limits, "
        f"arrives within {task.travel_time_s:.1f} s and goes nowhere slower than {slowest:.2f} km/h between "
        "its stops needs less."
    )
