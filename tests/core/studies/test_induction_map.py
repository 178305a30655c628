import numpy as np
import pytest

from railjoule.core import ScenarioError, load_scenario
from railjoule.core.simulation.field_oriented import simulate_field_oriented
from railjoule.core.studies.motor_map import induction_map, machine_points

SCENARIO = load_scenario("ftorek-300s", {"strategy": "enoc", "enoc.acceleration_time_s": 62.713})


@pytest.fixture(scope="module")
def found():
    return induction_map(SCENARIO)


def test_a_run_works_within_the_map(found):
    points = machine_points(simulate_field_oriented(SCENARIO))
    rows = np.searchsorted(found.torque_nm, points.torque_nm) - 1
    assert np.all(np.isfinite(found.drive[rows, np.searchsorted(found.speed_rads, points.speed_rads) - 1]))
    # findings: 196.2 A at 7.6 N m/A
    assert points.torque_nm.max() == pytest.approx(196.2 * 7.6, rel=2e-3)


def test_less_flux_is_nowhere_worse(found):
    least = induction_map(SCENARIO.replace(**{"simulation.flux": "min_loss"}))
    both = np.isfinite(found.drive) & np.isfinite(least.drive)
    assert np.all(least.drive[both] >= found.drive[both] - 1e-9)
    light = np.argmin(np.abs(found.torque_nm - 200.0))
    assert np.nanmax(least.drive[light] - found.drive[light]) > 0.01


def test_a_lower_line_voltage_takes_a_part_of_it(found):
    less = induction_map(SCENARIO.replace(**{"disturbance.line_voltage_factor": 0.4}))
    top = less.speed_rads > 0.9 * less.speed_rads[-1]
    assert np.count_nonzero(np.isfinite(less.drive[:, top])) < np.count_nonzero(np.isfinite(found.drive[:, top]))


def test_a_drive_without_a_machine_has_none():
    with pytest.raises(ScenarioError, match="has no induction machine"):
        induction_map(load_scenario("liashenko-ii"))
