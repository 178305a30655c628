"""What the page Disturbances asks for: the events on the way, and the delay that is accepted."""

from collections.abc import Mapping
from typing import Any

import param

from railjoule.core import Scenario
from railjoule.dashboard.actual.event import (
    FIRST_LIMIT_M,
    FIRST_STOP_S,
    NOTICE_BEFORE_M,
    TABLES,
    EventModel,
    event_model,
)
from railjoule.dashboard.pages.disturbances.compute import LateArrivals, Rides
from railjoule.dashboard.state.numbers import TypedNumber, TypedParameters
from railjoule.dashboard.state.page_model import PageModel, result


class DisturbancesModel(TypedParameters, PageModel):
    """The events of the page and their results."""

    kept = ("events", "accepted_delay_s")
    passing = ("dropping", "as_driver")

    events = param.List(default=[], item_type=EventModel, doc="What happens on the way.")
    accepted_delay_s = TypedNumber(
        "Accepted delay, s", "s", default=0.0, bounds=(0.0, 86_400.0), softbounds=(0, 60), step=1
    )
    as_driver = param.Boolean(
        default=False, doc="Whether the accepted delay follows the driver's smallest one, until it is set by hand."
    )
    dropping = param.Selector(default="stop", objects=["stop", "limit"], doc="What a click on the track adds.")

    rides = result(Rides, "The last good rides.")
    late = result(LateArrivals, "Energy over lateness so far.")
    changed = param.Event(doc="An event has other numbers.")

    def take(self, scenario: Scenario) -> None:
        """Take over the events of a scenario's file."""
        events = [event_model(event) for event in scenario.disturbance.events]
        accepted = scenario.disturbance.accepted_delay_s
        self.param.update(events=events, accepted_delay_s=accepted, as_driver=False)

    def drop(self, kind: str, place_m: float) -> None:
        """Add an event of a kind at a place."""
        # core/scenario takes no event at 0 m
        place = float(max(round(place_m), 1))
        event = EventModel(
            kind=kind,
            position_m=place,
            to_m=place + FIRST_LIMIT_M,
            duration_s=FIRST_STOP_S,
            # changes of voltage and recuperation have no other place than that at which they are noticed
            noticed_at_m=max(place - NOTICE_BEFORE_M, 0.0) if kind in {"stop", "limit"} else place,
        )
        # flat out, each reaction would arrive at another time, and their energies would not compare
        if not self.events and self.accepted_delay_s == 0:
            self.as_driver = True
        self.events = [*self.events, event]

    def remove(self, event: EventModel) -> None:
        """Take an event away."""
        self.events = [other for other in self.events if other is not event]

    @property
    def changes(self) -> Mapping[str, Any]:
        """The events by the keys of the file."""
        tables: dict[str, Any] = {f"disturbance.{table}": [] for table in TABLES.values()}
        for event in self.events:
            tables[f"disturbance.{TABLES[event.kind]}"].append(event.document)
        return {**tables, "disturbance.accepted_delay_s": float(self.accepted_delay_s)}
