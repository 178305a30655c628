"""The inter-station runs of a line, each with its own time, and the run that they make together.

The time of each is (X_sum - X_tr) / v_sr, Shtompel, Khvorost 2025, (15): all have one average speed between two
arrivals that the stations' `arrival_s` fix, or over the whole line where none is fixed. X_tr is the length of the train
with `timetable.deduct_train_length`, else 0.
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.errors import StrategyRefusedError
from railjoule.core.limit_search.problem import Evaluation, SetSpeedRun
from railjoule.core.limit_search.search import LimitSearch
from railjoule.core.motion import build_meshed_line
from railjoule.core.strategies.line_parts import arrival_name, inner_stations, part_of, parts_between, stop_nodes
from railjoule.core.strategies.literal_regulator import literal_run
from railjoule.core.task import Task


def inter_station_runs(task: Task) -> tuple[Task, ...]:
    """Return the tasks from stop to stop, over the same mesh; raises ScenarioError if an `arrival_s` is too early."""
    stops = stop_nodes(task)
    given = {k: s.arrival_s for k, s in enumerate(inner_stations(task)) if s.arrival_s is not None}
    runs: list[Task] = []
    for first, last, running_s in parts_between(task, given):
        inside = [stop for stop in stops if first <= stop <= last]
        length_m = np.diff(task.mesh.position_m[inside]) - task.scenario.deducted_m
        for (a, b), share in zip(pairwise(inside), length_m / length_m.sum(), strict=True):
            runs.append(part_of(task, a, b, float(share * running_s)))
    return tuple(runs)


def require_slack(task: Task, runs: Sequence[Task]) -> None:
    """Raise StrategyRefusedError if an inter-station run has less time than its shortest."""
    for number, run in enumerate(runs):
        if not run.has_slack:
            raise StrategyRefusedError(
                f"{run_words(task, number)} needs more than the shortest {run.shortest_time_s:.1f} s: at the average "
                f"speed of the line it has {run.running_time_s:.1f} s. Use a longer time, arrival_s of the stations, "
                "or search.inter_station_runs = 'together'."
            )


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
