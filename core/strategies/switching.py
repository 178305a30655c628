"""Runs of drives with idle losses: free switching as a relaxation, and a decision for each cell as a run to drive.

Free switching between coasting and driving within a cell gives the convex hull of the drive's power, and with it a
problem that has a lower bound. If its optimum drives or brakes for a part of the way, as it does instead of holding
a speed, a run to drive must decide: on in some cells, off in the others. With that decided the problem is smooth again.

Two ways lead to decisions that keep `drive.least_switching_s`. Rounding keeps the time that the drive is on close to
its share, and ignores limits and the timetable. If its run lies clearly above free switching, dynamic programming in
a band of speeds around the relaxed optimum, then around the best run, finds the decisions of the two runs that bracket
the timetable. Each decision is solved exactly; the best one is a local optimum. If the relaxed optimum is no measure
of a run, or none lies near it, Bellman's recursion over all speeds and the runs near its own are tried, too.

Read `best_switched` first, then `Decisions.decide`.
"""

from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from railjoule.core.arrays import FloatArray, IntArray
from railjoule.core.bounds import minimise_decided
from railjoule.core.bounds.minimum import SPARED_SHARE
from railjoule.core.dynamic_programming.on_off import OnOffBand, on_off_decisions
from railjoule.core.dynamic_programming.search import Found, search, supply_energy_j
from railjoule.core.errors import SolverError
from railjoule.core.interior_point.duty import (
    Duty,
    coasting_exactly,
    duty,
    forbidden_energy_j,
    repaired_modes,
    round_shares,
)
from railjoule.core.interior_point.solver import CONVERGED, Optimum
from railjoule.core.motion import running_time
from railjoule.core.physics.energy_balance import reference_energy
from railjoule.core.physics.mesh_data import BRAKE, DRIVE, MeshData
from railjoule.core.physics.stretches import actions_of_run, shortest_stretch_s
from railjoule.core.strategies.plain_line import broken_accelerations, broken_efforts
from railjoule.core.task import Task

# A swing between stretches is some km/h wide and has to lie within the first band; the second, around the best run of
# the first, corrects its coarse grid. Of 12 metros and trams no run needs 0.05 % more than with further roundings and
# the bands around Bellman's run, which took five times as long. One band of 61 speeds takes longer than these two
# In which local optimum the second one ends depends on last digits, so that it goes on around the best run: that saves
# a metro that averages 20 km/h 0.05 % more, and takes little, as most of its decisions are known
WIDE, NARROW = OnOffBand(0.2, 31, 1.1), OnOffBand(0.06, 31, 1.02)
BANDS = ((WIDE, 1), (NARROW, 2), (NARROW, 2), (NARROW, 2))
"""Bands of speed that are searched, and how many decisions of the two that bracket the timetable are solved. The price
of time hardly depends on the grid."""
# Switching only at nodes, with a minimum on/off time, costs a metro that averages 20 km/h 0.14 % of its energy
TOO_FAR = 5e-3
"""How far above free switching a run lies, as a share of the energy, before Bellman's recursion is tried as well."""
GOOD_ENOUGH = 1e-4
"""A relaxed optimum this far above a run, relatively, is not the best one of its problem."""
# Free switching is a lower bound, so that no decision can save more than what a run lies above it. A band of speeds
# takes as long as five solutions
FAR = 3e-4
"""Excess of a run over free switching, relatively, from which on a band of speeds is searched."""
FORBIDDEN_SHARE = 1e-4
"""Share of the energy that a decided optimum may spend on forbidden efforts: more than a barrier leaves."""
# Each repair allows more cells; where three do not suffice, the decision leaves no run worth having
MAX_REPAIRS = 3
# An early arrival counts as a fault where it costs a hundred-thousandth of the energy
SPARED_COST = 3e-6
"""Largest cost of the time that a decision's optimum leaves, by the price of time, as a share of the energy."""
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


def best_switched(task: Task, relaxed: Optimum) -> DecidedRun:
    """Return the best run found that switches at nodes only and keeps the minimum on/off time.

    If no run is found that keeps it, the run switches as often as it likes.

    Parameters
    ----------
    task : Task
        The task.
    relaxed : Optimum
        Its optimum with free switching.

    Raises
    ------
    SolverError
        If Bellman's recursion, the last resort, finds no run either.
    """
    centre = DecidedRun(relaxed.speed2, relaxed.energy_j, relaxed.price_of_time_w, 0)
    for min_s in sorted({0.0, task.least_switching_s}, reverse=True):
        search = Decisions(task, relaxed.energy_j, relaxed.price_of_time_w, min_s)
        search.add(relaxed)
        search.decide_near(centre, duty(task.mesh.data, relaxed))
        is_measure = search.best is not None and is_measured(task, relaxed, search.best.energy_j)
        if not (is_measure and search.is_within(TOO_FAR, relaxed.energy_j)):
            search.decide_elsewhere()
        if search.best is not None:
            return search.best
    raise SolverError("no run was found that switches at nodes only.")


def with_min_on_off(task: Task, run: DecidedRun) -> DecidedRun | None:
    """Return a run if it keeps the minimum on/off time, else the best one near it that does, if any."""
    if shortest_stretch_s(task.mesh.data, run.speed2) >= task.least_switching_s:
        return run
    search = Decisions(task, run.energy_j, run.price_of_time_w, task.least_switching_s)
    search.iterations = run.iterations
    search.decide_near(run, duty_of_run(task.mesh.data, run.speed2))
    return search.best


def duty_of_run(mesh: MeshData, speed2: FloatArray) -> Duty:
    """Return the cells in which a run drives and brakes, given by its squares of speed [m2/s2] at the nodes."""
    action = actions_of_run(mesh, speed2).action
    return Duty((action == DRIVE).astype(float), (action == BRAKE).astype(float))


class Decisions:
    """Runs found so far, and the decisions that have been tried.

    Parameters
    ----------
    task : Task
        The task.
    energy_j, price_of_time_w : float
        About what the best run takes [J] and what a second costs [J/s].
    least_switching_s : float
        Runs with a stretch shorter than this, to the nearest cell, do not count [s].
    """

    def __init__(self, task: Task, energy_j: float, price_of_time_w: float, least_switching_s: float = 0.0) -> None:
        self.task, self.data, self.least_switching_s = task, task.mesh.data, least_switching_s
        self.reference_j = float(reference_energy(self.data, energy_j, task.running_time_s))
        # close to the shortest time a second may cost more than all the rest of the run
        waited_j = max(price_of_time_w, 0.0) * task.running_time_s
        spared = SPARED_COST * self.reference_j / waited_j if waited_j > 0 else SPARED_SHARE
        self.spared_time_share = min(SPARED_SHARE, spared)
        self.runs: list[DecidedRun] = []
        self.iterations = 0
        # arrays of numbers as bytes, which can be hashed
        self.tried: set[bytes] = set()

    @property
    def best(self) -> DecidedRun | None:
        """The run of the least energy, with the iterations of all; None as long as none counts."""
        run = min(self.runs, key=lambda run: run.energy_j, default=None)
        return None if run is None else replace(run, iterations=self.iterations)

    def is_within(self, share: float, energy_j: float) -> bool:
        """Return whether the best run needs no more than an energy [J] and a share of it."""
        return self.best is not None and self.best.energy_j - energy_j <= share * self.reference_j

    def decide(self, modes: IntArray) -> None:
        """Try a decision; where no run can do without an effort that it leaves out, that is allowed, too."""
        for _ in range(1 + MAX_REPAIRS):
            if modes.tobytes() in self.tried:
                return
            self.tried.add(modes.tobytes())
            found = minimise_decided(self.task, modes, self.spared_time_share)
            # an optimum that buys what is forbidden is no run of its decision, nor the best one of any other
            if forbidden_energy_j(self.data, modes, found) <= FORBIDDEN_SHARE * self.reference_j:
                self.add(found)
                return
            self.iterations += found.iterations
            modes = repaired_modes(self.data, modes, found)

    def add(self, optimum: Optimum) -> None:
        """Take up the run of an optimum, coasting exactly where it all but coasts.

        A point that has not converged is a run as well, if it keeps all limits.
        """
        self.iterations += optimum.iterations
        # the exact one first: what a barrier leaves of an effort makes a drive with idle losses take them
        exactly = coasting_exactly(self.data, optimum)
        self.take(exactly if keeps_limits(self.task, exactly) else optimum.speed2, optimum.price_of_time_w)

    def take(self, speed2: FloatArray, price_of_time_w: float) -> None:
        """Take up a run [m2/s2] if it keeps all limits and the minimum on/off time."""
        if self.is_spaced(speed2) and keeps_limits(self.task, speed2):
            self.runs.append(DecidedRun(speed2, supply_energy_j(self.data, speed2), max(price_of_time_w, 0.0), 0))

    def is_spaced(self, speed2: FloatArray) -> bool:
        """Return whether a run [m2/s2] keeps the minimum on/off time."""
        min_s = self.least_switching_s
        return min_s == 0.0 or shortest_stretch_s(self.data, speed2) >= min_s

    def decide_near(self, centre: DecidedRun, shares: Duty) -> None:
        """Try the decisions that lie near a run, which may switch as often as it likes, and its shares of each cell."""
        task, data = self.task, self.data
        done = actions_of_run(data, centre.speed2)
        self.decide(round_shares(*shares, done.duration_s, done.interrupted_by, self.least_switching_s))
        if self.is_within(FAR, centre.energy_j):
            return
        speed2, price_w = centre.speed2, centre.price_of_time_w + data.auxiliary_power_w
        for band, count in BANDS:
            given = data, task.fastest_speed2, task.running_time_s, speed2, self.least_switching_s
            found = on_off_decisions(*given, band, price_w)
            price_w, self.iterations = found.price_w, self.iterations + found.sweeps
            before = self.best
            for modes in found.modes[:count]:
                self.decide(modes)
            best = self.best
            if best is None or self.is_within(FAR, centre.energy_j):
                return
            # around the same run the same decisions would be found again
            if before is not None and best.speed2 is before.speed2 is speed2:
                return
            speed2 = best.speed2

    def decide_elsewhere(self) -> None:
        """Try the fastest run and that of Bellman's recursion, with their decisions and those near the latter."""
        # more time would save the fastest run nothing
        self.take(self.task.fastest_speed2, 0.0)
        self.decide(actions_of_run(self.data, self.task.fastest_speed2).mode)
        with suppress(SolverError):
            _, run = recursion(self.task)
            self.iterations += run.iterations
            # not judged again: it keeps the limits as the recursion does, and may be all that there is
            if self.is_spaced(run.speed2):
                self.runs.append(run)
            self.decide(actions_of_run(self.data, run.speed2).mode)
            self.decide_near(run, duty_of_run(self.data, run.speed2))


def is_measured(task: Task, relaxed: Optimum, energy_j: float) -> bool:
    """Return whether an optimum with free switching is a measure of a run of an energy [J].

    It does where it has converged and the run does not lie below it.
    """
    # where losses fall with speed the hull is not convex in both, and what has converged may be a local optimum
    reference = reference_energy(task.mesh.data, relaxed.energy_j, task.running_time_s)
    return bool(relaxed.status == CONVERGED and relaxed.energy_j - energy_j <= GOOD_ENOUGH * reference)


def keeps_limits(task: Task, speed2: FloatArray) -> bool:
    """Return whether a run is in time and keeps the limits of effort, acceleration and speed, but for rounding."""
    data = task.mesh.data
    return bool(
        running_time(data.cell_length_m, speed2) <= task.running_time_s * (1 + TIME_ROUNDING)
        and np.all(speed2 <= data.limit_speed2 * (1 + TIME_ROUNDING))
        # Coasting exactly changes where brakes begin, in short cells before a stop by more than a ten-millionth
        and not broken_efforts(task.mesh, speed2)
        and not broken_accelerations(task.mesh, speed2)
    )


def recursion(task: Task) -> tuple[Found, DecidedRun]:
    """Return the result of backward induction and its run, which may switch in any cell and is not judged again.

    Raises
    ------
    SolverError
        If the grid holds no run.
    """
    data = task.mesh.data
    found = search(data, task.fastest_speed2, task.running_time_s * (1 - TIME_ROUNDING))
    # the search prices a second with the auxiliaries that run in it; the run shows what only driving saves
    price = max(found.price_w - data.auxiliary_power_w, 0.0)
    return found, DecidedRun(found.speed2, supply_energy_j(data, found.speed2), price, found.sweeps)
