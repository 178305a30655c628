import pytest

from railjoule.core import InfeasibleLineError, ScenarioError, load_scenario
from railjoule.core.simulation.following import plan_for
from railjoule.dashboard.pages.what_if.compute import compute_reality

HEAVY = {"disturbance.actual_load_factor": 1.0, "disturbance.coordinate_error_m": 10.0}


def test_reality_is_measured_against_a_plan_that_knows_the_load() -> None:
    scenario = load_scenario("liashenko-ii")
    reality = compute_reality(scenario, HEAVY)
    known = plan_for(scenario.replace(**{"vehicle.load_factor": 1.0}))
    assert reality.replanned_kwh == pytest.approx(known.energy_kwh, rel=1e-9)
    assert reality.following.actual.energy_kwh > known.energy_kwh


def test_sensors_out_of_order_are_refused() -> None:
    request = (load_scenario("liashenko-ii"), {**HEAVY, "simulation.stop_sensor_m": 250.0})
    with pytest.raises(ScenarioError, match="order D1, D2, D3"):
        compute_reality(*request)


def test_an_error_beyond_the_line_is_refused() -> None:
    request = (load_scenario("liashenko-ii"), {**HEAVY, "disturbance.coordinate_error_m": 5000.0})
    with pytest.raises(ScenarioError, match="less than the shortest distance between two stops, 1300 m"):
        compute_reality(*request)


def test_a_train_that_cannot_climb_is_told() -> None:
    changes = {"vehicle.capacity_passengers": 20_000, "disturbance.actual_load_factor": 1.0}
    with pytest.raises(InfeasibleLineError, match="comes to a stand"):
        compute_reality(load_scenario("liashenko-iii").replace(**{"vehicle.load_factor": 0.0}), changes)
