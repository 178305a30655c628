"""The work behind the page Disturbances: what is asked for when, and where its results go."""

from dataclasses import replace
from typing import Any

from railjoule.dashboard.day import FOLLOWING, LOAD_AND_POSITION
from railjoule.dashboard.pages.disturbances.compute import (
    LateArrivals,
    Rides,
    RidesRequest,
    compute_late_arrivals,
    compute_rides,
)
from railjoule.dashboard.pages.disturbances.model import DisturbancesModel
from railjoule.dashboard.state.page_work import PageWork
from railjoule.dashboard.state.scenario import RUN_FIELDS
from railjoule.dashboard.state.workbench import Workbench
from railjoule.dashboard.work.runs import is_slow


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
        self.day = state.day
        # before a press adds the first one
        self._count = len(self.day.events)
        state.scenario.param.watch(self._ask, list(RUN_FIELDS))
        state.param.watch(self._ask, ["page", "chosen"])
        self.day.param.watch(self._watch_events, "events")
        self.day.param.watch(self._take_delay, "accepted_delay_s")
        # with `on` the rides have the load and the position error of the day, too: `event_changes`
        self.day.param.watch(self._ask, ["changed", "on", *LOAD_AND_POSITION, *FOLLOWING])

    def forget(self, *_: Any) -> None:
        """Forget what was asked for and end it, as the scenario has gone."""
        super().forget()
        self.late.stop()
        self._request = self._drawn = None

    def _watch_events(self, *_: Any) -> None:
        # flat out, each reaction would arrive at another time, and their energies would not compare
        if not self._count and self.day.events and self.day.accepted_delay_s == 0:
            self.model.as_driver = True
        # an event that is added on Drive must not change its numbers once this page is opened
        if not self.in_sight:
            self.model.as_driver = False
        self._count = len(self.day.events)
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
        changes = {"strategy": self.state.chosen, **self.day.event_changes}
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
                self.day.accepted_delay_s = rides.accepted_s
        self.model.param.update(rides=rides, failure=None)
        curve = self._curve()
        if not self.day.events:
            self._drawn = self.model.late = None
        elif curve is not None and curve != self._drawn:
            self._drawn = curve
            self.late.ask(curve)

    def _take_late(self, late: LateArrivals, last: bool) -> None:
        self.model.late = late
