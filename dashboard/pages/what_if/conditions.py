"""The actual conditions as the page computes with them: their sources, and the scenario with them."""

from collections.abc import Mapping
from typing import Any

from railjoule.dashboard import day
from railjoule.dashboard.pages.what_if.compute import Conditions
from railjoule.dashboard.state.recipes import followed
from railjoule.dashboard.workbench import Workbench


def _sources(*fields: str) -> tuple[str, ...]:
    return tuple(f"desk.day.{field}" for field in fields)


LOAD_AND_POSITION = _sources(*day.LOAD_AND_POSITION)
FOLLOWING = _sources(*day.FOLLOWING)
CHANCE = _sources(*day.CHANCE)
EVENTS = _sources("events", "changed", "accepted_delay_s", "on")
PREVIEW_RUNS = 500
"""Random draws without a request for more."""
NOTHING_WRONG = {"disturbance.actual_load_factor": 0.0, "disturbance.coordinate_error_m": 0.0}
"""Sources for studies with their own loads and position errors."""


def conditions(desk: Workbench, changes: Mapping[str, Any]) -> Conditions:
    """Return the scenario with some of the actual conditions, without the events of its file."""
    events = day.NO_EVENTS if desk.scenario.edited.disturbance.events else {}
    return Conditions(desk.scenario.scenario(), {"strategy": desk.chosen, **followed(desk), **events, **changes})
