"""Losses, voltage, efficiency and power factor of a motor over its flux."""

import math

import numpy as np
import pytest

from railjoule.core import ScenarioError, load_scenario
from railjoule.core.studies.flux_sweep import sweep_flux

TRAM = load_scenario("tram-950m").vehicle
CRUISE_MS = 12.26


def test_the_cruise_of_the_audit():
    """Audit of the papers: 10166 W with the rated flux, 422 V beyond 310 V, and 9549 W at 12 A."""
    sweep = sweep_flux(TRAM, CRUISE_MS)
    assert sweep.rated.input_power_w == pytest.approx(10166, abs=1)
    assert sweep.rated.phase_voltage_v == pytest.approx(422, abs=0.5)
    assert sweep.min_loss.input_power_w == pytest.approx(9549, abs=1)
    assert sweep.min_loss.flux_current_a == pytest.approx(12.0, abs=0.05)
    assert sweep.within_voltage.phase_voltage_v == pytest.approx(310.27, abs=0.01)
    # 1439.2 N + 0.55026 N/(km/h)2, of the vehicle's file
    assert sweep.effort_n == pytest.approx(1439.2 + 0.55026 * (3.6 * CRUISE_MS) ** 2, rel=1e-12)


def test_the_power_factor_is_that_of_the_equivalent_circuit():
    """Of the T circuit's impedance, with the losses of iron added to the power as the machine's formulas do."""
    drive = TRAM.drive
    sweep = sweep_flux(TRAM, CRUISE_MS)
    mutual, stator, rotor = (
        1e-3 * h for h in (drive.mutual_inductance_mh, drive.stator_inductance_mh, drive.rotor_inductance_mh)
    )
    for point in (sweep.min_loss, sweep.rated):
        slip = drive.rotor_resistance_ohm / rotor * point.torque_current_a / point.flux_current_a
        electrical = drive.pole_pairs * CRUISE_MS * drive.gear_ratio / (0.5 * drive.wheel_diameter_m)
        w = electrical + slip
        branch = drive.rotor_resistance_ohm * w / slip + 1j * w * (rotor - mutual)
        magnetising = 1j * w * mutual
        impedance = (
            drive.stator_resistance_ohm + 1j * w * (stator - mutual) + magnetising * branch / (magnetising + branch)
        )
        current = math.hypot(point.flux_current_a, point.torque_current_a)
        assert abs(impedance) * current == pytest.approx(point.phase_voltage_v, rel=1e-9)
        rated_rads = 2 * math.pi * drive.rated_frequency_hz
        iron = (drive.hysteresis_loss_w + drive.eddy_loss_w * w / rated_rads) * w / rated_rads
        iron *= (point.flux_current_a / drive.rated_magnetising_current_a) ** 2
        power = 1.5 * impedance.real * current**2 + iron
        assert point.power_factor == pytest.approx(power / (1.5 * abs(impedance) * current**2), rel=1e-9)


@pytest.mark.parametrize("name", ["tram-950m", "ftorek-300s"])
def test_the_flux_of_minimum_loss_is_the_lowest_of_the_sweep(name):
    sweep = sweep_flux(load_scenario(name).vehicle, CRUISE_MS)
    loss = sweep.values("loss_w")
    assert sweep.min_loss.loss_w <= loss.min() * (1 + 1e-12)
    assert np.argmin(np.abs(sweep.values("flux_current_a") - sweep.min_loss.flux_current_a)) == np.argmin(loss)
    # one power at the shaft, so the losses decide the efficiency
    assert np.argmax(sweep.values("efficiency")) == np.argmin(loss)
    assert sweep.min_loss.power_factor > sweep.rated.power_factor


@pytest.mark.parametrize("speed_kmh", [0.0, 72.5, math.inf])
def test_a_speed_that_the_train_does_not_have_is_refused(speed_kmh):
    with pytest.raises(ScenarioError, match=r"cruise_speed_kmh = .* must be above 0 and at most the vehicle's 72 km/h"):
        sweep_flux(TRAM, speed_kmh / 3.6)
