"""Power of a drive that is switched at will, and the pieces of its bound."""

import numpy as np
import pytest
from builders import INDUCTION, plain_scenario

from railjoule.core.drive.kernels import (
    power_when_on,
    smooth_power_when_on,
)
from railjoule.core.interior_point.switching import (
    hull_power,
    hull_with_standstill_brake,
)
from railjoule.core.physics.effort_limit import max_effort
from railjoule.core.strategies import prepare_task

TASK = prepare_task(plain_scenario({"vehicle.drive": INDUCTION, "vehicle.traction": {"max_speed_kmh": 72.0}}))
DATA = TASK.mesh.data
DRIVE = DATA.drive_kind, DATA.drive_parameters
SPEEDS = (0.4, 2.0, 5.0, 9.0, 13.0, 18.0)
SIDES = [(False, DATA.traction), (True, DATA.braking)]


def power(braking, effort, speed):
    return power_when_on(*DRIVE, braking, effort, speed)[0]


@pytest.mark.parametrize("speed", SPEEDS)
@pytest.mark.parametrize(("braking", "limit"), SIDES, ids=["driving", "braking"])
def test_the_hull_lies_below_all_mixtures_and_is_one(braking, limit, speed):
    """Against the least over a grid of shares: on for a share of the way with effort over share."""
    most = max_effort(limit, speed)
    for effort in np.array([0.02, 0.1, 0.3, 0.6, 0.9]) * most:
        shares = np.linspace(effort / most, 1, 2000)
        mixtures = [share * smooth_power_when_on(*DRIVE, braking, effort / share, speed)[0] for share in shares]
        hull, _ = hull_power(*DRIVE, braking, limit, effort, speed, 0.0)
        assert hull[0] == pytest.approx(min(mixtures), rel=1e-4, abs=1.0)
        assert hull[0] <= min(mixtures) + 1e-6 * abs(hull[0])


@pytest.mark.parametrize("speed", [0.5, 0.8, 1.2, 3.0])
def test_the_hull_with_a_standstill_brake_is_convex_and_no_power_is_drawn(speed):
    efforts = np.linspace(0, DATA.braking.constant_n, 200)
    values = np.array([hull_with_standstill_brake(*DRIVE, DATA.braking, x, speed, 0.0)[0][0] for x in efforts])
    assert np.all(values <= 1e-9)
    assert np.all(np.diff(values, 2) >= -1e-6 * max(-values.min(), 1))
    assert np.all(values <= np.minimum([power(True, max(x, 1e-3), speed) for x in efforts], 0.0) + 1e-6)
