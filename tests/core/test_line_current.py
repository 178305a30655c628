import numpy as np
import pytest
from builders import plain_scenario

from railjoule.core import ScenarioError, load_scenario, solve
from railjoule.core.energy import supply_current_a
from railjoule.core.scenario import format_scenario, parse_scenario, preset_names
from railjoule.core.simulation.disturbances import simulate_disturbances


def test_current_is_power_over_voltage_and_falls_below_zero_where_energy_goes_back():
    """1.5 MW from 750 V are 2000 A; the rest is arithmetic."""
    assert supply_current_a(np.array([1.5e6, 0.0, -0.75e6]), 750.0).tolist() == [2000.0, 0.0, -1000.0]


def test_without_a_voltage_there_is_no_current():
    assert supply_current_a(np.ones(3), None) is None
    assert solve(plain_scenario()).supply_current_a is None


def test_a_run_carries_the_current_of_its_line():
    run = solve(plain_scenario({"vehicle.line_voltage_v": 1500.0}))
    assert run.supply_current_a is not None
    assert run.supply_current_a == pytest.approx(run.supply_power_w / 1500.0)
    assert run.to_dataframe()["line_current_a"].to_numpy()[:-1] == pytest.approx(run.supply_current_a)


def test_every_shipped_vehicle_names_the_voltage_of_its_line():
    for name in preset_names("scenarios"):
        assert load_scenario(name).vehicle.line_voltage_v in {600.0, 750.0, 3000.0, 15_000.0, 25_000.0}, name


def test_the_voltage_survives_the_file():
    scenario = load_scenario("tram-950m", {"vehicle.line_voltage_v": 660.0})
    assert parse_scenario(format_scenario(scenario)).vehicle.line_voltage_v == 660.0


def test_a_voltage_of_nothing_is_refused_with_its_bound():
    with pytest.raises(ScenarioError, match=r"line_voltage_v.*0"):
        plain_scenario({"vehicle.line_voltage_v": 0.0})


def test_at_another_voltage_the_same_power_takes_another_current():
    """From the notice on the line has 80 % of its voltage: the current is the power over 600 V."""
    change = {"line_voltage_factor": 0.8, "noticed_at_m": 700.0, "reaction": "driver"}
    scenario = plain_scenario({"vehicle.line_voltage_v": 750.0, "disturbance.voltage_changes": [change]})
    run = simulate_disturbances(scenario).actual
    assert run.supply_current_a is not None
    middle = 0.5 * (run.position_m[1:] + run.position_m[:-1])
    assert run.supply_current_a == pytest.approx(run.supply_power_w / np.where(middle < 700.0, 750.0, 600.0))
