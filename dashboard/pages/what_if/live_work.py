"""The clock and the plans of the run that plays: one step at a time, in the page's turn or in a thread."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import panel as pn

from railjoule.core import RailjouleError, Scenario
from railjoule.core.simulation.live import (
    LiveRun,
    advance,
    finished_run,
    known_run,
    start_run,
    wait_longer,
)
from railjoule.dashboard.pages.what_if.live_model import LiveModel, LiveResult
from railjoule.dashboard.state.page_work import PageWork
from railjoule.dashboard.state.scenario import RUN_FIELDS
from railjoule.dashboard.state.workbench import Workbench
from railjoule.dashboard.work.refusals import named_refusals
from railjoule.dashboard.work.runs import is_slow

TICK_MS = 100
"""The clock is read this often."""
LONGEST_TICK_S = 0.5
"""A clock that was not read for longer stood still: the server was busy."""

Step = Callable[[LiveRun], LiveRun]
"""Replaces a run by one with another plan."""


@dataclass(frozen=True, eq=False)
class StepRequest:
    """A step, and the run that it is for."""

    step: Step
    run: LiveRun


def take_step(request: StepRequest) -> LiveRun:
    """Return the run after a step; errors as the step."""
    return request.step(request.run)


def begin_run(scenario: Scenario) -> LiveRun:
    """Return a run before its start; errors as `start_run`."""
    with named_refusals(scenario):
        return start_run(scenario)


def compare_with_notice(run: LiveRun) -> LiveResult:
    """Return the run beside the one of a train that knew the events; errors as `known_run`."""
    return LiveResult(finished_run(run), known_run(run))


class Live(PageWork[LiveModel]):
    """Plays a run while its page is in sight."""

    page = "What if"

    def __init__(self, state: Workbench) -> None:
        self.of = state.pages[self.page]
        super().__init__(state, self.of.live)
        self.starts = self.worker(
            begin_run, self._take_start, marked=True, is_slow=lambda scenario: is_slow(scenario, scenario.strategy)
        )
        self.steps = self.worker(take_step, self._take_step, self._refuse_step)
        self.results = self.worker(compare_with_notice, self._take_result)
        self._waiting: Step | None = None
        self._planning = False
        self._read_s = 0.0
        self._clock: Any = None
        state.scenario.follow(lambda scenario: scenario.line.length_m, self.model.take)
        state.scenario.param.watch(self._ask, list(RUN_FIELDS))
        state.param.watch(self._ask, ["page", "chosen"])
        self.of.param.watch(self._ask, "tab")
        self.model.param.watch(self._ask, "on")
        self.model.param.watch(self._set_clock, "playing")
        self.model.param.watch(self._restart, "restart")
        self.model.param.watch(lambda event: self.plan(event.new), "step")
        self.model.take(state.scenario.edited)

    @property
    def in_sight(self) -> bool:
        """Whether the tab of events is."""
        return super().in_sight and self.of.is_open("events")

    def forget(self, *_: Any) -> None:
        """Forget the run, as its scenario has gone."""
        super().forget()
        self._drop()

    def end(self, *_: Any) -> None:
        """Stop the clock as well."""
        super().end()
        self.model.playing = False

    def _restart(self, *_: Any) -> None:
        """Put the train back to the start."""
        self.forget()
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
        self.steps.ask(StepRequest(step, run))

    def tick(self, seconds: float) -> None:
        """Let the clock go on [s of reality]; it waits while a plan is made, as the plan begins where the train is."""
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
        if not (self.in_sight and self.model.on):
            self.model.playing = False
            return
        accepted = {"disturbance.accepted_delay_s": float(self.state.day.accepted_delay_s)}
        scenario = self.state.scenario.scenario().replace(strategy=self.state.chosen, **accepted)
        if self.is_new(scenario):
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
        self.take_failure(failure)
        self._go_on()

    def _go_on(self) -> None:
        self._planning = False
        step, self._waiting = self._waiting, None
        if step is not None:
            self.plan(step)

    def _take_result(self, result: LiveResult) -> None:
        self.model.ended = result

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
