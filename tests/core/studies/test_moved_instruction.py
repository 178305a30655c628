"""A moved instruction: it begins where it is put, the run arrives in time and keeps the limits, and costs energy."""

import numpy as np
import pytest

from railjoule.core import StrategyRefusedError, Trajectory, load_scenario
from railjoule.core.strategies import prepare_task, run_strategy
from railjoule.core.studies.moved_instruction import moved_run
from railjoule.core.task import Task

COAST, BRAKE = 5, 6
"""Phases of the scenario's optimum after its limit."""


@pytest.fixture(scope="module")
def task() -> Task:
    return prepare_task(load_scenario("metro-with-limit"))


@pytest.fixture(scope="module")
def optimum(task: Task) -> Trajectory:
    run = run_strategy(task, "optimal")
    assert [run.phases[k].phase for k in (COAST, BRAKE)] == ["coast", "brake"]
    return run


def keeps_the_task(run: Trajectory, task: Task) -> bool:
    # over other nodes, the braking curve differs a little
    greatest_ms = np.sqrt(np.interp(run.position_m, task.position_m, task.fastest_speed2))
    return bool(np.all(run.speed_ms <= greatest_ms + 0.1)) and run.travel_time_s == pytest.approx(170.0, abs=1e-2)


@pytest.mark.parametrize("metres", [-30.0, -15.0, 30.0, 60.0])
def test_coasting_begins_where_it_is_put(task: Task, optimum: Trajectory, metres: float) -> None:
    place = optimum.phases[COAST].start_m + metres
    run = moved_run(task, optimum, COAST, place)
    assert keeps_the_task(run, task)
    starts = [phase.start_m for phase in run.phases if phase.phase == "coast"]
    assert min(abs(start - place) for start in starts) <= task.scenario.solver.mesh_m
    assert run.energy_kwh > optimum.energy_kwh


def test_a_move_costs_more_the_farther_it_is(task: Task, optimum: Trajectory) -> None:
    start = optimum.phases[COAST].start_m
    near, far = (moved_run(task, optimum, COAST, start - metres).energy_kwh for metres in (10.0, 30.0))
    assert optimum.energy_kwh < near < far


def test_earlier_braking_is_from_a_higher_speed(task: Task, optimum: Trajectory) -> None:
    phase = optimum.phases[BRAKE]
    run = moved_run(task, optimum, BRAKE, phase.start_m - 10.0)
    assert keeps_the_task(run, task)
    brake = run.phases[-1]
    assert brake.phase == "brake"
    assert brake.start_m == pytest.approx(phase.start_m - 10.0, abs=task.scenario.solver.mesh_m)
    assert brake.start_ms > phase.start_ms
    assert run.energy_kwh > optimum.energy_kwh


def test_a_place_beyond_its_neighbours_is_refused(task: Task, optimum: Trajectory) -> None:
    with pytest.raises(StrategyRefusedError, match=r"can begin between 901 m and 2198 m here, not at 800 m"):
        moved_run(task, optimum, COAST, 800.0)
    with pytest.raises(StrategyRefusedError, match=r"can begin between .* here, not at 2250 m"):
        moved_run(task, optimum, BRAKE, 2250.0)
    with pytest.raises(StrategyRefusedError, match="only if it is coasting or braking"):
        moved_run(task, optimum, 0, 10.0)


def test_a_run_that_cannot_arrive_is_refused() -> None:
    task = prepare_task(load_scenario("liashenko-ii"))
    run = run_strategy(task, "optimal")
    with pytest.raises(StrategyRefusedError, match="cannot begin at 20 m"):
        moved_run(task, run, 1, 20.0)
