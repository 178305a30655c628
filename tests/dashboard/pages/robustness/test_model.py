import pytest

from railjoule.core import load_scenario
from railjoule.dashboard.pages.robustness.fields import RealityFields
from railjoule.dashboard.pages.robustness.model import FIRST_ERROR_M, FIRST_LOAD_PERCENT, RobustnessModel
from railjoule.dashboard.pages.robustness.work import Robustness
from railjoule.dashboard.state.workbench import Workbench


def test_the_first_reality_is_one_in_which_something_goes_wrong() -> None:
    model = RobustnessModel()
    model.take(load_scenario("liashenko-ii"))
    assert (model.actual_load_percent, model.coordinate_error_m) == (FIRST_LOAD_PERCENT, FIRST_ERROR_M)


def test_a_file_that_names_its_reality_is_believed() -> None:
    model = RobustnessModel()
    model.take(load_scenario("liashenko-fig-4"))
    assert model.actual_load_percent == pytest.approx(20.0)
    assert model.coordinate_error_m == -5.0


def test_its_changes_are_keys_of_the_file() -> None:
    model = RobustnessModel(actual_load_percent=70.0, stop_sensor_m=20.0, speed_error_percent=1.0, target_braking=True)
    scenario = load_scenario("liashenko-ii").replace(**model.changes)
    assert scenario.disturbance.actual_load_factor == 0.7
    assert scenario.simulation.stop_sensor_m == 20.0
    assert scenario.simulation.speed_error == 0.01


@pytest.mark.parametrize("late", [0.0, 12.0])
def test_what_chance_draws_are_keys_of_the_file(late: float) -> None:
    model = RobustnessModel(mean_departure_delay_s=late, seed=9)
    drawn = load_scenario("liashenko-ii").replace(**model.chance_changes(77)).montecarlo
    assert (drawn.runs, drawn.seed) == (77, 9)
    assert drawn.departure_delay_s.distribution == ("exponential" if late else "fixed")
    assert drawn.resistance_factor.distribution == "log_normal"


def test_sensors_are_keys_of_target_braking_only() -> None:
    """Those of a file are taken away with it, as the scenario would refuse them."""
    of_a_file = load_scenario("liashenko-ii").replace(**{"simulation.stop_sensor_m": 20.0})
    model = RobustnessModel(stop_sensor_m=20.0, target_braking=False)
    assert of_a_file.replace(**model.changes).simulation.stop_sensor_m == 15.0


# a metro with automatic train operation, and a tram without
@pytest.mark.parametrize(
    ("preset", "shown"),
    [("metro-with-limit", True), ("metro-10-stations", True), ("liashenko-ii", True), ("tram-950m", False)],
)
def test_sensors_are_shown_where_the_train_brakes_along_the_target_curve(preset: str, shown: bool) -> None:
    state = Workbench()
    Robustness(state)
    fields = RealityFields(state)
    state.scenario.choose(preset)
    assert state.robustness.target_braking == fields.sensors.visible == shown
    state.robustness.target_braking = not shown
    assert fields.sensors.visible == (not shown)


def test_the_first_run_stops_at_the_platform() -> None:
    """Without the target curve its headline was a saving of 1.8 % by a train 14.5 m beyond the platform."""
    state = Workbench()
    Robustness(state)
    state.page = "Robustness"
    reality = state.robustness.reality
    assert abs(reality.following.stop_error_m) < 0.05
    assert reality.following.actual.energy_kwh > (reality.replanned_kwh or 0.0)
