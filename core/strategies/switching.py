"""Runs of drives that take power without effort: with free switching as a relaxation, without it as a run to drive.

Free switching between coasting and driving within a cell gives the convex hull of the drive's power, and with it a
problem that has a lower bound. Where its optimum drives for a part of the way, as it does instead of holding a speed,
a run to drive must decide: on in some cells, off in the others. Sum-up rounding drives in a cell as soon as half of one
is owed; its runs approach the optimum with free switching as the mesh gets finer. With that decided the problem is
smooth again. How much must be owed is a matter of luck, cell by cell, so that some shares of a cell are tried, and the
best run found is decided again by its own efforts. Where it costs much, driving wherever the optimum drives at all is
tried as well.

Reference: Sager, Bock, Diehl 2012, "The integer approximation error in mixed-integer optimal control", Math. Program.
133, 1-23.
"""

from dataclasses import dataclass, replace

import numpy as np

from railjoule.core.arrays import BoolArray, FloatArray
from railjoule.core.bounds import minimise_decided
from railjoule.core.dynamic_programming.search import search
from railjoule.core.interior_point.duty import COASTED, DRIVEN, NEXT_TO_NOTHING, coasting_exactly, duty
from railjoule.core.interior_point.solver import CONVERGED, LARGEST_VIOLATION, Optimum
from railjoule.core.motion import running_time
from railjoule.core.physics.account import run_energy
from railjoule.core.physics.cell import mean_speed
from railjoule.core.physics.reference import reference_energy
from railjoule.core.task import Task

# A half keeps closest to the relaxed optimum on the whole. Where it rounds a short stretch to nothing or to all,
# another threshold may do better, which only trying tells; each costs a solution
OWED, OWED_AGAIN = (0.5, 0.25, 0.75, 0.4, 0.6), (0.5, 0.25, 0.75)
"""Shares of a cell that are tried as what must be owed before it is driven, first and for decisions made again."""
# Free switching is a lower bound, so that no decision can save more than what a run lies above it
GOOD_ENOUGH, WORTH_MORE = 1e-4, 1e-3
"""A run this close to free switching, relatively, is good enough; one this far above is worth yet another decision."""
# Each mending drives more cells; where three do not suffice, the decision leaves no run worth having
MOST_MENDED = 3
# How often the best run's own efforts are taken as the next decision, if they still better it
MOST_REPEATED = 3
# the rounding of a sum of some hundred times, as in `PhasePlanner`
TIME_ROUNDING = 1e-9
# What a checker calls kept. Coasting exactly changes where brakes begin, in short cells before a stop by more than that
RATE_ROUNDING = 1e-6


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
    driven_share : array of shape (n,)
        Share of each cell on which the drive would be on at its cheapest effort or above, or none where nothing is
        known of that.
    """

    speed2: FloatArray
    energy_j: float
    price_of_time_w: float
    iterations: int
    driven_share: FloatArray | None = None


def unswitched(task: Task, optimum: Optimum) -> Unswitched:
    """Return the best run found without switching within a cell: a local optimum.

    Parameters
    ----------
    task : Task
        What is to be run.
    optimum : Optimum
        Its optimum with free switching.

    Raises
    ------
    SolverError
        If Bellman's recursion, the last resort, finds no run either.
    """
    search = _Search(task, optimum)
    share, _ = duty(task.course.data, optimum)
    search.add(optimum, share <= COASTED)
    search.decide_by(share, OWED)
    for _ in range(MOST_REPEATED):
        best = search.best
        if best.driven_share is not None:
            search.decide_by(best.driven_share, OWED_AGAIN)
        if search.best is best:
            break
    # the safest decision: it leaves the solver every cell that the relaxed optimum drives in
    if search.excess > WORTH_MORE:
        search.decide(share > COASTED)
    if search.best.energy_j == np.inf:
        search.runs.append(_by_recursion(task))
    return replace(search.best, iterations=sum(run.iterations for run in search.runs))


class _Search:
    """Runs found so far, and the decisions where to drive that have been tried."""

    def __init__(self, task: Task, relaxed: Optimum) -> None:
        self.task, self.relaxed = task, relaxed
        self.runs: list[Unswitched] = []
        # arrays of bool as bytes, which can be hashed
        self.tried: set[bytes] = set()

    @property
    def best(self) -> Unswitched:
        return min(self.runs, key=lambda run: run.energy_j)

    @property
    def excess(self) -> float:
        """How far the best run lies above the optimum with free switching, relatively."""
        least = self.relaxed.energy_j
        reference = reference_energy(self.task.course.data, least, self.task.running_time_s)
        return float((self.best.energy_j - least) / reference)

    @property
    def is_good_enough(self) -> bool:
        """Whether the best run is good enough; what has not converged is no measure of that."""
        return self.relaxed.status == CONVERGED and self.excess <= GOOD_ENOUGH

    def decide_by(self, driven_share: FloatArray, owed: tuple[float, ...]) -> None:
        """Try the decisions that shares of driving lead to, until a run is good enough."""
        for least in owed:
            if self.is_good_enough:
                return
            self.decide(summed_up(driven_share, self.task.course.data.cell_length_m, least))

    def decide(self, on: BoolArray) -> None:
        """Try a decision; cells where no run can do without driving are driven, too."""
        for _ in range(1 + MOST_MENDED):
            if on.tobytes() in self.tried:
                return
            self.tried.add(on.tobytes())
            found = minimise_decided(self.task, on)
            self.add(found, ~on)
            needed = ~on & (found.traction_n > NEXT_TO_NOTHING * self.task.course.data.traction.constant_n)
            if not needed.any():
                return
            # the run drives there even so, as it needs the effort to go on: the decision has to allow it
            on = on | needed

    def add(self, optimum: Optimum, off: BoolArray) -> None:
        """Take up the run of an optimum, coasting exactly where it all but coasts; infinite if none keeps all limits.

        A point that has not converged is a run as well, if it keeps them.
        """
        data = self.task.course.data
        # the exact one first: what a barrier leaves of an effort makes a drive that is on take its power without effort
        points = coasting_exactly(data, optimum, off), optimum.speed2
        speed2 = next((point for point in points if _keeps_limits(self.task, point)), None)
        energy = np.inf if speed2 is None else _energy_j(self.task, speed2)
        best = optimum.speed2 if speed2 is None else speed2
        share, _ = duty(data, optimum)
        self.runs.append(Unswitched(best, energy, optimum.price_of_time_w, optimum.iterations, share))


def summed_up(driven_share: FloatArray, cell_length_m: FloatArray, owed_share: float = 0.5) -> BoolArray:
    """Return which cells to drive in so that the way driven up to each stays within a cell, or half of one; shape (n,).

    Parameters
    ----------
    driven_share : array of shape (n,)
        Share of each cell on which the drive is on.
    cell_length_m : array of shape (n,)
        Lengths of the cells [m].
    owed_share : float
        Which share of a cell must be owed before it is driven: a half keeps closest.
    """
    on: BoolArray = driven_share >= DRIVEN
    # sum-up rounding: what is driven so far follows the integral of the relaxed shares within a cell
    owed = 0.0
    for cell in np.flatnonzero(driven_share > COASTED):
        owed += driven_share[cell] * cell_length_m[cell]
        on[cell] |= bool(owed >= owed_share * cell_length_m[cell])
        owed -= cell_length_m[cell] if on[cell] else 0.0
    return on


def _by_recursion(task: Task) -> Unswitched:
    """Return the run that Bellman's recursion finds, which needs nothing to be smooth."""
    found = search(task.course.data, task.greatest_speed2, task.running_time_s)
    return Unswitched(
        found.speed2, _energy_j(task, found.speed2), found.price_w - task.course.data.auxiliary_power_w, found.sweeps
    )


def _energy_j(task: Task, speed2: FloatArray) -> float:
    """Return the line energy of a run with auxiliaries on its way [J], as the optimum counts it."""
    data = task.course.data
    auxiliaries = data.auxiliary_power_w * running_time(data.cell_length_m, speed2)
    return float(run_energy(data, speed2) + auxiliaries)


def _keeps_limits(task: Task, speed2: FloatArray) -> bool:
    """Return whether a run is in time and asks for no more effort or acceleration than is allowed, but for rounding."""
    data, force = task.course.data, task.course.net_force_n(speed2)
    speed = np.sqrt(speed2)
    v = mean_speed(speed[:-1], speed[1:])
    excess = np.maximum(force - data.traction.effort_n(v), -force - data.braking.effort_n(v) - data.friction_effort_n)
    in_time = running_time(data.cell_length_m, speed2) <= task.running_time_s * (1 + TIME_ROUNDING)
    change = np.diff(speed2) / (2 * data.cell_length_m)
    gentle = change.max() <= data.max_acceleration_ms2 * (1 + RATE_ROUNDING) and (
        change.min() >= -data.max_deceleration_ms2 * (1 + RATE_ROUNDING)
    )
    return bool(in_time and gentle and excess.max() <= LARGEST_VIOLATION * data.traction.constant_n)
