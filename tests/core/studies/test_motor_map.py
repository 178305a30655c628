"""Maps of drives that differ in what they know, and the points of a run on them."""

import numpy as np
import pytest
from builders import plain_scenario

from railjoule.core import ScenarioError, load_scenario, solve
from railjoule.core.studies.motor_map import motor_map, operating_points

GEAR = {"motors": 4, "gear_ratio": 5.0, "wheel_diameter_m": 0.8, "gear_loss_share": 0.02}
POLYNOMIAL = {
    "vehicle.drive": {
        "model": "loss_polynomial",
        "no_load_loss_w": 800.0,
        "torque_loss_w_per_nm2": 0.002,
        "recuperation_factor": 1.0,
        **GEAR,
    }
}


def test_a_polynomial_s_map_by_hand():
    """A shaft of torque M and speed w gives M w and loses 800 + 0.002 M^2 watts: M w / (M w + loss) in driving."""
    found = motor_map(plain_scenario(POLYNOMIAL))
    shaft = found.torque_nm[:, None] * found.speed_rads[None, :]
    loss = np.broadcast_to(800 + 0.002 * found.torque_nm[:, None] ** 2, shaft.shape)
    driving, braking = np.isfinite(found.drive) & (shaft > 0), np.isfinite(found.drive) & (shaft < 0)
    assert found.drive[driving] == pytest.approx(shaft[driving] / (shaft + loss)[driving], rel=1e-9)
    given_back = np.maximum(-shaft - loss, 0.0)[braking]
    assert found.drive[braking] == pytest.approx(given_back / -shaft[braking], abs=1e-9)
    assert found.motor is None
    # the vehicle's 1000 kW and 100 kN at the wheels, by 4 motors with 12.5 turns a metre and 2 % lost in the gear
    assert found.torque_nm[-1] == pytest.approx(100e3 * 1.02 / 50)
    assert shaft[driving].max() == pytest.approx(1000e3 * 1.02 / 4, rel=0.03)


@pytest.mark.parametrize("changes", [POLYNOMIAL, None])
def test_the_points_of_a_run_carry_its_energy(changes):
    """Motors' shafts with the losses of the gears give back the power of the wheels; turns give back the speed."""
    scenario = plain_scenario(changes) if changes else load_scenario("kharkiv-like-40kmh")
    run = solve(scenario, "fastest")
    drive, points = scenario.vehicle.drive, operating_points(run)
    speed = np.diff(run.position_m) / np.diff(run.time_s)
    wheel = (run.tractive_effort_n - run.electric_braking_n) * speed
    wheel = wheel[wheel != 0]
    share = np.where(wheel > 0, 1 + drive.gear_loss_share, 1 - drive.gear_loss_share)
    assert points.torque_nm * points.speed_rads * drive.motors == pytest.approx(wheel * share, rel=1e-9)
    assert points.speed_rads.max() == pytest.approx(speed.max() * drive.gear_ratio / (drive.wheel_diameter_m / 2))


def test_the_points_of_a_run_lie_on_its_map():
    scenario = load_scenario("kharkiv-like-40kmh")
    found, points = motor_map(scenario), operating_points(solve(scenario, "fastest"))
    both = np.isfinite(found.motor) & np.isfinite(found.drive)
    assert np.all(found.drive[both] <= found.motor[both])
    assert found.torque_nm[0] < points.torque_nm.min() < points.torque_nm.max() < found.torque_nm[-1]
    assert points.speed_rads.max() <= found.speed_rads[-1] * (1 + 1e-9)


def test_a_drive_without_motors_has_no_map():
    scenario = load_scenario("liashenko-ii")
    with pytest.raises(ScenarioError, match="there is no efficiency map"):
        motor_map(scenario)
    with pytest.raises(ScenarioError, match="there is no efficiency map"):
        operating_points(solve(scenario, "fastest"))
