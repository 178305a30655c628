"""Loss polynomial and map of losses: by hand, by differences, and against one another."""

import numpy as np
import pytest
from builders import LOSS_POLYNOMIAL, plain_scenario
from hypothesis import given
from hypothesis import strategies as st

from railjoule.core.drive import kernels, make_drive

TURNS = 5.33 / 0.39


def loss_by_hand(torque, speed):
    """350 + 2 w + 0.03 w^2 + 0.55 M + 0.0046 M^2: findings.md, Shtompel."""
    return 350 + 2 * speed + 0.03 * speed**2 + 0.55 * torque + 0.0046 * torque**2


def points():
    """The polynomial as a map of efficiencies in driving."""
    return [
        [float(m), float(w), 0.0 if m * w == 0 else float(m * w / (m * w + loss_by_hand(m, w)))]
        for m in np.linspace(0, 2000, 21)
        for w in np.linspace(0, 400, 21)
    ]


GEAR = {key: LOSS_POLYNOMIAL[key] for key in ("motors", "gear_ratio", "wheel_diameter_m", "gear_loss_share")}
DRIVES = {
    "polynomial": make_drive(plain_scenario({"vehicle.drive": LOSS_POLYNOMIAL}).vehicle.drive),
    "map": make_drive(
        plain_scenario(
            {"vehicle.drive": {"model": "efficiency_map", "points": points(), "recuperation_factor": 1.0, **GEAR}}
        ).vehicle.drive
    ),
}
efforts, speeds = st.floats(500, 2.5e5), st.floats(0.1, 25)


@given(effort=efforts, speed=speeds)
def test_power_by_hand(effort, speed):
    """F v (1 + g) and the losses of twelve motors in driving, F v (1 - g) less them in braking."""
    drive, wheel = DRIVES["polynomial"], effort * speed
    for sign, share in ((1, 1.025), (-1, 0.975)):
        loss = 12 * loss_by_hand(share * effort / 12 / TURNS, speed * TURNS)
        expected = sign * share * wheel + loss
        assert drive.electrical_power_w(sign * effort, speed) == pytest.approx(expected, rel=1e-12, abs=1e-6)


@pytest.mark.parametrize("name", DRIVES)
def test_no_effort_takes_no_power(name):
    assert not DRIVES[name].electrical_power_w(np.zeros(3), np.array([0.0, 5.0, 20.0])).any()


@pytest.mark.parametrize("name", DRIVES)
@given(speed=speeds)
def test_the_least_effort_takes_the_idle_power(name, speed):
    drive = DRIVES[name]
    idle = kernels.power_when_on(drive.kind, drive.parameters, False, 0.0, speed)[0]
    assert idle == pytest.approx(12 * loss_by_hand(0, speed * TURNS), rel=2e-3)
    assert drive.electrical_power_w(1.0, speed) == pytest.approx(idle, rel=1e-3)


@pytest.mark.parametrize("braking", [False, True])
@pytest.mark.parametrize("name", DRIVES)
@given(effort=efforts, speed=st.floats(0.5, 24))
def test_derivatives_against_differences(name, braking, effort, speed):
    drive = DRIVES[name]
    kernel = kernels.generated_power if braking else kernels.driving_power
    _, p_f, p_v, p_ff, p_fv, p_vv = kernel(drive.kind, drive.parameters, effort, speed)
    # first derivatives are continuous over the borders of a table, second ones jump there
    for exact, df, dv in ((p_f, 1e-5 * effort, 0.0), (p_v, 0.0, 1e-5 * speed)):
        after, before = (kernel(drive.kind, drive.parameters, effort + s * df, speed + s * dv)[0] for s in (1, -1))
        assert exact == pytest.approx((after - before) / (2 * (df + dv)), rel=1e-4, abs=1e-3)
    if name == "polynomial":
        for exact, first, df, dv in ((p_ff, 1, 1.0, 0.0), (p_fv, 1, 0.0, 1e-3), (p_vv, 2, 0.0, 1e-3)):
            up, down = (kernel(drive.kind, drive.parameters, effort + s * df, speed + s * dv)[first] for s in (1, -1))
            assert exact == pytest.approx((up - down) / (2 * (df + dv)), rel=1e-5, abs=1e-4)


@given(effort=efforts, speed=speeds)
def test_a_map_of_the_polynomial_gives_its_power(effort, speed):
    """Within one percent of the losses; at the lowest speeds efficiency does not determine them."""
    exact = DRIVES["polynomial"].electrical_power_w(effort, speed)
    loss = 12 * loss_by_hand(1.025 * effort / 12 / TURNS, speed * TURNS)
    assert DRIVES["map"].electrical_power_w(effort, speed) == pytest.approx(exact, abs=1e-2 * loss)


@pytest.mark.parametrize("name", DRIVES)
@given(effort=st.floats(-2.5e5, 2.5e5).filter(lambda effort: abs(effort) > 1), speed=speeds)
def test_never_more_out_than_in(name, effort, speed):
    drive = DRIVES[name]
    assert float(drive.electrical_power_w(effort, speed)) >= effort * speed - 1e-6
    losses = drive.losses_w(effort, speed)
    assert sum(losses.values()) == pytest.approx(drive.supply_power_w(effort, speed) - effort * speed, abs=1e-6)
    assert losses["gear"] in (0.0, pytest.approx(0.025 * abs(effort) * speed))
