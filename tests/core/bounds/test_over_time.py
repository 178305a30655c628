"""Lines that optima of some times prove beneath the least energy of all others."""

from dataclasses import replace

import numpy as np
import pytest

from railjoule.core import StrategyRefusedError, TimetableError, load_scenario
from railjoule.core.bounds import certify, minimise, time_lines
from railjoule.core.bounds.over_time import with_all_speeds
from railjoule.core.interior_point.certificate import fastest_of_better_runs
from railjoule.core.simulate.drawn import drive_drawn
from railjoule.core.strategies import prepare_task
from railjoule.core.task import Task
from tests.every_drive import train


def times_of(task: Task, shares: list[float]) -> list[float]:
    return [task.shortest_time_s * share + task.dwell_s for share in shares]


@pytest.fixture(params=["no recuperation", "recuperation and auxiliaries", "a stop"])
def task(request: pytest.FixtureRequest) -> Task:
    changes = {
        "no recuperation": {},
        "recuperation and auxiliaries": {"drive.recuperation_factor": 0.9, "vehicle.auxiliary_power_kw": 20.0},
        "a stop": {"line.stations": [{"name": "Between", "position_m": 1000.0, "dwell_s": 25.0}]},
    }[request.param]
    return prepare_task(load_scenario("metro-with-limit", {**changes, "timetable.travel_time_s": 400.0}))


def test_no_line_lies_above_the_least_energy_and_each_touches_it(task: Task) -> None:
    lines = time_lines(task, times_of(task, [1.05, 1.2, 1.6]))
    for time in times_of(task, [1.01, 1.05, 1.1, 1.2, 1.35, 1.6, 2.5]):
        timed = replace(task, running_time_s=time - task.dwell_s)
        solution = minimise(timed)
        # far below a line that were none, as those of neighbouring times lie hundredths apart
        assert lines.energy_j_at(time) <= certify(timed, solution.optimum).energy_j * (1 + 1e-6)
        if time in lines.travel_time_s:
            assert lines.energy_j_at(time) == pytest.approx(solution.energy_j, rel=1e-6)


def test_each_line_alone_is_a_bound_on_both_sides_of_its_time(task: Task) -> None:
    """Also far from it, where runs need more than its optimum and are faster, or have more time."""
    line = time_lines(task, times_of(task, [1.3]))
    for time in times_of(task, [1.002, 1.1, 1.29, 1.31, 1.8, 6.0]):
        energy = minimise(replace(task, running_time_s=time - task.dwell_s)).energy_j
        assert line.energy_j_at(time) <= energy * (1 + 1e-6)


def test_no_speed_is_left_out(task: Task) -> None:
    optimum = minimise(replace(task, running_time_s=1.3 * task.shortest_time_s)).optimum
    given = task.greatest_speed2, 1.3 * task.shortest_time_s
    own = fastest_of_better_runs(task.course.data, optimum, *given)
    # the proof for one time alone does leave some out
    assert np.any(own < np.sqrt(task.greatest_speed2) * (1 - 1e-6))
    kept = fastest_of_better_runs(task.course.data, with_all_speeds(task, optimum), *given)
    assert kept == pytest.approx(np.sqrt(task.greatest_speed2), rel=1e-12)


def test_runs_of_any_time_lie_above_many_lines_which_are_close_to_the_least_energy() -> None:
    scenario = load_scenario("liashenko-iii")
    task = prepare_task(scenario)
    lines = time_lines(task, task.shortest_time_s + np.geomspace(0.4, 400, 80))
    for speed in (20.0, 45.0, 60.0, 70.0):
        run = drive_drawn(scenario, task.course, np.full(task.course.cell_count + 1, speed / 3.6))
        least = minimise(replace(task, running_time_s=run.travel_time_s)).energy_j
        proven = lines.energy_j_at(run.travel_time_s)
        assert proven <= least * (1 + 1e-6)
        # between times that lie a tenth of the slack apart; see the module: the lines lie beneath a convex curve
        assert proven >= least * (1 - 1e-3)
        assert run.energy.net_j > proven


def test_what_has_no_such_lines_is_refused() -> None:
    task = prepare_task(load_scenario("liashenko-0"))
    with pytest.raises(TimetableError):
        time_lines(task, [0.9 * task.shortest_time_s])
    with pytest.raises(StrategyRefusedError, match="takes no power without effort"):
        time_lines(prepare_task(train("loss polynomial", 15.0)), [1000.0])
