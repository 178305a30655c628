"""The energy that no run of a task undercuts, and which runs that covers.

`certify` gives a first bound at once. Of a smooth drive it hardly ever lies below the optimum by more than a millionth;
of one that takes power without effort it lets the drive switch within cells, which no run of ours does. With a table of
losses, which need not be convex, it is pending: only the work at the wheels is known until chains have run. Where the
first is loose `railjoule.core.bounds.proof_steps` goes on with the chains of `railjoule.core.chain_proof`, which hold
for one effort in each cell, and `with_chains` keeps the greater one.

References: the proofs are in `railjoule.core.interior_point.certificate`, `...proof` and `...switching_bound`, and in
`railjoule.core.chain_proof.proof`.
"""

import math
from dataclasses import replace

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.bounds.minimum import minimise, minimise_decided
from railjoule.core.chain_proof.prices import node_prices
from railjoule.core.chain_proof.proof import ChainProof
from railjoule.core.chain_proof.table import premise
from railjoule.core.drive.kernels import may_be_concave
from railjoule.core.drive.kinds import LOSS_POLYNOMIAL
from railjoule.core.errors import InfeasibleLineError, SolverError, StrategyRefusedError, TimetableError
from railjoule.core.interior_point.duty import duty, safest_modes
from railjoule.core.interior_point.proof import prove
from railjoule.core.interior_point.solver import CONVERGED, Optimum
from railjoule.core.interior_point.start import SLOWEST_SPEED2
from railjoule.core.interior_point.switching_bound import switched_bound
from railjoule.core.physics.reference import reference_energy
from railjoule.core.task import Task, prepare_task
from railjoule.core.trajectory import PROVEN_GAP, Bound, Trajectory
from railjoule.core.units import J_PER_KWH, MS_PER_KMH

PROOF_SHARE = 0.8
"""A proof aims this much closer, so that a run's own rounding does not undo it."""
PROOF_BUDGET = 2_000_000
"""Boxes of speed that a proof may look at; a proof hardly ever needs more than one a cell."""
SWITCHED_PROOF_TOLERANCE, PIECES_A_CELL = 2e-4, 44
"""How close the bound of a drive that takes power without effort has to come to its multipliers' best, if it can, and
how many pieces of a cell's speeds it may look at for that."""
LITTLE = 0.05
"""Where the multipliers of free switching leave this share of its energy open, others are tried."""
# half of the thousandth that is asked of shipped scenarios: no proof finds more than it aims at
CHAIN_TOLERANCE = 5e-4
"""How far below the best known run a proof by chains aims, as a share of its energy."""
SWITCHED_PREMISE = "the power of the powertrain is convex in its effort and its losses do not fall with speed"
"""What the bound with free switching takes for granted, unless the formula of the losses tells."""
FINER_MESH = "A run over a finer mesh may need less."
"""What ends every statement: how much less, README tables under "How much the mesh decides"."""
SAID_M, SAID_S, ROUNDED = 0.1, 0.1, 1e-6
"""To which a sentence rounds the length of a cell [m] and a time [s], and the share of that which is rounding alone."""
SAID_KWH = 1e-4
"""To which a sentence rounds the energy of the first bound [kWh]."""
MOST_REFINED = 4
"""A run over more nodes than so many times the task's gets no bound: the printed regulator makes a cell of each step of
time, tens of thousands down to hundredths of a millimetre, over which an optimum takes a minute and does not converge.
Strategies with nodes of their own make at most twice the task's."""

# The floor of speeds between stops in the problem that is solved and in its proof: slower runs are not covered
SLOWEST_PROVEN_MS = math.sqrt(SLOWEST_SPEED2)


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
    """Return a run with a bound that covers it: its own, else the one known, else one over its nodes and in its time.

    A run over other nodes than the task's, or later than it, may need less than what is proven of the task. Over very
    many more nodes it stays without, as does one that is slower on its way than any bound covers, or one that misses a
    window of arrival which binds the optimum.
    """
    if run.bound is not None:
        return run
    # in this order: a bound that is known costs nothing, another one a solution
    if known is not None and known.covers(run):
        return run.with_bound(known)
    # beside a run that keeps windows of arrival, a bound of another problem would only mislead
    if known is not None and not all(run.keeps(window) for window in known.windows):
        return run
    if len(run.nodes_m) > MOST_REFINED * len(task.course.position_m):
        return run
    try:
        return run.with_bound(bound_of(_covering(task, run)))
    except (InfeasibleLineError, TimetableError):
        # limits that this task's mesh keeps may ask too much of another's shorter cells
        return run


def _covering(task: Task, run: Trajectory) -> Task:
    """Return a task over the nodes of a run and with its time, if that is longer."""
    if not np.array_equal(run.nodes_m, task.course.position_m):
        initial, final = task.end_speeds_ms
        task = prepare_task(task.scenario, initial, final, run.nodes_m)
    # a later run may need less: the bound has to hold for its time as well
    return replace(task, running_time_s=max(task.running_time_s, run.travel_time_s - task.dwell_s))


def certify(task: Task, optimum: Optimum, proof_budget: int = PROOF_BUDGET) -> Bound:
    """Return the lower bound that the multipliers of an optimum prove, and what it covers."""
    energy, jumps = proven_j(task, optimum, proof_budget), task.course.drive.jumps_at_no_effort
    statement = switched_bound_statement(task) if jumps else bound_statement(task)
    bound = Bound(energy, statement, task.course.position_m, task.travel_time_s, slowest_proven_ms(optimum))
    if not jumps:
        return bound
    pending = may_be_concave(task.course.data.drive_kind)
    return replace(bound, switched_j=energy, premise=switched_premise(task), pending=pending)


def slowest_proven_ms(optimum: Optimum) -> FloatArray:
    """Return the least speeds at the nodes of the runs that the proof of an optimum covers [m/s]."""
    # next to a stop, where the optimum itself is slower, its proof covers runs down to its speed
    slowest: FloatArray = np.minimum(SLOWEST_PROVEN_MS, np.sqrt(optimum.speed2))
    return slowest


def proven_j(task: Task, optimum: Optimum, proof_budget: int = PROOF_BUDGET) -> float:
    """Return the energy that no run of a task undercuts [J], dwells included, as the multipliers of an optimum prove.

    Arguments as for `certify`, which says what that covers.
    """
    # a cellwise proof needs a power that is continuous in effort; the other bounds its convex hull
    if task.course.drive.jumps_at_no_effort:
        proven, _ = switched_bound_j(task, optimum, proof_budget)
    else:
        given = task.course.data, optimum, task.greatest_speed2, task.running_time_s
        proven = prove(*given, PROOF_SHARE * PROVEN_GAP, proof_budget).bound_j
    # where multipliers prove little, as those that have not converged, the plain work may be the better bound
    # a plain number: kernels that are not compiled return numpy's, and a comparison of these is no bool
    return float(max(proven + task.dwell_energy_j, work_floor_j(task)))


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
    slowest2 = np.minimum(SLOWEST_SPEED2, optimum.speed2)
    given = data, task.running_time_s, task.greatest_speed2, slowest2, speed2
    return ChainProof(*given, node_prices(data, optimum), optimum.price_of_time_w, target)


def chain_target_j(task: Task, energy_j: float) -> float:
    """Return what a proof by chains aims at, below what a known run needs [J], dwells included in both."""
    moving = energy_j - task.dwell_energy_j
    return energy_j - CHAIN_TOLERANCE * reference_energy(task.course.data, moving, task.running_time_s)


def with_chains(task: Task, bound: Bound, proven_j: float) -> Bound:
    """Return the greater of a bound with free switching and what chains have proven [J], dwells not included."""
    energy = float(proven_j + task.dwell_energy_j)
    if energy <= bound.energy_j:
        return bound
    given = premise(task.course.data.drive_kind)
    if bound.switched_j is None:
        return replace(bound, energy_j=energy, statement=bound_statement(task, given), premise=given)
    # what is proven of runs that switch stays what it was, however often the bound is raised
    statement = chain_bound_statement(task, bound.switched_j)
    return replace(bound, energy_j=energy, statement=statement, premise=given, pending=False)


def switched_bound_j(task: Task, optimum: Optimum, proof_budget: int = PROOF_BUDGET) -> tuple[float, float]:
    """Return what multipliers prove of a drive that takes power without effort [J], and their price of time [W].

    Dwells are not included.

    Those of an optimum that has not converged, or to a local one, may prove next to nothing. A bound holds with any, so
    that those of a smooth problem are tried, too: with the drive on wherever the optimum drives at all.

    A drive whose power may be concave in its effort, as a table of losses makes it, breaks `SWITCHED_PREMISE`: its
    multipliers prove nothing here, and only chains prove a bound.
    """
    if may_be_concave(task.course.data.drive_kind):
        return -math.inf, 0.0
    data, effort = task.course.data, (SWITCHED_PROOF_TOLERANCE, min(PIECES_A_CELL, proof_budget))
    given = task.greatest_speed2, task.running_time_s
    # weak duality: every choice of multipliers bounds from below, the greatest of their bounds counts
    proven, _ = switched_bound(data, optimum, *given, *effort)
    little = LITTLE * reference_energy(data, optimum.energy_j, task.running_time_s)
    if optimum.status == CONVERGED and optimum.energy_j - proven <= little:
        return float(proven), optimum.price_of_time_w
    smooth = minimise_decided(task, safest_modes(duty(data, optimum)))
    other, _ = switched_bound(data, smooth, *given, *effort)
    return max((float(proven), optimum.price_of_time_w), (float(other), smooth.price_of_time_w))


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


def switched_premise(task: Task) -> str:
    """Return in one clause what the bound with free switching assumes of a task's drive, empty where nothing."""
    kind = task.course.data.drive_kind
    # A loss polynomial's coefficients are not negative: of its formula both properties follow. A drive that may break
    # the premise has only the work at the wheels as such a bound, which needs none.
    return "" if kind == LOSS_POLYNOMIAL or may_be_concave(kind) else SWITCHED_PREMISE


def bound_statement(task: Task, assumption: str = "", windows: str = "") -> str:
    """Return in words which runs a bound of a smooth drive covers, and what it assumes of the drive, if anything."""
    return (
        f"No run over {_mesh(task)}, with one effort in each, {_conditions(task, windows)}{_assuming(assumption)}. "
        f"{FINER_MESH}"
    )


def switched_bound_statement(task: Task, windows: str = "") -> str:
    """Return in words which runs the bound of a drive covers that takes power without effort."""
    return (
        f"No run over {_mesh(task)}, even if it switches freely between driving, coasting and braking within each, "
        f"{_conditions(task, windows)}{_assuming(switched_premise(task))}. {FINER_MESH}"
    )


def windowed_bound_statement(task: Task, windows: str) -> str:
    """Return in words which runs a bound under windows of arrival covers, which a clause names."""
    jumps = task.course.drive.jumps_at_no_effort
    return switched_bound_statement(task, windows) if jumps else bound_statement(task, windows=windows)


def chain_bound_statement(task: Task, switched_j: float) -> str:
    """Return in words which runs a bound by chains covers, and what is proven of those that switch [J]."""
    assumption, condition = _assuming(premise(task.course.data.drive_kind)), switched_premise(task)
    # downwards: rounded up, it would say more than is proven
    switched = math.floor(switched_j / J_PER_KWH / SAID_KWH) * SAID_KWH
    return (
        f"No run over {_mesh(task)}, with one effort in each, {_conditions(task)}{assumption}; of runs that switch "
        "between driving, coasting and braking within a cell, no more is proven than that they need at least "
        f"{switched:.4f} kWh{f', if {condition}' if condition else ''}. {FINER_MESH}"
    )


def _assuming(clause: str) -> str:
    return f"; this assumes that {clause}" if clause else ""


def _mesh(task: Task) -> str:
    # upwards: no cell is longer
    longest = math.ceil(float(task.course.data.cell_length_m.max()) / SAID_M - ROUNDED) * SAID_M
    return f"this mesh of {task.course.cell_count} cells of at most {longest:.6g} m"


def _conditions(task: Task, windows: str = "") -> str:
    slowest = SLOWEST_PROVEN_MS / MS_PER_KMH
    # downwards: a run that arrives later may need less
    time_s = math.floor(task.travel_time_s / SAID_S + ROUNDED) * SAID_S
    return (
        f"that keeps all limits{windows}, arrives within {time_s:.1f} s and never goes slower than "
        f"{slowest:.2f} km/h between its stops uses less energy"
    )
