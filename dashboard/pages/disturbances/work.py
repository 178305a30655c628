"""The work behind the page Disturbances: what is asked for when, and where its results go."""

from dataclasses import replace
from typing import Any

from railjoule.dashboard.actual.follower import FOLLOWER, REALITY
from railjoule.dashboard.actual.model import event_changes
from railjoule.dashboard.pages.disturbances.compute import (
    LateArrivals,
    Rides,
    RidesRequest,
    compute_late_arrivals,
    compute_rides,
)
from railjoule.dashboard.pages.disturbances.model import DisturbancesModel
from railjoule.dashboard.state.page_work import Items, PageWork
from railjoule.dashboard.state.scenario import RUN_FIELDS
from railjoule.dashboard.state.workbench import Workbench
from railjoule.dashboard.work.runs import is_slow

NUMBERS = ("position_m", "to_m", "duration_s", "limit_kmh", "share_percent", "noticed_at_m")


class Disturbances(PageWork[DisturbancesModel]):
    """Asks for the rides of one page, then for what later arrivals save, while it is in sight."""

    page = "Disturbances"

    def __init__(self, state: Workbench) -> None:
        super().__init__(state, state.disturbances)
        self.rides = self.worker(
            compute_rides,
            self._take_rides,
            marked=True,
            is_slow=lambda request: is_slow(request.scenario, request.scenario.strategy),
        )
        self.late = self.study(compute_late_arrivals, self._take_late)
        self._request: RidesRequest | None = None
        self._drawn: RidesRequest | None = None
        self._events = Items(lambda *_: self.model.param.trigger("changed"))
        state.scenario.follow(lambda scenario: scenario.disturbance, self.model.take)
        state.scenario.param.watch(self._ask, list(RUN_FIELDS))
        state.param.watch(self._ask, ["page", "chosen"])
        self.model.param.watch(self._watch_events, "events")
        self.model.param.watch(self._take_delay, "accepted_delay_s")
        self.model.param.watch(self._ask, "changed")
        # with it the rides have the load and the position error of the day, too: `event_changes`
        state.actual.param.watch(self._ask, "on")
        state.robustness.param.watch(self._ask, [*REALITY, *FOLLOWER])
        self.model.take(state.scenario.edited)

    def forget(self, *_: Any) -> None:
        """Forget what was asked for and end it, as the scenario has gone."""
        super().forget()
        self.late.stop()
        self._request = self._drawn = None

    def _watch_events(self, *_: Any) -> None:
        self._events.follow(self.model.events, lambda _: NUMBERS)
        # an event that is added on Drive must not change its numbers once this page is opened
        if not self.in_sight:
            self.model.as_driver = False
        self._ask()

    def _take_delay(self, *_: Any) -> None:
        # set by hand, by a link or by a step back
        if not self._quiet:
            self.model.as_driver = False
            self._ask()

    def _ask(self, *_: Any) -> None:
        if not self.in_sight:
            self.rest()
            return
        changes = {"strategy": self.state.chosen, **event_changes(self.state)}
        if self.model.as_driver:
            # what is accepted follows from the rest
            changes["disturbance.accepted_delay_s"] = 0.0
        request = RidesRequest(self.state.scenario.scenario(), changes, self.model.as_driver)
        if self.is_new(request):
            self._request = request
            # a curve of the same events goes on, whatever delay is accepted now
            if self._curve() != self._drawn:
                self.late.stop()
            self.rides.ask(request)

    def _curve(self) -> RidesRequest | None:
        """Return the request on which energy over delay depends: all but the delay that is accepted."""
        if self._request is None:
            return None
        changes = {**self._request.changes, "disturbance.accepted_delay_s": 0.0}
        return replace(self._request, changes=changes, as_driver=False)

    def _take_rides(self, rides: Rides) -> None:
        if rides.as_driver and self.model.as_driver:
            with self.quiet():
                self.model.accepted_delay_s = rides.accepted_s
        self.model.param.update(rides=rides, failure=None)
        curve = self._curve()
        if not self.model.events:
            self._drawn = self.model.late = None
        elif curve is not None and curve != self._drawn:
            self._drawn = curve
            self.late.ask(curve)

    def _take_late(self, late: LateArrivals, last: bool) -> None:
        self.model.late = late
