"""The energy that no run of a task undercuts, and which runs that covers.

`certify` gives the bound of `railjoule.core.continuous_bound`: it holds for every driving of the train, on any mesh and
none. Of a drive without idle losses it is close to the optimum. One that takes power without effort may be switched as
often as it likes there, and where it is slow one price for all speeds of a place says little: there
`railjoule.core.bounds.proof_steps` goes on with the chains of `railjoule.core.chain_proof`, which hold for runs over
one mesh with one effort in each cell, and `with_chains` keeps the greater one.

References: the proofs are in `railjoule.core.continuous_bound.bound` and `railjoule.core.chain_proof.proof`.
"""

import math
from dataclasses import replace

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.bounds.minimum import minimise, minimise_decided
from railjoule.core.chain_proof.prices import node_prices
from railjoule.core.chain_proof.proof import ChainProof
from railjoule.core.chain_proof.table import premise
from railjoule.core.continuous_bound.bound import ContinuousBound, continuous_bound
from railjoule.core.errors import SolverError, StrategyRefusedError
from railjoule.core.interior_point.duty import duty, safest_modes
from railjoule.core.interior_point.solver import Optimum
from railjoule.core.interior_point.start import SLOWEST_SPEED2
from railjoule.core.physics.reference import reference_energy
from railjoule.core.task import Task
from railjoule.core.trajectory import Bound, Costate, Trajectory
from railjoule.core.units import J_PER_KWH

LITTLE = 0.05
"""Where the multipliers of free switching leave this share of its energy open, others are tried."""
ROUNDED_GAP = 1e-6
"""A proof by chains aims at the tolerance less this share of it: no proof finds more than it aims at."""
SAID_M, SAID_S, ROUNDED = 0.1, 0.1, 1e-6
"""To which a sentence rounds the length of a cell [m] and a time [s], and the share of that which is rounding alone."""
SAID_KWH = 1e-4
"""To which a sentence rounds a bound [kWh]."""


def bound_of(task: Task) -> Bound | None:
    """Return the bound of a task, or None where there is no slack, its optimum is not found or takes too many cells.

    A bound is an extra: that it is missing is no reason to throw a finished run away.
    """
    if not task.has_slack:
        return None
    try:
        return certify(task, minimise(task).optimum)
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
    return run.with_bound(bound_of(longer))


def certify(task: Task, optimum: Optimum, proven: ContinuousBound | None = None) -> Bound:
    """Return the lower bound that the multipliers of an optimum prove for every driving of the train.

    Parameters
    ----------
    task : Task
        What is asked for.
    optimum : Optimum
        Over its mesh; the multipliers of any mesh, converged or not, prove a bound.
    proven : ContinuousBound, optional
        What they prove, if that is known.
    """
    proven = proven or every_run_bound(task, optimum)
    # where multipliers prove little, as those that have not converged, the plain work may be the better bound
    # a plain number: kernels that are not compiled return numpy's, and a comparison of these is no bool
    energy_j = float(max(proven.energy_j + task.dwell_energy_j, work_floor_j(task)))
    assumed = premise(task.course.data.drive_kind)
    statement = every_run_statement(task, energy_j)
    return Bound(energy_j, statement, task.travel_time_s, energy_j, premise=assumed, costate=_costate(task, proven))


def every_run_bound(task: Task, optimum: Optimum) -> ContinuousBound:
    """Return what the multipliers of an optimum prove, or better ones where these prove little.

    Those of a relaxation that has not converged, or to a local optimum, may prove next to nothing. Others are those of
    a smooth problem: with the drive on wherever the optimum drives at all.
    """
    course, time_s = task.course, task.running_time_s
    found = continuous_bound(course, optimum, time_s)
    little = LITTLE * reference_energy(course.data, optimum.energy_j, time_s)
    if not course.drive.jumps_at_no_effort or optimum.energy_j - found.energy_j <= little:
        return found
    smooth = minimise_decided(task, safest_modes(duty(course.data, optimum)))
    return max(found, continuous_bound(course, smooth, time_s), key=lambda bound: bound.energy_j)


def _costate(task: Task, proven: ContinuousBound) -> Costate:
    """Return the price of force along the line that proves a bound."""
    position = task.course.position_m[0] + proven.pieces.position_m
    ends = np.array([position[:-1], position[1:]]).T.ravel()
    return Costate(frozen_array(ends), frozen_array(proven.pieces.force.T.ravel()))


def chain_proof(task: Task, optimum: Optimum, speed2: FloatArray, energy_j: float) -> ChainProof:
    """Return the proof that no run with one effort in each cell needs much less than a known one, not yet begun.

    It is continued by `ChainProof.advance` or `run`; its energies are without dwells.

    Parameters
    ----------
    task : Task
        What is to be run.
    optimum : Optimum
        Whose multipliers are the prices.
    speed2 : array of shape (n + 1,)
        Squares of speed of the known run [m2/s2].
    energy_j : float
        What that needs, dwells included [J].
    """
    data, target = task.course.data, chain_target_j(task, energy_j) - task.dwell_energy_j
    given = data, task.running_time_s, task.greatest_speed2, slowest_covered_ms(optimum) ** 2, speed2
    return ChainProof(*given, node_prices(data, optimum), optimum.price_of_time_w, target)


def chain_target_j(task: Task, energy_j: float) -> float:
    """Return what a proof by chains aims at, below what a known run needs [J], dwells included in both."""
    moving = energy_j - task.dwell_energy_j
    # a gap is relative to the bound, this share to the run
    gap = task.scenario.solver.tolerance * (1.0 - ROUNDED_GAP)
    open_share = gap / (1.0 + gap)
    return energy_j - open_share * reference_energy(task.course.data, moving, task.running_time_s)


def slowest_covered_ms(optimum: Optimum) -> FloatArray:
    """Return the least speeds at the nodes of the runs that chains from an optimum's prices cover [m/s]."""
    # next to a stop, where the optimum itself is slower, they cover runs down to its speed
    slowest: FloatArray = np.sqrt(np.minimum(SLOWEST_SPEED2, optimum.speed2))
    return slowest


def with_chains(task: Task, bound: Bound, proven_j: float, slowest_ms: FloatArray) -> Bound:
    """Return the greater of a bound and what chains have proven [J], dwells not included, of runs so fast at least."""
    energy_j = float(proven_j + task.dwell_energy_j)
    if energy_j <= bound.energy_j:
        return bound
    return Bound(
        energy_j,
        mesh_statement(task, energy_j, bound.every_run_j),
        task.travel_time_s,
        bound.every_run_j,
        task.course.position_m,
        slowest_ms,
        premise(task.course.data.drive_kind),
        costate=bound.costate,
    )


def work_floor_j(task: Task) -> float:
    """Return the work at the wheels that every run needs [J], auxiliaries included: no drive gives energy for nothing.

    It counts gradients, curves, constant running resistance and the speeds that are given at both ends.
    """
    data = task.course.data
    start, end = data.fixed_speed2[[0, -1]]
    # what needs least: a free end at rest, and a free start at the greatest speed, whose kinetic energy is given
    start = task.greatest_speed2[0] if start < 0 else start
    kinetic = data.half_inertia_kg * (max(end, 0.0) - start)
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
        f"No way of driving this train over this line within {_said_s(task)}{windows} uses less than "
        f"{_said_kwh(energy_j)}{_assumption(task)}."
    )


def mesh_statement(task: Task, energy_j: float, every_run_j: float) -> str:
    """Return in one sentence what chains prove of runs over a mesh [J], and what every driving needs [J]."""
    # upwards: no cell is longer
    longest = math.ceil(float(task.course.data.cell_length_m.max()) / SAID_M - ROUNDED) * SAID_M
    return (
        f"No run within {_said_s(task)} over this mesh of {task.course.cell_count} cells of at most {longest:.6g} m, "
        f"with one effort in each, uses less than {_said_kwh(energy_j)}; every way of driving this train needs at "
        f"least {_said_kwh(every_run_j)}{_assumption(task)}."
    )


def _assumption(task: Task) -> str:
    assumed = premise(task.course.data.drive_kind)
    return f"; this assumes that {assumed}" if assumed else ""


def _said_s(task: Task) -> str:
    # downwards: a run that arrives later may need less
    return f"{math.floor(task.travel_time_s / SAID_S + ROUNDED) * SAID_S:.1f} s"


def _said_kwh(energy_j: float) -> str:
    # downwards: rounded up, it would say more than is proven
    return f"{math.floor(energy_j / J_PER_KWH / SAID_KWH) * SAID_KWH:.4f} kWh"
