"""The parts of the lower bound: each must lie below what it stands for."""

import numpy as np
import pytest
from builders import COPPER_LOSS, HILLS, plain_scenario
from hypothesis import given
from hypothesis import strategies as st
from random_scenarios import random_run, random_speeds
from scipy.interpolate import PchipInterpolator

from railjoule.core.bounds import minimise
from railjoule.core.interior_point.certificate import (
    cell_minimum,
    energy_tangents,
    fastest_of_better_runs,
    node_prices,
    price_cells,
    table_majorant,
    tangent_minimum,
    usable_prices,
)
from railjoule.core.physics.effort_limit import limit_over_speed, tabulated_limit
from railjoule.core.strategies import prepare_task
from railjoule.core.trajectory import make_trajectory

CASES = {
    "constant efficiency": {"drive.recuperation_factor": 1.0},
    "copper loss": {"vehicle.drive": COPPER_LOSS},
    "effort curve": {"vehicle.traction.curve": [[0, 100], [30, 95], [60, 55], [100, 30]]},
    "friction brakes": {"vehicle.braking.friction_effort_kn": 40.0, "vehicle.braking.max_power_kw": 500.0},
    "limits of acceleration": {
        "vehicle.traction.max_acceleration_ms2": 0.5,
        "vehicle.braking.max_deceleration_ms2": 0.3,
        "vehicle.auxiliary_power_kw": 80.0,
    },
}
seeds = st.integers(0, 10**6)


@pytest.fixture(scope="module", params=CASES)
def task(request):
    changes = {"line.sections": HILLS, "timetable.travel_time_s": 200.0, **CASES[request.param]}
    return prepare_task(plain_scenario(changes))


@pytest.fixture(scope="module")
def optimum(task):
    return minimise(task).optimum


def priced_cells(task, optimum, speed2):
    """Return what each cell of a run costs: line energy, priced time, and the prices of its two nodes."""
    data = task.course.data
    time, over = usable_prices(data, optimum)
    node = node_prices(data, optimum, time + data.auxiliary_power_w, over, energy_tangents(data, optimum))
    run = make_trajectory(task.scenario, task.course, "any", speed2)
    cost = np.diff(run.line_energy_j) + time * np.diff(run.time_s)
    return cost + node[:-1] * speed2[:-1] - node[1:] * speed2[1:]


def cell_minima(task, optimum, speed2):
    """Return the lower bounds of the cells at the very speeds of a run."""
    data, v = task.course.data, np.sqrt(speed2)
    cells, _, _ = price_cells(data, optimum)
    boxes = zip(cells, v, v, v[1:], v[1:], strict=False)
    return np.array([cell_minimum(cell, data.traction, data.braking, *box) for cell, *box in boxes])


@given(seed=seeds)
def test_no_feasible_cell_costs_less_than_its_minimum(task, optimum, seed):
    speed2 = random_speeds(task, seed)
    # the multipliers are off by the solver's tolerance, 1e-7 of the energy
    assert np.all(cell_minima(task, optimum, speed2) <= priced_cells(task, optimum, speed2) + 1e-7 * optimum.energy_j)


def test_at_the_optimum_minima_are_what_the_cells_cost(task, optimum):
    least, cost = cell_minima(task, optimum, optimum.speed2), priced_cells(task, optimum, optimum.speed2)
    assert np.sum(cost - least) == pytest.approx(0, abs=1e-6 * optimum.energy_j)


@given(seed=seeds)
def test_a_smaller_box_has_no_smaller_minimum(task, optimum, seed):
    """Nor does the tangent plane at a point of a box lie above the minimum over it."""
    data = task.course.data
    rounding = 1e-12 * data.traction.constant_n
    cells, _, _ = price_cells(data, optimum)
    rng, fastest = np.random.default_rng(seed), np.sqrt(task.greatest_speed2)
    for i in rng.integers(1, len(cells) - 1, 20):
        low0, v0, high0 = np.sort(rng.uniform(0.1, fastest[i], 3))
        low1, v1, high1 = np.sort(rng.uniform(0.1, fastest[i + 1], 3))
        boxes = (low0, high0, low1, high1), (low0, v0, v1, high1), (v0, v0, v1, v1)
        large, small, point = (cell_minimum(cells[i], data.traction, data.braking, *box) for box in boxes)
        # infinite where no force fits
        assert large <= small + rounding
        assert small <= point + rounding
        if len(data.traction.table) == 0:
            assert tangent_minimum(cells[i], v0, v1, *boxes[0])[1] <= large + rounding


@given(seeds, st.floats(0, 20), st.floats(0.1, 10), st.floats(0, 1))
def test_a_parabola_lies_above_its_table(seed, low, width, share):
    """Of pieces of any length with any cubic that joins their ends."""
    rng = np.random.default_rng(seed)
    begins = np.append(0.0, np.cumsum(rng.uniform(0.01, 0.5, 150)))
    efforts = rng.uniform(2e4, 1e5, len(begins))
    efforts = np.sort(efforts)[::-1] if seed % 2 else efforts
    curve = PchipInterpolator(begins, efforts)
    limit = tabulated_limit(1e5, np.column_stack([begins[:-1], curve.c[::-1].T]))
    high, v = low + width, low + share * width
    value, slope, half = table_majorant(limit, v, low, high)
    speeds = np.linspace(low, high, 997)
    parabola = value + (slope + half * (speeds - v)) * (speeds - v)
    table = np.array([limit_over_speed(limit, speed)[0] for speed in speeds])
    assert np.all(parabola >= table - 1e-9 * 1e5)


@given(seeds)
def test_no_run_of_less_energy_is_faster(seed):
    """Against random runs, whose own energy is the one not to be exceeded."""
    task = random_run(seed, stops=seed % 2 == 1).task
    speed2 = random_speeds(task, seed)
    energy = make_trajectory(task.scenario, task.course, "any", speed2).energy.net_j
    slow = minimise(task).optimum._replace(energy_j=energy)
    fastest = fastest_of_better_runs(task.course.data, slow, task.greatest_speed2, task.running_time_s)
    assert np.all(np.sqrt(speed2) <= fastest * (1 + 1e-9))
