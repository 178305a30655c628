"""Runs that switch seldom enough: `drive.least_switching_s` holds however short the cells of a mesh are.

Two ways lead to decisions that keep to it. Where the relaxed optimum drives for a part of the way, rounding in time
keeps what is on close to its share: within the most that one stretch on and one off make up at that share. Where limits
or time leave no room for that, dynamic programming around the best run known finds decisions that know of both. All are
solved and judged by the one account; what is best is a local optimum, as any run of a drive that jumps.

Reference: Zeile, Robuschi, Sager 2021, "Mixed-integer optimal control under minimum dwell time constraints", Math.
Program. 188, 653-694, on rounding with stretches that last.
"""

import math
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace

import numpy as np

from railjoule.core.arrays import BoolArray, FloatArray, IntArray
from railjoule.core.compiled import njit
from railjoule.core.dynamic_programming.spaced import spaced_decisions
from railjoule.core.errors import SolverError
from railjoule.core.interior_point.duty import COASTED, DRIVEN, Duty, duty
from railjoule.core.interior_point.solver import Optimum
from railjoule.core.physics.course_data import BRAKING, DRIVING, OFF, CourseData
from railjoule.core.physics.reference import reference_energy
from railjoule.core.physics.stretches import (
    BRAKES,
    DRIVES,
    NOTHING,
    actions_of_run,
    lasting_of_cells,
    shortest_stretch_s,
)
from railjoule.core.strategies.decisions import (
    FAR,
    GOOD_ENOUGH,
    DecidedRun,
    Decisions,
    is_measured,
    recursion,
)
from railjoule.core.strategies.switching import OWED, summed_up_modes
from railjoule.core.task import Task

# Where in its swing a stretch that is shared begins is a matter of luck, as in sum-up rounding
PHASES = (0.0, 0.5, -0.5)
"""What is owed where a shared stretch begins, over half of the swing that is allowed."""
# A swing between stretches is some km/h wide, and has to lie within the first band; the second mends its coarse grid
BANDS = ((0.15, 25), (0.12, 41))
"""Half widths of the bands of speed that are searched, over the top speed, and their numbers of speeds."""
# The solution of a decision moves its switchings in time by some percent; a cell is the step in which they are placed
SPARE = 1.05
"""How much longer than asked the stretches of a decision last."""


def seldom_switched(task: Task, relaxed: Optimum) -> DecidedRun | None:
    """Return the best run found whose drive stays on or off for long enough; None if none was found.

    Parameters
    ----------
    task : Task
        What is to be run.
    relaxed : Optimum
        Its optimum with free switching.
    """
    centre = DecidedRun(relaxed.speed2, relaxed.energy_j, relaxed.price_of_time_w, 0)
    run = spaced(task, centre, duty(task.course.data, relaxed))
    is_measure = run is not None and is_measured(task, relaxed, run.energy_j)
    # whoever lies no further above free switching is beaten by no other by more
    if is_measure and not lies_above(task, run, centre, GOOD_ENOUGH):
        return run
    # a search around one run finds what lies near it; the recursion's may lie elsewhere
    found = [run, _fastest_switched(task, centre)]
    with suppress(SolverError):
        _, free = recursion(task)
        found.append(seldom(task, free))
    return min((one for one in found if one is not None), key=lambda one: one.energy_j, default=None)


def _fastest_switched(task: Task, centre: DecidedRun) -> DecidedRun | None:
    """Return the fastest run, or a better one of its decision, if its drive stays on or off for long enough."""
    search = _Spaced(task, centre.energy_j, centre.price_of_time_w, task.least_switching_s)
    # more time would save this run nothing
    search.take(task.greatest_speed2, 0.0)
    search.decide(actions_of_run(task.course.data, task.greatest_speed2).machines)
    return search.found


def seldom(task: Task, run: DecidedRun) -> DecidedRun | None:
    """Return a run if its drive stays on or off for long enough, else the best one near it that does, if any."""
    if shortest_stretch_s(task.course.data, run.speed2) >= task.least_switching_s:
        return run
    return spaced(task, run, duty_of_run(task.course.data, run.speed2))


def spaced(task: Task, centre: DecidedRun, shares: Duty) -> DecidedRun | None:
    """Return the best run found near another one whose drive stays on or off for long enough; None if there is none.

    Parameters
    ----------
    task : Task
        What is to be run.
    centre : DecidedRun
        The other one, which may switch as often as it likes.
    shares : Duty
        On which share of each cell it drives and brakes.
    """
    data, least, speed2 = task.course.data, task.least_switching_s, centre.speed2
    search = _Spaced(task, centre.energy_j, centre.price_of_time_w, least)
    for modes in _rounded_decisions(data, speed2, shares, least):
        if lies_above(task, search.found, centre, GOOD_ENOUGH):
            search.decide(modes)
    top = math.sqrt(task.greatest_speed2.max())
    price = centre.price_of_time_w + data.auxiliary_power_w
    for width, points in BANDS:
        if not lies_above(task, search.found, centre, FAR):
            break
        band = speed2, price, width * top, points, SPARE * least
        decisions, sweeps = spaced_decisions(data, task.greatest_speed2, task.running_time_s, *band)
        search.iterations += sweeps
        for modes in decisions:
            search.decide(modes)
        speed2 = search.found.speed2 if search.found is not None else speed2
    if search.found is None:
        return None
    return replace(search.found, iterations=centre.iterations + search.iterations)


def _rounded_decisions(course: CourseData, speed2: FloatArray, shares: Duty, least_s: float) -> Iterator[FloatArray]:
    """Yield the decisions whose stretches last that shares of the cells of a run [m2/s2] lead to."""
    done = actions_of_run(course, speed2)
    # what is not shared switches seldom by itself, and then the threshold alone decides where
    for owed in OWED:
        modes = summed_up_modes(shares, course.cell_length_m, owed)
        if lasting_of_cells(modes.astype(int), done.duration_s, done.interrupted_by).min() >= least_s:
            yield modes
    for phase in PHASES:
        yield rounded(*shares, done.duration_s, done.interrupted_by, SPARE * least_s, phase)


def lies_above(task: Task, run: DecidedRun | None, other: DecidedRun, share: float) -> bool:
    """Return whether a run needs by more than a share of the energy more than another one, or there is none."""
    if run is None:
        return True
    reference = reference_energy(task.course.data, other.energy_j, task.running_time_s)
    return bool(run.energy_j > other.energy_j + share * reference)


def duty_of_run(course: CourseData, speed2: FloatArray) -> Duty:
    """Return where a run drives and brakes, given by its squares of speed [m2/s2] at the nodes."""
    action = actions_of_run(course, speed2).action
    return Duty((action == DRIVES).astype(float), (action == BRAKES).astype(float))


class _Spaced(Decisions):
    """A search that mends stretches of which a decision's own solution leaves too little."""

    @property
    def found(self) -> DecidedRun | None:
        """The best run that counts; None as long as there is none."""
        return self.best if self.runs and self.best.energy_j < math.inf else None

    def decide(self, modes: FloatArray) -> None:
        """Try a decision; where its run is on or off for too short a time, without that, then with more of it."""
        if self._is_enough(modes):
            return
        data, least = self.task.course.data, self.least_switching_s
        # what is given up may leave something else too short
        for gives_up in (True, True, False):
            action, machines, durations, interrupted_by = actions_of_run(data, self.runs[-1].speed2)
            short = lasting_of_cells(action, durations, interrupted_by) < least
            mended = given_up(machines, short) if gives_up else lengthened(machines, short, durations, least)
            if self._is_enough(mended):
                return

    def _is_enough(self, modes: FloatArray) -> bool:
        """Try a decision and return whether its run counts, or there is none to be mended."""
        super().decide(modes)
        return not self.runs or self.runs[-1].energy_j < math.inf


@njit(cache=True, error_model="numpy", nogil=True)
def given_up(decision: FloatArray, short: BoolArray) -> FloatArray:
    """Return a decision in which what is too short goes on with what is before it; arrays of shape (n,)."""
    mended = decision.copy()
    for i in range(1, decision.shape[0]):
        if short[i]:
            mended[i] = mended[i - 1]
    return mended


@njit(cache=True, error_model="numpy", nogil=True)
def lengthened(decision: FloatArray, short: BoolArray, durations_s: FloatArray, least_s: float) -> FloatArray:
    """Return a decision in which what is too short takes cells from what follows; arrays of shape (n,), a time [s]."""
    mended, lasts = decision.copy(), np.inf
    for i in range(decision.shape[0]):
        if short[i] and (i == 0 or not short[i - 1] or decision[i] != decision[i - 1]):
            lasts = 0.0
        elif i > 0 and not short[i] and lasts + 0.5 * durations_s[i] < least_s:
            mended[i] = mended[i - 1]
        lasts += durations_s[i]
    return mended


@njit(cache=True, error_model="numpy", nogil=True)
def rounded(
    driving: FloatArray,
    braking: FloatArray,
    durations_s: FloatArray,
    interrupted_by: IntArray,
    least_s: float,
    phase: float,
) -> FloatArray:
    """Return a decision, an array of shape (n,), whose stretches last and which keeps close to given shares.

    Parameters
    ----------
    driving, braking, durations_s : arrays of shape (n,)
        Shares of the cells on which the drive is on, and times of the cells [s].
    interrupted_by : array of shape (n,)
        What interrupts the drive before each cell.
    least_s : float
        For how long a stretch lasts at least [s].
    phase : float
        What is owed where a shared stretch begins, over half of the swing.
    """
    n = durations_s.shape[0]
    decision, does, lasts = np.full(n, OFF), OFF, np.inf
    owed_driving, owed_braking = 0.0, 0.0
    for i in range(n):
        t = durations_s[i]
        if interrupted_by[i] != NOTHING:
            does, lasts = OFF, np.inf
        owed_driving, drive = _owes(owed_driving, driving, i, t, least_s, phase, does == DRIVING)
        owed_braking, brake = _owes(owed_braking, braking, i, t, least_s, phase, does == BRAKING)
        wanted = DRIVING if drive else BRAKING if brake else OFF
        # to the nearest cell, as `shortest_stretch_s` counts
        if wanted != does and lasts + 0.5 * t >= least_s:
            does, lasts = wanted, 0.0
        owed_driving -= t if does == DRIVING else 0.0
        owed_braking -= t if does == BRAKING else 0.0
        decision[i] = does
        lasts += t
    return decision


@njit(cache=True, error_model="numpy")
def _owes(
    owed_s: float, share: FloatArray, cell: int, duration_s: float, least_s: float, phase: float, is_on: bool
) -> tuple[float, bool]:
    """Return for how long the drive is owed to be on at the end of a cell [s], and whether it is to be on there.

    At a share d the shortest stretches that last and keep to it are of d / (1 - d) to one: what is owed swings by
    max(d, 1 - d) of the shortest stretch.
    """
    part = share[cell]
    if part >= DRIVEN or part <= COASTED:
        return 0.0, bool(part >= DRIVEN)
    half_swing = 0.5 * least_s * max(part, 1.0 - part)
    if cell == 0 or not COASTED < share[cell - 1] < DRIVEN:
        owed_s = phase * half_swing
    owed_s += part * duration_s
    # in the middle of the cell: the borders of a stretch are then off by half a cell to either side
    middle = owed_s - 0.5 * duration_s
    return owed_s, bool(middle > -half_swing if is_on else middle >= half_swing)
