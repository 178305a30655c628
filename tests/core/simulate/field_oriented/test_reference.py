"""The reference of the closed loop against the plan that it rounds."""

import numpy as np
import pytest

from railjoule.core import load_scenario, solve
from railjoule.core.simulate.field_oriented.reference import PlannedMotion, make_reference

WINDOW_S = 0.2


@pytest.fixture(scope="module")
def plan():
    return solve(load_scenario("ftorek-300s", {"line.stations": [{"position_m": 2000, "dwell_s": 20}]}))


@pytest.fixture(scope="module")
def reference(plan):
    return make_reference(plan, WINDOW_S)


def test_it_begins_and_ends_at_rest_half_a_window_outside_the_plan(plan, reference):
    assert reference.time_s[0] == pytest.approx(-WINDOW_S / 2)
    assert reference.time_s[-1] >= plan.travel_time_s + WINDOW_S / 2 - 1e-9
    for values in (reference.speed_ms, reference.acceleration_ms2, reference.jerk_ms3):
        assert values[[0, -1]] == pytest.approx(0, abs=1e-7)
    assert reference.position_m[[0, -1]] == pytest.approx([0, 5000], abs=1e-7)


def test_each_is_the_derivative_of_the_one_before(reference):
    step = reference.step_s
    for values, derivative in (
        (reference.position_m, reference.speed_ms),
        (reference.speed_ms, reference.acceleration_ms2),
        (reference.acceleration_ms2, reference.jerk_ms3),
    ):
        difference = (values[2:] - values[:-2]) / (2 * step)
        # a derivative that is linear between corners: its difference misses by half of a step of its slope there
        largest_slope = np.abs(np.diff(derivative)).max() / step
        assert np.abs(difference - derivative[1:-1]).max() <= 0.6 * step * largest_slope


def test_nothing_rings(plan, reference):
    """A moving average never leaves the range of what it averages."""
    rise = np.diff(plan.speed_ms)[np.diff(plan.time_s) > 0] / np.diff(plan.time_s)[np.diff(plan.time_s) > 0]
    assert reference.speed_ms.min() >= -1e-7
    assert reference.speed_ms.max() <= plan.speed_ms.max() + 1e-7
    assert reference.acceleration_ms2.min() >= rise.min() - 1e-7
    assert reference.acceleration_ms2.max() <= rise.max() + 1e-7


def test_it_is_not_late(plan, reference):
    planned = PlannedMotion.of(plan).position_at(reference.time_s)
    # where acceleration jumps by a, two moving averages over h = 0.1 s each miss the place by at most a h^2 / 6
    jump = np.ptp(reference.acceleration_ms2)
    assert np.abs(reference.position_m - planned).max() <= jump * (WINDOW_S / 2) ** 2 / 6
    standing = (reference.position_m > 1999.999) & (reference.position_m < 2000.001)
    assert reference.step_s * np.count_nonzero(standing) == pytest.approx(20, abs=WINDOW_S)
