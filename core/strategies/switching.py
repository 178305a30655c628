"""Runs of drives that take power without effort: with free switching as a relaxation, without it as a run to drive.

Free switching between coasting and driving within a cell gives the convex hull of the drive's power, and with it a
problem that has a lower bound. Where its optimum drives for a part of the way, as it does instead of holding a speed,
a run to drive must decide: on in some cells, off in the others. Sum-up rounding drives in a cell as soon as half of one
is owed; its runs approach the optimum with free switching as the mesh gets finer. With that decided the problem is
smooth again. Where it costs much, driving wherever the optimum drives at all is tried as well.

Reference: Sager, Bock, Diehl 2012, "The integer approximation error in mixed-integer optimal control", Math. Program.
133, 1-23.
"""

from dataclasses import dataclass, replace

import numpy as np

from railjoule.core.arrays import BoolArray, FloatArray
from railjoule.core.bounds.minimum import SWITCHED_TOLERANCE
from railjoule.core.dynamic_programming.search import search
from railjoule.core.interior_point.duty import coasting_exactly, duty
from railjoule.core.interior_point.solver import LARGEST_VIOLATION, Optimum, minimise_energy
from railjoule.core.motion import running_time
from railjoule.core.physics.account import run_energy
from railjoule.core.physics.cell import mean_speed
from railjoule.core.physics.reference import reference_energy
from railjoule.core.task import Task

ITERATIONS, CENTRING = 60, 1e-6
FULL, NONE = 0.98, 0.02
"""Shares of driving from which a cell counts as driven, and up to which as coasted."""
FAR = 1e-3
"""A run this far above free switching, relatively, is worth a second decision."""
TIME_SHARE, TIME_ROUNDING = 1e-7, 1e-9


@dataclass(frozen=True, eq=False)
class Unswitched:
    """The best run found that switches nothing within a cell.

    Parameters
    ----------
    speed2 : array of shape (n + 1,)
        Squares of speed at the nodes [m2/s2].
    energy_j : float
        Line energy with auxiliaries, infinite if it keeps not all limits [J].
    price_of_time_w : float
        Price of a second [J/s].
    iterations : int
        Of all solutions together.
    """

    speed2: FloatArray
    energy_j: float
    price_of_time_w: float
    iterations: int


def unswitched(task: Task, optimum: Optimum) -> Unswitched:
    """Return the best run found without switching within a cell: a local optimum.

    Parameters
    ----------
    task : Task
        What is asked for.
    optimum : Optimum
        Its optimum with free switching.

    Raises
    ------
    SolverError
        If Bellman's recursion, the last resort, finds no run either.
    """
    share, _ = duty(task.course.data, optimum)
    runs = [_drivable(task, optimum, share <= NONE)]
    for on, apart in ((summed_up(share, task.course.data.cell_length_m), 0.0), (share > NONE, FAR)):
        if _apart(task, optimum, _cheapest(runs).energy_j) <= apart:
            break
        runs.append(_drivable(task, _solved(task, on), ~on))
    if _cheapest(runs).energy_j == np.inf:
        runs.append(_by_recursion(task))
    return replace(_cheapest(runs), iterations=sum(run.iterations for run in runs))


def _cheapest(runs: list[Unswitched]) -> Unswitched:
    return min(runs, key=lambda run: run.energy_j)


def summed_up(driven_share: FloatArray, cell_length_m: FloatArray) -> BoolArray:
    """Return which cells to drive in so that the way driven up to each stays within half a cell; shape (n,).

    Parameters
    ----------
    driven_share : array of shape (n,)
        Share of each cell on which the drive is on.
    cell_length_m : array of shape (n,)
        Lengths of the cells [m].
    """
    on: BoolArray = driven_share >= FULL
    owed = 0.0
    for cell in np.flatnonzero(driven_share > NONE):
        owed += driven_share[cell] * cell_length_m[cell]
        on[cell] |= bool(owed >= 0.5 * cell_length_m[cell])
        owed -= cell_length_m[cell] if on[cell] else 0.0
    return on


def _apart(task: Task, optimum: Optimum, energy_j: float) -> float:
    """Return how far an energy [J] lies above the optimum with free switching, relatively."""
    least = optimum.energy_j
    return float((energy_j - least) / reference_energy(task.course.data, least, task.running_time_s))


def _solved(task: Task, on: BoolArray) -> Optimum:
    """Return the optimum with the drive on in some cells and off in all others."""
    data = task.course.data._replace(machines_on=on.astype(float))
    # coasting exactly afterwards may cost some of the last digits of the time
    spare = min(TIME_SHARE * task.running_time_s, 0.01 * (task.running_time_s - task.shortest_time_s))
    times = task.shortest_time_s, task.running_time_s - spare
    return minimise_energy(data, task.greatest_speed2, *times, SWITCHED_TOLERANCE, ITERATIONS, CENTRING)


def _drivable(task: Task, optimum: Optimum, off: BoolArray) -> Unswitched:
    """Return a run with its exact energy, coasting exactly where it all but coasts; infinite if none keeps all limits.

    A point that has not converged is a run as well, if it keeps them.
    """
    data = task.course.data
    points = coasting_exactly(data, optimum, off), optimum.speed2
    speed2 = next((point for point in points if _keeps_limits(task, point)), None)
    energy = np.inf if speed2 is None else _energy_j(task, speed2)
    best = optimum.speed2 if speed2 is None else speed2
    return Unswitched(best, energy, optimum.price_of_time_w, optimum.iterations)


def _by_recursion(task: Task) -> Unswitched:
    """Return the run that Bellman's recursion finds, which needs nothing to be smooth."""
    found = search(task.course.data, task.greatest_speed2, task.running_time_s)
    return Unswitched(found.speed2, _energy_j(task, found.speed2), found.price_w, found.sweeps)


def _energy_j(task: Task, speed2: FloatArray) -> float:
    """Return the line energy of a run with auxiliaries on its way [J], as the optimum counts it."""
    data = task.course.data
    auxiliaries = data.auxiliary_power_w * running_time(data.cell_length_m, speed2)
    return float(run_energy(data, speed2) + auxiliaries)


def _keeps_limits(task: Task, speed2: FloatArray) -> bool:
    """Return whether a run is in time and needs no more effort than there is, but for rounding."""
    data, force = task.course.data, task.course.net_force_n(speed2)
    speed = np.sqrt(speed2)
    v = mean_speed(speed[:-1], speed[1:])
    excess = np.maximum(force - data.traction.effort_n(v), -force - data.braking.effort_n(v) - data.friction_effort_n)
    in_time = running_time(data.cell_length_m, speed2) <= task.running_time_s * (1 + TIME_ROUNDING)
    return bool(in_time and excess.max() <= LARGEST_VIOLATION * data.traction.constant_n)
