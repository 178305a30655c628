"""The run forward that a cost to go asks for."""

import numpy as np
import pytest
from every_drive import train

from railjoule.core.dynamic_programming.backward import least_speeds, speed_grid, sweep_back, tabulate_steps
from railjoule.core.dynamic_programming.rollout import likely_points, roll_out
from railjoule.core.motion import running_time
from railjoule.core.physics.account import run_energy
from railjoule.core.strategies import prepare_task

PRICE_W, POINTS = 5e4, 96


@pytest.fixture(scope="module", params=["loss polynomial", "induction"])
def swept(request):
    """A course, a grid over all its speeds with its steps, and what a sweep back finds at a price."""
    task = prepare_task(train(request.param, 15.0, **{"timetable.travel_time_s": 100.0}))
    data, greatest2 = task.course.data, task.greatest_speed2
    bounds, greatest = (greatest2, least_speeds(data, greatest2), data.fixed_speed2), np.sqrt(greatest2)
    grid = speed_grid(*bounds, 0.5 * greatest, greatest.max(), POINTS)
    steps = tabulate_steps(data, grid)
    return data, grid, steps, *sweep_back(steps, grid, PRICE_W)


def test_a_run_takes_about_the_cost_and_the_time_that_its_sweep_tells(swept):
    data, grid, steps, cost, best, time_s = swept
    run = roll_out(data, grid, steps, cost, best, PRICE_W, 4)
    taken = running_time(data.cell_length_m, run)
    assert taken == pytest.approx(time_s[0, 0], rel=0.03)
    assert run_energy(data, run) + PRICE_W * taken == pytest.approx(cost[0, 0], rel=0.01)


def test_looking_near_the_best_steps_finds_what_looking_everywhere_finds(swept):
    data, grid, steps, cost, best, _ = swept
    # without best steps nothing tells where to look
    nowhere = np.full_like(best, -1)
    totals = []
    for steps_known in (best, nowhere):
        run = roll_out(data, grid, steps, cost, steps_known, PRICE_W, 4)
        totals.append(run_energy(data, run) + PRICE_W * running_time(data.cell_length_m, run))
    assert totals[0] == pytest.approx(totals[1], rel=1e-3)


def test_likely_points_enclose_where_both_neighbours_lead(swept):
    _, grid, steps, _, best, _ = swept
    node = grid.shape[0] // 2
    between = 0.5 * (grid[node, 40] + grid[node, 41])
    least, most = likely_points(steps, best[node], grid[node], between)
    for neighbour in (40, 41):
        lower = steps.lower[best[node, neighbour]]
        assert least <= lower
        assert lower + 1 <= most
    assert likely_points(steps, np.full_like(best[node], -1), grid[node], between) == (0, POINTS - 1)
