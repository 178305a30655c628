"""Runs of drives that take power without effort: with free switching as a relaxation, without it as a run to drive.

Free switching between coasting and driving within a cell gives the convex hull of the drive's power, and with it a
problem that has a lower bound. Where its optimum drives or brakes for a part of the way, as it does instead of holding
a speed, a run to drive must decide: on in some cells, off in the others. Sum-up rounding turns a cell on as soon as
half of one is owed; its runs approach the optimum with free switching as the mesh gets finer. With that decided the
problem is smooth again. How much must be owed is a matter of luck, cell by cell, so that some shares of a cell are
tried.

Rounding knows neither limits nor time. Where its best run lies clearly above free switching, dynamic programming in
bands of speed around the relaxed optimum finds other decisions: those of the runs that bracket the timetable, and of
their hybrids. The most promising are solved once more, and all runs are judged by the one account. Where that is not
close either, or the relaxed optimum is no measure, the run of Bellman's recursion and its decision are tried, too.

Reference: Sager, Bock, Diehl 2012, "The integer approximation error in mixed-integer optimal control", Math. Program.
133, 1-23.
"""

from dataclasses import dataclass, replace

import numpy as np

from railjoule.core.arrays import BoolArray, FloatArray
from railjoule.core.bounds import minimise_decided
from railjoule.core.bounds.minimum import SPARED_SHARE
from railjoule.core.dynamic_programming.around import runs_around
from railjoule.core.dynamic_programming.search import Found, search
from railjoule.core.errors import SolverError
from railjoule.core.interior_point.duty import (
    COASTED,
    DRIVEN,
    Duty,
    coasting_exactly,
    duty,
    forbidden_energy_j,
    mended_modes,
    modes_of,
    modes_of_run,
)
from railjoule.core.interior_point.solver import CONVERGED, Optimum
from railjoule.core.motion import running_time
from railjoule.core.physics.account import run_energy
from railjoule.core.physics.reference import reference_energy
from railjoule.core.strategies.plain_line import broken_accelerations, broken_efforts
from railjoule.core.task import Task

# A half keeps closest to the relaxed optimum on the whole. Where it rounds a short stretch to nothing or to all,
# another threshold may do better, which only trying tells; each costs a solution
OWED = (0.5, 0.25, 0.75)
"""Shares of a cell that are tried as what must be owed before it is driven or braked."""
# Free switching is a lower bound, so that no decision can save more than what a run lies above it
GOOD_ENOUGH = 1e-4
"""A run this close to free switching, relatively, is good enough."""
# What a run lies above free switching before a band of speeds is searched, which takes as long as five solutions. Of
# 240 ordinary scenarios 41 lie between good enough and this, and Bellman's recursion is better by a ten-thousandth in
# none of them. It was in 3 where 5e-4 ended the search of bands
FAR = 3e-4
# The same before Bellman's recursion, which takes as long as all of that. With 5e-4 it alone was better by a
# ten-thousandth in 1 of the 240, with this in none
FAR_FOR_RECURSION = 4e-4
FORBIDDEN_SHARE = 1e-4
"""What a decided optimum may spend on forbidden efforts, of the energy: more than a barrier leaves of none."""
# The relaxed optimum lies within the first band on the whole, where it does not drive by turns with its best run; the
# second mends what the coarse grid of the first misses. 41 speeds, and 25 within 0.03, are no better and take longer
BANDS = ((0.15, 25), (0.06, 33))
"""Half widths of the bands of speed that are searched, over the top speed, and their numbers of speeds."""
# What the others promise more is seldom gained by solving their decisions
MOST_PROMISING = 2
"""How many of the runs that a band holds are solved as decisions."""
# Each mending allows more cells; where three do not suffice, the decision leaves no run worth having
MOST_MENDED = 3
# An early arrival counts as a fault where it costs a hundred-thousandth of the energy
SPARED_COST = 3e-6
"""What the time that a decision's optimum leaves may cost, by the price of time, as a share of the energy."""
# the rounding of a sum of some hundred times, as in `PhasePlanner`
TIME_ROUNDING = 1e-9


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
        What is to be run.
    optimum : Optimum
        Its optimum with free switching.

    Raises
    ------
    SolverError
        If Bellman's recursion, the last resort, finds no run either.
    """
    search = _Search(task, optimum)
    search.add(optimum)
    search.decide_by(duty(task.course.data, optimum), OWED)
    if search.is_measure and not search.is_within(FAR):
        search.decide_around(optimum.speed2, optimum.price_of_time_w + task.course.data.auxiliary_power_w)
    if not search.is_within(FAR_FOR_RECURSION):
        found = search.decide_by_recursion()
        # what has not converged, or to a local optimum, may lie anywhere
        if found is not None and not search.is_measure:
            search.decide_around(found.speed2, found.price_w)
    return replace(search.best, iterations=search.iterations)


class _Search:
    """Runs found so far, and the decisions what the drive does that have been tried."""

    def __init__(self, task: Task, relaxed: Optimum) -> None:
        self.task, self.relaxed = task, relaxed
        self.runs: list[Unswitched] = []
        self.iterations = 0
        # arrays of numbers as bytes, which can be hashed
        self.tried: set[bytes] = set()

    @property
    def best(self) -> Unswitched:
        return min(self.runs, key=lambda run: run.energy_j)

    @property
    def reference_j(self) -> float:
        """What energies are compared with [J]."""
        return float(reference_energy(self.task.course.data, self.relaxed.energy_j, self.task.running_time_s))

    @property
    def spared_time_share(self) -> float:
        """Which share of the time a decision's optimum may leave to what coasting exactly adds."""
        # close to the shortest time a second may cost more than all the rest of the run
        waited_j = max(self.relaxed.price_of_time_w, 0.0) * self.task.running_time_s
        return min(SPARED_SHARE, SPARED_COST * self.reference_j / waited_j) if waited_j > 0 else SPARED_SHARE

    def is_within(self, share: float) -> bool:
        """Whether the best run lies no more than this share of the energy above free switching."""
        return self.is_measure and self.best.energy_j - self.relaxed.energy_j <= share * self.reference_j

    @property
    def is_measure(self) -> bool:
        """Whether the relaxed optimum tells how good a run is: it has converged, and no run lies below it."""
        # where losses fall with speed the hull is not convex in both, and what has converged may be a local optimum
        below = self.relaxed.energy_j - self.best.energy_j
        return self.relaxed.status == CONVERGED and below <= GOOD_ENOUGH * self.reference_j

    def decide_by(self, duty: Duty, owed: tuple[float, ...]) -> None:
        """Try the decisions that shares of cells lead to, until a run is good enough."""
        length = self.task.course.data.cell_length_m
        for least in owed:
            if self.is_within(GOOD_ENOUGH):
                return
            self.decide(modes_of(summed_up(duty.driving, length, least), summed_up(duty.braking, length, least)))

    def decide_around(self, centre_speed2: FloatArray, price_w: float) -> None:
        """Try the decisions of the runs that dynamic programming finds around a run [m2/s2], then around the best.

        Its price of a second counts the auxiliaries [J/s].
        """
        data = self.task.course.data
        # its runs meet the time but for rounding, to either side
        given = data, self.task.greatest_speed2, self.task.running_time_s * (1 - TIME_ROUNDING)
        top = float(np.sqrt(self.task.greatest_speed2.max()))
        for width, points in BANDS:
            try:
                found = runs_around(*given, centre_speed2, price_w, width * top, points)
            except SolverError:
                # a band without a run leaves what was found before
                return
            self.iterations += found.sweeps
            self.take(found.meeting, found.price_w - data.auxiliary_power_w)
            for run in found.others[:MOST_PROMISING]:
                self.decide(modes_of_run(data, run))
            if self.is_within(FAR) or self.best.energy_j == np.inf:
                return
            centre_speed2, price_w = self.best.speed2, found.price_w

    def decide_by_recursion(self) -> Found | None:
        """Try the run that Bellman's recursion finds, which needs nothing to be smooth, and its decision."""
        data = self.task.course.data
        try:
            found = search(data, self.task.greatest_speed2, self.task.running_time_s * (1 - TIME_ROUNDING))
        except SolverError:
            if self.best.energy_j == np.inf:
                raise
            return None
        self.iterations += found.sweeps
        # not judged again: it keeps the limits as the recursion does, and may be all that there is
        price = max(found.price_w - data.auxiliary_power_w, 0.0)
        self.runs.append(Unswitched(found.speed2, _energy_j(self.task, found.speed2), price, 0))
        self.decide(modes_of_run(data, found.speed2))
        return found

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
        self.take(exactly if _keeps_limits(self.task, exactly) else optimum.speed2, optimum.price_of_time_w)

    def take(self, speed2: FloatArray, price_of_time_w: float) -> None:
        """Take up a run [m2/s2]; its energy is infinite if it does not keep all limits."""
        energy = _energy_j(self.task, speed2) if _keeps_limits(self.task, speed2) else np.inf
        self.runs.append(Unswitched(speed2, energy, max(price_of_time_w, 0.0), 0))


def summed_up(share: FloatArray, cell_length_m: FloatArray, owed_share: float = 0.5) -> BoolArray:
    """Return in which cells to be on so that the length up to each stays within a cell, or half of one; shape (n,).

    Parameters
    ----------
    share : array of shape (n,)
        Share of each cell on which the drive is on.
    cell_length_m : array of shape (n,)
        Lengths of the cells [m].
    owed_share : float
        Which share of a cell must be owed before it is on: a half keeps closest.
    """
    on: BoolArray = share >= DRIVEN
    # sum-up rounding: what it is on for so far follows the integral of the relaxed shares within a cell
    owed = 0.0
    for cell in np.flatnonzero(share > COASTED):
        owed += share[cell] * cell_length_m[cell]
        on[cell] |= bool(owed >= owed_share * cell_length_m[cell])
        owed -= cell_length_m[cell] if on[cell] else 0.0
    return on


def _energy_j(task: Task, speed2: FloatArray) -> float:
    """Return the line energy of a run with auxiliaries on its way [J], as the optimum counts it."""
    data = task.course.data
    auxiliaries = data.auxiliary_power_w * running_time(data.cell_length_m, speed2)
    return float(run_energy(data, speed2) + auxiliaries)


def _keeps_limits(task: Task, speed2: FloatArray) -> bool:
    """Return whether a run is in time and keeps the limits of effort, acceleration and speed, but for rounding."""
    data = task.course.data
    return bool(
        running_time(data.cell_length_m, speed2) <= task.running_time_s * (1 + TIME_ROUNDING)
        and np.all(speed2 <= data.largest_speed2 * (1 + TIME_ROUNDING))
        # Coasting exactly changes where brakes begin, in short cells before a stop by more than a ten-millionth
        and not broken_efforts(task.course, speed2)
        and not broken_accelerations(task.course, speed2)
    )
