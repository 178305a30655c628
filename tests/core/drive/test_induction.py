"""The induction drive against its formulas: by brute force over the flux, by differences, by its account."""

import math
from functools import partial

import numpy as np
import pytest
from builders import INDUCTION, plain_scenario
from hypothesis import given
from hypothesis import strategies as st

from railjoule.core.drive import kernels, kinds, make_drive
from railjoule.core.drive.geared import STANDSTILL_BRAKE
from railjoule.core.drive.induction.machine import (
    leakage_share,
    make_machine,
    phase_voltage_v,
    slip_rate,
    steady_state,
    torque_constant,
)
from railjoule.core.drive.induction.min_loss import BEYOND, FREE, FULL_VOLTAGE, RATED_FLUX, best_ratio
from railjoule.core.errors import ScenarioError

DRIVE = make_drive(plain_scenario({"vehicle.drive": INDUCTION}).vehicle.drive)
MACHINE = make_machine(DRIVE.parameters)
BARE = DRIVE.parameters.copy()
BARE[STANDSTILL_BRAKE] = 0.0
driving_power = partial(kernels.driving_power, kinds.INDUCTION)
generated_power = partial(kernels.generated_power, kinds.INDUCTION)
speeds = st.floats(0.05, 25)
shares = st.floats(0.001, 0.999)
signs = st.sampled_from([1.0, -1.0])


def largest(speed, braking):
    return float(DRIVE.effort_limit_n(np.array([speed]), braking)[0])


@given(sign=signs, share=shares, speed=speeds)
def test_input_power_is_shaft_power_and_losses(sign, share, speed):
    """The power at the terminals from voltages and currents, and the sum of where it goes."""
    i_x = share * MACHINE.magnetising_current_a
    w = 2 * 7.16 / 0.327 * speed
    state = steady_state(MACHINE, i_x, sign * 5 * i_x, w)
    parts = state.stator_copper_w + state.rotor_copper_w + state.iron_w + state.torque_nm * w / 2
    assert state.input_power_w == pytest.approx(parts, rel=1e-12, abs=1e-6)


def test_printed_forms_of_the_formulas():
    """(2), (4), (6) times I_yS, (7), (22) and (25) of Rawicki, with Psi = M Ix, at the rated flux."""
    i_x, i_y, w = 23.0, 150.0, 400.0
    m = MACHINE
    psi, inverse = m.mutual_inductance_h * i_x, m.stator_inductance_h * m.rotor_inductance_h - m.mutual_inductance_h**2
    state = steady_state(m, i_x, i_y, w)
    torque = 1.5 * 2 * m.mutual_inductance_h / m.rotor_inductance_h * psi * i_y
    slip = 2 * m.rotor_resistance_ohm * torque / (3 * 2 * psi**2)
    assert state.torque_nm == pytest.approx(torque)
    assert state.slip_rads == pytest.approx(slip)
    k = m.rotor_resistance_ohm * m.mutual_inductance_h
    assert state.voltage_x_v == pytest.approx(
        psi * (m.stator_resistance_ohm / m.mutual_inductance_h - (w + slip) * slip * inverse / k)
    )
    assert state.voltage_y_v == pytest.approx(
        psi
        * (
            (w + slip) * m.stator_inductance_h / m.mutual_inductance_h
            + m.stator_resistance_ohm * m.rotor_inductance_h * slip / k
        )
    )


@given(sign=signs, share=shares, speed=speeds)
def test_no_other_flux_loses_less(sign, share, speed):
    braking = sign < 0
    effort = share * largest(speed, braking)
    point = power_of(braking, effort, speed)
    torque = abs(torque_at(braking, effort))
    sign = 1.0 if torque_at(braking, effort) > 0 else -1.0
    w, limit = 2 * 7.16 / 0.327 * speed, MACHINE.max_phase_voltage_v * (1 + 1e-9)
    strength = torque / torque_constant(MACHINE)
    for i_x in np.linspace(0.01, 1, 60) * MACHINE.magnetising_current_a:
        state = steady_state(MACHINE, i_x, sign * strength / i_x, w)
        # a generator's voltage is low again where its field all but stands, far beyond the pull-out
        if phase_voltage_v(state) <= limit and abs(state.slip_rads) < 0.25 * w + 50:
            assert point <= DRIVE_MOTORS * state.input_power_w + 1e-6


DRIVE_MOTORS = 4


def torque_at(braking, effort):
    wheel = DRIVE_MOTORS * 7.16 / 0.327
    return 4.05 - 0.98 * effort / wheel if braking else 4.05 + effort / wheel / 0.98


def power_of(braking, effort, speed):
    return -generated_power(BARE, effort, speed)[0] if braking else driving_power(BARE, effort, speed)[0]


@given(braking=st.booleans(), share=st.floats(0.001, 0.95), speed=speeds)
def test_powers_and_derivatives(braking, share, speed):
    """Against central differences, wherever one limit decides the flux all around; slopes are steep at pull-out."""
    effort = share * largest(speed, braking)
    kernel = generated_power if braking else driving_power
    df, dv = 1e-5 * max(effort, 100.0), 1e-5 * max(speed, 1.0)
    torques = [torque_at(braking, effort + s * df) for s in (-1, 0, 1)]
    deciders = {
        best_ratio(MACHINE, math.copysign(1, t), abs(t) / torque_constant(MACHINE), 43.7920 * (speed + r * dv))[1]
        for t in torques
        for r in (-1, 0, 1)
    }
    _, p_f, p_v, p_ff, p_fv, p_vv = kernel(BARE, effort, speed)
    if len(deciders) > 1 or min(torques) * max(torques) <= 0:
        return
    up, down = kernel(BARE, effort + df, speed), kernel(BARE, effort - df, speed)
    later, before = kernel(BARE, effort, speed + dv), kernel(BARE, effort, speed - dv)
    for found, expected, scale in (
        (p_f, (up[0] - down[0]) / (2 * df), speed),
        (p_v, (later[0] - before[0]) / (2 * dv), effort + 100),
        (p_ff, (up[1] - down[1]) / (2 * df), speed / (effort + 100)),
        (p_fv, (later[1] - before[1]) / (2 * dv), 1.0),
        (p_vv, (later[2] - before[2]) / (2 * dv), (effort + 100) / speed),
    ):
        assert found == pytest.approx(expected, rel=2e-4, abs=1e-5 * scale)


@pytest.mark.parametrize(("speed", "rules"), [(4.0, {FREE, RATED_FLUX}), (12.0, {FREE, FULL_VOLTAGE})])
def test_first_derivatives_do_not_jump(speed, rules):
    """Along all efforts of a speed, from the flux of least loss to where a limit decides it."""
    efforts = np.linspace(1, 0.97 * largest(speed, False), 4001)
    strengths = torque_at(False, efforts) / torque_constant(MACHINE)
    assert {best_ratio(MACHINE, 1.0, k, 2 * 7.16 / 0.327 * speed)[1] for k in strengths} == rules
    slopes = np.array([driving_power(DRIVE.parameters, f, speed)[1] for f in efforts])
    assert np.abs(np.diff(slopes)).max() < 3e-3 * speed


def test_beyond_the_machine_power_goes_on():
    """Solvers may look where no limit holds: continuous, rising, finite."""
    limit = largest(18.0, False)
    assert best_ratio(MACHINE, 1.0, 3000.0, 526.0)[1] == BEYOND
    powers = np.array([driving_power(DRIVE.parameters, f, 18.0)[0] for f in np.linspace(0.99, 1.2, 200) * limit])
    steps = np.diff(powers)
    assert (steps > 0).all()
    assert steps.max() < 0.02 * powers[0]


@given(share=st.floats(-1, 1), speed=st.floats(0, 25), recuperation=st.floats(0, 1))
def test_the_account_closes(share, speed, recuperation):
    own = INDUCTION | {"recuperation_factor": recuperation}
    drive = make_drive(plain_scenario({"vehicle.drive": own}).vehicle.drive)
    effort = np.array([share * largest(speed, share < 0)])
    at = np.array([speed])
    losses = drive.losses_w(effort, at)
    assert set(losses) == {"copper", "iron", "mechanical", "gear", "standstill_brake", "brake_resistors"}
    assert all((loss >= -1e-9).all() for loss in losses.values())
    taken = drive.supply_power_w(effort, at)
    # rounding, and an effort that counts as none
    assert taken == pytest.approx(effort * speed + sum(losses.values()), rel=1e-9, abs=0.2)


def test_no_power_without_effort_and_idle_power_with_the_least():
    """n (T_m Omega + loss at T_m), with the currents of least loss; findings: coasting is only W(v)."""
    speed = np.array([12.0])
    assert DRIVE.supply_power_w(np.zeros(1), speed) == 0
    assert DRIVE.current_a(np.zeros(1), speed) == 0
    idle = kernels.power_when_on(DRIVE.kind, DRIVE.parameters, False, 0.0, 12.0)[0]
    assert DRIVE.supply_power_w(np.array([0.01]), speed)[0] == pytest.approx(idle, rel=1e-3)
    shaft = 4 * 4.05 * 7.16 / 0.327 * 12
    assert shaft < idle < 1.2 * shaft


def test_cruise_at_twelve_metres_per_second():
    """Findings on Rawicki: about 12 A of magnetising current; rated flux would cost 6 to 7 % more."""
    resistance = 1427.6 + 7.189 * 144
    torque = torque_at(False, resistance)
    w = 2 * 7.16 / 0.327 * 12
    ratio, decider = best_ratio(MACHINE, 1.0, torque / torque_constant(MACHINE), w)
    i_x = math.sqrt(torque / torque_constant(MACHINE) / ratio)
    assert decider == FREE
    assert i_x == pytest.approx(12, abs=0.5)
    least = driving_power(DRIVE.parameters, resistance, 12.0)[0]
    rated = 4 * steady_state(MACHINE, 23.03, torque / torque_constant(MACHINE) / 23.03, w).input_power_w
    assert 1.06 < rated / least < 1.07


def test_full_current_starts_at_rated_flux_and_weakens_it_under_full_voltage():
    """(1)-(3) below the corner, (18) above it, and no more than the pull-out torque needs further on."""
    corner = DRIVE.corner_speed_ms(201.05)
    torque = torque_constant(MACHINE) * 23.03 * math.sqrt(201.05**2 - 23.03**2)
    full = 4 * 7.16 / 0.327 * (torque - 4.05) * 0.98
    limit = DRIVE.effort_limit_n(np.array([0.0, corner, corner + 1e-3, 11.0, 19.0]))
    assert limit[:2] == pytest.approx([full, full])
    assert limit[2] < full * (1 - 1e-4)
    assert DRIVE.current_a(limit[:4], np.array([0.0, corner, corner, 11.0])) == pytest.approx([201.05] * 4, rel=1e-3)
    assert DRIVE.current_a(limit[4:], np.array([19.0])) < 190
    held, power = DRIVE.full_current_start(np.array([11.0, 16.0, 20.0]), 201.05)
    assert (held[0], power[0]) == pytest.approx((limit[3], DRIVE.supply_power_w(limit[3:4], np.array([11.0]))[0]))
    assert held[1] < DRIVE.effort_limit_n(np.array([16.0]))[0]
    # findings: above 18.9 m/s the voltage no longer carries the starting current
    assert held[2] < 0


@given(speed=speeds, braking=st.booleans(), current=st.floats(30, 300))
def test_no_pair_of_currents_gives_more(speed, braking, current):
    effort = float(DRIVE.effort_at_current_n(current, np.array([speed]), braking)[0])
    sign, w = (-1.0 if braking else 1.0), 2 * 7.16 / 0.327 * speed
    most = torque_at(braking, effort) * sign
    for i_x in np.linspace(0.01, 1, 40) * 23.03:
        for i_y in np.linspace(0.01, 1, 40) * math.sqrt(max(current**2 - i_x**2, 0)):
            state = steady_state(MACHINE, i_x, sign * i_y, w)
            if phase_voltage_v(state) <= 310.27 and abs(state.slip_rads) < 0.25 * w + 50:
                assert abs(state.torque_nm) <= most * (1 + 1e-9) + 1e-9


def test_standstill_brake_takes_over_where_braking_draws():
    """Findings on Rawicki: below 1.06 m/s the generator draws power."""
    effort = np.full(2, -largest(0.5, True))
    speed = np.array([1.05, 1.07])
    assert DRIVE.electrical_power_w(effort, speed)[0] == 0
    assert DRIVE.electrical_power_w(effort, speed)[1] < 0
    assert DRIVE.losses_w(effort, speed)["standstill_brake"] == pytest.approx([-effort[0] * 1.05, 0])
    bare = make_drive(plain_scenario({"vehicle.drive": INDUCTION | {"standstill_brake": False}}).vehicle.drive)
    assert bare.electrical_power_w(effort, speed)[0] > 0
    # currents at rated flux, R_S and R_W of four machines: 27.8 kW at standstill, with the iron loss of the slip
    assert 27e3 < bare.electrical_power_w(effort[:1], np.zeros(1))[0] < 32e3


def test_kernels_know_the_drive():
    assert DRIVE.kind == kinds.INDUCTION
    assert kernels.work_bounds(DRIVE.kind, DRIVE.parameters) == (1 / 0.98, 0.98)
    assert kernels.may_draw_while_braking(DRIVE.kind)
    assert leakage_share(MACHINE) == pytest.approx(1 - (33.15 / 33.81) ** 2)
    assert slip_rate(MACHINE) == pytest.approx(0.1266 / 0.03381)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (
            {"mutual_inductance_mh": 33.9},
            "drive.mutual_inductance_mh = 33.9 must be below stator_inductance_mh = 33.81, which includes it.",
        ),
        (
            {"starting_current_a": 20.0},
            "drive.starting_current_a = 20 must be above rated_magnetising_current_a = 23.03.",
        ),
        ({"gear_efficiency": 1.2}, "drive.gear_efficiency = 1.2 must be at most 1."),
        ({"standstill_brake": 1}, "drive.standstill_brake = 1 must be true or false."),
    ],
)
def test_parameters_that_make_no_machine(change, sentence):
    with pytest.raises(ScenarioError) as refusal:
        plain_scenario({"vehicle.drive": INDUCTION | change})
    assert str(refusal.value).endswith(sentence)


def test_a_machine_that_cannot_turn_itself():
    scenario = plain_scenario({"vehicle.drive": INDUCTION | {"mechanical_loss_torque_nm": 500.0}})
    with pytest.raises(
        ScenarioError, match=r"^drive.mechanical_loss_torque_nm = 500 must be below what the motor gives"
    ):
        make_drive(scenario.vehicle.drive)


@pytest.mark.parametrize("speed", [2.0, 6.0, 8.5, 11.0, 16.0])
@pytest.mark.parametrize("change", [{}, {"starting_current_a": 400.0}, {"max_phase_voltage_v": 180.0}], ids=str)
def test_beyond_what_the_machine_has_its_power_goes_on_rising(change, speed):
    """It fell where flux and voltage bind without the current (fault 1): a run paid less for more than there is."""
    drive = make_drive(plain_scenario({"vehicle.drive": {**INDUCTION, **change}}).vehicle.drive)
    most = float(drive.effort_limit_n(np.array([speed]))[0])
    efforts = most * np.linspace(0.5, 1.5, 400)
    power = drive.electrical_power_w(efforts, np.full(400, speed))
    assert (np.diff(power) > 0).all()


@pytest.mark.parametrize("braking", [False, True], ids=["driving", "braking"])
@pytest.mark.parametrize("change", [{}, {"starting_current_a": 400.0}, {"max_phase_voltage_v": 180.0}], ids=str)
def test_the_least_of_three_pairs_of_limits_is_the_limit_of_all(change, braking):
    """Flux with current is constant; the voltage with either of them is another."""
    drive = make_drive(plain_scenario({"vehicle.drive": {**INDUCTION, **change}}).vehicle.drive)
    speeds = np.linspace(0.0, 25.0, 400)
    constant = float(drive.effort_limit_n(np.zeros(1), braking)[0])
    assert np.minimum(constant, drive.weakening_limit_n(speeds, braking)) == pytest.approx(
        drive.effort_limit_n(speeds, braking), rel=1e-6
    )
