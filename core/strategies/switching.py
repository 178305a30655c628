"""Runs of drives that take power without effort: with free switching as a relaxation, without it as a run to drive.

Free switching between coasting and driving within a cell gives the convex hull of the drive's power, and with it a
problem that has a lower bound. Where its optimum drives for a part of the way, as it does instead of holding a speed,
a run to drive must decide: on in some cells, off in the others. With that decided the problem is smooth again. The
first decision drives the same share of each such stretch in one go; then the ends of all stretches are moved to where
driving and coasting are worth the same, which is the case if the price of force equals the least power per effort.
"""

from dataclasses import dataclass, replace

import numpy as np

from railjoule.core.arrays import BoolArray, FloatArray
from railjoule.core.drive.kernels import jumps_at_no_effort
from railjoule.core.dynamic_programming.rollout import run_energy
from railjoule.core.errors import SolverError
from railjoule.core.interior_point.duty import coasting_exactly, duty
from railjoule.core.interior_point.solver import CONVERGED, LARGEST_VIOLATION, Optimum, minimise_energy
from railjoule.core.motion import running_time
from railjoule.core.strategies.task import Task

TOLERANCE = 1e-6
"""Relative gap asked for; derivatives of machines jump, and no step uses what lies below."""
ITERATIONS, CENTRING = 60, 1e-6
FULL, NONE = 0.98, 0.02
"""Shares of driving from which a cell counts as driven, and up to which as coasted."""
BALANCED = 5e-3
"""The price of force may differ from the least power per effort by this share at the end of a stretch."""
TIME_SHARE, TIME_ROUNDING = 1e-7, 1e-9
FIRST_MOVE, MOST_SOLUTIONS = 4, 3


def takes_power_idling(task: Task) -> bool:
    """Return whether the drive of a task takes power without effort when it is on."""
    return bool(jumps_at_no_effort(task.course.data.drive_kind))


@dataclass(frozen=True, eq=False)
class Unswitched:
    """The best run found that switches nothing within a cell.

    Parameters
    ----------
    speed2 : array of shape (n + 1,)
        Squares of speed at the nodes [m2/s2].
    energy_j : float
        Line energy without auxiliaries [J].
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
        If the method converges for no decision.
    """
    share, _ = duty(task.course.data, optimum)
    best = _drivable(task, optimum, share <= NONE)
    if optimum.status != CONVERGED:
        best = replace(best, energy_j=np.inf)
    decisions = [first_decision(share, task.course.data.cell_length_m)]
    if _slows_much(task, optimum, (share > NONE) & ~decisions[0]):
        # on a long way holding a speed may be better than driving harder and coasting
        decisions.append(share > NONE)
    kept: tuple[BoolArray, Optimum] | None = None
    move, solutions, iterations = FIRST_MOVE, 0, optimum.iterations
    while decisions and solutions < MOST_SOLUTIONS:
        on = decisions.pop(0)
        found = _solved(task, on)
        iterations += found.iterations
        solutions += 1
        run = _drivable(task, found, ~on)
        if found.status == CONVERGED and run.energy_j < best.energy_j:
            best, kept = run, (on, found)
        elif not decisions:
            move //= 2
        if not decisions and kept is not None and move > 0:
            moved = _moved(task, *kept, move)
            decisions += [moved] if not np.array_equal(moved, kept[0]) else []
    if best.energy_j == np.inf:
        raise SolverError(f"no run without switching was found within {iterations} iterations.")
    return replace(best, iterations=iterations)


def first_decision(driven_share: FloatArray, cell_length_m: FloatArray) -> BoolArray:
    """Return which cells to drive in: of each stretch driven in part, the same share in one go; shape (n,).

    It joins what is driven wholly before the stretch or, failing that, after it.

    Parameters
    ----------
    driven_share : array of shape (n,)
        Share of each cell on which the drive is on.
    cell_length_m : array of shape (n,)
        Lengths of the cells [m].
    """
    on: BoolArray = driven_share >= FULL
    partly = (driven_share > NONE) & ~on
    edges = np.flatnonzero(np.diff(np.concatenate([[False], partly, [False]]).astype(int)))
    for start, end in zip(edges[::2], edges[1::2], strict=True):
        length = cell_length_m[start:end]
        way = float(driven_share[start:end] @ length)
        after = end < len(driven_share) and driven_share[end] >= FULL
        before = start > 0 and driven_share[start - 1] >= FULL
        if after and not before:
            on[start:end] = np.cumsum(length[::-1])[::-1] <= way
        else:
            on[start:end] = np.cumsum(length) <= way
    return on


def _slows_much(task: Task, optimum: Optimum, coasting: BoolArray) -> bool:
    """Return whether running resistance would take half of the kinetic energy on the longest way of coasting."""
    data, speed2 = task.course.data, optimum.speed2
    work = np.where(coasting, task.course.running_resistance_n(speed2) * data.cell_length_m, 0.0)
    total = np.cumsum(work)
    # what was done when the train last did not coast
    stretch = total - np.maximum.accumulate(np.where(coasting, 0.0, total))
    return bool(np.any(stretch > 0.5 * data.half_inertia_kg * speed2[1:]))


def _solved(task: Task, on: BoolArray) -> Optimum:
    """Return the optimum with the drive on in some cells and off in all others."""
    data = task.course.data._replace(machines_on=on.astype(float))
    # coasting exactly afterwards may cost some of the last digits of the time
    spare = min(TIME_SHARE * task.running_time_s, 0.01 * (task.running_time_s - task.shortest_time_s))
    times = task.shortest_time_s, task.running_time_s - spare
    return minimise_energy(data, task.greatest_speed2, *times, TOLERANCE, ITERATIONS, CENTRING, False)


def _drivable(task: Task, optimum: Optimum, off: BoolArray) -> Unswitched:
    """Return a run with its exact energy, coasting exactly where it all but coasts."""
    data = task.course.data
    speed2 = coasting_exactly(data, optimum, off)
    if not _keeps_limits(task, speed2):
        speed2 = optimum.speed2
    energy = float(run_energy(data, speed2))
    return Unswitched(speed2, energy, optimum.time_multiplier * data.traction.constant_n, optimum.iterations)


def _keeps_limits(task: Task, speed2: FloatArray) -> bool:
    """Return whether a run is in time and needs no more effort than there is, but for rounding."""
    data, force = task.course.data, task.course.net_force_n(speed2)
    mean_speed = 0.5 * (np.sqrt(speed2[1:]) + np.sqrt(speed2[:-1]))
    excess = np.maximum(
        force - data.traction.effort_n(mean_speed), -force - data.braking.effort_n(mean_speed) - data.friction_effort_n
    )
    in_time = running_time(data.cell_length_m, speed2) <= task.running_time_s * (1 + TIME_ROUNDING)
    return bool(in_time and excess.max() <= LARGEST_VIOLATION * data.traction.constant_n)


def _moved(task: Task, on: BoolArray, found: Optimum, move: int) -> BoolArray:
    """Return the cells to drive in with the ends of all stretches moved to where driving begins or ends to pay."""
    _, worth = duty(task.course.data, found)
    moved = on.copy()
    for border in np.flatnonzero(np.diff(on.astype(int))):
        on_cell, off_cell = (border, border + 1) if on[border] else (border + 1, border)
        outward = off_cell - on_cell
        if worth[off_cell] > 1 + BALANCED:
            cells = off_cell + outward * np.arange(move)
            moved[cells[(cells >= 0) & (cells < len(on))]] = True
        elif worth[on_cell] < 1 - BALANCED:
            cells = on_cell - outward * np.arange(move)
            moved[cells[(cells >= 0) & (cells < len(on))]] = False
    return moved
