"""One speed limit for each section, found by search, under which an ordinary regulator drives the train.

Source: Shtompel, Khvorost 2025. The regulators are in `railjoule.core.limit_search.trip` and `.literal`, the search in
`railjoule.core.limit_search.search`. The run may be late by `search.time_window`, and it is: time is what it pays with.
The inter-station runs of a line are searched together, or each by itself within its own time, as the paper has it,
which makes it more constrained: time cannot move from one of them to another.
"""

from dataclasses import replace
from itertools import pairwise

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.bounds import bounded
from railjoule.core.errors import ScenarioError, StrategyRefusedError
from railjoule.core.limit_search.problem import MIN_SECTION_M, LimitProblem, SetSpeedRun
from railjoule.core.limit_search.search import LimitSearch, Start, search_limits
from railjoule.core.motion.line_profile import section_borders
from railjoule.core.scenario import Scenario
from railjoule.core.strategies.optimal import known_optimum
from railjoule.core.strategies.plain_line import require_line_without
from railjoule.core.strategies.set_speed_run import (
    MIN_LIMIT_KMH,
    build_limit_problem,
    drive_limits,
    drive_literal_runs,
    inter_station_runs,
    join_runs,
    join_searches,
    no_limits_reason,
    problem_within,
    run_notes,
    run_words,
)
from railjoule.core.strategy import Strategy, register
from railjoule.core.task import Task
from railjoule.core.trajectory import Trajectory, make_trajectory
from railjoule.core.units import MS_PER_KMH

MAX_SECTIONS = 12
"""Of one inter-station run, or of a line without stations."""


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
    if task.mesh.data.fixed_speed2[-1] > 0:
        raise StrategyRefusedError("needs a run that ends at rest.")
    require_line_without(task, "passing_points")
    if options.limits_kmh is not None:
        is_literal = options.regulator == "literal"
        limits = _given_limits(task.scenario)
        problem = problem_within(task, task.running_time_s)
        given = problem.as_given(limits, borders)
        run = drive_literal_runs(task, limits, borders) if is_literal else drive_limits(task, problem, given)
        return _made(task, run), LimitSearch((given,), given)
    task.require_timetable()
    task.require_budget("speed_limits")
    if options.inter_station_runs == "separate":
        run, found = _search_separately(task, borders)
    else:
        problem = build_limit_problem(task)
        found = search_limits(problem, borders, options.free_boundaries, _separate_start(task, borders))
        run = _drive_found(task, problem, found)
    samples = sum(evaluation.stage == "sample" for evaluation in found.evaluations)
    moved = " and section ends" if options.free_boundaries else ""
    each = ", each inter-station run by itself" if found.runs else ""
    words = (
        f"{len(found.evaluations)} combinations of set speeds{moved} tried{each}, the first {samples} evenly spread; "
        "not a proof."
    )
    return _made(task, run, words), found


def _drive_found(task: Task, problem: LimitProblem, found: LimitSearch) -> SetSpeedRun:
    if not np.isfinite(found.best.energy_j):
        raise StrategyRefusedError(no_limits_reason(task, problem, found))
    return drive_limits(task, problem, found.best)


def _search_separately(task: Task, borders_m: FloatArray) -> tuple[SetSpeedRun, LimitSearch]:
    """Return the runs from station to station as one, each searched by itself within its own time, and the searches."""
    runs, searches = [], []
    for number, part in enumerate(inter_station_runs(task, needs_slack=True)):
        first, last = part.mesh.position_m[[0, -1]]
        inside = borders_m[(borders_m > first) & (borders_m < last)]
        try:
            problem = build_limit_problem(part)
            found = search_limits(problem, inside, task.scenario.search.free_boundaries)
            runs.append(_drive_found(part, problem, found))
        except StrategyRefusedError as refusal:
            raise StrategyRefusedError(f"{run_words(task, number)} {refusal}") from None
        searches.append(found)
    return join_runs(task, runs), join_searches(task, searches)


def _separate_start(task: Task, borders_m: FloatArray) -> Start | None:
    """Return the limits of the inter-station runs, each searched by itself; None where that gives none."""
    stops = task.scenario.line.in_running_order().stops_m
    options = task.scenario.search
    if len(stops) == 2 or options.free_boundaries or not np.isin(stops[1:-1], borders_m).all():
        return None
    try:
        limits = _search_separately(task, borders_m)[1].best.limits_ms
    except (ScenarioError, StrategyRefusedError):
        # a run may need more than its share of the time: together they may have enough
        return None
    return Start(limits, np.searchsorted(stops[1:-1], np.append(0.0, borders_m), side="right"))


def section_boundaries(scenario: Scenario) -> FloatArray:
    """Return the borders between the sections of a search [m]: those asked for, else those of the line's sections.

    Stations are borders, too, if limits are searched for without given borders, or for each inter-station run.

    Raises
    ------
    StrategyRefusedError
        If there are too many sections to search over.
    """
    options, line = scenario.search, scenario.line.in_running_order()
    stations = line.stops_m[1:-1]
    borders = np.array(options.boundaries_m) if options.boundaries_m else section_borders(line)[1:-1]
    if options.limits_kmh is not None:
        if len(options.limits_kmh) != len(borders) + 1:
            count = len(options.limits_kmh)
            raise ScenarioError(
                f"search.limits_kmh has {count} entries for the {len(borders) + 1} sections of the line."
            )
        return frozen_array(borders)
    if not options.boundaries_m or options.inter_station_runs == "separate":
        near = np.abs(np.subtract.outer(borders, stations)).min(axis=1, initial=np.inf) < MIN_SECTION_M
        borders = np.union1d(borders[~near], stations)
    _require_few_sections(line.stops_m, borders)
    return frozen_array(borders)


def _require_few_sections(stops_m: tuple[float, ...], borders_m: FloatArray) -> None:
    """Refuse more sections between two stops than a search is made for."""
    for start, end in pairwise(stops_m):
        count = 1 + int(((borders_m > start) & (borders_m < end)).sum())
        if count > MAX_SECTIONS:
            where = "the line" if len(stops_m) == 2 else f"the run from {start:.0f} to {end:.0f} m"
            raise StrategyRefusedError(
                f"needs borders of sections (search.boundaries_m): {where} has {count} sections, and it searches over "
                f"at most {MAX_SECTIONS}."
            )


def _given_limits(scenario: Scenario) -> FloatArray:
    """Return the limits that a scenario gives [m/s]."""
    most, given = scenario.vehicle.traction.max_speed_kmh, scenario.search.limits_kmh
    assert given is not None
    for index, limit in enumerate(given):
        if not MIN_LIMIT_KMH <= limit <= most:
            bound = f"at least {MIN_LIMIT_KMH:g}" if limit < MIN_LIMIT_KMH else f"at most the vehicle's {most:g}"
            raise ScenarioError(f"search.limits_kmh[{index}] = {limit:g} must be {bound}.")
    return np.array(given) * MS_PER_KMH


def _made(task: Task, driven: SetSpeedRun, *words: str) -> Trajectory:
    """Return a trajectory with bound and reference for the time that it takes, which may be later than planned.

    The bound holds over its own nodes; what it is measured against is the optimum over the scenario's.
    """
    notes = (*run_notes(task, driven), *words)
    run = bounded(task, make_trajectory(task.scenario, driven.mesh, "speed_limits", driven.speed2, notes=notes))
    late = replace(task, running_time_s=run.travel_time_s - task.dwell_s)
    best = known_optimum(late) if late.has_slack else None
    return run if best is None else replace(run, reference=best.reference)


register(
    Strategy(
        name="speed_limits",
        run=speed_limits,
        order=60,
        label="Set speeds",
        colour=("#D6409F", "#EE92C6"),
        dash=(12, 4),
        help=(
            "One set speed for each section of the line: below it the train drives, above it it coasts or brakes. "
            "The strategy searches the set speeds that need the least energy."
        ),
        applies_to="every scenario without neutral sections; it can be late within its time window, and proves nothing",
        source="shtompel-2025",
        labels=("Speed limits",),
        seconds_per_cell=1.6e-3,
    )
)
