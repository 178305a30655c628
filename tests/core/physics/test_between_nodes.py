"""A run between the nodes of its mesh, against a small integrator over time and against closed forms."""

import numpy as np
import pytest
from every_drive import DRIVES, one_cell, train
from random_scenarios import random_speeds

from railjoule.core import load_scenario
from railjoule.core.bounds import minimise
from railjoule.core.physics.between_nodes import follow_between_nodes, slow_to_possible
from railjoule.core.physics.braking import electric_efforts
from railjoule.core.physics.mesh_data import electric_limit_n, tractive_limit_n
from railjoule.core.physics.stretches import NEXT_TO_NOTHING
from railjoule.core.strategies import prepare_task

STEPS = 200
"""Of the integrator, in each cell."""
SLOWEST_MS = 1e-9


def integrate(mesh, run, start_ms):
    """Return speed [m/s], distance [m] and line energy [J] at the end of each cell, by the rule of Runge and Kutta."""
    data, drive = mesh.data, mesh.drive
    is_driving, follows_limit = run.effort_n >= 0, run.limit_share > 0
    is_off = np.abs(run.effort_n) <= NEXT_TO_NOTHING * data.traction.constant_n

    def slopes(state):
        v = np.maximum(state[0], SLOWEST_MS)
        strongest = electric_limit_n(data, v)
        largest = np.where(is_driving, tractive_limit_n(data, v), -strongest - data.friction_effort_n)
        force = np.where(follows_limit, run.limit_share * largest, run.effort_n)
        resistance = data.resistance_constant_n + data.resistance_linear * v + data.resistance_quadratic * v**2
        braking = np.maximum(-force, 0.0)
        parameters = data.drive_kind, data.drive_parameters
        electric = electric_efforts(*parameters, braking, v, strongest, data.friction_effort_n)
        power = drive.supply_power_w(np.where(is_driving, force, -electric), v)
        power = np.where(is_off, np.maximum(force, 0.0) * v, power)
        return np.array([(force - resistance - data.line_force_n) / (2 * data.half_inertia_kg), v, power])

    state, step = np.array([start_ms, 0 * start_ms, 0 * start_ms]), run.duration_s / STEPS
    for _ in range(STEPS):
        first = slopes(state)
        second = slopes(state + 0.5 * step * first)
        third = slopes(state + 0.5 * step * second)
        state = state + step / 6 * (first + 2 * second + 2 * third + slopes(state + step * third))
    return state


@pytest.mark.parametrize("friction_kn", [0.0, 15.0])
@pytest.mark.parametrize("drive", DRIVES)
def test_the_motion_within_cells_is_that_of_an_integrator(drive, friction_kn):
    task = prepare_task(train(drive, friction_kn, **{"timetable.travel_time_s": 150.0}))
    for speed2 in (task.fastest_speed2, random_speeds(task, 7)):
        run, speed = follow_between_nodes(task.mesh.data, speed2), np.sqrt(speed2)
        assert (run.limit_share > 0).any() or speed2 is not task.fastest_speed2
        reached, passed, energy = integrate(task.mesh, run, speed[:-1])
        assert reached == pytest.approx(speed[1:], abs=1e-6 * speed.max())
        assert passed == pytest.approx(run.cell_length_m, rel=1e-6)
        assert energy.sum() == pytest.approx(run.total_j, abs=1e-6 * np.abs(energy).sum())
        assert energy == pytest.approx(run.supply_energy_j, abs=1e-5 * np.abs(energy).max())


def unresisted(start_ms, end_ms, length_m=10.0):
    """Return the data of a cell where only efforts act, and squares of speed."""
    cell = one_cell(train("constant efficiency", 15.0), length_m, start_ms, end_ms)
    data = cell.mesh.data
    zero = np.zeros(1)
    kept = {"resistance_constant_n": 0.0, "resistance_linear": 0.0, "resistance_quadratic": zero, "line_force_n": zero}
    return data._replace(**kept), cell.speed2


def test_an_excess_at_full_power_is_that_of_the_closed_form():
    """At a constant power m (v1^3 - v0^3) = 3 P h; the account, at the mean speed, asks for less."""
    data, speed2 = unresisted(14.0, 15.0)
    needed_w = 2 * data.half_inertia_kg * (15.0**3 - 14.0**3) / 3 / 10.0
    found = follow_between_nodes(data, speed2).max_excess
    assert (found.kind, found.cell, found.start_m) == ("traction", 0, 0.0)
    assert found.share == pytest.approx(needed_w / data.traction.power_w - 1, rel=1e-9)
    by_mean_speed = data.half_inertia_kg * (speed2[1] - speed2[0]) / 10.0 * 14.5 / data.traction.power_w - 1
    assert 0 < found.share - by_mean_speed < 1e-3


@pytest.mark.parametrize(("start_ms", "end_ms", "kind"), [(3.0, 6.0, "traction"), (6.0, 3.0, "braking")])
def test_an_excess_at_constant_effort_is_force_over_limit(start_ms, end_ms, kind):
    data, speed2 = unresisted(start_ms, end_ms)
    limit_n = data.traction.constant_n if kind == "traction" else data.braking.constant_n + 15e3
    found = follow_between_nodes(data, speed2).max_excess
    assert found.kind == kind
    assert found.share == pytest.approx(data.half_inertia_kg * 27.0 / 10.0 / limit_n - 1, rel=1e-9)


def test_a_speed_above_its_limit_is_found():
    task = prepare_task(train("constant efficiency", **{"timetable.travel_time_s": 150.0}))
    data, middle = task.mesh.data, task.mesh.cell_count // 2
    speed2 = np.minimum(task.fastest_speed2, 25.0)
    limit2 = data.limit_speed2.copy()
    limit2[middle] = 25.0 / 1.02**2
    found = follow_between_nodes(data._replace(limit_speed2=limit2), speed2).max_excess
    assert (found.kind, found.cell, found.share) == ("speed", middle - 1, pytest.approx(0.02))
    assert found.start_m == pytest.approx(task.mesh.position_m[middle - 1])


def test_in_a_neutral_section_there_is_friction_only():
    data, speed2 = unresisted(6.0, 5.5)
    run = follow_between_nodes(data._replace(supply_share=np.full(1, 1e-9)), speed2)
    assert run.supply_energy_j == 0.0
    assert run.max_excess.share == pytest.approx(data.half_inertia_kg * 5.75 / 10.0 / 15e3 - 1)


@pytest.fixture(scope="module")
def impossible():
    """Return an optimum over 5 m that asks for more than full traction where the limit leaves its constant."""
    task = prepare_task(load_scenario("liashenko-fig-5"))
    speed2 = minimise(task).optimum.speed2
    assert 1e-3 < follow_between_nodes(task.mesh.data, speed2).max_excess.share < 1e-2
    return task, speed2


def test_a_run_slowed_down_is_possible_and_hardly_later(impossible):
    task, speed2 = impossible
    before = follow_between_nodes(task.mesh.data, speed2)
    slower = slow_to_possible(task.mesh.data, speed2)
    after = follow_between_nodes(task.mesh.data, slower)
    assert after.max_excess.share < 1e-11
    assert (slower <= speed2).all()
    assert 0 < after.total_s - before.total_s < 1e-5 * before.total_s


def test_cells_halved_by_their_excess_make_the_run_possible(impossible):
    task, speed2 = impossible
    nodes = task.mesh.position_m
    over = follow_between_nodes(task.mesh.data, speed2).excess_share > 5e-4
    halves = np.sort(np.concatenate([nodes, (0.5 * (nodes[:-1] + nodes[1:]))[over]]))
    finer = prepare_task(task.scenario, position_m=halves)
    assert follow_between_nodes(finer.mesh.data, minimise(finer).optimum.speed2).is_possible


def test_the_fastest_run_slowed_down_keeps_all_limits_for_each_drive():
    for drive in DRIVES:
        task = prepare_task(train(drive, 15.0, **{"timetable.travel_time_s": 150.0}))
        slower = slow_to_possible(task.mesh.data, task.fastest_speed2)
        assert follow_between_nodes(task.mesh.data, slower).max_excess.share < 1e-9
