"""The desk: the state that all pages of one session share, and the work behind it, the runs of the scenario.

It has the pages by name, and imports none of them.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import panel as pn
import param

from railjoule.core import RailjouleError, Scenario, Trajectory
from railjoule.core.bounds import with_tighter_bound
from railjoule.core.lower_bound import Bound
from railjoule.core.measured import MeasuredRun
from railjoule.core.strategies import STRATEGIES
from railjoule.dashboard.day import Day
from railjoule.dashboard.editor.model import EditorModel
from railjoule.dashboard.faults import Faults
from railjoule.dashboard.look import words
from railjoule.dashboard.page_list import PAGES, package_name, page_classes
from railjoule.dashboard.state.files import FilesModel
from railjoule.dashboard.state.kept import Kept, result
from railjoule.dashboard.state.pins import (
    LONGEST_NAME,
    MOST_PINS,
    TOO_MANY,
    KeptPin,
    Pin,
    make_pin,
    make_recipe,
    measured_name,
    pin_name,
    recipe_of_recording,
    same_run,
)
from railjoule.dashboard.state.recipes import Recipe
from railjoule.dashboard.state.scenario import RUN_FIELDS, ScenarioModel
from railjoule.dashboard.work.runs import FirstRuns, Proofs, Runs, RunsRequest, same_plan
from railjoule.dashboard.work.worker import Worker

if TYPE_CHECKING:
    from railjoule.core.studies.simple_advice import SimpleRun


COLOURS = ("system", "light", "dark")


class Workbench(Kept):
    """Everything that the views of one open page draw; they write to it, and the store fills in the results."""

    kept = (
        "page",
        "ticked",
        "chosen",
        "over_time",
        "colours",
        "kept_pins",
    )
    passing = ("dark", "notice")

    page = param.Selector(default="Start", objects=list(PAGES), doc="The page in sight.")
    ticked = param.ListSelector(default=["optimal", "fastest"], objects=list(STRATEGIES), doc="Strategies drawn.")
    chosen = param.Selector(default="optimal", objects=list(STRATEGIES), doc="The strategy whose numbers are shown.")
    # runs are compared at the same place first, where the line and its limits are the same
    over_time = param.Boolean(default=False, doc="Draw over time instead of distance.")
    colours = param.Selector(default="system", objects=list(COLOURS), doc="Whose request the colours follow.")
    dark = param.Boolean(default=False, doc="Dark colours.")
    notice = param.String(default="", doc="Message on a link or a file, until it has been read.")
    failure = result(RailjouleError, "Why the last request failed.")
    runs = result(Runs, "The last good runs.")
    pins = param.ClassSelector(class_=tuple, default=(), doc="The pinned runs, the last one pinned last.")
    kept_pins = param.List(default=[], item_type=KeptPin, doc="The same without their runs, as the address has them.")
    tightened = param.Event(doc="The bound of the runs has become greater, and nothing else has changed.")
    late = param.ClassSelector(
        class_=frozenset, default=frozenset(), doc="Pages that show what is from before the last change."
    )

    def __init__(self, **params: Any) -> None:
        self.faults = Faults(self._tell_fault)
        self._late: dict[object, tuple[str, ...]] = {}
        self.recorded: dict[str, Trajectory] = {}
        """Measured runs that were pinned, by the keys of their recipes: a step back finds them here."""
        # before the models of the pages: a snapshot is laid in this order, and where the scenario changes, pages take
        # their values from it again, so that edits on them before would be lost
        self.scenario = ScenarioModel()
        self.files = FilesModel(self.scenario)
        self.editor = EditorModel(self.scenario)
        self.day = Day(self.scenario)
        self.proof = Proofs()
        super().__init__(**params)
        self.pages: dict[str, Any] = {name: page(self) for name, page in page_classes().items()}
        """The pages, by name."""
        self.address_prefix = self.scenario.address_prefix = ""
        for name, model in self.models.items():
            if model is not self.scenario:
                model.address_prefix = f"{name}."
        self.scenario.param.watch(self._take_strategy, ["preset", "opened"])

    def _tell_fault(self, sentence: str) -> None:
        self.notice = sentence

    def marks(self, *pages: str) -> Callable[[bool], None]:
        """Return the callback of a piece of work for when these pages wait for it, and when they no longer do."""
        # several works may wait for one page, which is marked until the last of them has its result
        key = object()

        def mark(late: bool) -> None:
            if late:
                self._late[key] = pages
            else:
                self._late.pop(key, None)
            # a new set each time: watchers hear nothing of one that is changed in place
            self.late = frozenset(page for waiting in self._late.values() for page in waiting)

        return mark

    def _take_strategy(self, *_: Any) -> None:
        """Show the strategy that a scenario's file names."""
        if self.scenario.base.strategy in STRATEGIES:
            self.chosen = self.scenario.base.strategy

    @property
    def models(self) -> dict[str, Kept]:
        """The models of the scenario and of all pages, by name."""
        known = {name: model for name, model in vars(self).items() if isinstance(model, Kept)}
        return {**known, **{package_name(name): page for name, page in self.pages.items()}}

    @property
    def drawn(self) -> tuple[str, ...]:
        """The strategies to draw and to compute, the one whose numbers are shown included."""
        return tuple(name for name in STRATEGIES if name in self.ticked or name == self.chosen)

    @property
    def chosen_now(self) -> str:
        """The strategy whose numbers are shown: the optimum where the chosen one refuses the scenario."""
        chosen: str = self.chosen
        if self.runs is None or chosen in self.runs.runs:
            return chosen
        runs: Mapping[str, Trajectory] = self.runs.runs
        return next(name for name, run in runs.items() if run is self.runs.best)

    @property
    def run(self) -> Trajectory | None:
        """The run whose numbers are shown."""
        return None if self.runs is None else self.runs.runs[self.chosen_now]

    @property
    def pinned(self) -> Trajectory | None:
        """The run to compare with: the one pinned last."""
        return self.pins[-1].trajectory if self.pins else None

    @property
    def recipe(self) -> Recipe | None:
        """How the run whose numbers are shown comes about."""
        return None if self.runs is None else make_recipe(self.scenario, self.runs.scenario, self.chosen_now)

    @property
    def pin_of_run(self) -> Pin | None:
        """The pin of the run whose numbers are shown, if it is pinned."""
        run = self.run
        if run is None:
            return None
        same = (pin for pin in self.pins if pin.trajectory.strategy == run.strategy and not pin.recipe.moved)
        return next((pin for pin in same if pin.trajectory.scenario == run.scenario), None)

    def pin(self) -> None:
        """Pin the run whose numbers are shown; where there are as many pins as there may be, say so."""
        run, recipe = self.run, self.recipe
        if run is not None and recipe is not None and self.pin_of_run is None:
            self._pin(run, recipe)

    def pin_simple(self, scenario: Scenario, simple: "SimpleRun") -> None:
        """Pin a run of simple advice for a scenario."""
        if self.find_pin(simple.run) is None:
            recipe = replace(make_recipe(self.scenario, scenario, "optimal"), simple=simple.changes_allowed)
            self._pin(simple.run, recipe, f"{pin_name(simple.run)}, {simple.changes} changes")

    def pin_moved(self, run: Trajectory, number: int, place_m: float) -> None:
        """Pin an optimum with a moved instruction, given by the index of its phase and its place [m]."""
        if self.find_pin(run) is None:
            recipe = replace(make_recipe(self.scenario, run.scenario, "optimal"), moved=f"{number}@{place_m:.6f}")
            self._pin(run, recipe, f"Moved to {words.number(place_m, 0)} m, {pin_name(run)}"[:LONGEST_NAME])

    def turn_to(self, page: str, **values: Any) -> None:
        """Turn to a page, and give it values."""
        self.page = page
        self.pages[page].param.update(**values)

    def pin_measured(self, found: MeasuredRun) -> None:
        """Pin a measured run."""
        run = found.trajectory
        if self.find_pin(run) is not None:
            return
        recipe = recipe_of_recording(run)
        self.recorded[recipe.recording] = run
        self._pin(run, recipe, measured_name(run, found.measured is not None, found.recording.name))

    def pin_lesson(self, driven: Trajectory, commands: str, best: Trajectory, recipe: Recipe) -> None:
        """Pin a run of the lesson that is driven by hand, and the lesson's optimum, whose recipe is given."""
        if self.find_pin(best) is None:
            self._pin(best, recipe)
        if self.find_pin(driven) is None:
            self._pin(driven, replace(recipe, driven=commands))

    def find_pin(self, run: Trajectory) -> Pin | None:
        """Return the pin of a run that is no strategy's, if it is pinned."""
        return next((pin for pin in self.pins if same_run(pin.trajectory, run)), None)

    def _pin(self, run: Trajectory, recipe: Recipe, name: str = "") -> None:
        if len(self.pins) >= MOST_PINS:
            self.notice = TOO_MANY
        else:
            self.param.update(pins=(*self.pins, make_pin(self.pins, run, recipe, name)), notice="")

    def unpin(self, pin: Pin) -> None:
        """Let go of a pinned run."""
        # with one pin less, the sentence that there are too many no longer holds
        self.param.update(pins=tuple(other for other in self.pins if other is not pin), notice="")

    def rename(self, pin: Pin, name: str) -> None:
        """Give a pinned run another name."""
        self.pins = tuple(pin.renamed(name) if other is pin else other for other in self.pins)

    def take_bound(self, scenario: Scenario, bound: Bound) -> None:
        """Give a greater bound to all runs of a scenario's plan that are shown or pinned."""
        pins = tuple(
            replace(pin, trajectory=with_tighter_bound(pin.trajectory, bound))
            # what was measured is bounded by no model
            if same_plan(pin.trajectory.scenario, scenario) and not pin.recipe.recording
            else pin
            for pin in self.pins
        )
        runs = self.runs
        if runs is not None and same_plan(runs.scenario, scenario):
            runs = runs.with_bound(bound)
        # what draws runs need not draw them again for a bound: who shows one watches `tightened`
        with param.parameterized.discard_events(self):
            self.param.update(runs=runs, pins=pins)
        self.param.trigger("tightened")


FIRST = FirstRuns()


class Plans:
    """Asks for the runs of the strategies that are drawn, whatever page is in sight."""

    def __init__(self, state: Workbench) -> None:
        self.state = state
        self._mark_pages = state.marks(*(name for name, entry in PAGES.items() if entry.shows_runs))
        self.runs = Worker(
            FIRST.compute,
            self._take,
            lambda failure: state.param.update(failure=failure),
            self._mark,
            is_slow=lambda request: request.is_slow,
            about=state.scenario.identity,
        )

    def _mark(self, late: bool) -> None:
        """Mark the pages as late, unless only more strategies are under way: those that are shown stay valid."""
        state, runs = self.state, self.state.runs
        is_shown = runs is not None and runs.scenario == state.scenario.scenario() and state.chosen in runs.runs
        self._mark_pages(late and not is_shown)

    def begin(self) -> None:
        """Listen to what runs depend on: what the address has changed before is asked for once."""
        self.state.scenario.param.watch(self.ask, list(RUN_FIELDS))
        self.state.param.watch(self.ask, ["ticked", "chosen"])

    def ask(self, *_: Any) -> None:
        """Ask for the runs; the page asks again for those that need compiled code before there is any."""
        request = self._request()
        if request.is_possible:
            self.runs.ask(request)

    def take_first(self) -> None:
        """Take short runs that are known into a page that opens; others it asks for when it is there."""
        request = self._request()
        if not request.is_short:
            return
        known = FIRST.known(request)
        if known is not None:
            self._take(known)
        # without a page around it nobody else waits
        elif pn.state.curdoc is None:
            self.runs.do(request)

    def compute_first(self) -> None:
        """Compute what a page opens with, for those that will."""
        request = self._request()
        if FIRST.known(request) is None:
            FIRST.compute(request)

    def _request(self) -> RunsRequest:
        return RunsRequest(self.state.scenario.scenario(), self.state.drawn, with_law=self.state.chosen == "bellman")

    def _take(self, runs: Runs) -> None:
        self.state.param.update(runs=self.state.proof.laid_on(runs), failure=None)
