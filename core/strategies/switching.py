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

from dataclasses import replace

import numpy as np

from railjoule.core.arrays import BoolArray, FloatArray
from railjoule.core.dynamic_programming.around import runs_around
from railjoule.core.dynamic_programming.search import Found
from railjoule.core.errors import SolverError
from railjoule.core.interior_point.duty import COASTED, DRIVEN, Duty, duty, modes_of
from railjoule.core.interior_point.solver import Optimum
from railjoule.core.physics.stretches import actions_of_run
from railjoule.core.strategies.decisions import (
    FAR,
    GOOD_ENOUGH,
    TIME_ROUNDING,
    DecidedRun,
    Decisions,
    is_measured,
    recursion,
)
from railjoule.core.task import Task

# A half keeps closest to the relaxed optimum on the whole. Where it rounds a short stretch to nothing or to all,
# another threshold may do better, which only trying tells; each costs a solution
OWED = (0.5, 0.25, 0.75)
"""Shares of a cell that are tried as what must be owed before it is driven or braked."""
# The relaxed optimum lies within the first band on the whole, where it does not drive by turns with its best run; the
# second mends what the coarse grid of the first misses. 41 speeds, and 25 within 0.03, are no better and take longer
BANDS = ((0.15, 25), (0.06, 33))
"""Half widths of the bands of speed that are searched, over the top speed, and their numbers of speeds."""
# What the others promise more is seldom gained by solving their decisions
MOST_PROMISING = 2
"""How many of the runs that a band holds are solved as decisions."""


def unswitched(task: Task, optimum: Optimum) -> DecidedRun:
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
    if not search.is_within(GOOD_ENOUGH):
        found = search.decide_by_recursion()
        # what has not converged, or to a local optimum, may lie anywhere
        if found is not None and not search.is_measure:
            search.decide_around(found.speed2, found.price_w)
        # where a second costs more than all it saves, nothing beats full speed
        search.take(task.greatest_speed2, 0.0)
    return replace(search.best, iterations=search.iterations)


class _Search(Decisions):
    """A search that knows what free switching needs."""

    def __init__(self, task: Task, relaxed: Optimum) -> None:
        super().__init__(task, relaxed.energy_j, relaxed.price_of_time_w)
        self.relaxed = relaxed

    def is_within(self, share: float) -> bool:
        """Whether the best run lies no more than this share of the energy above free switching."""
        return self.is_measure and self.best.energy_j - self.relaxed.energy_j <= share * self.reference_j

    @property
    def is_measure(self) -> bool:
        """Whether the relaxed optimum tells how good a run is: it has converged, and no run lies below it."""
        return is_measured(self.task, self.relaxed, self.best.energy_j)

    def decide_by(self, duty: Duty, owed: tuple[float, ...]) -> None:
        """Try the decisions that shares of cells lead to, until a run is good enough."""
        length = self.task.course.data.cell_length_m
        for least in owed:
            if self.is_within(GOOD_ENOUGH):
                return
            self.decide(summed_up_modes(duty, length, least))

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
                self.decide(actions_of_run(data, run).machines)
            if self.is_within(FAR) or self.best.energy_j == np.inf:
                return
            centre_speed2, price_w = self.best.speed2, found.price_w

    def decide_by_recursion(self) -> Found | None:
        """Try the run that Bellman's recursion finds, which needs nothing to be smooth, and its decision."""
        try:
            found, run = recursion(self.task)
        except SolverError:
            if self.best.energy_j == np.inf:
                raise
            return None
        self.iterations += found.sweeps
        # not judged again: it keeps the limits as the recursion does, and may be all that there is
        self.runs.append(run)
        self.decide(actions_of_run(self.task.course.data, found.speed2).machines)
        return found


def summed_up_modes(duty: Duty, cell_length_m: FloatArray, owed_share: float = 0.5) -> FloatArray:
    """Return the decision that shares of driving and braking lead to, an array of shape (n,); as `summed_up`."""
    return modes_of(*(summed_up(share, cell_length_m, owed_share) for share in duty))


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
