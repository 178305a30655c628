"""The bound on Drive as it tightens: stale proofs are dropped, no bound falls, and Stop stops."""

import re
import threading
import time
from collections.abc import Iterator
from dataclasses import replace
from functools import cache

import pytest
from panel.io.state import set_curdoc
from turns import PATIENCE_S, Page

from railjoule.core import load_scenario
from railjoule.core.bounds import FIRST_STAGE_BOXES, ProofStep
from railjoule.dashboard.browser import Browser
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.page_host import PageHost
from railjoule.dashboard.page_work import PageWorks
from railjoule.dashboard.pages.drive import page
from railjoule.dashboard.work import runs
from railjoule.dashboard.work.runs import FURTHER_BOXES, ProofRequest, Runs, RunsRequest, compute_proof, compute_runs
from railjoule.dashboard.workbench import Workbench

TRAM = "tram-950m-recuperating"
FIRST_SHARE = 0.5
"""How much of the gap, 0.12 %, the first stage of these tests closes: what leaves less than 0.05 % open is proven."""


class Prover:
    """Proves at once, by steps that a test sets: how much of the gap to the run each of them closes."""

    def __init__(self) -> None:
        self.shares = [0.3, FIRST_SHARE]
        self.asked: list[int] = []
        self.reached = False
        self.may_go_on, self.ended = threading.Event(), threading.Event()
        self.may_go_on.set()

    def __call__(self, request: ProofRequest) -> Iterator[ProofStep]:
        """Take the place of `railjoule.core.bounds.tightening`."""
        self.asked.append(request.budget)
        bound = request.run.bound
        for number, share in enumerate(self.shares, 1):
            energy = first_j(request) + share * (request.run.energy.net_j - first_j(request))
            step = replace(bound, energy_j=max(energy, bound.energy_j))
            yield ProofStep(step, number * 1000, request.budget, self.reached, exhausted=False)
            if number == len(self.shares) - 1:
                assert self.may_go_on.wait(PATIENCE_S)
                self.ended.set()


def first_j(request: ProofRequest) -> float:
    """Return the first bound of a request [J]: a proof leaves the bound of every driving as it is."""
    return request.run.bound.every_run_j


@cache
def runs_of(name: str, travel_time_s: float) -> Runs:
    """Return the optimum and the fastest run of a scenario, computed once for all tests."""
    scenario = load_scenario(name).replace(**{"timetable.travel_time_s": travel_time_s})
    return compute_runs(RunsRequest(scenario, ("optimal", "fastest")))


class Desk:
    """A page turned to Drive, with its proofs."""

    def __init__(self) -> None:
        self.state = Workbench()
        self.work = PageWorks(self.state.pages["Drive"])
        self.host = PageHost(self.state.pages["Drive"], Browser(), Palette(dark=False))
        self.page = self.state.pages["Drive"]
        self.state.scenario.choose(TRAM)
        self.state.param.update(page="Drive", chosen="optimal")

    def run(self) -> None:
        """Take the runs of the scenario as it stands."""
        scenario = self.state.scenario.scenario()
        self.state.runs = self.state.proof.laid_on(runs_of(self.state.scenario.preset, scenario.travel_time_s))

    @property
    def closed(self) -> float:
        """How much of the first gap is closed."""
        run = self.state.run
        return (run.bound.energy_j - run.bound.every_run_j) / (run.energy.net_j - run.bound.every_run_j)

    @property
    def words(self) -> str:
        return " ".join(re.sub(r"<[^>]+>", " ", self.page.proof.object).split())


@pytest.fixture
def prover(monkeypatch: pytest.MonkeyPatch) -> Prover:
    prover = Prover()

    def prove(request: ProofRequest) -> Iterator[runs.Proven]:
        monkeypatch.setattr(runs, "tightening", lambda *_: prover(request))
        yield from compute_proof(request)

    monkeypatch.setattr(page, "compute_proof", prove)
    return prover


@pytest.fixture
def desk(prover: Prover) -> Desk:
    desk = Desk()
    desk.run()
    return desk


def test_the_first_stage_follows_the_run(desk: Desk, prover: Prover) -> None:
    assert prover.asked == [FIRST_STAGE_BOXES]
    assert desk.closed == pytest.approx(FIRST_SHARE)
    assert not desk.state.run.is_proven
    assert not desk.page.proving
    assert not desk.page.proving_further
    assert desk.words.startswith(
        "Lower bound No way of driving this train over this line within 95.0 s uses less than "
    )
    assert desk.page.prove.visible
    assert desk.page.prove.label == "Prove further"
    # all runs that it covers have it, so that one number has one value
    assert desk.state.runs.runs["fastest"].bound is desk.state.run.bound


def test_a_looser_bound_replaces_none(desk: Desk, prover: Prover) -> None:
    prover.shares = [0.1, 0.2]
    desk.page.param.trigger("prove_further")
    assert prover.asked == [FIRST_STAGE_BOXES, FURTHER_BOXES]
    assert desk.closed == pytest.approx(FIRST_SHARE)
    assert not desk.page.prove.visible
    assert "--prove-seconds" in desk.words


def test_prove_further_ends_where_the_proof_aims(desk: Desk, prover: Prover) -> None:
    prover.shares, prover.reached = [0.9], True
    desk.page.prove.param.trigger("clicks")
    assert desk.closed == pytest.approx(0.9)
    # within the tolerance the run is proven, and nothing is left to prove
    assert desk.state.run.is_proven
    assert not desk.page.prove.visible


def test_pins_have_the_same_bound(desk: Desk, prover: Prover) -> None:
    desk.state.pin()
    prover.shares = [0.8]
    desk.page.param.trigger("prove_further")
    assert desk.state.pins[0].trajectory.bound is desk.state.run.bound


def test_a_pin_that_is_run_again_has_what_is_proven(desk: Desk) -> None:
    first = runs_of(TRAM, desk.state.scenario.travel_time_s).runs["optimal"]
    assert desk.state.proof.bounded(first).bound is desk.state.run.bound
    other = runs_of(TRAM, desk.state.scenario.travel_time_s + 5).runs["optimal"]
    assert desk.state.proof.bounded(other) is other


def test_another_scenario_has_a_proof_of_its_own_and_undo_needs_none(desk: Desk, prover: Prover) -> None:
    time = desk.state.scenario.travel_time_s
    prover.shares = [0.4]
    desk.state.scenario.travel_time_s = time + 5
    assert desk.closed == pytest.approx(FIRST_SHARE), "what is shown is still the last run"
    desk.run()
    assert desk.closed == pytest.approx(0.4)
    desk.state.scenario.travel_time_s = time
    desk.run()
    assert desk.closed == pytest.approx(FIRST_SHARE)
    assert prover.asked == [FIRST_STAGE_BOXES] * 2


def test_smooth_drives_and_other_pages_need_no_proof(prover: Prover) -> None:
    desk = Desk()
    desk.state.page = "Trade-off"
    desk.run()
    assert prover.asked == []
    desk.state.page = "Drive"
    assert prover.asked == [FIRST_STAGE_BOXES]
    desk.state.scenario.choose("metro-with-limit")
    desk.run()
    assert prover.asked == [FIRST_STAGE_BOXES]
    assert "uses less than" in desk.words
    assert not desk.page.prove.visible


def test_the_price_of_force_is_drawn_on_request(desk: Desk) -> None:
    chart = desk.host.plots["price"]
    assert not chart.host.visible
    desk.page.prices.param.trigger("clicks")
    assert chart.host.visible
    assert desk.page.prices.label == "Hide price of force"
    places = desk.state.run.bound.costate.position_m
    assert len(chart.sources["price"].data["x"]) == len(places)
    # a bound that chains of boxes tighten has no single price along the line
    tighter = replace(desk.state.run.bound, energy_j=desk.state.run.bound.energy_j + 1.0, costate=None)
    desk.state.take_bound(desk.state.runs.scenario, tighter)
    assert not chart.host.visible
    assert not desk.page.prices.visible


@pytest.mark.parametrize("how", ["stop", "move"])
def test_what_comes_too_late_is_dropped(desk: Desk, prover: Prover, how: str) -> None:
    page = Page()
    prover.shares = [0.7, 0.9]
    prover.may_go_on.clear()
    prover.ended.clear()
    with set_curdoc(page.document):
        desk.page.param.trigger("prove_further")
        assert desk.page.proving_further
        assert desk.page.prove.label == "Stop"
        # a step is on its way when the work ends
        while not page.is_due:
            time.sleep(0.01)
        if how == "stop":
            desk.page.prove.param.trigger("clicks")
        else:
            desk.state.scenario.travel_time_s += 5
    assert not desk.page.proving
    assert not desk.page.proving_further
    prover.may_go_on.set()
    assert prover.ended.wait(PATIENCE_S)
    while page.is_due:
        page.take_turn()
    assert desk.closed == pytest.approx(FIRST_SHARE)
