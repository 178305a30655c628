"""The drive of a scenario: line power, losses, current for arrays."""

import numpy as np
import pytest
from builders import COPPER_LOSS, plain_scenario
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from railjoule.core.drive import make_drive

DRIVES = {
    "constant efficiency": plain_scenario({"drive.braking_efficiency": 0.6}).vehicle.drive,
    "copper loss": plain_scenario({"vehicle.drive": COPPER_LOSS}).vehicle.drive,
}
efforts = arrays(float, 5, elements=st.floats(-1e5, 1e5))
speeds = arrays(float, 5, elements=st.floats(0, 50))


@pytest.mark.parametrize("name", DRIVES)
@given(effort=efforts, speed=speeds, share=st.floats(0, 1))
def test_line_power_is_wheel_power_plus_losses(name, effort, speed, share):
    drive = make_drive(DRIVES[name].model_copy(update={"recuperation_factor": share}))
    losses = sum(drive.losses_w(effort, speed).values())
    assert np.allclose(drive.line_power_w(effort, speed), effort * speed + losses, rtol=1e-12, atol=1e-6)
    for loss in drive.losses_w(effort, speed).values():
        assert (loss >= -1e-6).all()


@pytest.mark.parametrize("name", DRIVES)
@given(effort=efforts, speed=speeds)
def test_the_line_takes_its_share_of_what_is_generated(name, effort, speed):
    drive = make_drive(DRIVES[name].model_copy(update={"recuperation_factor": 0.3}))
    electrical = drive.electrical_power_w(effort, speed)
    expected = np.where(electrical < 0, 0.3 * electrical, electrical)
    assert np.array_equal(drive.line_power_w(effort, speed), expected)


def test_arrays_broadcast():
    drive = make_drive(DRIVES["copper loss"])
    grid = drive.line_power_w(np.array([[1e4], [-1e4]]), np.array([1.0, 10.0, 20.0]))
    assert grid.shape == (2, 3)
    assert grid[1, 2] == drive.line_power_w(np.array([-1e4]), np.array([20.0]))[0]


def test_efficiencies():
    """1 MW at the wheels through 0.85, and back through 0.6, of which the line takes half."""
    drive = make_drive(DRIVES["constant efficiency"])
    power = drive.line_power_w(np.array([1e5, -1e5]), np.array([10.0, 10.0]))
    assert power == pytest.approx([1e6 / 0.85, -0.5 * 0.6e6])
    assert drive.losses_w(np.array([-1e5]), np.array([10.0])) == {
        "drive": pytest.approx([0.4e6]),
        "brake_resistors": pytest.approx([0.3e6]),
    }


def test_braking_efficiency_is_that_of_traction_where_absent():
    drive = make_drive(plain_scenario().vehicle.drive)
    assert drive.electrical_power_w(np.array([-1e5]), np.array([10.0])) == pytest.approx([-0.85e6])


def test_current_of_one_motor():
    """One of four motors: i = F r / (n k u) = 1e5 * 0.4 / (4 * 5 * 5)."""
    drive = make_drive(DRIVES["copper loss"])
    assert drive.current_a(np.array([1e5, -5e4]), np.array([3.0, 3.0])) == pytest.approx([400.0, -200.0])
    loss = drive.losses_w(np.array([1e5]), np.array([3.0]))["copper"]
    assert loss == pytest.approx([4 * 0.1 * 400.0**2])
    assert make_drive(DRIVES["constant efficiency"]).current_a(np.array([1e5]), np.array([3.0])) is None


@pytest.mark.parametrize("name", DRIVES)
def test_neither_drive_limits_its_effort(name):
    drive = make_drive(DRIVES[name])
    assert np.isinf(drive.effort_limit_n(np.array([0.0, 10.0]))).all()
    assert np.isinf(drive.effort_limit_n(np.array([0.0, 10.0]), braking=True)).all()
