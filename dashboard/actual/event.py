"""An event of the day: an unplanned stop or limit, another supply voltage, less recuperation."""

from collections.abc import Mapping
from typing import Any

import param

from railjoule.core.scenario.disturbance import (
    Event,
    RecuperationChange,
    UnplannedLimit,
    UnplannedStop,
    VoltageChange,
)
from railjoule.dashboard.look import words
from railjoule.dashboard.state.numbers import TypedNumber, TypedParameters, core_bounds

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

BY_KIND: Mapping[tuple[str, str], Mapping[str, Any]] = {
    ("stop", "position_m"): core_bounds(UnplannedStop, "position_m"),
    ("limit", "position_m"): core_bounds(UnplannedLimit, "from_m"),
    ("voltage", "share_percent"): core_bounds(VoltageChange, "line_voltage_factor", 100),
    ("recuperation", "share_percent"): core_bounds(RecuperationChange, "recuperation_factor", 100),
}
"""Bounds of the fields that kinds of events have in common."""

KIND_WORDS = {"stop": "Stop", "limit": "Limit", "voltage": "Supply voltage", "recuperation": "Recuperation"}


class EventModel(TypedParameters):
    """One event, in the units that the page shows."""

    kept = ("kind", "position_m", "to_m", "duration_s", "limit_kmh", "share_percent", "noticed_at_m")

    kind = param.Selector(default="stop", objects=list(KINDS), doc="What happens.")
    position_m = TypedNumber("at, m", "m", default=300.0, **core_bounds(UnplannedLimit, "from_m"))
    to_m = TypedNumber("to, m", "m", default=400.0, **core_bounds(UnplannedLimit, "to_m"))
    duration_s = TypedNumber("stops for, s", "s", default=5.0, **core_bounds(UnplannedStop, "duration_s"))
    limit_kmh = TypedNumber("km/h", "km/h", default=30.0, **core_bounds(UnplannedLimit, "limit_kmh"))
    share_percent = TypedNumber("of nominal, %", "%", default=80.0, bounds=(0.0, 200.0))
    noticed_at_m = TypedNumber("noticed at, m", "m", default=70.0, **core_bounds(Event, "noticed_at_m"))

    def bounds_of(self, field: str) -> tuple[float | None, float | None]:
        """Return the least and the largest number that a field takes for this kind of event."""
        own = BY_KIND.get((self.kind, field))
        return super().bounds_of(field) if own is None else own["bounds"]

    def closed_ends(self, field: str) -> tuple[bool, bool]:
        """Return whether a field takes its least and its largest number themselves, for this kind of event."""
        own = BY_KIND.get((self.kind, field))
        return super().closed_ends(field) if own is None else own["inclusive_bounds"]

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


def event_sign(event: EventModel) -> str:
    """Return what a chart writes at an event."""
    if event.kind == "stop":
        return f"stop {words.number(event.duration_s, 0)} s"
    if event.kind == "limit":
        return f"limit {words.number(event.limit_kmh, 0)}"
    return f"{KIND_WORDS[event.kind].lower()} {words.number(event.share_percent, 0)} %"
