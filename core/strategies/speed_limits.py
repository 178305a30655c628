"""One speed limit for each section, found by search, under which an ordinary regulator drives the train.

Source: Shtompel, Khvorost 2025. The regulators are in `railjoule.core.limit_search.trip` and `.literal`, the search in
`railjoule.core.limit_search.search`, and the run, with one effort in each cell, in `.whole_cells`. The run may be late
by `search.time_window`, and it is: time is what it pays with.
"""

from dataclasses import replace

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.bounds import bounded
from railjoule.core.errors import ScenarioError, StrategyRefusedError
from railjoule.core.limit_search.problem import Evaluation, LimitProblem, limit_problem
from railjoule.core.limit_search.search import LimitSearch, search_limits
from railjoule.core.limit_search.whole_cells import SHORTEST_PART_M
from railjoule.core.motion import Course, build_course
from railjoule.core.motion.line_profile import section_borders
from railjoule.core.motion.mesh import finer_at_stops
from railjoule.core.scenario import Scenario
from railjoule.core.strategies.literal_regulator import literal_run
from railjoule.core.strategies.optimal import known_optimum
from railjoule.core.strategies.plain_line import require_no_neutral_sections, require_no_passing_points
from railjoule.core.task import Task
from railjoule.core.trajectory import Trajectory, make_trajectory
from railjoule.core.units import MS_PER_KMH, distinct_numbers

LEAST_LIMIT_KMH = 1.0
"""Below (16): the least limit of a section."""
MOST_SECTIONS = 12
# near its stop a train's motors begin to draw power: where, only short cells tell
HALVINGS_AT_STOPS = 6
# A cell has one effort, that at its mean speed. Where the train speeds up or slows down faster than this, a limit of
# power changes much from one end of a cell to the other, and cells are cut to at most that length.
FAST_CHANGE_MS2, LONGEST_FAST_CELL_M = 0.2, 2.0


def speed_limits(task: Task) -> Trajectory:
    """Return the run under the best limits of sections, or under given ones.

    Raises
    ------
    TimetableError
        If the timetable cannot be kept.
    ScenarioError
        If a given limit or border is out of bounds.
    StrategyRefusedError
        If the regulator cannot keep the timetable, there are too many sections, or cells for a search.
    """
    return speed_limits_with_search(task)[0]


def speed_limits_with_search(task: Task) -> tuple[Trajectory, LimitSearch]:
    """Return the run and the path of the search that led to it; errors as `speed_limits`."""
    options = task.scenario.search
    borders = section_boundaries(task.scenario)
    if task.course.data.fixed_speed2[-1] > 0:
        raise StrategyRefusedError("needs a run that ends at rest.")
    require_no_passing_points(task)
    if options.limits_kmh is not None:
        limits = _given_limits(task.scenario, len(borders) + 1)
        problem = _problem(task, task.running_time_s)
        given = problem.as_given(limits, borders)
        return _trajectory(task, problem, given, ()), LimitSearch((given,), given)
    task.require_timetable()
    task.require_budget("speed_limits")
    problem = limit_problem_of(task)
    found = search_limits(problem, borders, options.free_boundaries)
    if not np.isfinite(found.best.energy_j):
        raise StrategyRefusedError(_no_limits(task, problem, found))
    words = _words(found, options.free_boundaries)
    return _trajectory(task, problem, found.best, words), found


def section_boundaries(scenario: Scenario) -> FloatArray:
    """Return the borders between the sections of a search [m]: those asked for, else those of the line's sections.

    Raises
    ------
    StrategyRefusedError
        If there are too many sections to search over.
    """
    options = scenario.search
    if options.boundaries_m:
        borders = np.array(options.boundaries_m)
    else:
        borders = section_borders(scenario.line.in_running_order())[1:-1]
        count = len(options.limits_kmh) if options.limits_kmh is not None else 0
        if count and count != len(borders) + 1:
            raise ScenarioError(
                f"search.limits_kmh has {count} entries for the {len(borders) + 1} sections of the line."
            )
    if len(borders) >= MOST_SECTIONS and options.limits_kmh is None:
        raise StrategyRefusedError(
            f"needs borders of sections (search.boundaries_m): the line has {len(borders) + 1} sections, and it "
            f"searches over at most {MOST_SECTIONS}."
        )
    return frozen_array(borders)


def _given_limits(scenario: Scenario, sections: int) -> FloatArray:
    """Return the limits that a scenario gives [m/s]."""
    most, given = scenario.vehicle.traction.max_speed_kmh, scenario.search.limits_kmh
    assert given is not None
    if len(given) != sections:
        raise ScenarioError(f"search.limits_kmh has {len(given)} entries for {sections} sections.")
    for index, limit in enumerate(given):
        if not LEAST_LIMIT_KMH <= limit <= most:
            bound = f"at least {LEAST_LIMIT_KMH:g}" if limit < LEAST_LIMIT_KMH else f"at most the vehicle's {most:g}"
            raise ScenarioError(f"search.limits_kmh[{index}] = {limit:g} must be {bound}.")
    return np.array(given) * MS_PER_KMH


def limit_problem_of(task: Task) -> LimitProblem:
    """Return the problem that the search of a task solves: trips within the latest time that its window allows.

    Raises
    ------
    StrategyRefusedError
        If the line has neutral sections.
    """
    return _problem(task, (1 + task.scenario.search.time_window) * task.running_time_s)


def _problem(task: Task, running_time_s: float) -> LimitProblem:
    """Return the problem of a task. The printed relay brakes for limits: its ideal does, and is searched with."""
    require_no_neutral_sections(task)
    options, vehicle = task.scenario.search, task.scenario.vehicle
    stops = task.course.position_m[task.course.data.fixed_speed2 == 0].tolist()
    nodes = finer_at_stops(task.course.position_m, stops, HALVINGS_AT_STOPS)
    return limit_problem(
        build_course(task.scenario, *task.end_speeds_ms, nodes),
        options.stop_deceleration_ms2,
        options.regulator != "coast",
        LEAST_LIMIT_KMH * MS_PER_KMH,
        vehicle.traction.max_speed_kmh * MS_PER_KMH,
        running_time_s,
    )


def _trajectory(task: Task, problem: LimitProblem, best: Evaluation, words: tuple[str, ...]) -> Trajectory:
    """Return the trajectory of limits on a mesh with nodes wherever the regulator changes its effort."""
    if task.scenario.search.regulator == "literal":
        return literal_trajectory(task, best.limits_ms, best.boundaries_m, words)
    # twice: on the coarse mesh forces are means over longer cells, and corners lie a little beside their places
    finer, best = _over_corners(task, problem, best, whole_cells=False)
    cells, best = _over_corners(task, finer, best, whole_cells=True)
    places, speed2 = cells.nodes_of(best.limits_ms, best.boundaries_m)
    if not np.isfinite(best.running_time_s):
        raise StrategyRefusedError(_failure(cells, places, speed2))
    if not np.isfinite(best.energy_j):
        raise StrategyRefusedError(_too_late(task, cells, best.running_time_s))
    return _made(task, cells.course, speed2, (limit_words(best.limits_ms, best.boundaries_m), *words))


def _over_corners(
    task: Task, problem: LimitProblem, best: Evaluation, whole_cells: bool
) -> tuple[LimitProblem, Evaluation]:
    """Return a problem with nodes at the corners of a trip too, and the trip there, scaled to its time again."""
    places, speed2 = problem.nodes_of(best.limits_ms, best.boundaries_m)
    # the second time those cells are short already
    fast = [] if whole_cells else _within_fast_changes(places, speed2)
    nodes = _merged(problem.course.position_m, np.concatenate([places, fast]))
    finer = problem.over(build_course(task.scenario, *task.end_speeds_ms, nodes), whole_cells)
    if best.stage == "given":
        return finer, finer.as_given(best.limits_ms, best.boundaries_m)
    return finer, finer.evaluate("refine", best.limits_ms, best.boundaries_m)


def _merged(position_m: FloatArray, places_m: FloatArray) -> FloatArray:
    """Return nodes [m] with further ones at places that are not too close to them, or to one another."""
    places = np.setdiff1d(places_m, position_m)
    after = np.searchsorted(position_m, places)
    inside = (after > 0) & (after < len(position_m))
    places, after = places[inside], after[inside]
    free = np.minimum(places - position_m[after - 1], position_m[after] - places) > SHORTEST_PART_M
    # one by one: whether a place is too close depends on which of those before it stay
    kept: list[float] = []
    for place in places[free]:
        if not kept or place - kept[-1] > SHORTEST_PART_M:
            kept.append(place)
    return np.union1d(position_m, kept)


def _failure(problem: LimitProblem, position_m: FloatArray, speed2: FloatArray) -> str:
    """Return why a trip does not reach the end of the line, from its nodes up to where it fails."""
    place = position_m[-1]
    if speed2[-1] <= 0.0:
        return f"comes to a stand at {place:.0f} m with these set speeds."
    if not np.isfinite(speed2[-1]):
        most = problem.course.data.max_deceleration_ms2
        return (
            f"slows down by more than the {most:g} m/s2 that are allowed before {place:.0f} m, which it approaches at "
            f"{np.sqrt(speed2[-2]) / MS_PER_KMH:.1f} km/h, even at full effort."
        )
    bound = problem.regulation.bound_speed2[len(speed2) - 1]
    if bound == 0.0:
        return f"cannot brake in time: it passes the stop at {place:.0f} m."
    passed, allowed = distinct_numbers(float(np.sqrt(speed2[-1])) / MS_PER_KMH, float(np.sqrt(bound)) / MS_PER_KMH)
    return f"cannot brake in time: it passes {place:.0f} m at {passed} km/h, where {allowed} km/h is the limit."


def _no_limits(task: Task, problem: LimitProblem, found: LimitSearch) -> str:
    """Return why a search found no limits."""
    fastest = min(found.evaluations, key=lambda one: one.running_time_s)
    if np.isfinite(fastest.running_time_s):
        return _too_late(task, problem, fastest.running_time_s)
    cells = problem.over(problem.course, whole_cells=True)
    return _failure(cells, *cells.nodes_of(fastest.limits_ms, fastest.boundaries_m))


def _too_late(task: Task, problem: LimitProblem, running_time_s: float) -> str:
    """Return why no limits keep a time, from the shortest running time under limits [s]."""
    # a timetable so much shorter would be kept with all of its window used
    least = (running_time_s / (1 + task.scenario.search.time_window)) + task.dwell_s
    return (
        f"needs at least {least:.1f} s with its regulator, which brakes at "
        f"{problem.regulation.deceleration_ms2:g} m/s2."
    )


def _within_fast_changes(position_m: FloatArray, speed2: FloatArray) -> list[float]:
    """Return places [m] that cut cells in which the train speeds up or slows down fast."""
    length = np.diff(position_m)
    # v^2 changes by 2 a h over a cell
    fast = np.abs(np.diff(speed2)) > 2 * FAST_CHANGE_MS2 * length
    pieces = np.ceil(length / LONGEST_FAST_CELL_M).astype(int)
    cut = np.flatnonzero(fast & (pieces > 1))
    return [float(position_m[i] + length[i] * number / pieces[i]) for i in cut for number in range(1, int(pieces[i]))]


def literal_trajectory(
    task: Task, limits_ms: FloatArray, boundaries_m: FloatArray, words: tuple[str, ...] = ()
) -> Trajectory:
    """Return the run of the printed regulator under limits, with sentences to go with it.

    Other arguments and errors as `railjoule.core.strategies.literal_regulator.literal_run`.
    """
    run = literal_run(task, limits_ms, boundaries_m)
    sentence = (
        f"The literal regulator switches {run.switches} times with time steps of "
        f"{task.scenario.search.time_step_s:g} s; energy and time depend on that step."
    )
    return _made(task, run.course, run.speed2, (limit_words(limits_ms, boundaries_m), sentence, *words))


def _made(task: Task, course: Course, speed2: FloatArray, notes: tuple[str, ...]) -> Trajectory:
    """Return a trajectory with bound and reference for the time that it takes, which may be later than planned.

    The bound holds over its own nodes; what it is measured against is the optimum over the scenario's.
    """
    run = bounded(task, make_trajectory(task.scenario, course, "speed_limits", speed2, notes=notes))
    late = replace(task, running_time_s=run.travel_time_s - task.dwell_s)
    best = known_optimum(late) if late.has_slack else None
    return run if best is None else replace(run, reference=best.reference)


def limit_words(limits_ms: FloatArray, boundaries_m: FloatArray) -> str:
    """Tell limits [m/s] and the borders between them [m]."""
    limits = ", ".join(f"{limit / MS_PER_KMH:.1f}" for limit in limits_ms)
    if len(boundaries_m) == 0:
        return f"Set speed: {limits} km/h."
    borders = ", ".join(f"{border:.0f}" for border in boundaries_m)
    return f"Set speeds: {limits} km/h, changing at {borders} m."


def _words(found: LimitSearch, free: bool) -> tuple[str, ...]:
    samples = sum(evaluation.stage == "sample" for evaluation in found.evaluations)
    moved = " and section ends" if free else ""
    return (
        f"{len(found.evaluations)} combinations of set speeds{moved} tried, the first {samples} evenly spread; "
        "not a proof.",
    )
