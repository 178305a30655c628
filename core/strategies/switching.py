"""Runs of drives with idle losses: free switching as a relaxation, and a decision for each cell as a run to drive.

Free switching between coasting and driving within a cell gives the convex hull of the drive's power, and with it a
problem that has a lower bound. Where its optimum drives or brakes for a part of the way, as it does instead of holding
a speed, a run to drive must decide: on in some cells, off in the others. With that decided the problem is smooth again.

Two ways lead to decisions that keep `drive.least_switching_s`. Rounding keeps the time that the drive is on close to
its share, and ignores limits and the timetable. Where its run lies clearly above free switching, dynamic programming in
a band of speeds around the relaxed optimum, then around the best run, finds the decisions of the two runs that bracket
the timetable. Each decision is solved exactly; the best one is a local optimum. Where the relaxed optimum is no measure
of a run, or none lies near it, Bellman's recursion over all speeds and the runs near its own are tried, too.
"""

from contextlib import suppress

from railjoule.core.arrays import FloatArray
from railjoule.core.dynamic_programming.on_off import OnOffBand
from railjoule.core.errors import SolverError
from railjoule.core.interior_point.duty import Duty, duty
from railjoule.core.interior_point.solver import Optimum
from railjoule.core.physics.course_data import CourseData
from railjoule.core.physics.stretches import BRAKES, DRIVES, actions_of_run, shortest_stretch_s
from railjoule.core.strategies.decisions import FAR, DecidedRun, Decisions, is_measured, recursion
from railjoule.core.strategies.rounding import round_shares
from railjoule.core.task import Task

# A swing between stretches is some km/h wide and has to lie within the first band; the second, around the best run of
# the first, corrects its coarse grid. Of 12 metros and trams no run needs 0.05 % more than with further roundings and
# the bands around Bellman's run, which took five times as long. One band of 61 speeds takes longer than these two
BANDS = ((0.2, 31, 1.1, 1), (0.06, 31, 1.02, 2))
"""Half widths of the bands of speed that are searched, over the top speed, their numbers of speeds, the factor by which
the bracket of the price of time first widens, as the price hardly depends on the grid, and how many decisions of the
two that bracket the timetable are solved."""
# Switching only at nodes, with a minimum on/off time, costs a metro that averages 20 km/h 0.14 % of its energy
TOO_FAR = 5e-3
"""How far above free switching a run lies, as a share of the energy, before Bellman's recursion is tried as well."""


def best_switched(task: Task, relaxed: Optimum) -> DecidedRun:
    """Return the best run found that switches at nodes only and keeps the minimum on/off time.

    Where no run is found that keeps it, the run switches as often as it likes.

    Parameters
    ----------
    task : Task
        What is to be run.
    relaxed : Optimum
        Its optimum with free switching.

    Raises
    ------
    SolverError
        If Bellman's recursion, the last resort, finds no run either.
    """
    centre = DecidedRun(relaxed.speed2, relaxed.energy_j, relaxed.price_of_time_w, 0)
    for least_s in sorted({0.0, task.least_switching_s}, reverse=True):
        search = Decisions(task, relaxed.energy_j, relaxed.price_of_time_w, least_s)
        search.add(relaxed)
        _decide_near(search, centre, duty(task.course.data, relaxed))
        is_measure = search.best is not None and is_measured(task, relaxed, search.best.energy_j)
        if not (is_measure and search.is_within(TOO_FAR, relaxed.energy_j)):
            _decide_elsewhere(search)
        if search.best is not None:
            return search.best
    raise SolverError("no run was found that switches at nodes only.")


def with_min_on_off(task: Task, run: DecidedRun) -> DecidedRun | None:
    """Return a run if it keeps the minimum on/off time, else the best one near it that does, if any."""
    if shortest_stretch_s(task.course.data, run.speed2) >= task.least_switching_s:
        return run
    search = Decisions(task, run.energy_j, run.price_of_time_w, task.least_switching_s)
    search.iterations = run.iterations
    _decide_near(search, run, duty_of_run(task.course.data, run.speed2))
    return search.best


def duty_of_run(course: CourseData, speed2: FloatArray) -> Duty:
    """Return where a run drives and brakes, given by its squares of speed [m2/s2] at the nodes."""
    action = actions_of_run(course, speed2).action
    return Duty((action == DRIVES).astype(float), (action == BRAKES).astype(float))


def _decide_near(search: Decisions, centre: DecidedRun, shares: Duty) -> None:
    """Try the decisions that lie near a run, which may switch as often as it likes, and its shares of each cell."""
    task, data, least_s = search.task, search.task.course.data, search.least_switching_s
    done = actions_of_run(data, centre.speed2)
    search.decide(round_shares(*shares, done.duration_s, done.interrupted_by, least_s))
    if search.is_within(FAR, centre.energy_j):
        return
    speed2, price_w = centre.speed2, centre.price_of_time_w + data.auxiliary_power_w
    for width, points, factor, count in BANDS:
        band = OnOffBand(data, task.greatest_speed2, task.running_time_s, speed2, least_s, width, points)
        decisions, price_w = band.decisions(price_w, factor)
        search.iterations += band.sweeps
        for modes in decisions[:count]:
            search.decide(modes)
        if search.best is None or search.is_within(FAR, centre.energy_j):
            return
        speed2 = search.best.speed2


def _decide_elsewhere(search: Decisions) -> None:
    """Try the fastest run and that of Bellman's recursion, with their decisions and those near the latter."""
    task, data = search.task, search.task.course.data
    # more time would save the fastest run nothing
    search.take(task.greatest_speed2, 0.0)
    search.decide(actions_of_run(data, task.greatest_speed2).machines)
    with suppress(SolverError):
        _, run = recursion(task)
        search.iterations += run.iterations
        # not judged again: it keeps the limits as the recursion does, and may be all that there is
        if shortest_stretch_s(data, run.speed2) >= search.least_switching_s:
            search.runs.append(run)
        search.decide(actions_of_run(data, run.speed2).machines)
        _decide_near(search, run, duty_of_run(data, run.speed2))
