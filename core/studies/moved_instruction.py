"""Runs whose coasting or braking begins at a given place, the rest of the run being optimal for the same arrival."""

from dataclasses import replace

import numpy as np

from railjoule.core.errors import RailjouleError, StrategyRefusedError
from railjoule.core.scenario import Scenario
from railjoule.core.scenario.line import SHORTEST_DISTANCE_M, NeutralSection, PassingPoint
from railjoule.core.strategies.optimal import optimal
from railjoule.core.task import Task, prepare_task
from railjoule.core.trajectory import Trajectory
from railjoule.core.units import MS_PER_KMH

POWERED_SHARE = 1e-2
"""From this share of the maximum effort on, a cell is driven under power."""
BELOW_FASTEST = 1e-3
"""A passing speed is below the greatest one by this share: an interior-point method needs a feasible interior."""
HALVINGS = 9
"""Of the interval of passing speeds, which leave less than 0.1 km/h of some 50 km/h."""


def moved_run(task: Task, run: Trajectory, number: int, place_m: float) -> Trajectory:
    """Compute the best run in which a phase of coasting or braking begins at another place.

    Earlier coasting is a stretch without traction power up to the end of the phase. Later coasting is the slowest
    passage of the place that the optimum reaches under power. Earlier braking is full braking from a higher
    speed; later braking is refused, as it would need a lower speed that other instructions set.

    Parameters
    ----------
    task : Task
        The task of the run.
    run : Trajectory
        Its optimum.
    number : int
        Index of the phase in `run.phases`.
    place_m : float
        The place where it is to begin [m].

    Raises
    ------
    StrategyRefusedError
        If the phase is neither coasting nor braking, the place lies beyond the phases beside it, or no such run
        arrives in time.
    """
    phase = run.phases[number]
    if phase.phase not in {"coast", "brake"} or number == 0:
        raise StrategyRefusedError("can be moved only if it is coasting or braking after another instruction.")
    low = run.phases[number - 1].start_m + SHORTEST_DISTANCE_M
    high = phase.end_m - SHORTEST_DISTANCE_M
    if phase.phase == "brake":
        low, high = max(low, _braking_curve_start_m(task, phase.end_m) + SHORTEST_DISTANCE_M), phase.start_m
    if not low <= place_m <= high:
        raise StrategyRefusedError(f"can begin between {low:.0f} m and {high:.0f} m here, not at {place_m:.0f} m.")
    try:
        if phase.phase == "brake":
            found = _passing_run(task, place_m, _fastest_ms(task, place_m))
        elif place_m <= phase.start_m:
            found = optimal(prepare_task(_without_power(task.scenario, place_m, phase.end_m)))
        else:
            found = _powered_run(task, run, place_m)
        # the point to pass and the stretch without power are of no line: bound and optimum are those of the task
        return replace(found, scenario=task.scenario, bound=run.bound, reference=run.reference)
    except StrategyRefusedError:
        raise
    except RailjouleError as failure:
        raise StrategyRefusedError(
            f"cannot begin at {place_m:.0f} m: no such run keeps the limits and arrives in time."
        ) from failure


def _powered_run(task: Task, run: Trajectory, place_m: float) -> Trajectory:
    """Compute the slowest run that passes a place under power."""
    low_ms, high_ms = float(np.interp(place_m, run.position_m, run.speed_ms)), _fastest_ms(task, place_m)
    found = _passing_run(task, place_m, high_ms)
    if not _is_powered_before(found, place_m):
        raise StrategyRefusedError(f"cannot begin at {place_m:.0f} m: no train is under power until there.")
    for _ in range(HALVINGS):
        middle_ms = 0.5 * (low_ms + high_ms)
        candidate = _passing_run(task, place_m, middle_ms)
        if _is_powered_before(candidate, place_m):
            found, high_ms = candidate, middle_ms
        else:
            low_ms = middle_ms
    return found


def _is_powered_before(run: Trajectory, place_m: float) -> bool:
    cell = int(np.searchsorted(run.position_m, place_m - 1e-6)) - 1
    return bool(run.tractive_effort_n[cell] > POWERED_SHARE * run.max_effort_n[cell])


def _fastest_ms(task: Task, place_m: float) -> float:
    """Return the greatest speed at a place, less a little [m/s]."""
    return float(np.sqrt(np.interp(place_m, task.position_m, task.fastest_speed2))) * (1 - BELOW_FASTEST)


def _braking_curve_start_m(task: Task, end_m: float) -> float:
    """Return the begin of the fastest run's full braking that ends at a place [m]."""
    node = int(np.searchsorted(task.position_m, end_m - 1e-6))
    while node > 0 and task.fastest_speed2[node - 1] > task.fastest_speed2[node]:
        node -= 1
    return float(task.position_m[node])


def _passing_run(task: Task, place_m: float, speed_ms: float) -> Trajectory:
    """Compute the optimum that passes a place at a speed [m/s]."""
    line = task.scenario.line
    position_m = line.length_m - place_m if line.reverse else place_m
    point = PassingPoint(position_m=position_m, speed_kmh=speed_ms / MS_PER_KMH)
    points = sorted((*line.passing_points, point), key=lambda one: one.position_m)
    return optimal(prepare_task(task.scenario.replace(**{"line.passing_points": [one.model_dump() for one in points]})))


def _without_power(scenario: Scenario, from_m: float, to_m: float) -> Scenario:
    line = scenario.line
    ends = (line.length_m - to_m, line.length_m - from_m) if line.reverse else (from_m, to_m)
    sections = (*line.neutral_sections, NeutralSection(from_m=ends[0], to_m=ends[1]))
    return scenario.replace(**{"line.neutral_sections": [one.model_dump() for one in sections]})
