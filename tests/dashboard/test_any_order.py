"""No order of actions leaves the page, its address and its runs apart."""

from typing import Any

import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, precondition, rule

from railjoule.core import RailjouleError, load_scenario
from railjoule.core.scenario import format_scenario
from railjoule.dashboard.app import VIEWS, Session
from railjoule.dashboard.browser.browser import Browser
from railjoule.dashboard.keep.keeping import Keeping
from railjoule.dashboard.keep.pins import Pins
from railjoule.dashboard.keep.snapshot import VIEW, Snapshot, snapshot_of
from railjoule.dashboard.page_list import PAGES
from railjoule.dashboard.state.pins import MOST_PINS, KeptPin
from railjoule.dashboard.state.workbench import Workbench

EXAMPLES, STEPS = 6, 15
# short lines whose drives take no power idling, so that a run takes milliseconds
PRESETS = ("metro-with-limit", "liashenko-i", "liashenko-ii", "tram-950m")
QUICK = ("optimal", "fastest", "eoc", "phases")
EDITS: dict[str, tuple[Any, ...]] = {
    "vehicle.auxiliary_power_kw": (0.0, 40.0, -1.0),
    "vehicle.tare_kg": (150e3, 1.0, "heavy"),
    "solver.mesh_m": (5.0, 10.0, 0.001),
    "title": ("Other", "", "turned \u202e"),
    "line.no_such_key": (1,),
}
"""Values of keys; some are out of bounds, or of no key that there is."""
LINKS = ("?v=1&load_percent=400", "?v=9", "#v=1&preset=liashenko-ii&load_percent=20", "?v=1&edits=[", "?v=1&toml=x")


def opened(address: str) -> Workbench:
    """Return the state of a new page at an address, with its pins run."""
    state = Workbench()
    Pins(state)
    # they give the models of pages what the scenario says of them
    for view in VIEWS.values():
        for work in view.works:
            work(state)
    Keeping(state, Browser()).begin(address)
    return state


class AnyOrder(RuleBasedStateMachine):
    """What a user may do with a page, in any order."""

    @initialize()
    def begin(self) -> None:
        self.session = Session()
        self.state, self.keeping = self.session.state, self.session.keeping

    def snapshot(self) -> Snapshot:
        return {key: value for key, value in snapshot_of(self.state).items() if key not in VIEW}

    @rule(preset=st.sampled_from(PRESETS))
    def choose(self, preset: str) -> None:
        self.state.scenario.choose(preset)

    @rule(preset=st.sampled_from(PRESETS), title=st.sampled_from(["Mine", "", "=1+1"]), whole=st.booleans())
    def open(self, preset: str, title: str, whole: bool) -> None:
        text = format_scenario(load_scenario(preset, {"title": title, "vehicle.load_factor": 0.3}))
        self.keeping.open_file("mine.toml", text if whole else text[:-40])

    @rule(percent=st.sampled_from([0.0, 35.0, 100.0]))
    def load(self, percent: float) -> None:
        self.state.scenario.load_percent = percent

    # some of them are too short to be kept: that is told, and the runs before stay
    @rule(share=st.sampled_from([0.0, 0.3, 0.9]))
    def slide(self, share: float) -> None:
        start, end = self.state.scenario.travel_time_range_s
        self.state.scenario.travel_time_s = round(start + share * (end - start), 1)

    @rule(key=st.sampled_from(sorted(EDITS)), which=st.integers(0, 2))
    def edit(self, key: str, which: int) -> None:
        before, value = self.snapshot(), EDITS[key][which % len(EDITS[key])]
        said = ""
        try:
            self.state.scenario.edit({key: value})
        except RailjouleError as refusal:
            said = str(refusal)
        assert not said or ("\n" not in said and self.snapshot() == before)

    @precondition(lambda self: self.state.scenario.changes)
    @rule(which=st.integers(0, 5))
    def take_back(self, which: int) -> None:
        keys = list(self.state.scenario.changes)
        self.state.scenario.take_back(keys[which % len(keys)])

    @rule(names=st.sets(st.sampled_from(QUICK)), chosen=st.sampled_from(QUICK))
    def draw(self, names: set[str], chosen: str) -> None:
        self.state.ticked, self.state.chosen = [name for name in QUICK if name in names], chosen

    @rule(seed=st.integers(0, 3), percent=st.sampled_from([1.0, 5.0]))
    def set_on_another_page(self, seed: int, percent: float) -> None:
        self.state.day.seed, self.state.pages["Set speeds"].time_window_percent = seed, percent

    @rule(page=st.sampled_from(["Start", "Help", "Files"]))
    def turn(self, page: str) -> None:
        assert page in PAGES
        self.state.page = page

    @rule()
    def pin(self) -> None:
        before = len(self.state.pins)
        self.state.pin()
        assert len(self.state.pins) <= min(before + 1, MOST_PINS)

    @precondition(lambda self: self.state.pins)
    @rule(which=st.integers(0, MOST_PINS - 1), name=st.sampled_from(["", "Best", "a\u202eb"]))
    def rename_or_unpin(self, which: int, name: str) -> None:
        pin = self.state.pins[which % len(self.state.pins)]
        if name:
            self.state.rename(pin, name)
        else:
            self.state.unpin(pin)

    @rule()
    def undo(self) -> None:
        self.keeping.undo()

    @rule()
    def redo(self) -> None:
        self.keeping.redo()

    @precondition(lambda self: self.keeping.history.can_undo)
    @rule()
    def step_back_and_forth(self) -> None:
        self.keeping.note()
        before = self.snapshot()
        self.keeping.undo()
        assert self.snapshot() != before
        self.keeping.redo()
        assert self.snapshot() == before

    @rule(query=st.sampled_from(LINKS))
    def open_link(self, query: str) -> None:
        self.keeping.open_link(query)

    @rule()
    def note(self) -> None:
        self.keeping.note()

    @invariant()
    def a_new_page_at_the_address_is_the_same(self) -> None:
        self.keeping.note()
        address = self.keeping.browser.address
        other = opened(address)
        assert other.notice == ""
        assert snapshot_of(other) == snapshot_of(self.state), address
        assert [pin.trajectory.energy_kwh for pin in other.pins] == pytest.approx(
            [pin.trajectory.energy_kwh for pin in self.state.pins]
        )

    @invariant()
    def the_runs_are_those_of_the_scenario_or_why_not_is_told(self) -> None:
        runs, scenario = self.state.runs, self.state.scenario.scenario()
        if self.state.failure is not None:
            assert "\n" not in str(self.state.failure)
            return
        assert runs is not None
        assert runs.scenario == scenario
        assert set(self.state.drawn) <= {*runs.runs, *runs.refused}
        run = self.state.run
        assert run is not None
        assert run.scenario == scenario
        assert self.state.chosen_now == run.strategy

    @invariant()
    def pins_and_their_address_are_alike(self) -> None:
        assert [KeptPin.of(pin).keep() for pin in self.state.pins] == [one.keep() for one in self.state.kept_pins]


AnyOrder.TestCase.settings = settings(max_examples=EXAMPLES, stateful_step_count=STEPS)
TestAnyOrder = AnyOrder.TestCase
