"""Limits of effort over speed: constant, power, curve."""

import numpy as np
import pytest
from builders import plain_scenario
from hypothesis import given
from hypothesis import strategies as st

from railjoule.core import ScenarioError
from railjoule.core.motion import build_course
from railjoule.core.physics.effort_limit import (
    NO_TABLE,
    TABLE_STEP_MS,
    EffortLimit,
    largest_effort,
    limit_over_speed,
    table_speeds,
    tabulated_limit,
)

SPEEDS = np.linspace(0.5, 27, 300)
CURVE = [[0, 100], [40, 90], [60, 55], [100, 30]]


def limits(changes):
    data = build_course(plain_scenario(changes)).data
    return data.traction, data.braking


def test_constant_and_power():
    traction, braking = limits({"vehicle.braking.max_power_kw": 600})
    assert traction.effort_n(SPEEDS) == pytest.approx(np.minimum(100e3, 1e6 / SPEEDS))
    assert braking.effort_n(SPEEDS) == pytest.approx(np.minimum(80e3, 600e3 / SPEEDS))


def test_no_power_limit():
    traction, _ = limits({"vehicle.traction.max_power_kw": None})
    assert (traction.effort_n(SPEEDS) == 100e3).all()
    assert largest_effort(traction, 20.0) == 100e3


def test_a_curve_is_followed():
    """Shape-preserving cubics through samples of a polygon: off only at its corners, where they cut less than 0.5 %."""
    traction, _ = limits({"vehicle.traction.curve": CURVE, "vehicle.traction.max_power_kw": None})
    knots = np.array(CURVE)
    polygon = np.interp(SPEEDS * 3.6, knots[:, 0], knots[:, 1]) * 1e3
    effort = traction.effort_n(SPEEDS)
    assert effort == pytest.approx(polygon, rel=5e-3)
    off_corners = (np.abs(SPEEDS[:, None] * 3.6 - knots[:, 0]) > 3 * TABLE_STEP_MS * 3.6).all(axis=1)
    assert off_corners.sum() > 200
    assert effort[off_corners] == pytest.approx(polygon[off_corners], rel=1e-9)


def test_curve_power_and_effort_hold_together():
    changes = {
        "vehicle.traction.curve": CURVE,
        "vehicle.traction.max_effort_kn": 80,
        "vehicle.traction.max_power_kw": 900,
    }
    traction, _ = limits(changes)
    knots = np.array(CURVE)
    polygon = np.interp(SPEEDS * 3.6, knots[:, 0], knots[:, 1]) * 1e3
    lowest = np.minimum(np.minimum(polygon, 80e3), 900e3 / SPEEDS)
    assert traction.effort_n(SPEEDS) == pytest.approx(lowest, rel=5e-3)
    assert traction.effort_n(SPEEDS).max() == 80e3


def test_the_curves_greatest_effort_is_the_constant_limit():
    traction, _ = limits({"vehicle.traction.max_effort_kn": None, "vehicle.traction.curve": CURVE})
    assert traction.constant_n == 100e3


def test_a_train_without_electric_brake_keeps_a_trace_of_one():
    """The interior-point method needs an inside; a billionth of the tractive effort moves no energy that counts."""
    _, braking = limits({"vehicle.braking.max_effort_kn": 0, "vehicle.braking.friction_effort_kn": 90})
    assert 0 < braking.constant_n <= 1e-9 * 100e3


@pytest.mark.parametrize("table", ["traction", "braking"])
def test_a_missing_limit(table):
    with pytest.raises(ScenarioError) as error:
        limits({f"vehicle.{table}.max_effort_kn": None})
    assert str(error.value) == f"vehicle.{table}.max_effort_kn is missing: this drive sets no limit of effort."


@given(st.floats(0.2, 26.9))
def test_derivatives(speed):
    step = 1e-6 * speed
    table = tabulated_limit(100e3, 100e3 / (1 + 0.01 * table_speeds(27.0) ** 2))
    hyperbola = EffortLimit(100e3, 1e6, NO_TABLE, TABLE_STEP_MS)
    for limit in (table, hyperbola):
        _, slope, curvature = limit_over_speed(limit, speed)
        (high, high_slope, _), (low, low_slope, _) = (limit_over_speed(limit, speed + d) for d in (step, -step))
        assert slope == pytest.approx((high - low) / (2 * step), rel=1e-4, abs=1e-2)
        on_border = abs(speed / TABLE_STEP_MS - round(speed / TABLE_STEP_MS)) < 1e-5  # curvature jumps there
        assert on_border or curvature == pytest.approx((high_slope - low_slope) / (2 * step), rel=1e-4, abs=1.0)


def test_beyond_the_table_its_last_piece_goes_on():
    table = tabulated_limit(100e3, 100e3 - 1e3 * table_speeds(27.0))
    assert table.effort_n(np.array([30.0])) == pytest.approx([70e3])
