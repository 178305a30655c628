"""The energy-optimal run, with a proof of how far it can be from the best.

References: the method is in `railjoule.core.interior_point.solver`, the proof in `...certificate` and `...proof`.
"""

from dataclasses import dataclass, replace

import numpy as np

from railjoule.core.budget import current_budget
from railjoule.core.energy import energy_decimals
from railjoule.core.errors import SolverError, StrategyRefusedError
from railjoule.core.interior_point.proof import prove
from railjoule.core.interior_point.solver import CONVERGED, Optimum, minimise_energy
from railjoule.core.interior_point.switching_bound import switched_bound
from railjoule.core.strategies.switching import TOLERANCE as SWITCHED_TOLERANCE
from railjoule.core.strategies.switching import takes_power_idling, unswitched
from railjoule.core.strategies.task import Task
from railjoule.core.trajectory import PROVEN_GAP, Bound, Reference, Trajectory, make_trajectory
from railjoule.core.units import J_PER_KWH, MS_PER_KMH

TOLERANCE = 1e-7
FIRST_ITERATIONS, SECOND_ITERATIONS = 40, 60
FREE_CENTRING, STEADY_CENTRING = 1e-6, 0.2
LOOSE_GAP = 0.1
PROOF_BUDGET = 2_000_000
"""Boxes of speed that a proof may look at; a proof hardly ever needs more than one a cell."""
SMOOTHED = 1e-4
"""By so much the smoothed power of a drive may put its optimum above a run, as a share."""
SWITCHED_PROOF_TOLERANCE, PIECES_A_CELL = 2e-4, 44
"""How close the bound of a drive that takes power without effort shall come to its multipliers' best, if it can."""


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
    """Return the optimum of a task; a drive that takes power without effort may be switched at will within a cell.

    Parameters
    ----------
    task : Task
        Must have slack in its timetable.
    tolerance : float
        Relative gap asked for, at least 1e-6 for such a drive.

    Raises
    ------
    SolverError
        If neither of two attempts converges; for such a drive, if the second does not come near it.
    StrategyRefusedError
        If the mesh has more cells than the current budget gives to such a drive.
    """
    iterations = 0
    if takes_power_idling(task):
        task.require_few_cells(current_budget().idling_cells)
        tolerance = max(tolerance, SWITCHED_TOLERANCE)
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
    if takes_power_idling(task) and optimum.relative_gap < LOOSE_GAP:
        # a relaxation is no run to drive: its multipliers are good enough for a bound and a decision where to drive
        return Solution(optimum, iterations)
    raise SolverError(f"the optimum was not found within {iterations} iterations.")


def optimal(task: Task, proof_budget: int = PROOF_BUDGET) -> Trajectory:
    """Return the run that needs the least energy, with its bound; it takes every drive.

    Of a drive that takes power without effort it is the best run found that is not switched within a cell. Its bound
    and the energy in its notes are those of runs with free switching.

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
    SolverError, StrategyRefusedError
        As `minimise`.
    """
    task.require_timetable()
    solution = minimise(task)
    optimum, data = solution.optimum, task.course.data
    bound = certify(task, optimum, proof_budget)
    if takes_power_idling(task):
        run = unswitched(task, optimum)
        # friction spares the drive what it would have to draw
        electric = np.zeros(task.course.cell_count)
        notes: tuple[str, ...] = (switching_note(task, optimum, run.energy_j),)
        speed2, price, iterations = run.speed2, run.price_of_time_w, run.iterations
    else:
        electric, notes = optimum.braking * data.traction.constant_n, ()
        speed2, price, iterations = (
            optimum.speed2,
            optimum.time_multiplier * data.traction.constant_n,
            solution.iterations,
        )
    best = make_trajectory(
        task.scenario,
        task.course,
        "optimal",
        speed2,
        electric,
        bound=bound,
        price_of_time_w=price,
        iterations=iterations,
        notes=notes,
    )
    return replace(best, reference=Reference(best.energy.net_j, best.strategy, task.travel_time_s, best.is_proven))


def known_optimum(task: Task) -> Trajectory | None:
    """Return the optimum of a task, to measure other runs against; None where it is not found."""
    try:
        return optimal(task)
    except (SolverError, StrategyRefusedError):
        return None


def certify(task: Task, optimum: Optimum, proof_budget: int = PROOF_BUDGET) -> Bound:
    """Return the lower bound that the multipliers of an optimum prove, and what it covers."""
    data = task.course.data
    given = data, optimum, task.greatest_speed2, task.running_time_s
    if takes_power_idling(task):
        pieces = min(PIECES_A_CELL, proof_budget)
        bound, _ = switched_bound(*given, SWITCHED_PROOF_TOLERANCE, pieces)
        return Bound(max(_energy_j(task, bound), work_floor_j(task)), switched_bound_statement(task))
    proof = prove(*given, 0.8 * PROVEN_GAP, proof_budget)
    return Bound(max(_energy_j(task, proof.bound), work_floor_j(task)), bound_statement(task))


def work_floor_j(task: Task) -> float:
    """Return the work at the wheels that every run needs [J], auxiliaries included: no drive gives energy for nothing.

    It counts gradients, curves, constant running resistance and the speeds that are given at both ends.
    """
    data = task.course.data
    start, end = data.fixed_speed2[[0, -1]]
    # an end that is free may be at rest, a start that is free as fast as can be
    start = task.greatest_speed2[0] if start < 0 else start
    kinetic = data.half_inertia_kg * (max(end, 0.0) - start)
    way = float(data.cell_length_m @ (data.line_force_n + data.resistance_constant_n))
    return float(kinetic) + way + data.auxiliary_power_w * (task.shortest_time_s + task.dwell_s)


def _energy_j(task: Task, scaled: float) -> float:
    """Return the net energy [J] of a scaled one that knows no dwells."""
    data = task.course.data
    return scaled * data.traction.constant_n + data.auxiliary_power_w * task.dwell_s


def bound_statement(task: Task) -> str:
    """Return in one sentence which runs a bound covers."""
    return f"No run over this mesh of {task.course.cell_count} cells, with one effort in each, {_conditions(task)}."


def switched_bound_statement(task: Task) -> str:
    """Return in one sentence which runs the bound of a drive covers that takes power without effort."""
    return (
        f"No run over this mesh of {task.course.cell_count} cells, even if it switches freely between driving, "
        f"coasting and braking within each, {_conditions(task)}; this assumes that the power of the powertrain is "
        "convex in its effort, and that its losses do not fall with speed."
    )


def switching_note(task: Task, optimum: Optimum, energy_j: float) -> str:
    """Return in one sentence what an optimal run of an energy [J] is, and what free switching needs if it is less."""
    data = task.course.data
    free = optimum.energy * data.traction.constant_n
    friction = (
        "friction brakes take over where electric braking would draw power"
        if data.friction_effort_n > 0
        else "the vehicle has no friction brakes to support the electric ones"
    )
    known = ""
    if free <= energy_j + SMOOTHED * abs(energy_j):
        needed = _energy_j(task, optimum.energy) / J_PER_KWH
        known = f"free switching would need {needed:.{energy_decimals(needed)}f} kWh; "
    return (
        "Each cell is driven or coasted as a whole, where free switching between driving, coasting and braking would "
        f"drive for a part of it; this is the best such run found, not proven; {known}{friction}."
    )


def _conditions(task: Task) -> str:
    slowest = 0.1 / MS_PER_KMH
    return (
        f"that keeps all limits, arrives within {task.travel_time_s:.1f} s and never goes slower than "
        f"{slowest:.2f} km/h between its stops uses less energy"
    )
