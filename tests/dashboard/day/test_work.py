"""The actual run on Drive is that of What if; no expected number is written down here."""

from itertools import pairwise

import pytest

from railjoule.core import load_scenario
from railjoule.dashboard.browser import Browser
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.page_host import PageHost
from railjoule.dashboard.page_work import PageWorks
from railjoule.dashboard.work.runs import RunsRequest, compute_runs
from railjoule.dashboard.workbench import Workbench


class Pages:
    """The work of both pages over one state, all done in the test's own turn."""

    def __init__(self, preset="metro-with-limit"):
        self.state = Workbench()
        PageWorks(self.state.pages["What if"])
        PageWorks(self.state.pages["Drive"])
        if preset != self.state.scenario.preset:
            self.state.scenario.choose(preset)
        if not self.state.day.events:
            self.state.day.add_stop()
        self.state.page = "Drive"

    def run(self):
        self.state.page = "Drive"
        return self.state.pages["Drive"].actual

    def draw(self):
        state = self.state
        state.runs = compute_runs(RunsRequest(state.scenario.scenario(), state.drawn))
        return PageHost(state.pages["Drive"], Browser(), Palette(dark=False))


@pytest.fixture
def pages():
    return Pages()


@pytest.mark.parametrize("preset", ["metro-with-limit", "liashenko-fig-3"])
def test_without_events_it_is_the_run_of_robustness(preset):
    pages = Pages(preset)
    pages.state.day.on = True
    pages.state.day.events = []
    run = pages.run()
    pages.state.page = "What if"
    following = pages.state.pages["What if"].reality.following
    assert run.actual.energy_kwh == following.actual.energy_kwh
    assert run.planned.energy_kwh == following.planned.energy_kwh
    assert run.delay_s == following.delay_s


@pytest.mark.parametrize("reaction", ["driver", "computer", "known"])
def test_it_is_the_ride_of_disturbances_with_all_that_differs(pages, reaction):
    state = pages.state
    state.day.param.update(on=True, reaction=reaction)
    state.day.param.update(actual_load_percent=80.0, coordinate_error_m=10.0)
    run = pages.run()
    state.pages["What if"].tab = "events"
    state.page = "What if"
    ride = state.pages["What if"].rides.rides[reaction]
    assert ride.actual.energy_kwh == run.actual.energy_kwh
    assert ride.planned.energy_kwh == run.planned.energy_kwh
    assert ride.delay_s == pytest.approx(run.delay_s)
    assert [cause.name for cause in run.causes] == ["load", "position", "stops"]


def test_switched_off_disturbances_has_its_events_alone(pages):
    state = pages.state
    state.pages["What if"].tab = "events"
    state.page = "What if"
    alone = state.pages["What if"].rides.rides["driver"]
    state.day.on = True
    assert state.pages["What if"].rides.rides["driver"].actual.energy_kwh != alone.actual.energy_kwh
    state.day.param.update(actual_load_percent=state.scenario.load_percent, coordinate_error_m=0.0)
    assert state.pages["What if"].rides.rides["driver"].actual.energy_kwh == pytest.approx(alone.actual.energy_kwh)


@pytest.mark.parametrize(
    ("model", "field", "value"),
    [
        ("scenario", "travel_time_s", 200.0),
        ("scenario", "load_percent", 20.0),
        ("scenario", "recuperation_percent", 80.0),
        ("day", "actual_load_percent", 70.0),
        ("day", "coordinate_error_m", -15.0),
    ],
)
def test_each_widget_acts(pages, model, field, value):
    pages.state.day.on = True
    before = pages.run()
    setattr(getattr(pages.state, model), field, value)
    after = pages.run()
    assert after is not before
    assert after.extra_kwh != before.extra_kwh


def test_as_planned_there_is_nothing_extra(pages):
    state = pages.state
    state.day.on = True
    state.day.as_planned()
    run = pages.run()
    assert (run.extra_kwh, run.causes) == (0.0, ())
    assert "The actual run equals the plan" in pages.draw().figures.object


def test_a_stop_is_added_in_the_middle_of_the_longest_free_stretch():
    state = Pages("metro-10-stations").state
    state.day.events = []
    places = state.day.occupied_m()
    longest = max(after - before for before, after in pairwise(places))
    state.day.add_stop()
    (stop,) = state.day.events
    assert min(abs(stop.position_m - place) for place in places) == pytest.approx(0.5 * longest, abs=0.5)
    assert stop.noticed_at_m < stop.position_m


def test_a_moved_stop_is_noticed_as_far_ahead_as_before(pages):
    (stop,) = pages.state.day.events
    ahead = stop.position_m - stop.noticed_at_m
    stop.move(1450.0)
    assert (stop.position_m, stop.noticed_at_m) == (1450.0, 1450.0 - ahead)


def test_a_stop_beyond_the_line_or_at_another_is_refused(pages):
    state = pages.state
    state.day.add_stop()
    first, second = state.day.events
    with pytest.raises(ValueError, match=r"2310 m lies beyond the line, 2300 m"):
        state.day.checked_place(second, 2310.0)
    with pytest.raises(ValueError, match=f"from the one at {first.position_m:g} m"):
        state.day.checked_place(second, first.position_m)
    assert state.day.checked_place(second, second.position_m) == second.position_m


def test_a_failure_keeps_the_plan_and_says_why(pages):
    state = pages.state
    state.day.on = True
    state.day.events[0].position_m = 5000.0
    assert "must lie before the end of the line" in str(state.pages["Drive"].failure)
    view = pages.draw()
    assert "must lie before the end" in view.message.object
    assert "Energy from the supply" in view.figures.object


def test_a_preset_with_a_disturbance_opens_with_its_plan_and_shows_the_disturbance_once_switched_on():
    pages = Pages("liashenko-fig-3")
    assert pages.run() is None
    pages.state.day.on = True
    assert pages.run().scenario.disturbance.actual_load_factor == 1.0
    assert load_scenario("liashenko-fig-3").disturbance.coordinate_error_m == 10.0
