"""The actual run: a plan that meets another load, a wrong place and events."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from railjoule.core import Scenario
from railjoule.core.simulation.actual_run import ActualRun, actual_run
from railjoule.dashboard.work.refusals import named_refusals


@dataclass(frozen=True)
class ActualRequest:
    """A scenario, and what differs from its plan, by the keys of the scenario's file."""

    scenario: Scenario
    changes: Mapping[str, Any]


def compute_actual(request: ActualRequest) -> ActualRun:
    """Return the plan of a scenario and what becomes of it.

    Raises
    ------
    RailjouleError
        If a value is out of its bounds, the plan cannot be kept or the line not be passed.
    """
    scenario = request.scenario.replace(**request.changes)
    with named_refusals(scenario):
        return actual_run(scenario)
