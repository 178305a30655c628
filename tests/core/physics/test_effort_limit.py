"""Limits of effort over speed: constant, power, curve."""

import numpy as np
import pytest
from builders import plain_scenario
from every_drive import train
from hypothesis import given
from hypothesis import strategies as st

from railjoule.core import ScenarioError
from railjoule.core.drive import make_drive
from railjoule.core.motion import build_meshed_line
from railjoule.core.physics.effort_limit import (
    FIT_SHARE,
    EffortLimit,
    effort_range,
    fitted_limit,
    limit_over_speed,
    max_effort,
)
from railjoule.core.physics.vehicle_limit import curve_effort_n

SPEEDS = np.linspace(0.5, 27, 300)
CURVE = [[0, 100], [40, 90], [60, 55], [100, 30]]


def limits(changes):
    data = build_meshed_line(plain_scenario(changes)).data
    return data.traction, data.braking


def test_constant_and_power():
    traction, braking = limits({"vehicle.braking.max_power_kw": 600})
    assert traction.effort_n(SPEEDS) == pytest.approx(np.minimum(100e3, 1e6 / SPEEDS))
    assert braking.effort_n(SPEEDS) == pytest.approx(np.minimum(80e3, 600e3 / SPEEDS))


def test_no_power_limit():
    traction, _ = limits({"vehicle.traction.max_power_kw": None})
    assert (traction.effort_n(SPEEDS) == 100e3).all()
    assert max_effort(traction, 20.0) == 100e3


def polygon(speeds):
    knots = np.array(CURVE)
    return np.interp(speeds * 3.6, knots[:, 0], knots[:, 1]) * 1e3


def assert_just_below(limit, true):
    """Never above, and closer than what a cubic may miss."""
    assert (limit <= true).all()
    assert limit == pytest.approx(true, abs=4 * FIT_SHARE * true.max())


def test_a_curve_is_followed():
    traction, _ = limits({"vehicle.traction.curve": CURVE, "vehicle.traction.max_power_kw": None})
    assert_just_below(traction.effort_n(SPEEDS), polygon(SPEEDS))


@pytest.mark.parametrize("curve", [CURVE, [[0, 40], [30, 40], [32, 70], [50, 20], [100, 60]]], ids=["falling", "any"])
@pytest.mark.parametrize("power_kw", [None, 900.0])
def test_the_efforts_over_a_range_lie_outside_of_the_limits_there(curve, power_kw):
    traction, _ = limits({"vehicle.traction.curve": curve, "vehicle.traction.max_power_kw": power_kw})
    for slow, fast in [(0.5, 27.0), (0.5, 8.5), (8.4, 8.8), (8.6, 8.6), (9.0, 14.0), (14.0, 27.0)]:
        true = traction.effort_n(np.linspace(slow, fast, 20_001))
        least, greatest = effort_range(traction, slow, fast)
        # over pieces of half a metre a second, a cubic's Bezier points exceed it by little
        assert 0.995 * true.min() <= least <= true.min()
        assert true.max() <= greatest <= 1.005 * true.max()


def test_curve_power_and_effort_hold_together():
    changes = {
        "vehicle.traction.curve": CURVE,
        "vehicle.traction.max_effort_kn": 80,
        "vehicle.traction.max_power_kw": 900,
    }
    traction, _ = limits(changes)
    lowest = np.minimum(np.minimum(polygon(SPEEDS), 80e3), 900e3 / SPEEDS)
    assert_just_below(traction.effort_n(SPEEDS), lowest)
    assert traction.effort_n(SPEEDS).max() == 80e3


def test_beyond_its_last_point_a_curve_goes_on_with_its_power():
    """100 kN at 60 km/h are 1667 kW; 200 kN up to 80 km/h would be 2222 kW at the top speed (review A4)."""
    curve = [[0, 200], [40, 200], [60, 100]]
    traction, _ = limits({"vehicle.traction.curve": curve, "vehicle.traction.max_power_kw": None})
    beyond = np.array([60, 70, 80, 99]) / 3.6
    assert traction.effort_n(beyond) * beyond == pytest.approx(100e3 * 60 / 3.6, rel=1e-5)
    assert curve_effort_n(tuple(map(tuple, curve)), np.array([0.0, 50 / 3.6, 120 / 3.6])) == pytest.approx(
        [200e3, 150e3, 50e3]
    )


@pytest.mark.parametrize("braking", [False, True], ids=["driving", "braking"])
@pytest.mark.parametrize("name", ["induction", "synchronous", "efficiency map"])
@pytest.mark.parametrize("power_kw", [None, 500.0])
def test_no_drive_is_asked_for_more_than_it_has(name, braking, power_kw):
    """At 5,000 speeds, corners of voltage, of power and of a map between them."""
    own = {"max_power_kw": power_kw, "max_effort_kn": None}
    scenario = train(
        name, **{f"vehicle.{table}.{key}": value for table in ("traction", "braking") for key, value in own.items()}
    )
    data, drive = build_meshed_line(scenario).data, make_drive(scenario.vehicle.drive)
    speeds = np.linspace(0.02, 70 / 3.6, 5000)
    true = np.minimum(drive.effort_limit_n(speeds, braking), np.inf if power_kw is None else 1e3 * power_kw / speeds)
    limit = data.braking if braking else data.traction
    assert (limit.effort_n(speeds) <= true * (1 + 1e-9)).all()
    assert limit.effort_n(speeds) == pytest.approx(true, abs=1e-5 * true.max())


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
    table = fitted_limit(100e3, lambda v: 100e3 / (1 + 0.01 * v**2), 27.0, np.zeros(0))
    for limit in (table, EffortLimit(100e3, 1e6)):
        _, slope, curvature = limit_over_speed(limit, speed)
        (high, high_slope, _), (low, low_slope, _) = (limit_over_speed(limit, speed + d) for d in (step, -step))
        assert slope == pytest.approx((high - low) / (2 * step), rel=1e-4, abs=1e-2)
        on_border = len(limit.table) > 0 and np.abs(speed - limit.table[:, 0]).min() < 2 * step  # curvature jumps there
        assert on_border or curvature == pytest.approx((high_slope - low_slope) / (2 * step), rel=1e-4, abs=1.0)


def test_beyond_the_table_its_last_piece_goes_on():
    table = fitted_limit(100e3, lambda v: 100e3 - 1e3 * v, 27.0, np.zeros(0))
    assert table.effort_n(np.array([30.0])) == pytest.approx([70e3])


@given(st.floats(1.0, 26.0), st.floats(-8e3, -100.0), st.floats(-8e3, -100.0))
def test_a_corner_that_nobody_told_is_found(corner, before, after):
    """The least of two straight limits that cross, or the polygon that bends upwards there."""

    def bent(v):
        return 5e5 + np.where(v < corner, before, after) * (v - corner)

    speeds = np.linspace(0.01, 27, 3000)
    table = fitted_limit(1e6, bent, 27.0, np.zeros(0))
    assert (table.effort_n(speeds) <= bent(speeds) * (1 + 1e-9)).all()
    assert table.effort_n(speeds) == pytest.approx(bent(speeds), abs=4 * FIT_SHARE * 1e6)


def test_what_lies_far_above_the_constant_limit_need_not_be_followed():
    """A power near rest: no piece is spent on it."""
    limit = fitted_limit(50e3, lambda v: 4e5 / np.maximum(v, 1e-3), 27.0, np.zeros(0))
    assert limit.effort_n(np.array([1e-4, 1.0, 7.9])).tolist() == [50e3] * 3
    assert len(limit.table) < 200
    assert limit.effort_n(np.array([20.0])) == pytest.approx([20e3], rel=1e-5)


def test_a_speed_that_is_no_number_leads_out_of_no_table():
    """Bellman's law holds none where there is no run; as an index it would be -2^31, far from the table."""
    table = fitted_limit(100e3, lambda v: 100e3 - 1e3 * v, 27.0, np.zeros(0))
    alone = table.effort_n(np.full(100, np.nan))
    assert not ((alone < 0) | (alone > 100e3)).any()


@pytest.mark.parametrize("changes", [{}, {"vehicle.traction.curve": CURVE, "vehicle.traction.max_power_kw": None}])
def test_a_lowered_limit_is_lower_at_every_speed(changes):
    traction, _ = limits(changes)
    assert traction.lowered(0.01).effort_n(SPEEDS) == pytest.approx(0.99 * traction.effort_n(SPEEDS), rel=1e-12)


def test_a_curve_of_the_electric_brake_is_followed_and_then_keeps_its_power():
    _, braking = limits({"vehicle.braking": {"curve": [[0, 0], [10, 60], [60, 60]]}})
    speeds = SPEEDS[SPEEDS < 60 / 3.6]
    # at rest a hundred-thousandth is left to the solver
    assert_just_below(braking.effort_n(speeds), 1e3 * np.interp(3.6 * speeds, [0, 10, 60], [60e-5, 60, 60]))
    assert braking.constant_n == 60e3
    beyond = np.array([70, 99]) / 3.6
    assert braking.effort_n(beyond) * beyond == pytest.approx(60e3 * 60 / 3.6, rel=1e-5)


@pytest.mark.parametrize("table", ["traction", "braking"])
@pytest.mark.parametrize(
    "curve", [[[0, 60], [30, 50], [60, 15], [90, 0]], [[0, 60], [60, 0], [90, 0]], [[0, 5], [10, 60], [80, 0], [90, 0]]]
)
def test_a_curve_may_end_at_no_effort(table, curve):
    """Nothing is divided by no effort, as a warning is an error here, and the table is as close as elsewhere."""
    changes = {"vehicle.traction.max_speed_kmh": 90.0, f"vehicle.{table}.curve": curve}
    changes |= {f"vehicle.{table}.max_effort_kn": None, f"vehicle.{table}.max_power_kw": None}
    limit = limits(changes)[0 if table == "traction" else 1]
    speeds = np.linspace(0.01, 24.9, 300)
    # where the curve has none, a hundred-thousandth of its 60 kN is left to the solver
    places, efforts = np.transpose(curve)
    assert_just_below(limit.effort_n(speeds), 1e3 * np.interp(3.6 * speeds, places, np.maximum(efforts, 60e-5)))


@pytest.mark.parametrize("table", ["traction", "braking"])
@pytest.mark.parametrize(
    ("own", "at_breakdown_kn"),
    [
        ({"max_effort_kn": 80.0, "max_power_kw": 1000.0}, 60.0),
        ({"max_effort_kn": 40.0, "max_power_kw": 1000.0}, 40.0),
        ({"curve": [[0, 90], [60, 45], [100, 40]]}, 45.0),
    ],
    ids=["beyond the corner", "before the corner", "curve"],
)
def test_beyond_the_breakdown_the_effort_falls_with_the_square_of_the_speed(table, own, at_breakdown_kn):
    """At 60 km/h, 1000 kW are 60 kN; at 90 km/h, 4/9 of the effort at 60 km/h is left."""
    changes = {"max_effort_kn": None, "breakdown_speed_kmh": 60.0, **own}
    more = {"max_speed_kmh": 100.0} if table == "traction" else {}
    both = limits({f"vehicle.{table}": {key: it for key, it in {**changes, **more}.items() if it is not None}})
    limit = both[table == "braking"]
    beyond = np.array([60.001, 75.0, 90.0, 100.0])
    assert limit.effort_n(beyond / 3.6) == pytest.approx(1e3 * at_breakdown_kn * (60 / beyond) ** 2, rel=2e-5)
    before = np.array([10.0, 30.0, 50.0])
    efforts = [min(own.get("max_effort_kn", 1e3), own.get("max_power_kw", 1e6) / (kmh / 3.6)) for kmh in before]
    if "curve" in own:
        efforts = np.interp(before, [0, 60, 100], [90, 45, 40])
    assert limit.effort_n(before / 3.6) == pytest.approx(1e3 * np.array(efforts), rel=2e-5)
