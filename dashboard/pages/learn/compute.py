"""Results of the lessons of Learn: small scenarios that are solved again for each position of a slider."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

from railjoule.core import Scenario, Trajectory, load_scenario, solve
from railjoule.core.energy import share_above
from railjoule.core.simulation.following import follow, plan_for
from railjoule.core.strategies import prepare_task
from railjoule.core.studies.steady import PhaseCurve, SteadySpeeds, phase_plane, steady_speeds
from railjoule.core.studies.tradeoff import Frontier, energy_time_frontier, frontier_times, one_speed_run

BASE = "liashenko-0"
"""A metro train of five cars with a constant efficiency, whose speeds follow from a formula."""
# the texts in assets/texts/lessons.toml name these and what comes of them; their test computes it again
SHORT_M, MIDDLE_M, LONG_M = 1500.0, 3000.0, 6000.0
HUMP_TIME_S, LONG_TIME_S, LOAD_TIME_S = 125.0, 430.0, 125.0
PLANNED_LOAD = 0.3


@dataclass(frozen=True, eq=False)
class LessonResult:
    """The results of one lesson.

    Parameters
    ----------
    runs : mapping
        Runs by the names of their lines.
    frontier : Frontier or None
        Energy over travel time.
    steady : SteadySpeeds or None
        Speeds on level track that follow from the multiplier.
    plane : tuple of PhaseCurve
        The run in the phase plane.
    """

    runs: Mapping[str, Trajectory]
    frontier: Frontier | None = None
    steady: SteadySpeeds | None = None
    plane: tuple[PhaseCurve, ...] = field(default=())

    @property
    def saved_share(self) -> float:
        """Energy saved by the first run against the second, as a share of the second."""
        first, second, *_ = (run.energy_kwh for run in self.runs.values())
        return -share_above(first, second)


# those of a class all begin with the same
@lru_cache(maxsize=64)
def compute_lesson(lesson: str, value: float) -> LessonResult:
    """Compute the runs of a lesson for a value of its slider; raises RailjouleError if that asks for the impossible."""
    return LESSONS[lesson](value)


def compute_lessons(values: tuple[float, ...]) -> dict[str, LessonResult]:
    """Compute all lessons, each for the value of its slider."""
    return {name: compute_lesson(name, value) for name, value in zip(LESSONS, values, strict=True)}


def _level(length_m: float, **changes: Any) -> Scenario:
    return load_scenario(BASE).replace(line={"sections": [{"length_m": length_m}]}, **changes)


def _coasting(value: float) -> LessonResult:
    scenario = _level(SHORT_M, **{"timetable.travel_time_s": value})
    return LessonResult({"optimum": solve(scenario), "constant speed": one_speed_run(scenario)})


def _multiplier(value: float) -> LessonResult:
    scenario = _level(MIDDLE_M, **{"timetable.travel_time_s": value})
    later = solve(scenario.replace(**{"timetable.travel_time_s": value + 1}))
    task = prepare_task(scenario)
    frontier = energy_time_frontier(task, frontier_times(task, 24))
    return _with_plane(scenario, {"optimum": solve(scenario), "with one more second": later}, frontier)


def _recuperation(value: float) -> LessonResult:
    without = _level(LONG_M, **{"timetable.travel_time_s": LONG_TIME_S})
    scenario = without.replace(**{"drive.recuperation_factor": value / 100})
    return _with_plane(scenario, {"optimum": solve(scenario), "no recuperation": solve(without)})


def _gradient(value: float) -> LessonResult:
    steep = value
    # SHORT_M together, so that both plans are of the same length
    sections = [
        {"length_m": 150.0},
        {"length_m": 250.0, "gradient_permille": -steep},
        {"length_m": 700.0},
        {"length_m": 250.0, "gradient_permille": steep},
        {"length_m": 150.0},
    ]
    without = _level(SHORT_M, **{"timetable.travel_time_s": HUMP_TIME_S})
    with_gradients = without.replace(line={"sections": sections})
    driven = follow(plan_for(without), with_gradients).actual
    return LessonResult({"planned with gradients": plan_for(with_gradients), "planned for level track": driven})


def _load(value: float) -> LessonResult:
    planned = _level(SHORT_M, **{"timetable.travel_time_s": LOAD_TIME_S, "vehicle.load_factor": PLANNED_LOAD})
    actual = value / 100
    driven = follow(plan_for(planned), planned.replace(**{"disturbance.actual_load_factor": actual})).actual
    # a heavier train is late: the plan for the actual load gets the same arrival
    for_actual = planned.replace(**{"vehicle.load_factor": actual, "timetable.travel_time_s": driven.travel_time_s})
    return LessonResult({"planned for the actual load": plan_for(for_actual), "planned for 30 %": driven})


def _with_plane(scenario: Scenario, runs: Mapping[str, Trajectory], frontier: Frontier | None = None) -> LessonResult:
    run = runs["optimum"]
    steady = steady_speeds(scenario, run.price_of_time_w or 0.0, float(run.speed_ms.max()))
    return LessonResult(runs, frontier, steady, phase_plane(scenario, steady))


LESSONS: Mapping[str, Callable[[float], LessonResult]] = {
    "coasting": _coasting,
    "multiplier": _multiplier,
    "recuperation": _recuperation,
    "gradient": _gradient,
    "load": _load,
}
"""Functions that compute the lessons, in reading order."""
