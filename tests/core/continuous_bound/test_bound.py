"""A bound for every driving: its least Hamiltonians against grids, and whatever the prices, no run lies below it."""

from dataclasses import replace

import numpy as np
import pytest

from railjoule.core import load_scenario
from railjoule.core.bounds import minimise
from railjoule.core.continuous_bound.bound import continuous_bound, piece_shares, sum_of_ends, tabulate_drive
from railjoule.core.continuous_bound.drive_rows import rows_at
from railjoule.core.continuous_bound.hamiltonian import min_hamiltonian, strip_bends
from railjoule.core.continuous_bound.refinement import refined_optimum
from railjoule.core.physics.effort_limit import max_effort
from railjoule.core.physics.place_limits import NO_PLACE
from railjoule.core.scenario import scenario_from_document
from railjoule.core.strategies import prepare_task
from railjoule.core.units import J_PER_KWH
from tests.any_scenarios import any_wide_document
from tests.every_drive import DRIVES, train
from tests.interpreted import interpreted
from tests.random_scenarios import random_run

PLACES = 40
"""Random prices, limits and line forces for each drive."""


def brute_force(mesh, place, speeds, shares):
    """Return the least Hamiltonian over a grid of speeds and efforts [J/m], and the size of its terms there."""
    price, by_speed2, constant, linear, limit, price_of_time, powered = place
    v = np.append(speeds[speeds < limit], limit)[:, None]
    data = mesh.data
    driving, braking = (
        np.array([max_effort(side, float(speed)) for speed in v[:, 0]])[:, None] * shares
        for side in (data.traction, data.braking)
    )
    effort = np.hstack([driving, -braking]) * powered
    at = np.broadcast_to(v, effort.shape)
    power = mesh.drive.supply_power_w(effort.ravel(), at.ravel()).reshape(effort.shape)
    # a drive that is off takes nothing
    drive = np.where(effort == 0.0, 0.0, power / v) - price * effort
    friction = data.friction_effort_n * min(price, 0.0)
    rest = price * (constant + linear * v) + price_of_time / v + by_speed2 * v**2
    total = drive + friction + rest
    row, column = np.unravel_index(total.argmin(), total.shape)
    terms = abs(power[row, column] / v[row, 0]) + abs(price * effort[row, column]) - friction
    size = terms + abs(price) * (abs(constant) + linear * v[row, 0]) + price_of_time / v[row, 0]
    return total[row, column], size + abs(by_speed2) * v[row, 0] ** 2


@pytest.mark.parametrize("drive", DRIVES)
def test_the_least_hamiltonian_is_that_of_a_grid_from_below(drive):
    mesh = prepare_task(train(drive, 15.0)).mesh
    rows, rng = rows_at(tabulate_drive(mesh), NO_PLACE), np.random.default_rng(7)
    with interpreted():
        bend, fastest = strip_bends(rows.speed_ms), rows.speed_ms[-1]
    speeds = np.union1d(np.geomspace(0.01, fastest, 150), np.linspace(0.1, fastest, 300))
    shares = np.linspace(0.0, 1.0, 121) ** 1.5
    for number in range(PLACES):
        place = (
            rng.uniform(-0.5, 2.5),
            rng.normal(0.0, 30.0),
            rng.uniform(-15e3, 15e3),
            rng.uniform(0.0, 300.0),
            rng.uniform(0.3, 1.0) * fastest,
            10.0 ** rng.uniform(3.0, 5.5),
            # a quarter of them in a neutral section, where friction brakes are all there is
            number % 4 > 0,
        )
        with interpreted():
            found = min_hamiltonian(rows, bend, *place)
        least, size = brute_force(mesh, place, speeds, shares)
        assert found <= least + 1e-9 * size
        assert found >= least - 2e-3 * size


@pytest.fixture(scope="module", params=["liashenko-ii", "metro-with-limit", "ftorek-300s"])
def refined(request):
    return request.param, refined_optimum(prepare_task(load_scenario(request.param)))


# that no driving needs more than this was found by a prototype of its own: 2.22283, 7.81205 and 4.18040 kWh
PROVEN_KWH = {"liashenko-ii": 2.2227, "metro-with-limit": 7.811, "ftorek-300s": 4.179}


def test_what_is_proven_of_shipped_scenarios(refined):
    name, found = refined
    assert PROVEN_KWH[name] <= found.bound.energy_j / J_PER_KWH <= found.solution.energy_j / J_PER_KWH


def test_any_prices_prove_and_the_worse_they_are_the_less(refined):
    """Prices off by a share that is random at both ends of each cell, and a price of time off by as much."""
    _, found = refined
    mesh, pieces = found.task.mesh, found.bound.pieces
    rows, node = tabulate_drive(mesh), np.append(0.0, np.cumsum(mesh.data.cell_length_m))
    way = (np.array([pieces.position_m[:-1], pieces.position_m[1:]]) - node[pieces.cell]) / np.diff(node)[pieces.cell]
    for seed in range(2):
        ends = np.random.default_rng(seed).normal(size=(2, mesh.cell_count))
        off = ends[0, pieces.cell] * (1 - way) + ends[1, pieces.cell] * way
        proven = []
        for share in (0.0, 1e-3, 1e-2, 1e-1):
            change = share * off * np.abs(pieces.motion)
            wrong = pieces._replace(motion=pieces.motion + change, force=pieces.force + change)
            price = found.bound.price_of_time_w * (1 + share * ends[0, 0])
            shares = piece_shares(mesh, rows, wrong, price + mesh.data.auxiliary_power_w)
            proven.append(shares.sum() + sum_of_ends(mesh, wrong) - price * found.task.running_time_s)
        assert proven[0] == pytest.approx(found.bound.energy_j, rel=1e-9)
        assert proven == sorted(proven, reverse=True)
        assert proven[0] < found.solution.optimum.energy_j


@pytest.mark.parametrize("seed", [4, 9, 22])
def test_no_run_over_cells_an_eighth_as_long_lies_below_the_bound_of_a_coarse_mesh(seed):
    """Over its own mesh an optimum may: the account of a cell next to a stop is optimistic by up to a thousandth."""
    task = random_run(seed, stops=seed % 2 == 1).task
    bound = continuous_bound(task.mesh, minimise(task).optimum, task.running_time_s)
    node = task.mesh.position_m
    eighths = np.append((node[:-1, None] + np.diff(node)[:, None] * np.arange(8) / 8).ravel(), node[-1])
    fine = replace(prepare_task(task.scenario, *task.end_speeds_ms, eighths), running_time_s=task.running_time_s)
    assert minimise(fine).optimum.energy_j > bound.energy_j


@pytest.mark.parametrize("seed", [10, 766])
def test_efforts_that_a_machine_cannot_reach_leave_no_hole_in_the_table(seed):
    """At the greatest speed the line above a limit passed the pull-out: the bound was NaN, `optimal` a traceback."""
    task = prepare_task(scenario_from_document(any_wide_document(seed)))
    assert np.all(np.isfinite(tabulate_drive(task.mesh).least))
