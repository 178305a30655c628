"""The energy that no run of a task undercuts: a bound for every driving of the train, for any time and timetable.

`certify` gives the bound of `railjoule.core.continuous_bound`: it holds for every driving of the train, on any mesh and
none. Without idle losses it is close to the optimum. A drive with idle losses may be switched as often as it likes
there, and where it is slow one price for all speeds of a place proves little: there `railjoule.core.bounds.chain_bound`
goes on with chains.

The prices of one optimum, with T its time and lambda its price of a second, prove for every driving that takes t

    E + lambda t >= D,

see `railjoule.core.continuous_bound.bound`, which does not depend on the time allowed. A run that may take t' takes no
more, and lambda >= 0, so that E >= (D - lambda T) - lambda (t' - T) for each t', shorter or longer than T: that line is
`time_line`. A bound holds for all runs within its time, so that one of a longer time holds for every shorter one as
well; the least energy never rises with the time, but a proof may be tighter at the longer time (`strongest_bounds`).
"""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from railjoule.core.arrays import frozen_array
from railjoule.core.bounds.minimum import minimise, minimise_decided
from railjoule.core.chain_proof.table import premise
from railjoule.core.continuous_bound.bound import ContinuousBound, continuous_bound
from railjoule.core.errors import SolverError, StrategyRefusedError
from railjoule.core.interior_point.duty import duty, safest_modes
from railjoule.core.interior_point.solver import Optimum
from railjoule.core.lower_bound import Bound, Costate
from railjoule.core.physics.energy_balance import reference_energy
from railjoule.core.task import Task
from railjoule.core.trajectory import Trajectory
from railjoule.core.units import J_PER_KWH

LITTLE = 0.05
"""If the multipliers of free switching leave this share of its energy open, others are tried."""
SAID_M, SAID_S, ROUNDED = 0.1, 0.1, 1e-6
"""To which a sentence rounds the length of a cell [m] and a time [s], and the share of that which is only rounding."""
SAID_KWH = 1e-4
"""To which a sentence rounds a bound [kWh]."""


def find_bound(task: Task) -> Bound | None:
    """Return the bound of a task, or None where there is no slack, its optimum is not found or takes too many cells.

    A bound is an extra: that it is missing is no reason to throw a finished run away.
    """
    optimum = _known_optimum(task) if task.has_slack else None
    return None if optimum is None else certify(task, optimum)


def time_line(task: Task) -> ContinuousBound | None:
    """Return a bound, dwells included, whose energy falls by `price_of_time_w` with each second more, or rises so.

    None where no optimum is found.

    Parameters
    ----------
    task : Task
        Must have slack in its timetable; its windows of arrival do not count.
    """
    optimum = _known_optimum(task)
    if optimum is None:
        return None
    proven = every_run_bound(task, optimum)
    return proven._replace(energy_j=proven.energy_j + task.dwell_energy_j)


def _known_optimum(task: Task) -> Optimum | None:
    try:
        return minimise(task).optimum
    except (SolverError, StrategyRefusedError):
        return None


def bounded(task: Task, run: Trajectory, known: Bound | None = None) -> Trajectory:
    """Return a run with a bound that covers it: its own, else the one known, else one for the time that it takes.

    A run that misses a window of arrival which binds the optimum stays without.
    """
    if run.bound is not None:
        return run
    # in this order: a bound that is known costs nothing, another one a solution
    if known is not None and known.covers(run):
        return run.with_bound(known)
    # beside a run that keeps windows of arrival, a bound of another problem would only mislead
    if known is not None and not all(run.keeps(window) for window in known.windows):
        return run
    longer = replace(task, running_time_s=max(task.running_time_s, run.travel_time_s - task.dwell_s))
    return run.with_bound(find_bound(longer))


def certify(task: Task, optimum: Optimum, proven: ContinuousBound | None = None) -> Bound:
    """Return the lower bound that the multipliers of an optimum prove for every driving of the train.

    Parameters
    ----------
    task : Task
        The task.
    optimum : Optimum
        Over its mesh; the multipliers of any mesh, converged or not, prove a bound.
    proven : ContinuousBound, optional
        The bound that they prove, if that is known.
    """
    proven = proven or every_run_bound(task, optimum)
    # where multipliers prove little, as those that have not converged, the plain work may be the better bound
    # a plain number: kernels that are not compiled return numpy's, and a comparison of these is no bool
    energy_j = float(max(proven.energy_j + task.dwell_energy_j, work_floor_j(task)))
    assumed = premise(task.mesh.data.drive_kind)
    statement = every_run_statement(task, energy_j)
    return Bound(energy_j, statement, task.travel_time_s, energy_j, premise=assumed, costate=_costate(task, proven))


def every_run_bound(task: Task, optimum: Optimum) -> ContinuousBound:
    """Return the bound that the multipliers of an optimum prove, or better ones where these prove little.

    Multipliers of a relaxation that has not converged, or has to a local optimum, may prove next to nothing. The others
    are of a smooth problem: with the drive on wherever the optimum drives at all.
    """
    mesh, time_s = task.mesh, task.running_time_s
    found = continuous_bound(mesh, optimum, time_s)
    little = LITTLE * reference_energy(mesh.data, optimum.energy_j, time_s)
    if not mesh.drive.has_idle_losses or optimum.energy_j - found.energy_j <= little:
        return found
    smooth = minimise_decided(task, safest_modes(duty(mesh.data, optimum)))
    return max(found, continuous_bound(mesh, smooth, time_s), key=lambda bound: bound.energy_j)


def _costate(task: Task, proven: ContinuousBound) -> Costate:
    """Return the price of force along the line that proves a bound."""
    position = task.mesh.position_m[0] + proven.pieces.position_m
    ends = np.array([position[:-1], position[1:]]).T.ravel()
    return Costate(frozen_array(ends), frozen_array(proven.pieces.force.T.ravel()))


def work_floor_j(task: Task) -> float:
    """Return the work at the wheels that every run needs [J], auxiliaries included: no drive gives energy for nothing.

    It counts gradients, curves, constant running resistance and the speeds that are given at both ends.
    """
    data = task.mesh.data
    start, end = data.fixed_speed2[[0, -1]]
    # what needs least: a free end at rest, and a free start at the greatest speed, whose kinetic energy is given
    start = task.fastest_speed2[0] if np.isnan(start) else start
    kinetic = data.half_inertia_kg * (np.nan_to_num(end) - start)
    work = float(data.cell_length_m @ (data.line_force_n + data.resistance_constant_n))
    return float(kinetic) + work + data.auxiliary_power_w * task.shortest_time_s + task.dwell_energy_j


def every_run_statement(task: Task, energy_j: float, windows: str = "") -> str:
    """Return in one sentence what a bound proves of every driving of a task's train.

    Parameters
    ----------
    task : Task
    energy_j : float
        The bound [J].
    windows : str
        Windows of arrival that are kept, as the end of a list.
    """
    return (
        f"No way of driving this train over this line within {said_time(task)}{windows} uses less than "
        f"{said_energy(energy_j)}{assumption(task)}."
    )


def assumption(task: Task) -> str:
    """Return the premise of a bound of a task, as the end of a sentence."""
    assumed = premise(task.mesh.data.drive_kind)
    return f"; this assumes that {assumed}" if assumed else ""


def said_time(task: Task) -> str:
    """Return the time of a task in words."""
    # downwards: a run that arrives later may need less
    return f"{math.floor(task.travel_time_s / SAID_S + ROUNDED) * SAID_S:.1f} s"


def said_energy(energy_j: float) -> str:
    """Return a bound [J] in words."""
    # downwards: rounded up, it would say more than is proven
    return f"{math.floor(energy_j / J_PER_KWH / SAID_KWH) * SAID_KWH:.4f} kWh"


def strongest_bounds(bounds: Sequence[Bound]) -> list[Bound]:
    """Return for each bound of a scenario the greatest of all that cover whatever it covers.

    Parameters
    ----------
    bounds : sequence of Bound
        Of the same scenario but for the timetable's times, in any order; one over a mesh holds over no other.

    Returns
    -------
    list of Bound
        In the same order, each a given one with its own statement. Over one mesh they do not rise with the time.
    """
    return [
        max((other for other in bounds if _includes(other, own)), key=lambda bound: bound.energy_j) for own in bounds
    ]


def _includes(other: Bound, own: Bound) -> bool:
    """Return whether all runs that a bound covers are covered by another one, too."""
    # the numbers first: they rule out half of all pairs
    return (
        other.travel_time_s >= own.travel_time_s
        and other.energy_j >= own.energy_j
        and set(other.windows) <= set(own.windows)
        and _covers_mesh(other, own)
    )


def _covers_mesh(other: Bound, own: Bound) -> bool:
    """Return whether a bound holds over every mesh, or over that of another one for runs that are as slow."""
    if other.position_m is None or own.position_m is None:
        return other.position_m is None
    return np.array_equal(other.position_m, own.position_m) and bool(np.all(other.slowest_ms <= own.slowest_ms))
