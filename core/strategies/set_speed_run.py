"""Runs under limits of sections: the problem of a task, its trips made runs with one effort in each cell, refusals.

A task may be that of a whole line or of one inter-station run, a part of its nodes. The time of each inter-station run
is (X_sum - X_tr) / v_sr, Shtompel, Khvorost 2025, (15): all have one average speed between two arrivals that the
stations' `arrival_s` fix, or over the whole line where none is fixed. X_tr is the length of the train with
`timetable.deduct_train_length`, else 0.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from itertools import pairwise

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.errors import StrategyRefusedError
from railjoule.core.limit_search.problem import Evaluation, LimitProblem, RelayRuns, SetSpeedRun
from railjoule.core.limit_search.regulation import make_regulation
from railjoule.core.limit_search.search import LimitSearch
from railjoule.core.limit_search.trip import SHORTEST_PART_M
from railjoule.core.motion import MeshedLine, build_meshed_line
from railjoule.core.motion.mesh import finer_at_stops
from railjoule.core.strategies.line_parts import arrival_name, cut_part, inner_stations, parts_between, stop_nodes
from railjoule.core.strategies.literal_regulator import literal_cost, literal_run, require_literal
from railjoule.core.strategies.plain_line import require_line_without
from railjoule.core.task import Task
from railjoule.core.units import MS_PER_KMH, distinct_numbers

MIN_LIMIT_KMH = 1.0
"""Below (16): the least limit of a section."""
# near its stop a train's motors begin to draw power: where, only short cells tell
HALVINGS_AT_STOPS = 6
# A cell has one effort, that at its mean speed. A limit of power changes much within a cell if the train speeds up or
# slows down faster than this, so that such cells are cut to at most that length.
FAST_CHANGE_MS2, LONGEST_FAST_CELL_M = 0.2, 2.0


def build_limit_problem(task: Task) -> LimitProblem:
    """Return the problem that the search of a task solves: trips within the latest time that its window allows.

    The literal regulator is searched with its own runs.

    Raises
    ------
    StrategyRefusedError
        If the line has neutral sections, or the literal regulator does not take the task.
    """
    options = task.scenario.search
    earliest_s, latest_s = ((1 + sign * options.time_window) * task.running_time_s for sign in (-1, 1))
    problem = problem_within(task, latest_s)
    if options.regulator != "literal":
        return problem
    require_literal(task)
    return replace(problem, relay=RelayRuns(earliest_s, latest_s, partial(literal_cost, task)))


def problem_within(task: Task, running_time_s: float) -> LimitProblem:
    """Return the problem of a task with an ideal regulator within a time [s]; the literal regulator's ideal brakes."""
    require_line_without(task, "neutral_sections")
    options, vehicle = task.scenario.search, task.scenario.vehicle
    stops = task.mesh.position_m[task.mesh.data.fixed_speed2 == 0].tolist()
    mesh = mesh_over(task, finer_at_stops(task.mesh.position_m, stops, HALVINGS_AT_STOPS))
    regulation = make_regulation(mesh, options.stop_deceleration_ms2, options.regulator != "coast")
    most_ms = vehicle.traction.max_speed_kmh * MS_PER_KMH
    return LimitProblem(mesh, regulation, MIN_LIMIT_KMH * MS_PER_KMH, most_ms, running_time_s)


def mesh_over(task: Task, position_m: FloatArray) -> MeshedLine:
    """Return the meshed line of a task over other nodes between the same ends [m]."""
    mesh = build_meshed_line(task.scenario, *task.end_speeds_ms, position_m)
    # a part of a line ends at stations, whose dwells are none of its run's
    dwell = mesh.dwell_s.copy()
    dwell[[0, -1]] = 0.0
    return replace(mesh, dwell_s=frozen_array(dwell))


def drive_limits(task: Task, problem: LimitProblem, best: Evaluation) -> SetSpeedRun:
    """Return the run under limits, over a mesh with nodes wherever the regulator changes its effort.

    Raises
    ------
    StrategyRefusedError
        If the regulator drives no run that the train can, or comes too late.
    """
    if task.scenario.search.regulator == "literal":
        return literal_run(task, best.limits_ms, best.boundaries_m)
    # twice: on the coarse mesh forces are means over longer cells, and corners lie a little beside their places
    finer, best = _over_corners(task, problem, best, whole_cells=False)
    cells, best = _over_corners(task, finer, best, whole_cells=True)
    places, speed2 = cells.place_nodes(best.limits_ms, best.boundaries_m)
    if not np.isfinite(best.running_time_s):
        raise StrategyRefusedError(_failure(cells, places, speed2))
    if not np.isfinite(best.energy_j):
        raise StrategyRefusedError(_too_late(task, cells, best.running_time_s))
    return SetSpeedRun(cells.mesh, speed2, best.limits_ms, best.boundaries_m)


def _over_corners(
    task: Task, problem: LimitProblem, best: Evaluation, whole_cells: bool
) -> tuple[LimitProblem, Evaluation]:
    """Return a problem with nodes at the corners of a trip too, and the trip there, scaled to its time again."""
    places, speed2 = problem.place_nodes(best.limits_ms, best.boundaries_m)
    # the second time those cells are short already
    fast = [] if whole_cells else _within_fast_changes(places, speed2)
    nodes = _merged(problem.mesh.position_m, np.concatenate([places, fast]))
    finer = problem.over(mesh_over(task, nodes), whole_cells)
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


def _within_fast_changes(position_m: FloatArray, speed2: FloatArray) -> list[float]:
    """Return places [m] that cut cells in which the train speeds up or slows down fast."""
    length = np.diff(position_m)
    # v^2 changes by 2 a h over a cell
    fast = np.abs(np.diff(speed2)) > 2 * FAST_CHANGE_MS2 * length
    pieces = np.ceil(length / LONGEST_FAST_CELL_M).astype(int)
    cut = np.flatnonzero(fast & (pieces > 1))
    return [float(position_m[i] + length[i] * number / pieces[i]) for i in cut for number in range(1, int(pieces[i]))]


def no_limits_reason(task: Task, problem: LimitProblem, found: LimitSearch) -> str:
    """Return why a search found no limits."""
    if problem.relay is not None:
        return (
            f"finds no set speeds with which the literal regulator takes {problem.relay.earliest_s:.1f} to "
            f"{problem.relay.latest_s:.1f} s between stops. Use a longer time, or another search.regulator."
        )
    fastest = min(found.evaluations, key=lambda one: one.running_time_s)
    if np.isfinite(fastest.running_time_s):
        return _too_late(task, problem, fastest.running_time_s)
    cells = problem.over(problem.mesh, whole_cells=True)
    return _failure(cells, *cells.place_nodes(fastest.limits_ms, fastest.boundaries_m))


def _failure(problem: LimitProblem, position_m: FloatArray, speed2: FloatArray) -> str:
    """Return why a trip does not reach the end of the line, from its nodes up to where it fails."""
    place = position_m[-1]
    if speed2[-1] <= 0.0:
        return f"comes to a stand at {place:.0f} m with these set speeds."
    if not np.isfinite(speed2[-1]):
        most = problem.mesh.data.max_deceleration_ms2
        return (
            f"slows down by more than the limit of {most:g} m/s2 before {place:.0f} m, which it approaches at "
            f"{np.sqrt(speed2[-2]) / MS_PER_KMH:.1f} km/h, even at full effort."
        )
    bound = problem.regulation.bound_speed2[len(speed2) - 1]
    if bound == 0.0:
        return f"cannot brake in time: it passes the stop at {place:.0f} m."
    passed, allowed = distinct_numbers(float(np.sqrt(speed2[-1])) / MS_PER_KMH, float(np.sqrt(bound)) / MS_PER_KMH)
    return f"cannot brake in time: it passes {place:.0f} m at {passed} km/h, where {allowed} km/h is the limit."


def _too_late(task: Task, problem: LimitProblem, running_time_s: float) -> str:
    """Return why no limits keep a time, from the shortest running time under limits [s]."""
    # a timetable so much shorter would be kept with all of its window used
    least = (running_time_s / (1 + task.scenario.search.time_window)) + task.dwell_s
    return (
        f"needs at least {least:.1f} s with its regulator, which brakes at "
        f"{problem.regulation.deceleration_ms2:g} m/s2."
    )


def run_notes(task: Task, run: SetSpeedRun) -> tuple[str, ...]:
    """Return the set speeds of a run as a sentence, and one on the literal regulator."""
    limits = ", ".join(f"{limit / MS_PER_KMH:.1f}" for limit in run.limits_ms)
    borders = ", ".join(f"{border:.0f}" for border in run.boundaries_m)
    words = f"Set speeds: {limits} km/h, changing at {borders} m." if borders else f"Set speed: {limits} km/h."
    if task.scenario.search.regulator != "literal":
        return (words,)
    step = f"{task.scenario.search.time_step_s:g}"
    return words, (
        f"The literal regulator switches {run.switches} times with time steps of {step} s; energy and time depend on "
        "that step."
    )


def inter_station_runs(task: Task, needs_slack: bool = False) -> tuple[Task, ...]:
    """Return the tasks from stop to stop, over the same mesh.

    Raises
    ------
    ScenarioError
        If an `arrival_s` is too early.
    StrategyRefusedError
        If a run that needs slack has no more than its shortest time.
    """
    stops = stop_nodes(task)
    given = {k: s.arrival_s for k, s in enumerate(inner_stations(task)) if s.arrival_s is not None}
    runs: list[Task] = []
    for first, last, running_s in parts_between(task, given):
        inside = [stop for stop in stops if first <= stop <= last]
        length_m = np.diff(task.mesh.position_m[inside]) - task.scenario.deducted_m
        for (a, b), share in zip(pairwise(inside), length_m / length_m.sum(), strict=True):
            run = cut_part(task, a, b, float(share * running_s))
            if needs_slack and not run.has_slack:
                raise StrategyRefusedError(
                    f"{run_words(task, len(runs))} needs more than the shortest {run.shortest_time_s:.1f} s: at the "
                    f"average speed of the line it has {run.running_time_s:.1f} s. Use a longer time, arrival_s of the "
                    "stations, or search.inter_station_runs = 'together'."
                )
            runs.append(run)
    return tuple(runs)


def drive_literal_runs(task: Task, limits_ms: FloatArray, boundaries_m: FloatArray) -> SetSpeedRun:
    """Return the runs of the literal regulator from stop to stop as one; arguments and errors as `literal_run`."""
    runs = []
    for part in inter_station_runs(task):
        first, last = part.mesh.position_m[[0, -1]]
        sections = slice(np.searchsorted(boundaries_m, first, "right"), np.searchsorted(boundaries_m, last) + 1)
        inside = boundaries_m[(boundaries_m > first) & (boundaries_m < last)]
        runs.append(literal_run(part, limits_ms[sections], inside))
    # as given: a station need not be a border
    return join_runs(task, runs)._replace(limits_ms=limits_ms, boundaries_m=boundaries_m)


def run_words(task: Task, number: int) -> str:
    """Return from where to where an inter-station run goes, by its number, counted from 0."""
    start = task.scenario.line.start_station
    departs = arrival_name(task, number - 1) if number else start.name if start and start.name else "the start"
    return f"from {departs} to {arrival_name(task, number)}"


def join_runs(task: Task, runs: Sequence[SetSpeedRun]) -> SetSpeedRun:
    """Return runs that follow one another as one, with the dwells of the stations between them."""
    # the last node of a run is the first of the next one, at which the relay may stand until its effort moves the train
    position, speed2 = (
        np.concatenate([values[0], *(later[1:] for later in values[1:])])
        for values in ([run.mesh.position_m for run in runs], [run.speed2 for run in runs])
    )
    mesh = build_meshed_line(task.scenario, *task.end_speeds_ms, position)
    dwell, node = mesh.dwell_s.copy(), 0
    for run in runs:
        dwell[node] += run.mesh.dwell_s[0]
        node += run.mesh.cell_count
    stations = [station.position_m for station in inner_stations(task)]
    return SetSpeedRun(
        replace(mesh, dwell_s=frozen_array(dwell)),
        speed2,
        np.concatenate([run.limits_ms for run in runs]),
        np.union1d(np.concatenate([run.boundaries_m for run in runs]), stations),
        sum(run.switches for run in runs),
    )


def join_searches(task: Task, searches: Sequence[LimitSearch]) -> LimitSearch:
    """Return the searches of the inter-station runs as one, whose sections are theirs, with the stations between."""
    best = [search.best for search in searches]
    stations = [station.position_m for station in inner_stations(task)]
    whole = Evaluation(
        stage="separate",
        unscaled_ms=np.concatenate([one.unscaled_ms for one in best]),
        limits_ms=np.concatenate([one.limits_ms for one in best]),
        boundaries_m=np.union1d(np.concatenate([one.boundaries_m for one in best]), stations),
        running_time_s=sum(one.running_time_s for one in best),
        energy_j=sum(one.energy_j for one in best) + task.dwell_energy_j,
    )
    return LimitSearch(tuple(one for search in searches for one in search.evaluations), whole, tuple(searches))
