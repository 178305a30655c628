"""One speed limit for each section, found by search, under which an ordinary regulator drives the train.

Source: Shtompel, Khvorost 2025. The regulators are in `railjoule.core.limit_search.trip` and `.literal`, the search in
`railjoule.core.limit_search.search`. The run may be late by `search.time_window`, and it is: time is what it pays with.
"""

from dataclasses import replace

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.bounds import bounded
from railjoule.core.budget import current_budget, rounded_up
from railjoule.core.errors import ScenarioError, StrategyRefusedError
from railjoule.core.limit_search.literal import ARRIVED, Relay, literal_trip
from railjoule.core.limit_search.problem import Evaluation, LimitProblem, limit_problem
from railjoule.core.limit_search.search import LimitSearch, search_limits
from railjoule.core.motion import Course, build_course
from railjoule.core.motion.line_profile import section_borders
from railjoule.core.motion.mesh import finer_at_stops, with_nodes_at
from railjoule.core.scenario import Scenario
from railjoule.core.strategies.optimal import known_optimum
from railjoule.core.task import Task
from railjoule.core.trajectory import Trajectory, make_trajectory
from railjoule.core.units import MS_PER_KMH

LEAST_LIMIT_KMH = 1.0
"""Below (16): the least limit of a section."""
MOST_SECTIONS = 12
HALVINGS_AT_STOPS = 6
"""Near its stop a train's motors begin to draw power: where, only short cells tell."""
FAST_CHANGE_MS2, LONGEST_FAST_CELL_M = 0.2, 2.0
LONGEST_LITERAL_SHARE = 3.0
"""A literal trip may take so many times as long as planned."""
SHORTEST_STEP_M = 1e-5


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
    if options.limits_kmh is not None:
        limits = _given_limits(task.scenario, len(borders) + 1)
        problem = _problem(task, task.running_time_s)
        given = problem.as_given(limits, borders)
        if not np.isfinite(given.running_time_s):
            raise StrategyRefusedError("needs limits under which the train does not come to a stand.")
        return _trajectory(task, problem, given, ()), LimitSearch((given,), given)
    task.require_timetable()
    task.require_budget("speed_limits")
    problem = limit_problem_of(task)
    found = search_limits(problem, borders, options.free_boundaries)
    if not np.isfinite(found.best.energy_j):
        least = found.best.running_time_s + task.dwell_s
        raise StrategyRefusedError(
            f"needs at least {least / (1 + options.time_window):.1f} s with its regulator, which brakes at "
            f"{problem.way.deceleration_ms2:g} m/s2."
        )
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
            f"needs search.boundaries_m: the line has {len(borders) + 1} sections, and it searches over at most "
            f"{MOST_SECTIONS}."
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
    """Return the problem that the search of a task solves: trips within the latest time that its window allows."""
    return _problem(task, (1 + task.scenario.search.time_window) * task.running_time_s)


def _problem(task: Task, running_time_s: float) -> LimitProblem:
    """Return the problem of a task. The printed relay brakes for limits: its ideal does, and is searched with."""
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
    """Return the trajectory of limits on a mesh with nodes wherever the regulator changes its mind."""
    if task.scenario.search.regulator == "literal":
        return literal_trajectory(task, best.limits_ms, best.boundaries_m, words)
    ends = task.end_speeds_ms
    places, speed2 = problem.nodes_of(best.limits_ms, best.boundaries_m)
    fine = build_course(
        task.scenario,
        *ends,
        with_nodes_at(problem.course.position_m, [*places[1:-1], *_within_fast_changes(places, speed2)]),
    )
    finer = limit_problem(
        fine,
        problem.way.deceleration_ms2,
        problem.way.brakes,
        problem.least_ms,
        problem.most_ms,
        problem.running_time_s,
    )
    if best.stage != "given":
        best = finer.evaluate("refine", best.limits_ms, best.boundaries_m)
    places, speed2 = finer.nodes_of(best.limits_ms, best.boundaries_m)
    course = build_course(task.scenario, *ends, places)
    return _made(task, course, speed2, (limit_words(best.limits_ms, best.boundaries_m), *words))


def _within_fast_changes(position_m: FloatArray, speed2: FloatArray) -> list[float]:
    """Return places [m] that cut cells in which the train speeds up or slows down fast: limits of power bend there."""
    length = np.diff(position_m)
    fast = np.abs(np.diff(speed2)) > 2 * FAST_CHANGE_MS2 * length
    pieces = np.ceil(length / LONGEST_FAST_CELL_M).astype(int)
    cut = np.flatnonzero(fast & (pieces > 1))
    return [float(position_m[i] + length[i] * number / pieces[i]) for i in cut for number in range(1, int(pieces[i]))]


def literal_trajectory(
    task: Task, limits_ms: FloatArray, boundaries_m: FloatArray, words: tuple[str, ...] = ()
) -> Trajectory:
    """Return the run of the printed regulator under limits.

    Parameters
    ----------
    task : Task
        Train and line.
    limits_ms : array of shape (k,)
        Of the sections [m/s].
    boundaries_m : array of shape (k - 1,)
        Between them [m].
    words : tuple of str
        Sentences to go with it.

    Raises
    ------
    StrategyRefusedError
        If the line has stops on its way, the regulator does not bring the train to its end, or takes too many steps.
    """
    options, scenario = task.scenario.search, task.scenario
    if scenario.line.inner_stations:
        raise StrategyRefusedError("needs a line without stops between its ends for the literal regulator.")
    _require_few_steps(options.time_step_s, task.running_time_s)
    relay = Relay(
        options.dead_zone_kmh * MS_PER_KMH,
        options.regulation_speed_kmh * MS_PER_KMH,
        options.full_effort_time_s,
        options.effort_rate_share,
        options.time_step_s,
    )
    way = limit_problem(task.course, options.stop_deceleration_ms2, False, 0.0, np.inf, np.inf).way
    most = int(LONGEST_LITERAL_SHARE * task.running_time_s / options.time_step_s)
    position, speed2 = np.empty(most), np.empty(most)
    nodes, standing, switches, status = literal_trip(
        task.course.data, way, boundaries_m, limits_ms, relay, position, speed2
    )
    if status != ARRIVED:
        raise StrategyRefusedError(f"comes to a stand at {position[nodes - 1]:.0f} m with the literal regulator.")
    # steps of time that hardly move make cells in which rounding would be all of the force
    kept = np.append(True, np.diff(position[:nodes]) > SHORTEST_STEP_M)
    kept[-1] = True
    if position[nodes - 1] - position[:nodes][kept][-2] <= SHORTEST_STEP_M:
        kept[np.flatnonzero(kept)[-2]] = False
    course = build_course(scenario, float(np.sqrt(speed2[0])), 0.0, position_m=position[:nodes][kept])
    dwell = course.dwell_s.copy()
    dwell[0] = standing
    sentence = (
        f"The literal regulator switches {switches} times with time steps of {options.time_step_s:g} s; energy and "
        "time depend on that step."
    )
    return _made(
        task,
        replace(course, dwell_s=frozen_array(dwell)),
        speed2[:nodes][kept],
        (limit_words(limits_ms, boundaries_m), sentence, *words),
    )


def _require_few_steps(step_s: float, running_time_s: float) -> None:
    """Refuse a step of time that makes more cells of the printed regulator's run than the current budget has."""
    most = current_budget().cell_count
    if running_time_s > most * step_s:
        raise StrategyRefusedError(
            f"takes at most {most:,} steps of the literal regulator, and search.time_step_s = {step_s:g} makes "
            f"{running_time_s / step_s:,.0f}. Use {rounded_up(running_time_s / most):g} s or more."
        )


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
