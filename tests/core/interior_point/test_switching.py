"""Power of a drive that is switched at will, and the pieces of its bound."""

import numpy as np
import pytest
from builders import INDUCTION, plain_scenario

from railjoule.core.drive import make_drive
from railjoule.core.drive.kernels import (
    idle_power,
    jumps_at_no_effort,
    power_when_on,
    shaft_force,
    smooth_power_when_on,
)
from railjoule.core.interior_point.layout import RAY_COUNT
from railjoule.core.interior_point.switching import (
    hull_power,
    hull_with_standstill_brake,
    keep_larger_curvature,
    tabulate_rays,
    tabulated_power,
    tangent,
)
from railjoule.core.interior_point.switching_bound import cheapest_effort, curve_bound
from railjoule.core.physics.effort_limit import largest_effort
from railjoule.core.strategies import prepare_task

TASK = prepare_task(plain_scenario({"vehicle.drive": INDUCTION, "vehicle.traction": {"max_speed_kmh": 72.0}}))
DATA = TASK.course.data
DRIVE = DATA.drive_kind, DATA.drive_parameters
SPEEDS = (0.4, 2.0, 5.0, 9.0, 13.0, 18.0)
SIDES = [(False, DATA.traction), (True, DATA.braking)]


def power(braking, effort, speed):
    return power_when_on(*DRIVE, braking, effort, speed)[0]


def test_the_jump_is_the_power_without_effort():
    for speed in SPEEDS:
        jump, by_speed, _ = idle_power(*DRIVE, speed)
        assert 0 < jump == pytest.approx(power(False, 1e-6, speed))
        assert by_speed == pytest.approx((idle_power(*DRIVE, speed + 1e-4)[0] - jump) / 1e-4, rel=1e-3)
    assert idle_power(1, np.array([1.0]), 5.0) == (0.0, 0.0, 0.0)
    assert [jumps_at_no_effort(kind) for kind in range(3)] == [False, False, True]


@pytest.mark.parametrize("speed", SPEEDS)
@pytest.mark.parametrize(("braking", "limit"), SIDES, ids=["driving", "braking"])
def test_power_when_on_is_convex_and_losses_do_not_fall_with_speed(braking, limit, speed):
    """What the bound takes for granted, sampled; driving, both follow from the formulas.

    Where it brakes without generating, near standstill, the loss may fall; what it draws there no bound counts.
    """
    most = 0.98 * largest_effort(limit, speed + 0.1)
    efforts = np.linspace(1e-3, most, 60)
    values = np.array([power(braking, effort, speed) for effort in efforts])
    assert np.all(np.diff(values, 2) > -1e-7 * np.abs(values).max())

    def losses(at):
        return np.array([power(braking, y, at) - shaft_force(*DRIVE, braking, y)[0] * at for y in efforts])

    generating = values < 0 if braking else np.ones(60, dtype=bool)
    assert np.all((losses(speed + 0.1) - losses(speed))[generating] >= -1e-9)


@pytest.mark.parametrize("speed", SPEEDS)
@pytest.mark.parametrize(("braking", "limit"), SIDES, ids=["driving", "braking"])
def test_smooth_power_is_near_and_never_more(braking, limit, speed):
    most = largest_effort(limit, speed)
    for effort in np.linspace(0.01, 0.97, 40) * most:
        smooth, true = smooth_power_when_on(*DRIVE, braking, effort, speed), power(braking, effort, speed)
        assert true - 1e-3 * abs(true) - 1 <= smooth[0] <= true + 1e-12 * abs(true) + 1e-6
        after, before = (smooth_power_when_on(*DRIVE, braking, effort + d, speed) for d in (1.0, -1.0))
        assert smooth[1] == pytest.approx((after[0] - before[0]) / 2, rel=1e-4, abs=1e-3)
        assert smooth[3] == pytest.approx((after[1] - before[1]) / 2, rel=1e-2, abs=1e-5)


@pytest.mark.parametrize("speed", SPEEDS)
@pytest.mark.parametrize(("braking", "limit"), SIDES, ids=["driving", "braking"])
def test_the_hull_lies_below_all_mixtures_and_is_one(braking, limit, speed):
    """Against the least over a grid of shares: on for a share of the way with effort over share."""
    most = largest_effort(limit, speed)
    for effort in np.array([0.02, 0.1, 0.3, 0.6, 0.9]) * most:
        shares = np.linspace(effort / most, 1, 2000)
        mixtures = [share * smooth_power_when_on(*DRIVE, braking, effort / share, speed)[0] for share in shares]
        hull, _ = hull_power(*DRIVE, braking, limit, effort, speed, 0.0)
        assert hull[0] == pytest.approx(min(mixtures), rel=1e-4, abs=1.0)
        assert hull[0] <= min(mixtures) + 1e-6 * abs(hull[0])


@pytest.mark.parametrize("speed", [0.5, 0.8, 1.2, 3.0])
def test_the_hull_with_a_standstill_brake_is_convex_and_no_power_is_drawn(speed):
    most = DATA.braking.constant_n
    efforts = np.linspace(0, most, 200)
    values = np.array([hull_with_standstill_brake(*DRIVE, DATA.braking, x, speed, 0.0)[0][0] for x in efforts])
    assert np.all(values <= 1e-9)
    assert np.all(np.diff(values, 2) >= -1e-6 * max(-values.min(), 1))
    true = np.minimum([power(True, max(x, 1e-3), speed) for x in efforts], 0.0)
    assert np.all(values <= true + 1e-6)


def test_a_tangent_touches():
    for speed in SPEEDS:
        effort, (p, p_f, *_) = tangent(*DRIVE, False, speed, 0.0, largest_effort(DATA.traction, speed), 0.0)
        assert effort * p_f == pytest.approx(p, rel=1e-4)


@pytest.mark.parametrize("price", [0.9, 1.1, 1.3, 2.0])
def test_the_cheapest_effort_is_a_bound_and_close(price):
    for speed in SPEEDS:
        most = largest_effort(DATA.traction, speed)
        grid = [power(False, y, speed) / speed - price * y for y in np.linspace(1e-3, most, 3000)]
        bound, _ = cheapest_effort(DATA, False, 1.0, price, speed, speed, most, 0.0, 1e-3)
        least = min(0.0, *grid)
        assert bound <= least + 1e-9
        assert bound == pytest.approx(least, rel=1e-4, abs=0.5)


def test_a_curve_lies_above_its_bound():
    rng = np.random.default_rng(0)
    for _ in range(300):
        square, linear, kappa = rng.normal(size=3) * [1, 10, 100]
        low = rng.uniform(0.1, 20)
        high = low * (1 + rng.uniform(0, 1) ** 4)
        v = np.linspace(low, high, 200)
        least = (square * v**2 + linear * v + kappa / v).min()
        assert curve_bound(square, linear, kappa, low, high) <= least + 1e-9 * (abs(least) + 1)


def test_the_larger_curvature_is_kept_for_one_iteration():
    curvature, last = np.zeros((9, 1)), np.zeros((6, 1))
    seen = []
    for value in (4.0, 1.0, 1.0, 2.0):
        curvature[0] = value
        keep_larger_curvature(curvature, last)
        seen.append(float(curvature[0, 0]))
    assert seen == [4.0, 4.0, 1.0, 2.0]


def test_the_drive_of_these_tests_is_an_induction_drive():
    assert make_drive(TASK.scenario.vehicle.drive).kind == DATA.drive_kind == 2


@pytest.mark.parametrize(("braking", "limit"), SIDES, ids=["driving", "braking"])
def test_tabulated_rays_are_those_of_the_hull(braking, limit):
    """Between the speeds of the table, the cubic through values and slopes is exact to 1e-5."""
    rays = np.empty((2, RAY_COUNT, 3))
    tabulate_rays(DATA, rays)
    for speed in np.linspace(1.0, 19.0, 37):
        effort = 0.05 * largest_effort(limit, speed)
        found, _ = tabulated_power(DATA, braking, rays[int(braking)], effort, speed)
        hull, _ = hull_power(*DRIVE, braking, limit, effort, speed, 0.0)
        assert found[:2] == pytest.approx(hull[:2], rel=1e-5)
        assert found[2] == pytest.approx(hull[2], rel=1e-3, abs=1e-2 * abs(hull[1]))
