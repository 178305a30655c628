import numpy as np
import pytest
from builders import COPPER_LOSS, HILLS, plain_scenario

from railjoule.core.motion.cell_step import COAST, FULL_BRAKE, FULL_TRACTION, cell_cost, cell_of, exit_speed2
from railjoule.core.strategies import prepare_task, run_strategy

HILLY = {"line.sections": HILLS, "vehicle.resistance.linear_n_per_kn_per_kmh": 0.02}


@pytest.mark.parametrize("entering_speed2", [0.0, 25.0, 300.0])
@pytest.mark.parametrize("cell", [0, 45, 100])
def test_a_control_leads_to_the_speed_that_its_force_gives(cell, entering_speed2):
    course = prepare_task(plain_scenario(HILLY)).course
    data = course.data
    limits = data.traction.table, data.braking.table, data.traction.table_step_ms
    for control in (FULL_TRACTION, COAST, FULL_BRAKE):
        after = exit_speed2(cell_of(data, cell), *limits, entering_speed2, control)
        if after <= 0:
            continue
        speed2 = np.full(course.cell_count + 1, entering_speed2)
        speed2[cell + 1] = after
        mean = 0.5 * (np.sqrt(entering_speed2) + np.sqrt(after))
        wanted = {
            FULL_TRACTION: data.traction.effort_n(mean),
            COAST: 0.0,
            FULL_BRAKE: -data.braking.effort_n(mean),
        }[control]
        assert course.net_force_n(speed2)[cell] == pytest.approx(wanted, abs=1e-4)


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"vehicle.drive": COPPER_LOSS},
        {"vehicle.braking.max_effort_kn": 10.0, "vehicle.braking.friction_effort_kn": 90.0},
    ],
)
def test_the_cells_of_a_run_cost_what_its_account_says(changes):
    task = prepare_task(plain_scenario({**HILLY, **changes}))
    run, data = run_strategy(task, "fastest"), task.course.data
    limits = data.traction.table, data.braking.table, data.traction.table_step_ms
    steps = [
        cell_cost(
            cell_of(data, i), *limits, data.drive_parameters, task.greatest_speed2[i], task.greatest_speed2[i + 1]
        )
        for i in range(task.course.cell_count)
    ]
    assert all(allowed for _, _, allowed in steps)
    assert sum(energy for energy, _, _ in steps) == pytest.approx(run.energy.net_j, rel=1e-9)
    assert sum(time for _, time, _ in steps) == pytest.approx(run.travel_time_s, rel=1e-12)
