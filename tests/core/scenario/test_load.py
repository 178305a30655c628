"""The load of any vehicle: a share of its capacity or tonnes, planned and actual."""

import pytest

from railjoule.core import ScenarioError
from railjoule.core.scenario import Scenario, format_scenario, parse_scenario
from railjoule.core.simulation.actual_vehicle import actual_vehicle
from railjoule.core.studies.montecarlo import draw
from tests.builders import plain_scenario

FREIGHT = {"vehicle.max_load_t": 60.0}


def freight(changes: dict[str, object]) -> Scenario:
    """Return the plain train, 100 t, with room for 60 t of freight."""
    return plain_scenario({**FREIGHT, **changes})


def test_tonnes_and_shares_are_the_same_load() -> None:
    by_share, by_mass = freight({"vehicle.load_factor": 0.25}).vehicle, freight({"vehicle.load_t": 15.0}).vehicle
    for vehicle in (by_share, by_mass):
        assert (vehicle.total_mass_kg, vehicle.load_share) == (115e3, 0.25)
        assert vehicle.total_inertia_kg == pytest.approx(1.1 * 115e3)
    assert plain_scenario({"vehicle.load_t": 12.0}).vehicle.load_share == pytest.approx(12e3 / (400 * 75))


def test_without_a_capacity_tonnes_are_the_capacity() -> None:
    vehicle = plain_scenario({"vehicle.capacity_passengers": 0, "vehicle.load_t": 40.0}).vehicle
    assert (vehicle.total_mass_kg, vehicle.load_share) == (140e3, 1.0)
    assert vehicle.with_load(0.5).total_mass_kg == 120e3


@pytest.mark.parametrize("changes", [{"vehicle.load_t": 15.0}, {"vehicle.preset": "metro-81-7036"}])
def test_a_load_is_saved_as_it_is_written(changes: dict[str, object]) -> None:
    scenario = freight(changes) if "vehicle.load_t" in changes else plain_scenario({})
    if "vehicle.preset" in changes:
        scenario = plain_scenario({"vehicle": {"preset": "metro-81-7036", "load_t": 10.0}})
        assert scenario.vehicle.load_t == 10.0
        assert len(format_scenario(scenario).split("[vehicle]")[1].split("[")[0].strip().splitlines()) == 2
    assert parse_scenario(format_scenario(scenario)) == scenario


@pytest.mark.parametrize(
    ("changes", "mass_t"),
    [
        ({"disturbance.actual_load_t": 30.0}, 130.0),
        ({"disturbance.actual_load_factor": 0.75}, 145.0),
        ({"disturbance.actual_load_t": 0.0}, 100.0),
        ({}, 115.0),
    ],
)
def test_the_actual_load_replaces_the_planned_one(changes: dict[str, object], mass_t: float) -> None:
    scenario = freight({"vehicle.load_t": 15.0, **changes})
    assert actual_vehicle(scenario).vehicle.total_mass_kg == pytest.approx(1000 * mass_t)
    assert scenario.actual_load_share == pytest.approx((mass_t - 100) / 60)


def test_monte_carlo_draws_shares_around_the_tonnes() -> None:
    loads = draw(freight({"vehicle.load_t": 30.0, "montecarlo.runs": 500}))["load_factor"]
    assert abs(float(loads.mean()) - 0.5) < 0.03
    assert 0 <= float(loads.min()) < float(loads.max()) <= 1


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"vehicle.load_t": 61.0}, "load_t = 61 must be at most 60, the capacity with crush_load_factor"),
        ({"disturbance.actual_load_t": 61.0}, "disturbance.actual_load_t = 61 must be at most 60"),
        ({"vehicle": {"max_load_t": 60.0, "capacity_passengers": 9}}, "needs only one of max_load_t and"),
        ({"vehicle": {"load_t": 1.0, "load_factor": 0.5}}, "needs only one of load_t and load_factor"),
        ({"disturbance": {"actual_load_t": 1.0, "actual_load_factor": 0.5}}, "needs only one of actual_load_t and"),
    ],
)
def test_two_loads_or_too_much_are_refused(changes: dict[str, object], sentence: str) -> None:
    table = changes.pop("vehicle", None)
    document = {**plain_scenario(FREIGHT).vehicle.model_dump(mode="json", exclude_none=True), **(table or {})}
    with pytest.raises(ScenarioError) as refusal:
        freight(changes) if table is None else plain_scenario({"vehicle": document})
    assert sentence in str(refusal.value)


def test_a_share_of_nothing_is_refused_with_both_ways_out() -> None:
    with pytest.raises(ScenarioError, match=r"or max_load_t; load_t is a load in tonnes"):
        plain_scenario({"vehicle.capacity_passengers": 0, "vehicle.load_factor": 0.5})
