"""The run that plays: its events, its clock, and its plans, one step at a time in the page's turn or in a thread."""

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

TICK_MS = 100
"""The clock is read this often."""
LONGEST_TICK_S = 0.5
"""A clock that was not read for longer stood still: the server was busy."""
PACES = (1.0, 5.0, 20.0)
"""How many times faster than in reality a run plays."""


Step = Callable[[LiveRun], LiveRun]
"""Replaces a run by one with another plan."""


@dataclass(frozen=True, eq=False)
class LiveResult:
    """A run that has arrived, and the run with all events known before the start."""

    live: DisturbedRun
    known: DisturbedRun


def clear_first(run: LiveRun) -> LiveRun:
    """Return a run whose next red signal is clear; the same run where none is red."""
    red = [one for one in run.events if one.is_ahead and not run.has_left(one)]
    return clear_signal(run, min(red, key=run.stand_node)) if red else run


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


class Live(TypedParameters):
    """The run that plays while the tab of events is in sight, and the next events; `page` has the tab."""

    passing = ("on", "playing", "pace", "is_open", "replan_s")

    on = param.Boolean(default=False, doc="Whether the page plays a run.")
    playing = param.Boolean(default=False, doc="Whether its clock runs.")
    pace = param.Selector(default=5.0, objects=list(PACES), doc="How many times faster than in reality.")
    is_open = param.Boolean(default=False, doc="Whether the signal stays red until it is cleared.")

    failure = result(RailjouleError, "Why the last request failed.")
    run = result(LiveRun, "The run as it is now.")
    planned = param.Event(doc="The run has another plan, or is another one.")
    replan_s = param.Number(default=0.0, doc="How long its plan ahead took [s].")
    ended = result(LiveResult, "The run that has arrived, beside others.")

    def __init__(self, page: Any, **params: Any) -> None:
        super().__init__(**params)
        self.page, self.desk = page, page.desk
        self.signal, self.limit = EventModel(duration_s=FIRST_STOP_S), EventModel(kind="limit")
        self.voltage = EventModel(kind="voltage")
        self._asked: Scenario | None = None
        self._waiting: Step | None = None
        self._planning = False
        self._read_s = 0.0
        self._clock: Any = None

    def begin_work(self, works: "PageWorks") -> None:
        """Make the workers."""
        self.works, scenario = works, self.desk.scenario
        # first of all watchers: the run of the scenario before is gone when the next one is asked for
        scenario.param.watch(self._forget, ["preset", "opened"])
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
            "live_result", compare_with_notice, lambda ended: self.param.update(ended=ended), self._fail
        )
        scenario.follow(lambda scenario: scenario.line.length_m, self.take)
        scenario.param.watch(self._ask, list(RUN_FIELDS))
        self.desk.param.watch(self._ask, ["page", "chosen"])
        self.page.param.watch(self._ask, "tab")
        self.param.watch(self._ask, "on")
        self.param.watch(self._set_clock, "playing")
        self.take(scenario.edited)

    def take(self, scenario: Scenario) -> None:
        """Choose places on a scenario's line."""
        length = scenario.line.length_m
        self.signal.position_m = round(0.5 * length)
        self.limit.param.update(position_m=round(0.6 * length), to_m=round(0.7 * length))

    # ---- what the user asks for

    def set(self, event: EventModel, *_: Any) -> None:
        """Set the red signal, the lower limit or the supply voltage of an event."""
        if event.kind == "limit" and event.position_m >= event.to_m:
            begins, ends = f"{event.position_m:g} m", f"{event.to_m:g} m"
            self.failure = ScenarioError(f"Limit to {ends}: it begins at {begins}. Choose an end beyond that.")
            return
        is_open = self.is_open and event is self.signal
        self.plan(partial(set_event, event=EVENTS[event.kind](**event.values), is_open=is_open))

    def clear(self, *_: Any) -> None:
        """Clear the red signal that the train meets first."""
        self.plan(clear_first)

    def restart(self, *_: Any) -> None:
        """Put the train back to the start."""
        self._forget()
        self._ask()

    def plan(self, step: Step) -> None:
        """Take a step with the run as it is; one that comes while another is taken waits for it."""
        if self._planning:
            self._waiting = step
        elif self.run is not None:
            self._planning = True
            self.steps.ask((step, self.run))

    def tick(self, seconds: float) -> None:
        """Advance the clock [s of reality]; it waits while a plan is made, which begins at the train's position."""
        if self.run is None or self._planning or self.run.has_arrived:
            return
        self.run = now = advance(self.run, seconds * self.pace)
        if now.held_at is not None:
            self.plan(wait_longer)
        elif now.has_arrived:
            self.playing = False
            self.results.ask(now)

    # ---- what is computed

    def _ask(self, *_: Any) -> None:
        if not (self.works.in_sight and self.page.is_open("events") and self.on):
            self.playing = False
            return
        accepted = {"disturbance.accepted_delay_s": float(self.desk.day.accepted_delay_s)}
        scenario = self.desk.scenario.scenario().replace(strategy=self.desk.chosen, **accepted)
        if scenario != self._asked:
            self._forget()
            self._asked = scenario
            self.starts.ask(scenario)

    def _forget(self, *_: Any) -> None:
        """Remove the run, as its scenario has been replaced."""
        self._asked, self._waiting, self._planning = None, None, False
        self.param.update(run=None, ended=None, failure=None, playing=False)
        self.param.trigger("planned")

    def _fail(self, failure: RailjouleError) -> None:
        self.failure = failure

    def _take_start(self, run: LiveRun) -> None:
        self.param.update(run=run, ended=None, failure=None, replan_s=0.0)
        self.param.trigger("planned")

    def _take_step(self, run: LiveRun) -> None:
        # the run that it was for may have gone
        if self._planning:
            self.param.update(run=run, failure=None, replan_s=self.steps.last_duration_s)
            self.param.trigger("planned")
            self._go_on()

    def _refuse_step(self, failure: RailjouleError) -> None:
        self.failure = failure
        self._go_on()

    def _go_on(self) -> None:
        self._planning = False
        step, self._waiting = self._waiting, None
        if step is not None:
            self.plan(step)

    # ---- the clock

    def _set_clock(self, *_: Any) -> None:
        if self._clock is not None:
            self._clock.stop()
            self._clock = None
        # without a page around it, `tick` is called by hand
        if self.playing and pn.state.curdoc is not None:
            self._read_s = time.monotonic()
            self._clock = pn.state.add_periodic_callback(self._read, period=TICK_MS)

    def _read(self) -> None:
        now = time.monotonic()
        since, self._read_s = now - self._read_s, now
        with pn.io.hold():
            self.tick(min(since, LONGEST_TICK_S))
