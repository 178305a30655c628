"""Simple advice on Drive: nothing before it is asked for, and never that of another plan."""

import re
import threading
from functools import cache
from typing import Any

import pytest
from turns import PATIENCE_S

from railjoule.core import Scenario, StrategyRefusedError, load_scenario
from railjoule.dashboard.browser import Browser
from railjoule.dashboard.keep.pins import run_again
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.page_host import PageHost
from railjoule.dashboard.page_work import PageWorks
from railjoule.dashboard.pages.drive import page
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.state.pins import KeptPin
from railjoule.dashboard.work.runs import Runs, RunsRequest, compute_runs
from railjoule.dashboard.work.simple_advice import choose_simple, compute_simple_advice
from railjoule.dashboard.workbench import Workbench

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
        return (
            advice_of(scenario.travel_time_s) if scenario.title.startswith("Tram") else compute_simple_advice(scenario)
        )


@cache
def runs_in(travel_time_s: float) -> Runs:
    scenario = load_scenario(SCENARIO, {"timetable.travel_time_s": travel_time_s})
    return compute_runs(RunsRequest(scenario, ("optimal", "fastest")))


class Desk:
    """A page turned to Drive."""

    def __init__(self) -> None:
        self.state = Workbench()
        PageWorks(self.state.pages["Drive"])
        self.host = PageHost(self.state.pages["Drive"], Browser(), Palette(dark=False))
        self.page = self.state.pages["Drive"]
        self.state.scenario.choose(SCENARIO)
        self.state.param.update(page="Drive", chosen="optimal", runs=runs_in(self.state.scenario.travel_time_s))

    @property
    def text(self) -> str:
        return " ".join(re.sub(r"<[^>]+>", " ", self.page.advice_pane.object).split())


@pytest.fixture
def searcher(monkeypatch: pytest.MonkeyPatch) -> Searcher:
    searcher = Searcher()
    monkeypatch.setattr(page, "compute_simple_advice", searcher)
    return searcher


@pytest.fixture
def desk(searcher: Searcher) -> Desk:
    return Desk()


def test_nothing_is_computed_before_it_is_asked_for(desk: Desk, searcher: Searcher) -> None:
    desk.state.scenario.travel_time_s += 5
    assert searcher.asked == []
    assert not desk.page.pin.visible


def test_the_switch_shows_the_fewest_instructions_that_cost_little(desk: Desk, searcher: Searcher) -> None:
    exact = desk.text
    desk.page.advice = "simple"
    assert len(searcher.asked) == 1
    simple, sentence = choose_simple(desk.page.simple.found)
    assert simple is not None
    assert desk.page.advice_pane.object.startswith(parts.advice(simple.run, False).removesuffix("</div>"))
    assert sentence in desk.text
    # the run is drawn beside the optimum
    assert list(desk.host.plots["speed"].sources["variant"].data["y"])[-1] == pytest.approx(0.0)
    desk.page.advice = "exact"
    assert desk.text == exact
    assert not len(desk.host.plots["speed"].sources["variant"].data["y"])


def test_another_travel_time_shows_the_optimum_until_its_advice_is_there(desk: Desk, searcher: Searcher) -> None:
    desk.page.advice = "simple"
    time_s = desk.state.scenario.travel_time_s + 10
    desk.state.runs = runs_in(time_s)
    assert "Computing simple advice" in desk.text
    assert "stale" in desk.page.advice_pane.object
    desk.state.scenario.travel_time_s = time_s
    assert searcher.asked == [time_s - 10, time_s]
    assert "Computing" not in desk.text


def test_another_scenario_has_advice_of_its_own(desk: Desk, searcher: Searcher) -> None:
    desk.page.advice = "simple"
    before = desk.page.simple
    desk.state.scenario.choose("liashenko-0")
    assert desk.page.simple is not before
    assert desk.page.simple.request.title == "Metro, profile 0"


def test_a_refusal_is_a_sentence(desk: Desk, searcher: Searcher) -> None:
    searcher.refusal = StrategyRefusedError("finds no run with at most 9 changes of regime that is in time.")
    desk.page.advice = "simple"
    assert "Simple advice finds no run with at most 9 changes of regime that is in time." in desk.text
    assert not desk.page.pin.visible
    assert desk.page.failure is None


def test_the_chosen_run_is_pinned_and_run_again_from_an_address(desk: Desk) -> None:
    desk.page.advice = "simple"
    chosen, _ = choose_simple(desk.page.simple.found)
    assert chosen is not None
    desk.page.pin.clicks += 1
    (pin,) = desk.state.pins
    assert pin.trajectory is chosen.run
    assert pin.name.startswith("Simple advice, ")
    assert pin.name.endswith(f", {chosen.changes} changes")
    assert desk.page.pin.disabled
    desk.page.pin.clicks += 1
    assert len(desk.state.pins) == 1
    kept = KeptPin(**KeptPin.of(pin).keep())
    assert kept.recipe() == pin.recipe
    (again,) = run_again((kept,))
    assert again.trajectory.energy.net_j == chosen.run.energy.net_j
    desk.state.unpin(pin)
    assert not desk.page.pin.disabled


def test_a_pin_of_more_changes_than_are_of_use_is_refused() -> None:
    with pytest.raises(StrategyRefusedError, match="finds no run that 9 changes of regime make better"):
        run_again((KeptPin(preset="liashenko-ii", simple=9),))
