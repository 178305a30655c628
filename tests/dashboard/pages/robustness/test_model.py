import pytest

from railjoule.dashboard.pages.robustness.fields import RealityFields
from railjoule.dashboard.pages.robustness.work import Robustness
from railjoule.dashboard.state.workbench import Workbench


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
    assert state.day.target_braking == fields.sensors.visible == shown
    state.day.target_braking = not shown
    assert fields.sensors.visible == (not shown)


def test_the_first_run_stops_at_the_platform() -> None:
    """Without the target curve its headline was a saving of 1.8 % by a train 14.5 m beyond the platform."""
    state = Workbench()
    Robustness(state)
    state.page = "Robustness"
    reality = state.robustness.reality
    assert abs(reality.following.stop_error_m) < 0.05
    assert reality.following.actual.energy_kwh > (reality.replanned_kwh or 0.0)
