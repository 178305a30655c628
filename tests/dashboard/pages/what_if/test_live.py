"""The run that plays, as its page's work leads it: without a page around it, the clock is moved by hand."""

import pytest

from railjoule.core.simulation.disturbances import simulate_disturbances
from railjoule.dashboard.browser import Browser
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.page_host import PageHost
from railjoule.dashboard.page_work import PageWorks
from railjoule.dashboard.workbench import Workbench


def test_a_run_is_played_with_events_kept_and_computed_by_the_page() -> None:
    state = Workbench()
    PageWorks(state.pages["What if"])
    model = state.pages["What if"].live
    state.scenario.choose("liashenko-ii")
    state.pages["What if"].tab = "events"
    state.page = "What if"
    view = PageHost(state.pages["What if"], Browser(), Palette(dark=False))
    assert model.run is None
    model.on = model.playing = True
    model.pace = 20.0
    model.signal.param.update(position_m=900.0, duration_s=15.0)
    while model.run.position_m < 400.0:
        model.tick(0.1)
    drawn = view.plots["live_speed"].sources
    assert drawn["train"].data["x"] == pytest.approx([model.run.position_m])
    assert drawn["driven"].data["x"][-1] == pytest.approx(model.run.position_m)
    model.set(model.signal)
    assert model.failure is None
    assert list(drawn["signs"].data["text"]) == ["red 15 s"]
    assert "planned again in" in view.of.playing.status.object
    # one behind the train is refused, and the run goes on
    model.signal.position_m = 100.0
    model.set(model.signal)
    assert "is not ahead of the train" in view.of.playing.message.object
    while model.ended is None:
        model.tick(0.5)
    assert not model.playing
    assert "How it ended" in view.of.playing.table.object
    played = model.ended.live
    state.pages["What if"].keep_events()
    assert not model.on
    (event,) = state.day.events
    assert (event.kind, event.position_m, event.duration_s) == ("stop", 900.0, pytest.approx(15.0))
    replanned = state.pages["What if"].rides.rides["computer"]
    assert replanned.actual.energy_kwh == pytest.approx(played.actual.energy_kwh, rel=1e-6)
    assert simulate_disturbances(state.pages["What if"].rides.undisturbed.scenario).delay_s == pytest.approx(
        0.0, abs=1e-3
    )


def test_the_clock_stops_when_the_page_is_left_and_the_run_goes_with_its_scenario() -> None:
    state = Workbench()
    PageWorks(state.pages["What if"])
    state.pages["What if"].tab = "events"
    state.page = "What if"
    state.pages["What if"].live.on = state.pages["What if"].live.playing = True
    assert state.pages["What if"].live.run is not None
    state.page = "Drive"
    assert not state.pages["What if"].live.playing
    state.pages["What if"].tab = "events"
    state.page = "What if"
    before = state.pages["What if"].live.run
    assert before is not None
    state.scenario.choose("tram-950m")
    assert state.pages["What if"].live.run is not before
