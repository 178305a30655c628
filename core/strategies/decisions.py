"""Runs of decisions what a drive does in each cell: solved, judged by the one account, the best of them kept.

With that decided a problem that jumps is smooth. Where the solution of a decision cannot do without an effort that it
leaves out, that is allowed, too; where it all but coasts, the run coasts exactly.
"""

from dataclasses import dataclass, replace

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.bounds import minimise_decided
from railjoule.core.bounds.minimum import SPARED_SHARE
from railjoule.core.dynamic_programming.search import Found, search
from railjoule.core.interior_point.duty import coasting_exactly, forbidden_energy_j, mended_modes
from railjoule.core.interior_point.solver import CONVERGED, Optimum
from railjoule.core.motion import running_time
from railjoule.core.physics.account import run_energy
from railjoule.core.physics.reference import reference_energy
from railjoule.core.physics.stretches import shortest_stretch_s
from railjoule.core.strategies.plain_line import broken_accelerations, broken_efforts
from railjoule.core.task import Task

GOOD_ENOUGH = 1e-4
"""A relaxed optimum this far above a run, relatively, is not the best one of its problem."""
# Free switching is a lower bound, so that no decision can save more than what a run lies above it. A band of speeds
# takes as long as five solutions
FAR = 3e-4
"""What a run lies above free switching, relatively, before a band of speeds is searched."""
FORBIDDEN_SHARE = 1e-4
"""What a decided optimum may spend on forbidden efforts, of the energy: more than a barrier leaves of none."""
# Each mending allows more cells; where three do not suffice, the decision leaves no run worth having
MOST_MENDED = 3
# An early arrival counts as a fault where it costs a hundred-thousandth of the energy
SPARED_COST = 3e-6
"""What the time that a decision's optimum leaves may cost, by the price of time, as a share of the energy."""
# the rounding of a sum of some hundred times, as in `PhasePlanner`
TIME_ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class DecidedRun:
    """A run that switches nothing within a cell.

    Parameters
    ----------
    speed2 : array of shape (n + 1,)
        Squares of speed at the nodes [m2/s2].
    energy_j : float
        Line energy with auxiliaries, infinite if it keeps not all limits [J].
    price_of_time_w : float
        Price of a second [J/s].
    iterations : int
        Of all solutions that led to it.
    """

    speed2: FloatArray
    energy_j: float
    price_of_time_w: float
    iterations: int


class Decisions:
    """Runs found so far, and the decisions what the drive does that have been tried.

    Parameters
    ----------
    task : Task
        What is to be run.
    energy_j, price_of_time_w : float
        About what the best run takes [J] and what a second costs [J/s].
    least_switching_s : float
        Runs whose drive stays as it is for less than this, to the nearest cell, do not count [s].
    """

    def __init__(self, task: Task, energy_j: float, price_of_time_w: float, least_switching_s: float = 0.0) -> None:
        self.task, self.price_of_time_w, self.least_switching_s = task, price_of_time_w, least_switching_s
        self.reference_j = float(reference_energy(task.course.data, energy_j, task.running_time_s))
        self.runs: list[DecidedRun] = []
        self.iterations = 0
        # arrays of numbers as bytes, which can be hashed
        self.tried: set[bytes] = set()

    @property
    def best(self) -> DecidedRun | None:
        """The run of the least energy, with the iterations of all; None as long as none counts."""
        run = min(self.runs, key=lambda run: run.energy_j, default=None)
        return replace(run, iterations=self.iterations) if run is not None and run.energy_j < np.inf else None

    def is_within(self, share: float, energy_j: float) -> bool:
        """Return whether the best run needs no more than an energy [J] and a share of it."""
        return self.best is not None and self.best.energy_j - energy_j <= share * self.reference_j

    @property
    def spared_time_share(self) -> float:
        """Which share of the time a decision's optimum may leave to what coasting exactly adds."""
        # close to the shortest time a second may cost more than all the rest of the run
        waited_j = max(self.price_of_time_w, 0.0) * self.task.running_time_s
        return min(SPARED_SHARE, SPARED_COST * self.reference_j / waited_j) if waited_j > 0 else SPARED_SHARE

    def decide(self, modes: FloatArray) -> None:
        """Try a decision; where no run can do without an effort that it leaves out, that is allowed, too."""
        data = self.task.course.data
        for _ in range(1 + MOST_MENDED):
            if modes.tobytes() in self.tried:
                return
            self.tried.add(modes.tobytes())
            found = minimise_decided(self.task, modes, self.spared_time_share)
            # an optimum that buys what is forbidden is no run of its decision, nor the best one of any other
            if forbidden_energy_j(data, modes, found) <= FORBIDDEN_SHARE * self.reference_j:
                self.add(found)
                return
            self.iterations += found.iterations
            modes = mended_modes(data, modes, found)

    def add(self, optimum: Optimum) -> None:
        """Take up the run of an optimum, coasting exactly where it all but coasts.

        A point that has not converged is a run as well, if it keeps all limits.
        """
        self.iterations += optimum.iterations
        # the exact one first: what a barrier leaves of an effort makes a drive that is on take its power without effort
        exactly = coasting_exactly(self.task.course.data, optimum)
        speed2 = exactly if keeps_limits(self.task, exactly) else optimum.speed2
        self.take(speed2, optimum.price_of_time_w)

    def counts(self, speed2: FloatArray) -> bool:
        """Whether a run [m2/s2] keeps all limits and switches seldom enough."""
        least = self.least_switching_s
        return keeps_limits(self.task, speed2) and (
            least == 0.0 or shortest_stretch_s(self.task.course.data, speed2) >= least
        )

    def take(self, speed2: FloatArray, price_of_time_w: float) -> None:
        """Take up a run [m2/s2]; its energy is infinite if it does not keep all limits, or switches too often."""
        energy = line_energy_j(self.task, speed2) if self.counts(speed2) else np.inf
        self.runs.append(DecidedRun(speed2, energy, max(price_of_time_w, 0.0), 0))


def is_measured(task: Task, relaxed: Optimum, energy_j: float) -> bool:
    """Return whether an optimum with free switching tells how good a run of an energy [J] is.

    It does where it has converged and the run does not lie below it.
    """
    # where losses fall with speed the hull is not convex in both, and what has converged may be a local optimum
    reference = reference_energy(task.course.data, relaxed.energy_j, task.running_time_s)
    return bool(relaxed.status == CONVERGED and relaxed.energy_j - energy_j <= GOOD_ENOUGH * reference)


def line_energy_j(task: Task, speed2: FloatArray) -> float:
    """Return the line energy of a run with auxiliaries on its way [J], as the optimum counts it."""
    data = task.course.data
    auxiliaries = data.auxiliary_power_w * running_time(data.cell_length_m, speed2)
    return float(run_energy(data, speed2) + auxiliaries)


def keeps_limits(task: Task, speed2: FloatArray) -> bool:
    """Return whether a run is in time and keeps the limits of effort, acceleration and speed, but for rounding."""
    data = task.course.data
    return bool(
        running_time(data.cell_length_m, speed2) <= task.running_time_s * (1 + TIME_ROUNDING)
        and np.all(speed2 <= data.largest_speed2 * (1 + TIME_ROUNDING))
        # Coasting exactly changes where brakes begin, in short cells before a stop by more than a ten-millionth
        and not broken_efforts(task.course, speed2)
        and not broken_accelerations(task.course, speed2)
    )


def recursion(task: Task) -> tuple[Found, DecidedRun]:
    """Return what backward induction finds and its run, which may switch in any cell and is not judged again.

    Raises
    ------
    SolverError
        If the grid holds no run.
    """
    data = task.course.data
    found = search(data, task.greatest_speed2, task.running_time_s * (1 - TIME_ROUNDING))
    # the search prices a second with the auxiliaries that run in it; what is shown is what driving alone saves
    price = max(found.price_w - data.auxiliary_power_w, 0.0)
    return found, DecidedRun(found.speed2, line_energy_j(task, found.speed2), price, found.sweeps)
