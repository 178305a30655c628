"""The check's own loss models against numbers by hand and against plain searches over currents."""

import math

import numpy as np
import pytest

from railjoule.core.check.drives import loss_model
from railjoule.core.check.induction import Machine as InductionMachine
from railjoule.core.check.polynomials import product, real_roots, values
from railjoule.core.check.synchronous import Machine as SynchronousMachine
from railjoule.core.check.synchronous import side_bands
from railjoule.core.scenario import preset_document
from railjoule.core.scenario.drive import Induction, Synchronous
from tests.builders import COPPER_LOSS, INDUCTION, LOSS_POLYNOMIAL, plain_scenario

EFFORT, SPEED = np.array([5e4, -3e4]), np.array([10.0, 12.0])
MOTOR = Induction.model_validate(INDUCTION)
RELUCTANCE = Synchronous.model_validate(preset_document("vehicles", "metro-5-car-synchronous")["drive"])


def model_of(drive):
    return loss_model(plain_scenario({"vehicle.drive": drive}).vehicle.drive)


def test_constant_efficiency_by_hand():
    """500 kW at 0.8 cost 625 kW; of 360 kW at the wheels 0.5 come out."""
    drive = {"model": "constant_efficiency", "traction_efficiency": 0.8, "braking_efficiency": 0.5}
    assert model_of(drive).losses_w(EFFORT, SPEED)["drive"] == pytest.approx([125e3, 180e3])


def test_copper_loss_by_hand():
    """Of 4 motors of 5 N m/A with gear 5 and wheels of 0.8 m each carries 200 A at 50 kN, 120 A at 30 kN."""
    model = model_of(COPPER_LOSS)
    assert model.current_a(EFFORT, SPEED) == pytest.approx([200.0, -120.0])
    assert model.losses_w(EFFORT, SPEED)["copper"] == pytest.approx([4 * 0.1 * 200**2, 4 * 0.1 * 120**2])


def test_loss_polynomial_by_hand():
    """12 motors, x = 5.33 / 0.39: 312.47 N m at 136.67 rad/s driving."""
    losses = model_of(LOSS_POLYNOMIAL).losses_w(EFFORT, SPEED)
    lever = 5.33 / 0.39
    torque, speed = 5e4 * 1.025 / (12 * lever), 10 * lever
    one = 350 + 2 * speed + 0.03 * speed**2 + 0.55 * torque + 0.0046 * torque**2
    assert losses["motors_and_inverters"][0] == pytest.approx(12 * one)
    assert losses["gear"] == pytest.approx([0.025 * 5e5, 0.025 * 3.6e5])


def test_a_map_gives_its_points_back_and_knows_nothing_beyond():
    """Driving M w (1 / eta - 1), braking M w (1 - eta): by hand."""
    efficiencies = {
        (torque, speed): 0.9 - 1e-4 * torque for torque in (-900, -500, 0, 500, 900) for speed in (0, 90, 200)
    }
    points = [
        [torque, speed, efficiency if torque * speed else 0.0] for (torque, speed), efficiency in efficiencies.items()
    ]
    drive = {"model": "efficiency_map", "points": points, "motors": 2, "gear_ratio": 4.0, "wheel_diameter_m": 0.8}
    model = model_of(drive)
    effort, speed = 500 * 2 * 10.0, 90 / 10.0
    losses = model.losses_w(np.array([effort, -effort, 1.9 * effort]), np.full(3, speed))["motors_and_inverters"]
    assert losses[0] == pytest.approx(2 * 500 * 90 * (1 / 0.85 - 1))
    assert losses[1] == pytest.approx(2 * 500 * 90 * 0.05)
    assert np.isnan(losses[2])
    assert model.largest_effort_n(np.array([speed]), False) == pytest.approx([1.8 * effort])


# ---- induction machine


def induction_currents(torque, speed):
    """Return flux currents on a fine grid, with the input power and the voltage of each, by (1)-(13) of the source."""
    m, lr, ls = (
        INDUCTION["mutual_inductance_mh"] / 1e3,
        INDUCTION["rotor_inductance_mh"] / 1e3,
        INDUCTION["stator_inductance_mh"] / 1e3,
    )
    p, rs, rr = INDUCTION["pole_pairs"], INDUCTION["stator_resistance_ohm"], INDUCTION["rotor_resistance_ohm"]
    flux = INDUCTION["rated_magnetising_current_a"] * np.geomspace(0.01, 1, 40_001)
    across = torque / (1.5 * p * m**2 / lr * flux)
    field = p * speed + rr / lr * across / flux
    sigma = 1 - m**2 / (ls * lr)
    u_x, u_y = rs * flux - field * sigma * ls * across, rs * across + field * ls * flux
    share = field / (2 * math.pi * INDUCTION["rated_frequency_hz"])
    iron = INDUCTION["hysteresis_loss_w"] * abs(share) + INDUCTION["eddy_loss_w"] * share**2
    power = 1.5 * (u_x * flux + u_y * across) + iron * (flux / INDUCTION["rated_magnetising_current_a"]) ** 2
    return power, np.hypot(u_x, u_y), np.hypot(flux, across)


@pytest.mark.parametrize(
    ("torque", "speed"),
    [
        (20.0, 20.0),
        (150.0, 50.0),
        (150.0, 150.0),
        (60.0, 330.0),
        (-20.0, 20.0),
        (-100.0, 2.0),
        (-100.0, 150.0),
        (-60.0, 330.0),
    ],
)
def test_least_losses_are_those_of_the_best_flux(torque, speed):
    """Against all flux currents within rated flux and voltage; the grid is 1e-4 fine, and the optimum flat."""
    power, voltage, current = induction_currents(torque, speed)
    allowed = voltage <= INDUCTION["max_phase_voltage_v"]
    best = np.flatnonzero(allowed)[np.argmin(power[allowed])]
    copper, iron, amperes = InductionMachine(MOTOR).least_losses(np.array([torque]), np.array([speed]))
    assert copper[0] + iron[0] + torque * speed == pytest.approx(power[best], rel=2e-6)
    assert amperes[0] == pytest.approx(current[best], rel=1e-3)


def test_no_flux_carries_a_torque_beyond_the_pull_out():
    machine = InductionMachine(MOTOR)
    speed = np.array([400.0])
    most = machine.greatest_torque(speed, 1e4, False)
    inside, beyond = (machine.least_losses(share * most, speed)[0][0] for share in (0.999, 1.01))
    assert np.isfinite(inside)
    assert np.isnan(beyond)


@pytest.mark.parametrize("speed", [1.0, 100.0, 200.0, 400.0])
@pytest.mark.parametrize("braking", [False, True])
def test_the_greatest_torque_is_that_of_a_search(speed, braking):
    """The torque at which the best flux just keeps current and voltage, found by halving."""
    limit = INDUCTION["braking_current_a"] if braking else INDUCTION["starting_current_a"]
    sign = -1 if braking else 1

    def fits(torque):
        _, voltage, current = induction_currents(sign * torque, speed)
        return ((voltage <= INDUCTION["max_phase_voltage_v"]) & (current <= limit)).any()

    low, high = 1.0, 2000.0
    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if fits(middle) else (low, middle)
    found = InductionMachine(MOTOR).greatest_torque(np.array([speed]), limit, braking)
    assert found[0] == pytest.approx(low, rel=1e-4)


def test_a_standstill_brake_does_what_would_draw_power():
    with_brake, without = model_of(INDUCTION), model_of(INDUCTION | {"standstill_brake": False})
    effort, speed = np.array([-2000.0]), np.array([0.2])
    assert with_brake.losses_w(effort, speed)["standstill_brake"] == pytest.approx([400.0])
    assert without.losses_w(effort, speed)["standstill_brake"] == 0
    assert sum(without.losses_w(effort, speed).values()) > 400


# ---- synchronous machine


def synchronous_grid(torque, rads):
    """Return currents along the magnets on a fine grid, with current and voltage."""
    along = -RELUCTANCE.max_current_a * np.linspace(0, 1, 40_001)
    direct, quadrature = RELUCTANCE.direct_inductance_mh / 1e3, RELUCTANCE.quadrature_inductance_mh / 1e3
    across = torque / (1.5 * RELUCTANCE.pole_pairs * (RELUCTANCE.magnet_flux_vs - (quadrature - direct) * along))
    r = RELUCTANCE.stator_resistance_ohm
    u_d = r * along - rads * quadrature * across
    u_q = r * across + rads * (RELUCTANCE.magnet_flux_vs + direct * along)
    return np.hypot(along, across), np.hypot(u_d, u_q)


@pytest.mark.parametrize("speed", [5.0, 120.0, 300.0])
@pytest.mark.parametrize("braking", [False, True])
def test_the_greatest_torque_of_a_synchronous_motor_is_that_of_a_search(speed, braking):
    machine, sign = SynchronousMachine(RELUCTANCE), -1 if braking else 1
    drag = RELUCTANCE.mechanical_loss_torque_nm + RELUCTANCE.ventilation_loss_w_per_rads3 * speed**2

    def fits(torque):
        current, voltage = synchronous_grid(sign * torque + drag, RELUCTANCE.pole_pairs * speed)
        return ((current <= RELUCTANCE.max_current_a) & (voltage <= machine.largest_voltage_v)).any()

    low, high = 1.0, 20_000.0
    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if fits(middle) else (low, middle)
    assert machine.greatest_torque(np.array([speed]), braking)[0] == pytest.approx(low, rel=1e-4)


@pytest.mark.parametrize(("torque", "speed"), [(300.0, 50.0), (900.0, 150.0), (200.0, 320.0), (-600.0, 200.0)])
def test_currents_of_a_synchronous_motor_are_the_least_within_its_voltage(torque, speed):
    machine, rads = SynchronousMachine(RELUCTANCE), RELUCTANCE.pole_pairs * speed
    current, voltage = synchronous_grid(torque, rads)
    least = current[voltage <= machine.largest_voltage_v].min()
    along, across = machine._currents(np.array([torque]), np.array([rads]))
    assert math.hypot(along[0], across[0]) == pytest.approx(least, rel=1e-4)


def test_a_synchronous_motor_has_no_losses_beyond_its_limits():
    machine = SynchronousMachine(RELUCTANCE)
    most = machine.greatest_torque(np.array([200.0]), False)[0]
    loss = machine.loss_w(np.array([0.999 * most, 1.01 * most]), np.full(2, 200.0))
    assert np.isfinite(loss[0])
    assert np.isnan(loss[1])


def test_side_bands_are_those_of_a_switched_leg():
    """Against the spectrum of the pulses themselves at 0.8 of half the link voltage, 21 carriers in a period."""
    depth, amplitude = side_bands()
    row = int(np.argmin(np.abs(depth - 0.8)))
    samples, carriers = 2**18, 21
    angle = 2 * np.pi * np.arange(samples) / samples
    phases = [depth[row] * np.cos(angle - 2 * np.pi * k / 3) for k in range(3)]
    leg = phases[0] - 0.5 * (np.max(phases, axis=0) + np.min(phases, axis=0))
    triangle = 2 * np.abs(2 * ((carriers * angle / (2 * np.pi)) % 1) - 1) - 1
    spectrum = 2 * np.abs(np.fft.rfft(np.where(leg > triangle, 1.0, -1.0))) / samples
    for multiple, band in ((1, -4), (1, -2), (1, 2), (1, 4), (2, -1), (2, 1)):
        assert amplitude[row, multiple - 1, 16 + band] == pytest.approx(spectrum[multiple * carriers + band], abs=2e-3)


# ---- polynomials


def test_polynomials_by_hand():
    """(1 + x)(2 - x) = 2 + x - x^2; (x - 2)(x + 3) has the roots 2 and -3, x^2 + 1 none."""
    assert product(np.array([[1.0, 1.0]]), np.array([[2.0, -1.0]])).tolist() == [[2.0, 1.0, -1.0]]
    roots = real_roots(np.array([[-6.0, 1.0, 1.0], [1.0, 0.0, 1.0]]))
    assert sorted(roots[0]) == pytest.approx([-3.0, 2.0])
    assert np.isnan(roots[1]).all()
    assert np.isnan(real_roots(np.array([[1.0, 1.0, 0.0], [1.0, np.inf, 1.0]]))).all()
    assert values(np.array([[2.0, 1.0, -1.0]]), np.array([[3.0, 0.0]])).tolist() == [[-4.0, 2.0]]
