"""What the page Disturbances asks for: the events on the way, and the delay that is accepted."""

from collections.abc import Mapping
from typing import Any

import param

from railjoule.core import Scenario
from railjoule.core.scenario.disturbance import Event, UnplannedLimit, UnplannedStop, VoltageChange
from railjoule.dashboard.pages.disturbances.compute import LateArrivals, Rides
from railjoule.dashboard.state.numbers import TypedNumber, TypedParameters
from railjoule.dashboard.state.page_model import PageModel, result

KINDS = ("stop", "limit", "voltage", "recuperation")
TABLES = {
    "stop": "stops",
    "limit": "speed_limits",
    "voltage": "voltage_changes",
    "recuperation": "recuperation_changes",
}
"""Kinds of events, and where they stand in the file."""
NOTICE_BEFORE_M, FIRST_LIMIT_M, FIRST_STOP_S = 230.0, 100.0, 20.0
"""An event is noticed this far ahead [m]; a new limit is this long [m], a new stop takes this long [s]."""
LONGEST_M = 1e7


class EventModel(TypedParameters):
    """One event, in the units that the page shows."""

    kept = ("kind", "position_m", "to_m", "duration_s", "limit_kmh", "share_percent", "noticed_at_m")

    kind = param.Selector(default="stop", objects=list(KINDS), doc="What happens.")
    position_m = TypedNumber("at, m", "m", default=300.0, bounds=(0.0, LONGEST_M))
    to_m = TypedNumber("to, m", "m", default=400.0, bounds=(0.0, LONGEST_M))
    duration_s = TypedNumber("stops for, s", "s", default=5.0, bounds=(0.0, 86_400.0))
    limit_kmh = TypedNumber("km/h", "km/h", default=30.0, bounds=(0.0, 600.0))
    share_percent = TypedNumber("of nominal, %", "%", default=80.0, bounds=(0.0, 200.0))
    noticed_at_m = TypedNumber("noticed at, m", "m", default=70.0, bounds=(0.0, LONGEST_M))

    @property
    def document(self) -> dict[str, Any]:
        """The event as in the file."""
        noticed = {"noticed_at_m": float(self.noticed_at_m)}
        if self.kind == "stop":
            return {"position_m": float(self.position_m), "duration_s": float(self.duration_s), **noticed}
        if self.kind == "limit":
            places = {"from_m": float(self.position_m), "to_m": float(self.to_m)}
            return {**places, "limit_kmh": float(self.limit_kmh), **noticed}
        key = "line_voltage_factor" if self.kind == "voltage" else "recuperation_factor"
        return {key: self.share_percent / 100, **noticed}


class DisturbancesModel(TypedParameters, PageModel):
    """The events of the page and their results."""

    kept = ("events", "accepted_delay_s")
    passing = ("dropping",)

    events = param.List(default=[], item_type=EventModel, doc="What happens on the way.")
    accepted_delay_s = TypedNumber(
        "Accepted delay, s", "s", default=0.0, bounds=(0.0, 86_400.0), softbounds=(0, 60), step=1
    )
    dropping = param.Selector(default="stop", objects=["stop", "limit"], doc="What a click on the track adds.")

    rides = result(Rides, "The last good rides.")
    late = result(LateArrivals, "Energy over lateness so far.")
    changed = param.Event(doc="An event has other numbers.")

    def take(self, scenario: Scenario) -> None:
        """Take over the events of a scenario's file."""
        events = [event_model(event) for event in scenario.disturbance.events]
        self.param.update(events=events, accepted_delay_s=scenario.disturbance.accepted_delay_s)

    def drop(self, kind: str, place_m: float) -> None:
        """Add an event of a kind at a place."""
        place = float(max(round(place_m), 1))
        event = EventModel(
            kind=kind,
            position_m=place,
            to_m=place + FIRST_LIMIT_M,
            duration_s=FIRST_STOP_S,
            noticed_at_m=max(place - NOTICE_BEFORE_M, 0.0) if kind in {"stop", "limit"} else place,
        )
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


def event_model(event: Event) -> EventModel:
    """Return the page's model of an event of a file."""
    noticed = {"noticed_at_m": event.noticed_at_m or 0.0}
    if isinstance(event, UnplannedStop):
        return EventModel(kind="stop", position_m=event.position_m, duration_s=event.duration_s, **noticed)
    if isinstance(event, UnplannedLimit):
        return EventModel(kind="limit", position_m=event.from_m, to_m=event.to_m, limit_kmh=event.limit_kmh, **noticed)
    if isinstance(event, VoltageChange):
        return EventModel(kind="voltage", share_percent=100 * event.line_voltage_factor, **noticed)
    return EventModel(kind="recuperation", share_percent=100 * event.recuperation_factor, **noticed)  # type: ignore[attr-defined]
