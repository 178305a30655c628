"""How the electric brake and friction brakes share an effort, for every kind of drive."""

import numpy as np
import pytest
from every_drive import DRIVES, train
from hypothesis import given
from hypothesis import strategies as st

from railjoule.core.drive import make_drive
from railjoule.core.drive.kernels import generated_power
from railjoule.core.physics.braking import electric_effort, electric_efforts

STRONGEST = 45e3
"""Of the electric brake at any speed here [N]."""
MACHINES = {name: make_drive(train(name).vehicle.drive) for name in DRIVES}
efforts = st.floats(100.0, 60e3)
speeds = st.one_of(st.floats(0.05, 3.0), st.floats(3.0, 19.0))


def generated(drive, effort, speed):
    return generated_power(drive.kind, drive.parameters, effort, speed)[0]


def share_of(drive, braking, speed, friction):
    return electric_effort(drive.kind, drive.parameters, braking, speed, STRONGEST, friction)


@pytest.mark.parametrize("name", DRIVES)
@given(efforts, speeds)
def test_without_friction_brakes_the_electric_brake_does_all(name, braking, speed):
    assert share_of(MACHINES[name], braking, speed, 0.0) == braking


@pytest.mark.parametrize("name", DRIVES)
@given(efforts, speeds, st.floats(1e3, 80e3))
def test_no_other_share_generates_more(name, braking, speed, friction):
    """Against a hundred others, none of them beyond what either brake has."""
    drive, most = MACHINES[name], min(braking, STRONGEST)
    least = max(braking - friction, 0.0)
    electric = share_of(drive, braking, speed, friction)
    if least >= most:
        assert electric == most
        return
    assert least <= electric <= most
    others = [generated(drive, effort, speed) for effort in np.linspace(least, most, 101)]
    # a map's losses are convex but for its patches
    slack = 2e-3 * most * speed if "map" in name or name == "synchronous" else 1e-9 * most * speed
    assert generated(drive, electric, speed) >= max(others) - slack


@pytest.mark.parametrize("name", DRIVES)
@given(efforts, st.floats(8.0, 19.0), st.floats(1e3, 80e3))
def test_the_electric_brake_comes_first_where_it_generates(name, braking, speed, friction):
    drive = MACHINES[name]
    first = min(braking, STRONGEST)
    _, slope, *_ = generated_power(drive.kind, drive.parameters, first, speed)
    if generated(drive, first, speed) >= 0 and slope >= 0:
        assert share_of(drive, braking, speed, friction) == first


def test_copper_loss_generates_most_at_half_the_speed_over_its_coefficient():
    """F v - k F^2 is greatest at F = v / (2 k)."""
    drive = MACHINES["copper loss"]
    coefficient = drive.parameters[0]
    assert share_of(drive, 40e3, 1.0, 50e3) == pytest.approx(1.0 / (2 * coefficient), rel=1e-9)
    assert 1.0 / (2 * coefficient) < 40e3
    # friction is not strong enough for that: the electric brake does the rest
    least = 40e3 - 10e3
    assert share_of(drive, 40e3, 1.0, 10e3) == pytest.approx(least)


def test_arrays():
    drive, speed = MACHINES["copper loss"], np.array([0.0, 1.0, 15.0])
    braking, strongest = np.array([40e3, 40e3, 50e3]), np.full(3, STRONGEST)
    found = electric_efforts(drive.kind, drive.parameters, braking, speed, strongest, 50e3)
    assert found[1:].tolist() == [share_of(drive, b, v, 50e3) for b, v in zip(braking[1:], speed[1:], strict=True)]
    assert found[0] == pytest.approx(0.0, abs=1e-3)
