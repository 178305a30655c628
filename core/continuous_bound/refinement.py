"""The optimum of a task over a mesh that is refined until its run is close to what no driving undercuts.

Solve, bound, compare the cost of the run with the share of the bound cell by cell, cut the cells in which they differ,
and repeat. That cost is the energy of the run between the nodes, or that of its account, which takes the mean speed of
each cell: what differs more from the bound. The gap of a cell of the length h falls with h^2 or faster, so that a cell
whose gap is k^2 times its share of the tolerance is cut into k. Three faults of a mesh are cured, each by itself: a gap
above the tolerance, limits that the run exceeds between the nodes, and an account below the bound. That account is too
low where the power has a kink between the speeds of a cell, as next to a stop where the electric brake begins to draw.
No cell stays more than four times as long as its neighbour.
"""

from dataclasses import dataclass, replace

import numpy as np

from railjoule.core.arrays import BoolArray, FloatArray, IntArray
from railjoule.core.bounds.minimum import Solution, minimise
from railjoule.core.budget import current_budget
from railjoule.core.continuous_bound.bound import ContinuousBound, continuous_bound
from railjoule.core.energy import net_energy
from railjoule.core.errors import RailjouleError, SolverError
from railjoule.core.lower_bound import BELOW_SHARE, LATE_SHARE
from railjoule.core.motion import running_time
from railjoule.core.physics.between_nodes import RunBetweenNodes, follow_between_nodes, slow_to_possible
from railjoule.core.physics.energy_balance import reference_energy, run_balance
from railjoule.core.physics.mesh_data import MeshData
from railjoule.core.task import Task, task_over_nodes
from railjoule.core.trajectory import Trajectory, supply_energies_j

MAX_ROUNDS = 6
"""Solutions at most; nearly all scenarios need one to three."""
MAX_PARTS, SHORTEST_M = 4, 0.02
"""Into how many parts a cell is cut in one round, and the length below which it is not [m]."""
ALLOTTED = (0.4, 1.6, 6.4, 25.6)
"""Which multiple of the tolerance the cells together may keep; the first that makes no more cells than allowed."""
STEEPEST, ROUNDING = 4.0, 1e-6
"""How many times as long as its neighbour a cell may be."""
MAX_EXCESS = 5e-4
"""Cells in which a run exceeds a limit by more than this share are cut."""
MAX_SHORTENED, IN_TIME = 3, 1e-9
"""How often the time of a run that is slowed down is shortened, until it is later by less than this share."""
MAX_GROWTH, FEWEST_CELLS = 4, 2000
"""A mesh grows at most to so many times its cells, or to so many."""


@dataclass(frozen=True, eq=False)
class RefinedOptimum:
    """An optimum and what is proven of it.

    Parameters
    ----------
    task : Task
        The task over the refined mesh.
    solution : Solution
        The optimum over that mesh.
    followed : RunBetweenNodes
        Its run between the nodes.
    bound : ContinuousBound
        The greatest bound found.
    rounds : int
        How many solutions that took.
    """

    task: Task
    solution: Solution
    followed: RunBetweenNodes
    bound: ContinuousBound
    rounds: int

    @property
    def scale_j(self) -> float:
        """Reference energy of the run, over which gaps are taken [J]."""
        return reference_energy(self.task.mesh.data, self.energy_j, self.task.running_time_s)

    @property
    def gap(self) -> float:
        """Energy of the run less the bound, over the reference energy: followed between the nodes or as its account."""
        followed_j = self.followed.total_j + self.task.mesh.data.auxiliary_power_w * self.followed.total_s
        gaps = [(energy_j - self.bound.energy_j) / self.scale_j for energy_j in (followed_j, self.energy_j)]
        return max(gaps, key=abs)

    @property
    def is_below_bound(self) -> bool:
        """Whether the account of the cells puts the run below the bound."""
        return self.energy_j - self.bound.energy_j < -BELOW_SHARE * self.scale_j

    @property
    def is_true(self) -> bool:
        """Whether the train can drive the run between the nodes, with the energy that its account has."""
        return self.followed.is_possible and not self.is_below_bound

    @property
    def energy_j(self) -> float:
        """Energy of the run by the account of its cells, without dwells [J]."""
        return self.solution.energy_j - self.task.dwell_energy_j


def refined_optimum(task: Task) -> RefinedOptimum:
    """Return the optimum of a smooth drive over a mesh as fine as `solver.tolerance` asks for.

    Parameters
    ----------
    task : Task
        Must have slack in its timetable; its cells are the longest.

    Raises
    ------
    SolverError
        If no optimum is found over the first mesh. If a finer one has none, that before it stands.
    """
    tolerance = task.scenario.solver.tolerance
    max_cells = min(max(MAX_GROWTH * task.mesh.cell_count, FEWEST_CELLS), current_budget().cell_count)
    found = _bounded_optimum(task, 1)
    best = found
    while best.rounds < MAX_ROUNDS:
        cuts = _cuts(found, tolerance, max_cells)
        if cuts.max() == 1:
            break
        try:
            found = _bounded_optimum(_finer_task(found.task, cuts), found.rounds + 1)
        except RailjouleError:
            break
        best = _better(best, found, tolerance)
    return possible_optimum(best)


def _bounded_optimum(task: Task, rounds: int) -> RefinedOptimum:
    task.require_timetable()
    solution = minimise(task)
    followed = follow_between_nodes(task.mesh.data, solution.optimum.speed2)
    bound = continuous_bound(task.mesh, solution.optimum, task.running_time_s)
    return RefinedOptimum(task, solution, followed, bound, rounds)


def _better(before: RefinedOptimum, found: RefinedOptimum, tolerance: float) -> RefinedOptimum:
    """Return the later of two optima with the greater of both bounds, unless its gap is larger and not tolerated.

    A run that lies below the bound, or exceeds its limits between the nodes, is one of too coarse a mesh, whatever the
    gap of the finer one.
    """
    bound = max(before.bound, found.bound, key=lambda bound: bound.energy_j)
    before, found = (replace(one, bound=bound, rounds=found.rounds) for one in (before, found))
    if not before.is_true or abs(found.gap) <= max(abs(before.gap), tolerance):
        return found
    return before


def cell_gaps_j(found: RefinedOptimum) -> tuple[FloatArray, FloatArray]:
    """Return the cost of each cell less the share of the bound [J]: by the account, and between nodes; shape (n,)."""
    data, optimum, pieces = found.task.mesh.data, found.solution.optimum, found.bound.pieces
    count = len(data.cell_length_m)
    numbers = np.arange(count)
    first = np.searchsorted(pieces.cell, numbers)
    last = np.searchsorted(pieces.cell, numbers, side="right") - 1
    start, end = pieces.motion[0, first] * optimum.speed2[:-1], pieces.motion[1, last] * optimum.speed2[1:]
    shares_j = np.bincount(pieces.cell, found.bound.shares_j, count) + data.half_inertia_kg * (end - start)
    by_account, followed = _priced_costs_j(data, optimum.speed2, found.followed, optimum.price_of_time_w)
    return by_account - shares_j, followed - shares_j


def possible_optimum(found: RefinedOptimum) -> RefinedOptimum:
    """Return an optimum whose run keeps its limits between the nodes, too.

    A run that exceeds them by more than a thousandth is slowed down. If it is then late, the optimum of a time that is
    shorter by as much takes its place. If the train cannot be faster, the run stays as it is.
    """
    task, optimum = found.task, found.solution.optimum
    if found.followed.is_possible:
        return found
    data, shorter = task.mesh.data, task
    speed2 = slow_to_possible(data, optimum.speed2)
    for _ in range(MAX_SHORTENED):
        late_s = running_time(data.cell_length_m, speed2) - task.running_time_s
        if late_s <= IN_TIME * task.running_time_s:
            break
        shorter = replace(shorter, running_time_s=shorter.running_time_s - late_s)
        if not shorter.has_slack:
            return found
        try:
            optimum = minimise(shorter).optimum
        except SolverError:
            return found
        speed2 = slow_to_possible(data, optimum.speed2)
    if running_time(data.cell_length_m, speed2) > task.running_time_s * (1 + LATE_SHARE):
        return found
    net_j = net_energy(*supply_energies_j(task.mesh, run_balance(data, speed2)))
    moved = optimum._replace(speed2=speed2, energy_j=net_j - task.dwell_energy_j)
    solution = Solution(moved, found.solution.iterations + optimum.iterations, net_j)
    return replace(found, solution=solution, followed=follow_between_nodes(data, speed2))


def _cuts(found: RefinedOptimum, tolerance: float, max_cells: int) -> IntArray:
    """Return into how many parts each cell is cut, 1 in all where no more cells would help; shape (n,)."""
    length_m = found.task.mesh.data.cell_length_m
    whole = np.ones(len(length_m), dtype=int)
    is_close = abs(found.gap) <= tolerance
    if is_close and found.is_true:
        return whole
    by_account, followed = cell_gaps_j(found)
    faulty = found.followed.excess_share > MAX_EXCESS
    if found.is_below_bound:
        faulty |= _is_low(followed - by_account)
    open_share = np.maximum(np.abs(by_account), np.abs(followed)) * len(whole) / (tolerance * found.scale_j)
    # with too many cells those that matter most are cut first
    for allotted in ALLOTTED:
        parts = np.zeros(len(whole)) if is_close else np.ceil(np.sqrt(open_share / allotted))
        cuts = np.clip(parts, 1, MAX_PARTS).astype(int)
        cuts[faulty] = MAX_PARTS
        cuts[length_m < SHORTEST_M] = 1
        cuts = _graded(length_m, cuts)
        if cuts.sum() <= max_cells:
            return cuts
    return whole


def _graded(length_m: FloatArray, cuts: IntArray) -> IntArray:
    """Return cuts that leave no cell more than `STEEPEST` times as long as its neighbour."""
    if cuts.max() == 1:
        return cuts
    while True:
        part = length_m / cuts
        steep = np.zeros(len(length_m), dtype=bool)
        steep[1:] |= part[1:] > STEEPEST * (1.0 + ROUNDING) * part[:-1]
        steep[:-1] |= part[:-1] > STEEPEST * (1.0 + ROUNDING) * part[1:]
        if not steep.any():
            return cuts
        cuts = np.where(steep, 2 * cuts, cuts)


def cut_low_accounts(task: Task, run: Trajectory) -> Task:
    """Return a task over a mesh that is finer where the account of its run is too low.

    All other cells are halved if the run is below its bound by more than the tolerance.
    """
    data, speed2 = task.mesh.data, run.node_speed_ms**2
    by_account, followed = _priced_costs_j(data, speed2, follow_between_nodes(data, speed2), run.price_of_time_w or 0.0)
    others = 1 if run.gap is None or run.gap >= -task.scenario.solver.tolerance else 2
    return _finer_task(task, _graded(data.cell_length_m, np.where(_is_low(followed - by_account), MAX_PARTS, others)))


def _priced_costs_j(
    data: MeshData, speed2: FloatArray, followed: RunBetweenNodes, price_of_time_w: float
) -> tuple[FloatArray, FloatArray]:
    """Return energy and priced time of each cell of a run [J]: by its account, and between the nodes; shape (n,)."""
    account, price_w = run_balance(data, speed2), data.auxiliary_power_w + max(price_of_time_w, 0.0)
    return (
        (account.supply_power_w + price_w) * account.duration_s,
        followed.supply_energy_j + price_w * followed.duration_s,
    )


def _is_low(missing_j: FloatArray) -> BoolArray:
    """Return the cells whose account misses more energy than that of a mean cell."""
    is_low: BoolArray = missing_j > np.maximum(missing_j, 0.0).mean()
    return is_low


def _finer_task(task: Task, cuts: IntArray) -> Task:
    """Return a task over a mesh whose cells are cut into parts."""
    node = task.mesh.position_m
    number = np.repeat(np.arange(len(cuts)), cuts)
    part = np.arange(len(number)) - np.repeat(np.cumsum(cuts) - cuts, cuts)
    position = np.append(node[number] + (node[number + 1] - node[number]) * part / cuts[number], node[-1])
    return task_over_nodes(task, position)
