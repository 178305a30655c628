import numpy as np
import pytest
from builders import HILLS, plain_scenario

from railjoule.core.motion.cell_step import COAST, FULL_BRAKE, FULL_TRACTION, exit_speed2
from railjoule.core.physics.course_data import cell_of, train_of
from railjoule.core.strategies import prepare_task

HILLY = {"line.sections": HILLS, "vehicle.resistance.linear_n_per_kn_per_kmh": 0.02}


@pytest.mark.parametrize("entering_speed2", [0.0, 25.0, 300.0])
@pytest.mark.parametrize("cell", [0, 45, 100])
def test_a_control_leads_to_the_speed_that_its_force_gives(cell, entering_speed2):
    course = prepare_task(plain_scenario(HILLY)).course
    data = course.data
    limits = train_of(data), data.traction, data.braking
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
