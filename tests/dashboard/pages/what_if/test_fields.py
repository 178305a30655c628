"""The sidebar's part of What if."""

import pytest

from railjoule.dashboard.workbench import Workbench


# a metro with automatic train operation, and a tram without
@pytest.mark.parametrize(
    ("preset", "shown"),
    [("metro-with-limit", True), ("metro-10-stations", True), ("liashenko-ii", True), ("tram-950m", False)],
)
def test_sensors_are_shown_where_the_train_brakes_along_the_target_curve(preset: str, shown: bool) -> None:
    state = Workbench()
    page = state.pages["What if"]
    page.layout_fields()
    state.scenario.choose(preset)
    assert state.day.target_braking == page.sensors.visible == shown
    state.day.target_braking = not shown
    assert page.sensors.visible == (not shown)


def test_the_fields_are_those_of_the_tab() -> None:
    state = Workbench()
    page = state.pages["What if"]
    page.layout_fields()
    bodies = page.tab_fields.bodies
    assert [body.visible for body in bodies.values()] == [True, False, False]
    assert not list(bodies["events"])
    page.tab = "events"
    assert [body.visible for body in bodies.values()] == [False, True, False]
    page._drop_in_middle("limit")
    assert [event.kind for event in state.day.events] == ["limit"]
    assert len(page.list) == 1
    page.tab = "chance"
    page.drawing = True
    assert page.more_progress.stop.visible
    page.more_progress.stop.clicks += 1
    assert not page.drawing
