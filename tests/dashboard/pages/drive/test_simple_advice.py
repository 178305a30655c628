"""Simpler advice on Drive: nothing before it is asked for, stale requests dropped, old figures told as such."""

import json
import re
import threading
from functools import cache
from html import unescape
from typing import Any

import pytest
from bokeh.document import Document
from turns import PATIENCE_S

from railjoule.core import Scenario, StrategyRefusedError, load_scenario
from railjoule.dashboard.browser.browser import Browser
from railjoule.dashboard.keep.pins import run_again
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.pages.drive import simple_work
from railjoule.dashboard.pages.drive.simple_work import SimpleAdvising
from railjoule.dashboard.pages.drive.view import DriveView
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.state.pins import KeptPin
from railjoule.dashboard.state.workbench import Workbench
from railjoule.dashboard.work.runs import Runs, RunsRequest, compute_runs
from railjoule.dashboard.work.simple_advice import compute_simple_advice, first_told

SCENARIO = "tram-950m-recuperating"


@cache
def advice_of(travel_time_s: float) -> Any:
    return compute_simple_advice(load_scenario(SCENARIO, {"timetable.travel_time_s": travel_time_s}))


class Searcher:
    """Searches once for each travel time, or refuses; notes what it was asked for."""

    def __init__(self) -> None:
        self.asked: list[float] = []
        self.refusal: StrategyRefusedError | None = None
        self.may_go_on = threading.Event()
        self.may_go_on.set()

    def __call__(self, scenario: Scenario) -> Any:
        self.asked.append(scenario.travel_time_s)
        assert self.may_go_on.wait(PATIENCE_S)
        if self.refusal is not None:
            raise self.refusal
        return advice_of(scenario.travel_time_s)


@cache
def runs() -> Runs:
    return compute_runs(RunsRequest(load_scenario(SCENARIO), ("optimal", "fastest")))


class Desk:
    """A page turned to Drive."""

    def __init__(self) -> None:
        self.state = Workbench()
        self.work = SimpleAdvising(self.state)
        self.view = DriveView(self.state, Browser(), Palette(dark=False))
        self.state.scenario.choose(SCENARIO)
        self.state.param.update(page="Drive", chosen="optimal", runs=runs())

    @property
    def section(self) -> Any:
        return self.view.simple

    @property
    def told(self) -> str:
        return re.sub(r"<[^>]+>", "", self.section.told.object)

    def open(self) -> None:
        self.section.head._handle_msg({"what": "turn"})


@pytest.fixture
def searcher(monkeypatch: pytest.MonkeyPatch) -> Searcher:
    searcher = Searcher()
    monkeypatch.setattr(simple_work, "compute_simple_advice", searcher)
    return searcher


@pytest.fixture
def desk(searcher: Searcher) -> Desk:
    return Desk()


def test_nothing_is_computed_before_it_is_opened(desk: Desk, searcher: Searcher) -> None:
    assert desk.section.view.visible
    assert not desk.section.body.visible
    desk.state.scenario.travel_time_s += 5
    assert searcher.asked == []


def test_opening_shows_the_fewest_orders_that_cost_little(desk: Desk, searcher: Searcher) -> None:
    desk.open()
    model, section = desk.state.simple, desk.section
    assert len(searcher.asked) == 1
    assert section.results.visible
    assert not section.again.visible
    assert "changes" in desk.told
    chosen = model.chosen
    assert chosen is first_told(model.found.advice)
    assert section.choice.value == chosen.changes
    assert list(section.choice.options.values()) == list(model.found.runs)
    assert section.orders.object == parts.advice(
        chosen.run,
        False,
        "simpler advice",
        f", at most {chosen.changes} changes of regime",
        parts.driver_sheet(chosen.run),
    )
    # closed and opened again, it is still there
    desk.open()
    assert not section.body.visible
    desk.open()
    assert section.results.visible
    assert len(searcher.asked) == 1


def test_the_chart_tells_what_the_table_does(desk: Desk) -> None:
    desk.open()
    found, chart = desk.state.simple.found, desk.section.chart
    assert list(chart.sources["runs"].data["x"]) == list(found.runs)
    prices = [simple.run.energy_kwh - found.advice.optimum.energy_kwh for simple in found.runs.values()]
    assert list(chart.sources["runs"].data["y"]) == pytest.approx(prices)
    assert list(chart.sources["chosen"].data["x"]) == [desk.state.simple.changes]


def test_a_changed_scenario_makes_it_stale_until_it_is_asked_for_again(desk: Desk, searcher: Searcher) -> None:
    desk.open()
    section, time_s = desk.section, desk.state.scenario.travel_time_s
    desk.state.scenario.travel_time_s = time_s + 10
    assert desk.state.simple.stale
    assert section.results.css_classes == ["rj-stale"]
    assert "stale" in section.orders.object
    assert "<div class=stale>" in section.table.object
    assert section.again.visible
    assert "from before" in desk.told
    # who comes back has not changed it
    desk.state.scenario.travel_time_s = time_s
    assert not desk.state.simple.stale
    assert not section.again.visible
    desk.state.scenario.travel_time_s = time_s + 10
    section._press()
    assert searcher.asked == [time_s, time_s + 10]
    assert not desk.state.simple.stale
    assert desk.state.simple.chosen.run.travel_time_s == pytest.approx(time_s + 10, abs=1e-2)
    assert section.results.css_classes == []


def test_another_scenario_has_none_of_it(desk: Desk) -> None:
    # in a document, where the widget takes none but its own options
    desk.section.view.get_root(Document())
    desk.open()
    desk.state.scenario.choose("liashenko-0")
    assert desk.state.simple.found is None
    assert desk.state.simple.changes is None
    assert desk.section.choice.value is None
    assert desk.section.choice.options == {}
    assert not desk.section.results.visible
    assert desk.section.again.label == "Compute"


def test_a_refusal_is_told_and_can_be_tried_again(desk: Desk, searcher: Searcher) -> None:
    searcher.refusal = StrategyRefusedError("finds no run with at most 9 changes of regime that is in time.")
    desk.open()
    assert desk.told == "This run is not possible. Finds no run with at most 9 changes of regime that is in time."
    assert desk.section.again.visible
    searcher.refusal = None
    desk.section._press()
    assert desk.section.results.visible
    assert desk.state.simple.failure is None


def test_the_chosen_run_is_pinned_and_run_again_from_an_address(desk: Desk) -> None:
    desk.open()
    section, chosen = desk.section, desk.state.simple.chosen
    section.pin.clicks += 1
    (pin,) = desk.state.pins
    assert pin.trajectory is chosen.run
    assert pin.name.startswith("Simpler advice, ")
    assert pin.name.endswith(f", {chosen.changes} changes")
    assert section.pin.disabled
    desk.state.pin_simple()
    assert len(desk.state.pins) == 1
    kept = KeptPin(**KeptPin.of(pin).keep())
    assert kept.recipe() == pin.recipe
    (again,) = run_again((kept,))
    assert again.trajectory.energy.net_j == chosen.run.energy.net_j
    desk.state.unpin(pin)
    assert not section.pin.disabled


def test_a_pin_of_more_changes_than_are_of_use_is_refused() -> None:
    with pytest.raises(StrategyRefusedError, match="finds no run that 9 changes of regime make better"):
        run_again((KeptPin(preset="liashenko-ii", simple=9),))


def test_the_sheet_has_timetable_and_limits() -> None:
    run = compute_runs(RunsRequest(load_scenario("metro-with-limit"), ("optimal",))).runs["optimal"]
    markup = parts.advice(run, False, "simpler advice", "", parts.driver_sheet(run))
    found = re.search("data-sheet='([^']*)'", markup)
    sheet = json.loads(unescape(found[1]))
    assert sheet["before"] == [
        "Timetable",
        [["0 m", "", "departs 0.0 s"], ["2\u202f300 m", "arrives 170.0 s", ""]],
    ]
    # the file's one limit, and the vehicle's largest speed
    assert sheet["after"] == [
        "Speed limits",
        [["0 m to 600 m", "80 km/h"], ["600 m to 900 m", "50 km/h"], ["900 m to 2\u202f300 m", "80 km/h"]],
    ]
