"""Edits of the scenario reach the pages that have fields of their own for them."""

import pytest

from railjoule.dashboard.pages.host import make_works
from railjoule.dashboard.state.workbench import Workbench


@pytest.fixture
def state() -> Workbench:
    return Workbench()


def test_sections_follow_an_edited_line_and_search(state: Workbench) -> None:
    make_works("Set speeds")(state)
    page = state.pages["Set speeds"]
    state.scenario.edit({"line": {"preset": "flat-5km"}, "search.limits_kmh": [50.0, 60.0]})
    state.scenario.edit({"search.boundaries_m": [3000.0]})
    assert (page.borders_m, page.limits_kmh) == ((3000.0,), (50.0, 60.0))
    assert page.sections[-1].to_m == 5000.0


def test_events_follow_edited_disturbances(state: Workbench) -> None:
    make_works("What if")(state)
    stop = {"position_m": 0.5, "duration_s": 9.0}
    state.scenario.edit({"disturbance.stops": [stop], "disturbance.accepted_delay_s": 7200.0})
    (event,) = state.day.events
    assert (event.position_m, event.duration_s, state.day.accepted_delay_s) == (0.5, 9.0, 7200.0)


def test_reality_follows_edited_disturbance_and_sensors(state: Workbench) -> None:
    make_works("What if")(state)
    state.scenario.edit(
        {
            "disturbance.coordinate_error_m": -7.0,
            "simulation.target_braking": True,
            "simulation.reset_sensor_m": 250.0,
        }
    )
    assert (state.day.coordinate_error_m, state.day.reset_sensor_m) == (-7.0, 250.0)
