"""The actual conditions: what they take of a scenario, and what they give it."""

import pytest

from railjoule.core import load_scenario
from railjoule.core.simulation.disturbances import simulate_disturbances
from railjoule.dashboard.day import FIRST_ERROR_M, FIRST_LOAD_PERCENT, TABLES, Day
from railjoule.dashboard.state.scenario import ScenarioModel


def open_day(preset: str) -> Day:
    scenario = ScenarioModel()
    day = Day(scenario)
    scenario.choose(preset)
    return day


def test_at_first_the_plan_fails() -> None:
    day = open_day("liashenko-ii")
    assert (day.actual_load_percent, day.coordinate_error_m) == (FIRST_LOAD_PERCENT, FIRST_ERROR_M)


def test_the_conditions_of_a_file_are_taken() -> None:
    day = open_day("liashenko-fig-4")
    assert (day.actual_load_percent, day.coordinate_error_m) == (pytest.approx(20.0), -5.0)


def test_an_edit_of_something_else_leaves_what_was_set() -> None:
    day = open_day("tram-950m-stop")
    day.param.update(actual_load_percent=70.0, events=[])
    day.scenario.edit({"vehicle.auxiliary_power_kw": 40.0})
    assert (day.actual_load_percent, day.events) == (70.0, [])
    # sensors are no events
    day.drop("stop", 500.0)
    day.scenario.edit({"simulation.speed_error": 0.01})
    assert (day.speed_error_percent, len(day.events)) == (1.0, 1)
    day.scenario.edit({"disturbance.coordinate_error_m": 3.0})
    assert day.coordinate_error_m == 3.0
    assert [event.position_m for event in day.events] == [300.0]


def test_conditions_are_keys_of_the_file() -> None:
    day = open_day("liashenko-ii")
    day.param.update(actual_load_percent=70.0, stop_sensor_m=20.0, speed_error_percent=1.0, target_braking=True)
    scenario = load_scenario("liashenko-ii").replace(**day.conditions)
    assert scenario.disturbance.actual_load_factor == 0.7
    assert (scenario.simulation.stop_sensor_m, scenario.simulation.speed_error) == (20.0, 0.01)


@pytest.mark.parametrize("late", [0.0, 12.0])
def test_draws_are_keys_of_the_file(late: float) -> None:
    day = open_day("liashenko-ii")
    day.param.update(mean_departure_delay_s=late, seed=9)
    drawn = load_scenario("liashenko-ii").replace(**day.chance_changes(77)).montecarlo
    assert (drawn.runs, drawn.seed) == (77, 9)
    assert drawn.departure_delay_s.distribution == ("exponential" if late else "fixed")
    assert drawn.resistance_factor.distribution == "log_normal"


def test_sensors_are_keys_of_target_braking_only() -> None:
    """Without it, the sensors of a file are removed, as the scenario would refuse them."""
    of_a_file = load_scenario("liashenko-ii").replace(**{"simulation.stop_sensor_m": 20.0})
    day = open_day("liashenko-ii")
    day.param.update(stop_sensor_m=20.0, target_braking=False)
    assert of_a_file.replace(**day.conditions).simulation.stop_sensor_m == 15.0


def test_no_event_is_invented() -> None:
    day = open_day("tram-950m-stop")
    day.scenario.choose("liashenko-ii")
    assert day.events == []


def test_the_events_of_a_file_are_taken_over() -> None:
    day = open_day("tram-950m-stop")
    (stop,) = load_scenario("tram-950m-stop").replace(**day.event_tables).disturbance.stops
    assert (stop.position_m, stop.duration_s, stop.noticed_at_m) == (300.0, 5.0, 70.11)


@pytest.mark.parametrize("kind", TABLES)
def test_what_is_dropped_can_be_driven(kind: str) -> None:
    day = open_day("liashenko-ii")
    day.drop(kind, 500.4)
    (event,) = day.events
    assert event.position_m == 500.0
    scenario = load_scenario("liashenko-ii").replace(**day.event_tables)
    assert len(scenario.disturbance.events) == 1
    assert simulate_disturbances(scenario, "computer").actual.distance_m == pytest.approx(1300)


def test_a_changed_event_is_a_change_of_the_conditions() -> None:
    day = open_day("tram-950m-stop")
    heard: list[object] = []
    day.param.watch(heard.append, "changed")
    day.events[0].duration_s = 8.0
    assert len(heard) == 1
    day.drop("limit", 400.0)
    day.events[1].limit_kmh = 20.0
    day.events[0].duration_s = 9.0
    assert len(heard) == 3
