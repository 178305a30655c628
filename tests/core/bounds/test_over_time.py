"""The line that the optimum of one time proves below the least energy of all others."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from railjoule.core import load_scenario
from railjoule.core.bounds import certify, minimise, time_line
from railjoule.core.continuous_bound.refinement import refined_optimum
from railjoule.core.simulation.manual import drive_drawn
from railjoule.core.strategies import prepare_task
from railjoule.core.task import Task


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


def line_at(task: Task, share: float) -> Callable[[float], float]:
    """Return the proven energy [J] over the travel time [s], from the optimum at a share of the shortest time."""
    begun = task.shortest_time_s * share
    line = time_line(replace(task, running_time_s=begun))
    return lambda time: line.energy_j - line.price_of_time_w * (time - task.dwell_s - begun)


@pytest.mark.parametrize("share", [1.05, 1.3])
def test_a_line_touches_the_least_energy_and_is_a_bound_on_both_sides(task: Task, share: float) -> None:
    """Also far from its time, where runs need more than its optimum and are faster, or have more time."""
    proven = line_at(task, share)
    for time in times_of(task, [1.002, share - 0.01, share, share + 0.01, 1.8, 6.0]):
        assert proven(time) < refined_optimum(replace(task, running_time_s=time - task.dwell_s)).solution.energy_j
    own = replace(task, running_time_s=share * task.shortest_time_s)
    at = proven(times_of(task, [share])[0])
    assert at == pytest.approx(certify(own, minimise(own).optimum).energy_j, rel=1e-12)
    assert at == pytest.approx(refined_optimum(own).solution.energy_j, rel=2e-3)


def test_runs_of_any_time_lie_above_a_line() -> None:
    scenario = load_scenario("liashenko-iii")
    task = prepare_task(scenario)
    proven = line_at(task, 1.2)
    for speed in (20.0, 45.0, 60.0, 70.0):
        run = drive_drawn(scenario, task.mesh, np.full(task.mesh.cell_count + 1, speed / 3.6))
        assert run.energy.net_j > proven(run.travel_time_s)
