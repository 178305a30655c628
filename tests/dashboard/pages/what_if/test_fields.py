"""The sidebar's part of What if."""

import pytest

from railjoule.dashboard.pages.what_if.fields import WhatIfFields
from railjoule.dashboard.workbench import Workbench


# a metro with automatic train operation, and a tram without
@pytest.mark.parametrize(
    ("preset", "shown"),
    [("metro-with-limit", True), ("metro-10-stations", True), ("liashenko-ii", True), ("tram-950m", False)],
)
def test_sensors_are_shown_where_the_train_brakes_along_the_target_curve(preset: str, shown: bool) -> None:
    state = Workbench()
    fields = WhatIfFields(state.pages["What if"])
    state.scenario.choose(preset)
    assert state.day.target_braking == fields.sensors.visible == shown
    state.day.target_braking = not shown
    assert fields.sensors.visible == (not shown)


def test_the_fields_are_those_of_the_tab() -> None:
    state = Workbench()
    page = state.pages["What if"]
    fields = WhatIfFields(state.pages["What if"])
    assert [part.visible for part in fields.parts.values()] == [True, False, False]
    assert not list(fields.parts["events"])
    page.tab = "events"
    assert [part.visible for part in fields.parts.values()] == [False, True, False]
    fields._adder("limit")(None)
    assert [event.kind for event in state.day.events] == ["limit"]
    assert len(fields.list) == 1
    page.tab = "chance"
    page.drawing = True
    assert fields.drawing._stop.visible
    fields.drawing._stop.clicks += 1
    assert not page.drawing
