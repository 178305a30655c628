"""Runs under given set speeds."""

from typing import Any

from railjoule.core.scenario import Scenario
from railjoule.core.strategies import run_strategy
from railjoule.core.task import prepare_task
from railjoule.core.trajectory import Trajectory


def drive_under_limits(scenario: Scenario, limits_kmh: list[float], regulator: str | None = None) -> Trajectory:
    """Return the run of a scenario under given set speeds [km/h]."""
    changes: dict[str, Any] = {"search.limits_kmh": limits_kmh}
    if regulator is not None:
        changes["search.regulator"] = regulator
    return run_strategy(prepare_task(scenario.replace(**changes)), "speed_limits")
