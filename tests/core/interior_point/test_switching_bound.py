"""The bound of one priced cell, against all that a run may do in it."""

import math

import numpy as np
import pytest
from every_drive import train

from railjoule.core.drive.kernels import power_when_on
from railjoule.core.interior_point.switching_bound import (
    BY_SPEED,
    COLUMNS,
    CONSTANT,
    END,
    LENGTH,
    PRICE,
    RETURNED,
    START,
    TIME,
    TOP_BRAKING,
    TOP_TRACTION,
    least_of_cell,
)
from railjoule.core.physics.effort_limit import largest_effort
from railjoule.core.strategies import prepare_task

COARSE = {"solver.mesh_m": 50.0, "timetable.travel_time_s": 900.0}
STANDING = "induction with a standstill brake"
# speeds at both ends of a cell [m/s]: least and greatest at the start, then at the end
WIDE = 2.0, 14.0, 2.0, 14.0


def task_of(drive, time_share=1.2, **changes):
    first = prepare_task(train(drive, 0.0, 1.0, **COARSE, **changes))
    time = {"timetable.travel_time_s": time_share * first.shortest_time_s}
    return prepare_task(train(drive, 0.0, 1.0, **{**COARSE, **changes, **time}))


def cost(task, cell, speeds, shares, efforts):
    """Return what a priced cell costs that shares its time between driving, electric braking and a standstill brake."""
    data, v = task.course.data, 0.5 * (speeds[0] + speeds[1])
    total = cell[START] * speeds[0] ** 2 + cell[END] * speeds[1] ** 2 + cell[CONSTANT]
    total += cell[TIME] / v + cell[BY_SPEED] * v
    for mode, (share, effort) in enumerate(zip(shares, efforts, strict=True)):
        force = share * effort * (1.0 if mode == 0 else -1.0)
        power = (
            share * power_when_on(data.drive_kind, data.drive_parameters, mode == 1, effort, v)[0] if mode < 2 else 0
        )
        total += cell[LENGTH] * ((cell[RETURNED] if mode == 1 else 1.0) * power / v - cell[PRICE] * force)
    return total


def limits(task, speeds):
    v, data = 0.5 * sum(speeds), task.course.data
    braking = largest_effort(data.braking, v)
    return np.array([largest_effort(data.traction, v), braking, braking])


def cell_with(price, time=2e5):
    cell = np.zeros(COLUMNS)
    cell[PRICE], cell[RETURNED], cell[LENGTH], cell[TIME] = price, 1.0, 50.0, time
    cell[START] = cell[END] = 400.0
    # no less than the limits of the train
    cell[TOP_TRACTION] = cell[TOP_BRAKING] = math.inf
    return cell


@pytest.mark.parametrize("box", [(0.3, 1.5, 0.3, 1.5), (3.0, 9.0, 3.0, 9.0)], ids=["near standstill", "on its way"])
@pytest.mark.parametrize("price", [-0.9, -0.4, 1.2, 1.6])
def test_no_mixture_of_modes_costs_less_than_the_bound_of_its_cell(price, box):
    """Random shares, efforts and speeds; what is left of the shares is coasting."""
    task, rng, cell = task_of(STANDING), np.random.default_rng(3), cell_with(price)
    bound, _ = least_of_cell(task.course.data, cell, box, 0.25 * sum(box), 1.0, 500)
    found = []
    for _ in range(400):
        speeds = rng.uniform(box[0], box[1]), rng.uniform(box[2], box[3])
        efforts = rng.uniform(1e-3, 1, 3) ** 0.5 * limits(task, speeds)
        found.append(cost(task, cell, speeds, rng.dirichlet(np.full(4, 0.4))[:3], efforts))
    assert min(found) >= bound
    # and no lower than it need be: one mode, at equal speeds at both ends, costs about as much
    modes = []
    for v in np.linspace(box[0], box[1], 100):
        for mode in range(4):
            most = limits(task, (v, v))
            modes += [cost(task, cell, (v, v), np.eye(4)[mode, :3], share * most) for share in np.linspace(0.02, 1, 50)]
    assert bound <= min(modes) < bound + 1e-2 * abs(bound)


def test_near_standstill_the_standstill_brake_is_the_cheapest():
    """So that the bounds above would be wrong without it."""
    task, cell, speeds = task_of(STANDING), cell_with(-0.9), (0.6, 0.6)
    most = limits(task, speeds)
    machines = [cost(task, cell, speeds, (0, 1, 0), share * most) for share in np.linspace(0.02, 1, 50)]
    assert cost(task, cell, speeds, (0, 0, 1), most) < min(machines) - 0.1 * cell[LENGTH] * most[2]


@pytest.mark.parametrize("price", [1.3, 1.8, 2.5])
@pytest.mark.parametrize("drive", ["loss polynomial", STANDING])
def test_the_bound_holds_where_a_limit_rises_with_speed(drive, price):
    """Over wide pieces, one of them with a curve that jumps up from 40 to 70 kN."""
    task = task_of(drive, **{"vehicle.traction.curve": [[0, 40], [30, 40], [32, 70], [70, 70]]})
    cell = cell_with(price)
    bound, _ = least_of_cell(task.course.data, cell, WIDE, 30.0, math.inf, 1)
    found = []
    for v in np.linspace(2.0, 14.0, 121):
        most = limits(task, (v, v))
        found += [cost(task, cell, (v, v), (1, 0, 0), share * most) for share in np.linspace(0.02, 1.0, 50)]
    assert bound <= min(found)
