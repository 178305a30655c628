"""A loose bound is tightened step by step by chains of boxes, within a budget of boxes or seconds.

The chains of `railjoule.core.chain_proof` hold for runs over one mesh with one effort in each cell. They only tighten
bounds of drives with idle losses; the bound for every driving stays beside them. The page, the report and the command
line all take their bounds from here, so that a run has one bound everywhere: the first stage has a budget of boxes, no
time, and proves the same on every machine.
"""

import math
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.bounds.certified import ROUNDED, SAID_M, assumption, said_energy, said_time
from railjoule.core.bounds.minimum import minimise
from railjoule.core.budget import current_budget
from railjoule.core.chain_proof.prices import node_prices
from railjoule.core.chain_proof.proof import ChainProof
from railjoule.core.chain_proof.table import premise
from railjoule.core.errors import ScenarioError
from railjoule.core.interior_point.start import SLOWEST_SPEED2
from railjoule.core.lower_bound import Bound
from railjoule.core.physics.energy_balance import reference_energy
from railjoule.core.task import Task, task_over_nodes
from railjoule.core.trajectory import Trajectory

ROUNDED_GAP = 1e-6
"""A proof by chains aims at the tolerance less this share of it: no proof finds more than it aims at."""
FIRST_STAGE_BOXES = 1_400_000
"""Boxes of the stage that needs no asking, some 0.4 s; it settles all shipped scenarios but the slowest metro."""
# the slowest metro: 22 % open after the first stage, 0.3 % after 4.3 million boxes
LOOSE_SHARE, LOOSE_STAGE_BOXES = 3e-3, 4_500_000
"""A bound that is open by more than this share of the energy after that stage goes on up to so many boxes, some 2 s."""
LONGEST_PROOF_S = 86_400.0
OPTIMUM = "optimal"
"""The strategy whose runs are optima."""


@dataclass(frozen=True, eq=False)
class ProofStep:
    """How far a proof is after a level.

    Parameters
    ----------
    bound : Bound
        The greatest bound so far.
    boxes, budget : int
        Boxes looked at so far, and those that may be in all.
    reached : bool
        Whether the bound is as close to the run as a proof aims.
    exhausted : bool
        Whether the next level would need more boxes than the largest budget, or there is none.
    """

    bound: Bound
    boxes: int
    budget: int
    reached: bool
    exhausted: bool

    @property
    def share(self) -> float:
        """How much of the budget is used."""
        return min(self.boxes / self.budget, 1.0) if self.budget else 1.0


def can_tighten(task: Task, bound: Bound, run: Trajectory) -> bool:
    """Return whether chains may prove more of a run of a task than a bound."""
    # the gap of an optimum without idle losses is that of its bound: no proof comes near another run that needs more
    may_be_best = task.mesh.drive.has_idle_losses or run.strategy == OPTIMUM
    # a proof of the whole line leaves windows of arrival out: it comes near no run that they bind
    return may_be_best and bound.travel_time_s <= task.travel_time_s and not bound.windows and bound.covers(run)


def tightening(
    task: Task, bound: Bound, run: Trajectory, budget: int = FIRST_STAGE_BOXES, seconds: float = math.inf
) -> Iterator[ProofStep]:
    """Yield the bound of a task, and again after each level of a proof by chains.

    It never falls. Nothing is computed ahead of the step that is asked for.

    Parameters
    ----------
    task : Task
        The task of the bound.
    bound : Bound
        The greatest one known; the first is of `certify`.
    run : Trajectory
        A good run that it covers: the proof aims a little below it.
    budget : int
        Boxes that may be looked at.
    seconds : float
        A level that would last longer, estimated from those before it, is not begun [s].
    """
    possible = can_tighten(task, bound, run)
    reached = possible and bound.energy_j >= chain_target_j(task, run.energy.net_j)
    yield ProofStep(bound, 0, budget, reached, exhausted=not possible)
    if reached or not possible or budget <= 0 or seconds <= 0.0:
        return
    started = time.perf_counter()
    if not np.array_equal(run.nodes_m, task.mesh.position_m):
        # a refined optimum has a mesh of its own
        task = task_over_nodes(task, run.nodes_m)
    optimum = minimise(task).optimum
    # next to a stop, where the optimum itself is slower, chains cover runs down to its speed
    slowest2: FloatArray = np.minimum(SLOWEST_SPEED2, optimum.speed2)
    data, target_j = task.mesh.data, chain_target_j(task, run.energy.net_j)
    given = data, task.running_time_s, task.fastest_speed2, slowest2, run.node_speed_ms**2
    # chains leave dwells out
    proof = ChainProof(*given, node_prices(data, optimum), optimum.price_of_time_w, target_j - task.dwell_energy_j)
    most = current_budget().chain_boxes
    while proof.may_advance(allowed := _boxes(budget, task, bound, run)):
        used = time.perf_counter() - started
        # levels take some time a box; of the first none is known, and it is the shortest
        if used * (1.0 + proof.next_boxes / proof.boxes if proof.boxes else 1.0) > seconds:
            return
        proof.advance()
        bound = _with_chains(task, bound, proof.bound_j, np.sqrt(slowest2))
        yield ProofStep(bound, proof.boxes, allowed, proof.proven, not proof.proven and not proof.may_advance(most))


def _boxes(budget: int, task: Task, bound: Bound, run: Trajectory) -> int:
    """Return how many boxes a proof may look at: more than in the first stage where the bound is loose."""
    open_j = run.energy.net_j - bound.energy_j
    scale_j = reference_energy(task.mesh.data, run.energy.net_j - task.dwell_energy_j, task.running_time_s)
    loose = budget >= FIRST_STAGE_BOXES and open_j > LOOSE_SHARE * scale_j
    return max(budget, min(LOOSE_STAGE_BOXES, current_budget().chain_boxes)) if loose else budget


def chain_target_j(task: Task, energy_j: float) -> float:
    """Return the target of a proof by chains, a little below the energy of a known run [J], dwells included in both."""
    moving = energy_j - task.dwell_energy_j
    # a gap is relative to the bound, this share to the run
    gap = task.scenario.solver.tolerance * (1.0 - ROUNDED_GAP)
    open_share = gap / (1.0 + gap)
    return energy_j - open_share * reference_energy(task.mesh.data, moving, task.running_time_s)


def _with_chains(task: Task, bound: Bound, proven_j: float, slowest_ms: FloatArray) -> Bound:
    """Return the greater of a bound and what chains have proven [J], dwells not included, of runs so fast at least."""
    energy_j = float(proven_j + task.dwell_energy_j)
    if energy_j <= bound.energy_j:
        return bound
    return Bound(
        energy_j,
        _mesh_statement(task, energy_j, bound.every_run_j),
        task.travel_time_s,
        bound.every_run_j,
        task.mesh.position_m,
        slowest_ms,
        premise(task.mesh.data.drive_kind),
        costate=bound.costate,
    )


def _mesh_statement(task: Task, energy_j: float, every_run_j: float) -> str:
    """Return in one sentence what chains prove of runs over a mesh [J], and what every driving needs [J]."""
    # upwards: no cell is longer
    longest = math.ceil(float(task.mesh.data.cell_length_m.max()) / SAID_M - ROUNDED) * SAID_M
    return (
        f"No run within {said_time(task)} over this mesh of {task.mesh.cell_count} cells of at most {longest:.6g} m, "
        f"with one effort in each, uses less than {said_energy(energy_j)}; every way of driving this train needs at "
        f"least {said_energy(every_run_j)}{assumption(task)}."
    )


def tightened(
    task: Task,
    bound: Bound,
    run: Trajectory,
    budget: int = FIRST_STAGE_BOXES,
    seconds: float | None = None,
) -> Bound:
    """Return a bound of a task, or the one by chains of boxes where the first is loose and that is greater.

    Parameters
    ----------
    task, bound, run
        As for `tightening`.
    budget : int
        Boxes that may be looked at where no time is given.
    seconds : float, optional
        How long to go on instead [s]; 0 keeps the bound.
    """
    if seconds is not None:
        budget = current_budget().chain_boxes
    *_, last = tightening(task, bound, run, budget, math.inf if seconds is None else seconds)
    return last.bound


def check_seconds(seconds: float | None) -> None:
    """Raise ScenarioError if a proof may not go on for that long [s]."""
    if seconds is not None and not 0.0 <= seconds <= LONGEST_PROOF_S:
        raise ScenarioError(f"prove_seconds = {seconds:g} must be a number from 0 to {LONGEST_PROOF_S:g}.")


def run_to_prove(bound: Bound, runs: Iterable[Trajectory]) -> Trajectory | None:
    """Return the run that a proof starts from: the optimum, else the best one that a bound covers, if any."""
    covered = [run for run in runs if bound.covers(run)]
    # the same one whatever others were asked for beside it, so that the bound does not depend on them
    optimum = next((run for run in covered if run.strategy == OPTIMUM), None)
    return optimum or min(covered, key=lambda run: run.energy.net_j, default=None)


def with_tighter_bound(run: Trajectory, bound: Bound) -> Trajectory:
    """Return a run with a bound where that covers it and is greater than its own."""
    if not bound.covers(run) or (run.bound is not None and run.bound.energy_j >= bound.energy_j):
        return run
    return run.with_bound(bound)
