"""The losses of synchronous motors and their inverters by kind, with the harmonics among them."""

import numpy as np
import pytest

from railjoule.core import load_scenario, solve
from railjoule.core.drive import make_drive
from railjoule.core.drive.synchronous.drive import efficiency_maps, torque_envelope
from railjoule.core.scenario import Scenario

KINDS = ("copper", "iron", "mechanical", "harmonics", "inverter")


def steady() -> Scenario:
    """Return a run that keeps 54 km/h, 15 m/s, on a constant gradient."""
    return load_scenario("kharkiv-like-40kmh").replace(
        **{
            "line": {"sections": [{"length_m": 300.0, "gradient_permille": 30.0, "speed_limit_kmh": 54.0}]},
            "timetable": {"travel_time_s": 20.001, "entry_speed_kmh": 54.0, "exit_speed_kmh": 54.0},
            "search": {},
            "solver.mesh_m": 50.0,
        }
    )


def without_harmonics(scenario: Scenario) -> Scenario:
    return scenario.replace(**{"drive.harmonic_losses": False})


def test_the_parts_are_those_of_the_machine_and_sum_to_its_losses():
    parameters = load_scenario("kharkiv-like-40kmh").vehicle.drive
    drive, turns = make_drive(parameters), 5.33 / 0.39
    rng = np.random.default_rng(3)
    speed = rng.uniform(3.0, 22.0, 40)
    torque = rng.uniform(0.1, 0.9, 40) * torque_envelope(parameters, speed * turns)
    effort = 12 * torque * turns / 1.025
    losses = drive.losses_w(effort, speed)
    parts = np.array([losses[kind] for kind in KINDS])
    whole = drive.electrical_power_w(effort, speed) - effort * speed - losses["gear"]
    assert parts.sum(axis=0) == pytest.approx(whole, rel=1e-9)
    # each share is that of the machine's own formulas
    places = zip(torque[:, None], speed[:, None] * turns, strict=True)
    exact = np.array([efficiency_maps(parameters, *place).losses_w[0, 0] for place in places])
    shares = exact / exact.sum(axis=1, keepdims=True)
    inverter = shares[:, 4:].sum(axis=1, keepdims=True)
    found_shares = (parts / whole).T
    assert found_shares == pytest.approx(np.hstack([shares[:, :4], inverter]), rel=1e-9)
    # the audit's range, of a motor without its inverter
    of_motor = exact[:, 3] / exact[:, :4].sum(axis=1)
    assert 0.005 < of_motor.min() < of_motor.max() < 0.07


def test_a_machine_without_harmonics_loses_the_other_kinds_as_before():
    parameters = load_scenario("kharkiv-like-40kmh").vehicle.drive
    torque, speed = np.linspace(50.0, 600.0, 7), np.linspace(20.0, 200.0, 9)
    with_all = efficiency_maps(parameters, torque, speed).losses_w
    without = efficiency_maps(parameters.model_copy(update={"harmonic_losses": False}), torque, speed).losses_w
    known = ~np.isnan(with_all[..., 0])
    assert np.all(without[known][:, 3] == 0)
    kept = [0, 1, 2, 4, 5]
    assert without[known][:, kept] == pytest.approx(with_all[known][:, kept], rel=1e-12)


def test_a_steady_run_without_harmonics_takes_less_by_their_loss():
    scenario = steady()
    runs = [solve(each, "optimal", check=True, prove_seconds=0) for each in (scenario, without_harmonics(scenario))]
    assert all(run.check.ok for run in runs)
    harmonics = runs[0].energy.losses_j["harmonics"]
    assert harmonics > 0
    assert runs[1].energy.losses_j["harmonics"] == 0
    # the table is good to a few thousandths of the losses, of which the harmonics are some hundredths
    assert runs[0].energy.net_j - runs[1].energy.net_j == pytest.approx(harmonics, rel=0.05)
    assert abs(runs[0].energy.imbalance) < 1e-9
