"""The envelope of a map's power: nowhere above it, convex in effort, and the power itself where that is convex."""

import numpy as np
import pytest
from every_drive import DRIVES, train
from scipy.spatial import ConvexHull

from railjoule.core.drive.kernels import may_be_concave, power_when_on
from railjoule.core.interior_point.envelope import envelope_power, envelope_steps, lower_hull, tabulate_envelope
from railjoule.core.interior_point.layout import ENVELOPE_EFFORTS, RAY_COUNT
from railjoule.core.physics.effort_limit import max_effort
from railjoule.core.strategies import prepare_task

ROUNDING = 2e-6
"""By which share of the largest power the cubics between the nodes of the table may pass the power: see `layout`."""
MAPS = ("efficiency map", "synchronous")


@pytest.fixture(scope="module", params=MAPS)
def case(request):
    """Return the meshed line of a drive with a map, and its envelopes."""
    data = prepare_task(train(request.param)).mesh.data
    table = np.empty((2, RAY_COUNT, ENVELOPE_EFFORTS, 4))
    tabulate_envelope(data, table)
    return request.param, data, table


def points(data, braking, count, seed=0):
    """Yield random efforts up to their limit at random speeds."""
    rng, limit = np.random.default_rng(seed), data.braking if braking else data.traction
    for speed in rng.uniform(0.3, 0.97 * np.sqrt(data.limit_speed2.max()), count):
        yield rng.uniform(0.01, 0.99) * max_effort(limit, speed), speed


def power(data, braking, effort, speed):
    return power_when_on(data.drive_kind, data.drive_parameters, braking, effort, speed)[0]


def max_power(data, braking):
    return max(abs(power(data, braking, *point)) for point in points(data, braking, 50, seed=1))


@pytest.mark.parametrize("braking", [False, True])
def test_it_is_nowhere_above_the_power_nor_above_none_at_no_effort(case, braking):
    _, data, table = case
    allowed = ROUNDING * max_power(data, braking)
    for effort, speed in points(data, braking, 3000):
        assert (
            envelope_power(data, table[int(braking)], effort, speed)[0] <= power(data, braking, effort, speed) + allowed
        )
        assert envelope_power(data, table[int(braking)], 0.0, speed)[0] == 0.0


@pytest.mark.parametrize("braking", [False, True])
def test_it_is_convex_in_effort_at_the_speeds_of_the_table(case, braking):
    _, data, table = case
    step, speed_step = envelope_steps(data)
    allowed = ROUNDING * max_power(data, braking)
    for k in range(5, RAY_COUNT - 1, 7):
        limit = max_effort(data.braking if braking else data.traction, k * speed_step)
        assert np.all(np.diff(table[int(braking), k, : int(limit / step) + 1, 0], 2) >= -allowed)


@pytest.mark.parametrize("braking", [False, True])
def test_it_is_the_hull_of_off_and_on_where_losses_do_not_fall_with_speed(case, braking):
    """Against the hull of 2,000 samples; of a map whose losses fall with speed it is lower, by a hundredth at most."""
    name, data, table = case
    largest = max_power(data, braking)
    for _, speed in points(data, braking, 12):
        most = max_effort(data.braking if braking else data.traction, speed)
        efforts = np.linspace(0.0, most, 2000)
        values = np.array([0.0, *(power(data, braking, y, speed) for y in efforts[1:])])
        numbers = np.empty(2000, dtype=np.int64)
        corners = numbers[: lower_hull(efforts, values, 2000, numbers)]
        asked = np.linspace(0.02, 0.98, 25) * most
        hull = np.interp(asked, efforts[corners], values[corners])
        found = np.array([envelope_power(data, table[int(braking)], y, speed)[0] for y in asked])
        lowered = 0.0 if name == "efficiency map" else 0.01
        # two samples around the point of contact lie a little above it
        assert np.all(found <= hull + 3 * ROUNDING * largest)
        assert np.all(found >= hull - lowered * np.abs(hull) - 3 * ROUNDING * largest)


@pytest.mark.parametrize("braking", [False, True])
def test_derivatives_against_differences(case, braking):
    _, data, table = case
    side, step, speed_step = table[int(braking)], *envelope_steps(data)
    for effort, speed in points(data, braking, 200):
        found, df, dv = envelope_power(data, side, effort, speed), 1e-4 * step, 1e-4 * speed_step
        by_effort = [envelope_power(data, side, effort + d, speed) for d in (df, -df)]
        by_speed = [envelope_power(data, side, effort, speed + d) for d in (dv, -dv)]
        assert found[1] == pytest.approx((by_effort[0][0] - by_effort[1][0]) / (2 * df), rel=1e-3, abs=1e-2)
        assert found[2] == pytest.approx(
            (by_speed[0][0] - by_speed[1][0]) / (2 * dv), rel=1e-3, abs=1e-3 * abs(found[0])
        )
        # second ones jump from step to step
        if int((effort + df) / step) == int((effort - df) / step):
            assert found[3] == pytest.approx((by_effort[0][1] - by_effort[1][1]) / (2 * df), rel=1e-2, abs=1e-5)
            assert found[4] == pytest.approx((by_effort[0][2] - by_effort[1][2]) / (2 * df), rel=1e-2, abs=1e-3)
        if int((speed + dv) / speed_step) == int((speed - dv) / speed_step):
            scale = abs(found[0]) + 1e3
            assert found[5] == pytest.approx((by_speed[0][2] - by_speed[1][2]) / (2 * dv), rel=1e-2, abs=1e-3 * scale)


def test_the_hull_against_that_of_scipy():
    rng = np.random.default_rng(3)
    for _ in range(50):
        x, y = np.sort(rng.uniform(size=30)), rng.normal(size=30)
        numbers = np.empty(30, dtype=np.int64)
        found = numbers[: lower_hull(x, y, 30, numbers)]
        outer = ConvexHull(np.column_stack([x, y])).vertices
        along = y[0] + (y[-1] - y[0]) * (x - x[0]) / (x[-1] - x[0])
        assert found.tolist() == sorted(i for i in outer if i in (0, 29) or y[i] < along[i])


def test_maps_alone_have_one():
    kinds = {name: prepare_task(train(name)).mesh.data.drive_kind for name in DRIVES}
    assert {name for name, kind in kinds.items() if may_be_concave(kind)} == set(MAPS)
