"""Energy over a metre of the way: power over speed, its derivatives against differences, for every kind of drive."""

import pytest
from every_drive import DRIVES, train
from hypothesis import given
from hypothesis import strategies as st

from railjoule.core.drive import make_drive
from railjoule.core.drive.kernels import driving_power, generated_power
from railjoule.core.interior_point.cell import scaled_energy_per_metre
from railjoule.core.physics.energy_per_metre import energy_per_metre

SCALE_N = 7e4
MACHINES = {name: make_drive(train(name).vehicle.drive) for name in DRIVES}


def energy(name, braking, effort, speed):
    drive = MACHINES[name]
    power = (generated_power if braking else driving_power)(drive.kind, drive.parameters, effort, speed)
    return energy_per_metre(power, speed)


def test_by_hand():
    """P = 6 f v^2 + v at f = 2, v = 5 is 305 W: E = 6 f v + 1, E_f = 6 v, E_v = 6 f, E_fv = 6."""
    f, v = 2.0, 5.0
    power = 6 * f * v**2 + v, 6 * v**2, 12 * f * v + 1, 0.0, 12 * v, 12 * f
    assert energy_per_metre(power, v) == pytest.approx((61, 30, 12, 0, 6, 0), abs=1e-12)


@pytest.mark.parametrize("braking", [False, True], ids=["driving", "braking"])
@pytest.mark.parametrize("name", ["constant efficiency", "copper loss", "loss polynomial"])
@given(st.floats(1e3, 6e4), st.floats(1.0, 19.0))
def test_derivatives(name, braking, effort, speed):
    """Of drives whose formulas are smooth everywhere; others have corners and patches."""
    df, dv = 1e-3 * effort, 1e-4 * speed
    e, e_f, e_v, e_ff, e_fv, e_vv = energy(name, braking, effort, speed)
    more, less = (energy(name, braking, effort + sign * df, speed) for sign in (1, -1))
    faster, slower = (energy(name, braking, effort, speed + sign * dv) for sign in (1, -1))
    size = abs(e) + effort
    assert e_f == pytest.approx((more[0] - less[0]) / (2 * df), rel=1e-6, abs=1e-9 * size / df)
    assert e_v == pytest.approx((faster[0] - slower[0]) / (2 * dv), rel=1e-6, abs=1e-9 * size / dv)
    assert e_ff == pytest.approx((more[1] - less[1]) / (2 * df), rel=1e-6, abs=1e-9 / df)
    assert e_fv == pytest.approx((faster[1] - slower[1]) / (2 * dv), rel=1e-5, abs=1e-9 / dv)
    assert e_vv == pytest.approx((faster[2] - slower[2]) / (2 * dv), rel=1e-5, abs=1e-8 * size / dv)


@pytest.mark.parametrize("name", DRIVES)
@given(st.floats(1e3, 6e4), st.floats(1.0, 19.0))
def test_the_solver_scales_energies_and_efforts_alike(name, effort, speed):
    """A derivative by an effort over an energy is the same whatever both are scaled by."""
    drive = MACHINES[name]
    power = driving_power(drive.kind, drive.parameters, effort, speed)
    e, e_f, e_v, e_ff, e_fv, e_vv = energy_per_metre(power, speed)
    scaled = scaled_energy_per_metre(power, SCALE_N, speed)
    assert scaled == pytest.approx((e / SCALE_N, e_f, e_v / SCALE_N, e_ff * SCALE_N, e_fv, e_vv / SCALE_N), rel=1e-12)
