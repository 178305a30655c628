"""The drive of a scenario: line power, losses, current for arrays."""

import numpy as np
import pytest
from builders import COPPER_LOSS, plain_scenario

from railjoule.core.drive import make_drive

DRIVES = {
    "constant efficiency": plain_scenario({"drive.braking_efficiency": 0.6}).vehicle.drive,
    "copper loss": plain_scenario({"vehicle.drive": COPPER_LOSS}).vehicle.drive,
}


def test_efficiencies():
    """1 MW at the wheels through 0.85, and back through 0.6, of which the line takes half."""
    drive = make_drive(DRIVES["constant efficiency"])
    power = drive.supply_power_w(np.array([1e5, -1e5]), np.array([10.0, 10.0]))
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
    assert drive.losses_w(np.array([1e5]), np.array([3.0]))["copper"] == pytest.approx([4 * 0.1 * 400.0**2])
    assert make_drive(DRIVES["constant efficiency"]).current_a(np.array([1e5]), np.array([3.0])) is None
