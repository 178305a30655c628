"""The run that plays: its fields, its clock, and its plans, one step at a time in the page's turn or in a thread."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import panel as pn
import param

from railjoule.core import RailjouleError, Scenario, ScenarioError
from railjoule.core.simulation.disturbances import DisturbedRun
from railjoule.core.simulation.live import (
    LiveRun,
    advance,
    clear_signal,
    finished_run,
    known_run,
    set_event,
    start_run,
    wait_longer,
)
from railjoule.dashboard.day import EVENTS, FIRST_STOP_S, EventModel
from railjoule.dashboard.state.kept import result
from railjoule.dashboard.state.numbers import TypedParameters
from railjoule.dashboard.state.scenario import RUN_FIELDS
from railjoule.dashboard.work.runs import is_slow, named_refusals

if TYPE_CHECKING:
    from railjoule.dashboard.page_work import PageWorks

PACES = (1.0, 5.0, 20.0)
"""How many times faster than in reality a run plays."""


@dataclass(frozen=True, eq=False)
class LiveResult:
    """A run that has arrived, and the run with all events known before the start."""

    live: DisturbedRun
    known: DisturbedRun


class LiveModel(TypedParameters):
    """The run that plays, and the next events."""

    passing = ("on", "playing", "pace", "is_open", "replan_s", "step")

    on = param.Boolean(default=False, doc="Whether the page plays a run.")
    playing = param.Boolean(default=False, doc="Whether its clock runs.")
    pace = param.Selector(default=5.0, objects=list(PACES), doc="How many times faster than in reality.")
    is_open = param.Boolean(default=False, doc="Whether the signal stays red until it is cleared.")

    failure = result(RailjouleError, "Why the last request failed.")
    run = result(LiveRun, "The run as it is now.")
    planned = param.Event(doc="The run has another plan, or is another one.")
    replan_s = param.Number(default=0.0, doc="How long its plan ahead took [s].")
    step = param.Callable(default=None, allow_None=True, doc="Replaces the run by one with another plan.")
    restart = param.Event(doc="The train begins at the start again.")
    ended = result(LiveResult, "The run that has arrived, beside others.")

    def __init__(self, **params: Any) -> None:
        super().__init__(**params)
        self.signal, self.limit = EventModel(duration_s=FIRST_STOP_S), EventModel(kind="limit")
        self.voltage = EventModel(kind="voltage")

    def set(self, event: EventModel, *_: Any) -> None:
        """Set the red signal, the lower limit or the supply voltage of an event."""
        if event.kind == "limit" and event.position_m >= event.to_m:
            begins, ends = f"{event.position_m:g} m", f"{event.to_m:g} m"
            self.failure = ScenarioError(f"Limit to {ends}: it begins at {begins}. Choose an end beyond that.")
            return
        is_open = self.is_open and event is self.signal
        self.step = partial(set_event, event=EVENTS[event.kind](**event.values), is_open=is_open)

    def clear_signal(self, *_: Any) -> None:
        """Clear the red signal that the train meets first."""
        # another function each time, as the same value would be no change
        self.step = partial(clear_first)

    def take(self, scenario: Scenario) -> None:
        """Choose places on a scenario's line."""
        length = scenario.line.length_m
        self.signal.position_m = round(0.5 * length)
        self.limit.param.update(position_m=round(0.6 * length), to_m=round(0.7 * length))


def clear_first(run: LiveRun) -> LiveRun:
    """Return a run whose next red signal is clear; the same run where none is red."""
    red = [one for one in run.events if one.is_ahead and not run.has_left(one)]
    return clear_signal(run, min(red, key=run.stand_node)) if red else run


# ---- the clock

TICK_MS = 100
"""The clock is read this often."""
LONGEST_TICK_S = 0.5
"""A clock that was not read for longer stood still: the server was busy."""

Step = Callable[[LiveRun], LiveRun]
"""Replaces a run by one with another plan."""


def take_step(request: tuple[Step, LiveRun]) -> LiveRun:
    """Return the run after a step; errors as the step."""
    step, run = request
    return step(run)


def begin_run(scenario: Scenario) -> LiveRun:
    """Return a run before its start; errors as `start_run`."""
    with named_refusals(scenario):
        return start_run(scenario)


def compare_with_notice(run: LiveRun) -> LiveResult:
    """Return the run beside the one of a train that knew the events; errors as `known_run`."""
    return LiveResult(finished_run(run), known_run(run))


class Live:
    """Plays a run while the tab of events is in sight.

    Parameters
    ----------
    page : Page
        The page that has the tab, and the run as `page.live`.
    works : PageWorks
        The work of the page.
    """

    def __init__(self, page: Any, works: "PageWorks") -> None:
        self.of, self.works, self.state, self.model = page, works, page.desk, page.live
        state, model = self.state, self.model
        # first of all watchers: the run of the scenario before is gone when the next one is asked for
        state.scenario.param.watch(self._forget, ["preset", "opened"])
        self.starts = works.worker(
            "live_start",
            begin_run,
            self._take_start,
            self._fail,
            marked=True,
            is_slow=lambda scenario: is_slow(scenario, scenario.strategy),
        )
        self.steps = works.worker("live_step", take_step, self._take_step, self._refuse_step)
        self.results = works.worker(
            "live_result", compare_with_notice, lambda ended: model.param.update(ended=ended), self._fail
        )
        self._asked: Scenario | None = None
        self._waiting: Step | None = None
        self._planning = False
        self._read_s = 0.0
        self._clock: Any = None
        state.scenario.follow(lambda scenario: scenario.line.length_m, model.take)
        state.scenario.param.watch(self._ask, list(RUN_FIELDS))
        state.param.watch(self._ask, ["page", "chosen"])
        self.of.param.watch(self._ask, "tab")
        model.param.watch(self._ask, "on")
        model.param.watch(self._set_clock, "playing")
        model.param.watch(self._restart, "restart")
        model.param.watch(lambda event: self.plan(event.new), "step")
        model.take(state.scenario.edited)

    def _forget(self, *_: Any) -> None:
        """Remove the run, as its scenario has been replaced."""
        self._asked = None
        self._drop()

    def _fail(self, failure: RailjouleError) -> None:
        self.model.failure = failure

    def _restart(self, *_: Any) -> None:
        """Put the train back to the start."""
        self._forget()
        self._ask()

    def plan(self, step: Step) -> None:
        """Take a step with the run as it is; one that comes while another is taken waits for it."""
        run = self.model.run
        if run is None:
            return
        if self._planning:
            self._waiting = step
            return
        self._planning = True
        self.steps.ask((step, run))

    def tick(self, seconds: float) -> None:
        """Advance the clock [s of reality]; it waits while a plan is made, which begins at the train's position."""
        run = self.model.run
        if run is None or self._planning or run.has_arrived:
            return
        now = advance(run, seconds * self.model.pace)
        self.model.run = now
        if now.held_at is not None:
            self.plan(wait_longer)
        elif now.has_arrived:
            self.model.playing = False
            self.results.ask(now)

    def _ask(self, *_: Any) -> None:
        if not (self.works.in_sight and self.of.is_open("events") and self.model.on):
            self.model.playing = False
            return
        accepted = {"disturbance.accepted_delay_s": float(self.state.day.accepted_delay_s)}
        scenario = self.state.scenario.scenario().replace(strategy=self.state.chosen, **accepted)
        if scenario != self._asked:
            self._asked = scenario
            self._drop()
            self.starts.ask(scenario)

    def _drop(self) -> None:
        self._waiting, self._planning = None, False
        self.model.param.update(run=None, ended=None, failure=None, playing=False)
        self.model.param.trigger("planned")

    def _take_start(self, run: LiveRun) -> None:
        self.model.param.update(run=run, ended=None, failure=None, replan_s=0.0)
        self.model.param.trigger("planned")

    def _take_step(self, run: LiveRun) -> None:
        # the run that it was for may have gone
        if not self._planning:
            return
        self.model.param.update(run=run, failure=None, replan_s=self.steps.last_duration_s)
        self.model.param.trigger("planned")
        self._go_on()

    def _refuse_step(self, failure: RailjouleError) -> None:
        self._fail(failure)
        self._go_on()

    def _go_on(self) -> None:
        self._planning = False
        step, self._waiting = self._waiting, None
        if step is not None:
            self.plan(step)

    def _set_clock(self, *_: Any) -> None:
        if self._clock is not None:
            self._clock.stop()
            self._clock = None
        # without a page around it, `tick` is called by hand
        if self.model.playing and pn.state.curdoc is not None:
            self._read_s = time.monotonic()
            self._clock = pn.state.add_periodic_callback(self._read, period=TICK_MS)

    def _read(self) -> None:
        now = time.monotonic()
        since, self._read_s = now - self._read_s, now
        with pn.io.hold():
            self.tick(min(since, LONGEST_TICK_S))
