"""The work behind the page Disturbances: what is asked for when, and where its results go."""

from dataclasses import replace
from typing import Any

from railjoule.core import RailjouleError
from railjoule.dashboard.models.actual import event_changes
from railjoule.dashboard.models.disturbances import EventModel
from railjoule.dashboard.models.scenario import PLAN_FIELDS
from railjoule.dashboard.models.workbench import Workbench
from railjoule.dashboard.robustness import FOLLOWER, REALITY
from railjoule.dashboard.store import (
    LateArrivals,
    Rides,
    RidesRequest,
    Study,
    Worker,
    compute_late_arrivals,
    compute_rides,
    is_slow,
)

NUMBERS = ("position_m", "to_m", "duration_s", "limit_kmh", "share_percent", "noticed_at_m")


class Disturbances:
    """Asks for the rides of one page, then for what later arrivals save, while it is in sight."""

    def __init__(self, state: Workbench) -> None:
        self.state, self.model = state, state.disturbances
        self.rides = Worker(
            compute_rides,
            self._take_rides,
            self._take_failure,
            state.marks("Disturbances"),
            is_slow=lambda request: is_slow(request.scenario, request.scenario.strategy),
            about=state.scenario.identity,
        )
        self.late = Study(compute_late_arrivals, self._take_late, self._take_failure)
        self._asked: RidesRequest | None = None
        self._drawn: RidesRequest | None = None
        self._watched: list[EventModel] = []
        state.scenario.param.watch(self._forget, ["preset", "opened"])
        state.scenario.follow(lambda scenario: scenario.disturbance, self.model.take)
        state.scenario.param.watch(self._ask, list(PLAN_FIELDS))
        state.param.watch(self._ask, ["page", "chosen"])
        self.model.param.watch(self._watch_events, "events")
        self.model.param.watch(self._ask, ["accepted_delay_s", "changed"])
        state.actual.param.watch(self._ask, "on")
        state.robustness.param.watch(self._ask, [*REALITY, *FOLLOWER])
        self.model.take(state.scenario.edited)

    def end(self) -> None:
        """End the study: the page is gone."""
        self.late.stop()

    def _forget(self, *_: Any) -> None:
        """Forget what was asked for: what comes of it is dropped, as the scenario has gone."""
        self.late.stop()
        self._asked = self._drawn = None

    def _watch_events(self, *_: Any) -> None:
        """Listen to events that are new, then ask."""
        for event in self.model.events:
            if not any(event is known for known in self._watched):
                event.param.watch(lambda *_: self.model.param.trigger("changed"), list(NUMBERS))
        self._watched = list(self.model.events)
        self._ask()

    def _ask(self, *_: Any) -> None:
        if self.state.page != "Disturbances":
            return
        request = RidesRequest(
            self.state.scenario.scenario(), {"strategy": self.state.chosen, **event_changes(self.state)}
        )
        if request != self._asked:
            self._asked = request
            if self._curve() != self._drawn:
                self.late.stop()
            self.rides.ask(request)

    def _curve(self) -> RidesRequest | None:
        """Return the request on which energy over delay depends: all but the delay that is accepted."""
        if self._asked is None:
            return None
        return replace(self._asked, changes={**self._asked.changes, "disturbance.accepted_delay_s": 0.0})

    def _take_rides(self, rides: Rides) -> None:
        self.model.param.update(rides=rides, failure=None)
        curve = self._curve()
        if not self.model.events:
            self._drawn = self.model.late = None
        elif curve is not None and curve != self._drawn:
            self._drawn = curve
            self.late.ask(curve)

    def _take_late(self, late: LateArrivals, last: bool) -> None:
        self.model.late = late

    def _take_failure(self, failure: RailjouleError) -> None:
        self.model.failure = failure
