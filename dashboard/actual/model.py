"""The run of a day on Drive: whether it is drawn, and what differs from the plan.

Load and error of the place are those of Robustness, the events those of Disturbances: one value for all three pages.
"""

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any, get_args

import param

from railjoule.core import Scenario
from railjoule.core.scenario.disturbance import Reaction
from railjoule.core.scenario.line import SHORTEST_DISTANCE_M
from railjoule.core.simulation.actual_run import ActualRun
from railjoule.dashboard.actual.event import EventModel
from railjoule.dashboard.state.numbers import TypedParameters
from railjoule.dashboard.state.page_model import PageModel, result

if TYPE_CHECKING:
    from railjoule.dashboard.state.workbench import Workbench


class ActualModel(TypedParameters, PageModel):
    """Whether the actual run is drawn beside the plan, and who reacts to its events."""

    kept = ("on", "reaction")

    on = param.Boolean(default=False, doc="Whether the actual run is drawn beside the plan.")
    reaction = param.Selector(default="driver", objects=list(get_args(Reaction)), doc="Who reacts to an event.")
    run = result(ActualRun, "The last good actual run.")

    def take(self, scenario: Scenario) -> None:
        """Take over who reacts in a scenario's file."""
        events = scenario.disturbance.events
        self.reaction = events[0].reaction if events else "driver"


def actual_changes(state: "Workbench") -> Mapping[str, Any]:
    """Return all that differs from the plan in the actual run, by the keys of the file."""
    reaction = {"reaction": state.actual.reaction}
    # Drive names one reaction for all events, where a file has one for each
    events = {
        key: [{**event, **reaction} for event in value] if isinstance(value, list) else value
        for key, value in state.disturbances.changes.items()
    }
    return {**state.robustness.changes, **events}


def event_changes(state: "Workbench") -> Mapping[str, Any]:
    """Return what differs from the plan on Disturbances: the events, and on the day also the load and the place."""
    day: dict[str, Any] = dict(state.robustness.changes)
    if not state.actual.on:
        day = {"disturbance.coordinate_error_m": 0.0}
        if state.scenario.edited.disturbance.actual_load_factor is not None:
            day["disturbance.actual_load_factor"] = None
    # a later departure moves all rides by the same time, and is no event
    return {**day, "disturbance.departure_delay_s": 0.0, **state.disturbances.changes}


def as_planned(state: "Workbench") -> None:
    """Let the actual run equal the plan: its load, the right place, no events."""
    state.robustness.param.update(actual_load_percent=state.scenario.load_percent, coordinate_error_m=0.0)
    state.disturbances.events = []


def occupied_m(state: "Workbench", besides: EventModel | None = None) -> list[float]:
    """Return where the train stands on its way, both ends included, but for one stop [m]."""
    line = state.scenario.edited.line.in_running_order()
    stops = [event.position_m for event in stops_of(state) if event is not besides]
    return sorted({0.0, line.length_m, *(station.position_m for station in line.inner_stations), *stops})


def stops_of(state: "Workbench") -> Sequence[EventModel]:
    """Return the unplanned stops."""
    return [event for event in state.disturbances.events if event.kind == "stop"]


def add_stop(state: "Workbench") -> None:
    """Add a stop in the middle of the longest stretch without one."""
    before, after = max(pairwise(occupied_m(state)), key=lambda ends: ends[1] - ends[0])
    state.disturbances.drop("stop", 0.5 * (before + after))


def checked_place(state: "Workbench", stop: EventModel, place_m: float) -> float:
    """Return a place for a stop [m].

    Raises
    ------
    ValueError
        With a sentence that names what is in the way.
    """
    length = state.scenario.edited.line.length_m
    if place_m > length - SHORTEST_DISTANCE_M:
        raise ValueError(f"A stop at {place_m:g} m lies beyond the line, {length:g} m.")
    near = [other for other in occupied_m(state, stop) if abs(other - place_m) < SHORTEST_DISTANCE_M]
    if near:
        raise ValueError(f"A stop at {place_m:g} m must be {SHORTEST_DISTANCE_M:g} m from the one at {near[0]:g} m.")
    return place_m


def move_stop(stop: EventModel, place_m: float) -> None:
    """Put a stop at another place [m]; it is noticed as far ahead as before."""
    ahead = max(stop.position_m - stop.noticed_at_m, 0.0)
    stop.param.update(position_m=place_m, noticed_at_m=max(place_m - ahead, 0.0))
