"""Entry points of the public API that begin with a scenario and end with a result."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.scenario import Scenario, as_scenario
from railjoule.core.strategies import prepare_task

if TYPE_CHECKING:
    from railjoule.core.scenario.disturbance import Reaction
    from railjoule.core.simulation.actual_run import ActualRun
    from railjoule.core.studies import Frontier


def simulate(scenario: Scenario | str | Path, reaction: "Reaction | None" = None, **disturbance: Any) -> "ActualRun":
    """Simulate what becomes of a scenario's plan under actual conditions, and what each cause adds.

    Parameters
    ----------
    scenario : Scenario, str or Path
        A scenario, the name of a shipped one, or the path of a scenario file.
    reaction : str, optional
        Reaction to events: "driver", "computer" or "known"; by default that of the events of the scenario.
    **disturbance
        Keys of the scenario's table `disturbance` to change, such as `actual_load_factor=1.0` or
        `coordinate_error_m=15.0`.

    Raises
    ------
    ScenarioError
        If a key is unknown or its value out of bounds, an event lies outside the line, or two stops lie at one place.
    RailjouleError
        As in `solve` for the plan; InfeasibleLineError if the train comes to a stand on its way.
    """
    from railjoule.core.simulation.actual_run import actual_run  # noqa: PLC0415  (slow to import)

    changes = {f"disturbance.{key}": value for key, value in disturbance.items()}
    return actual_run(as_scenario(scenario).replace(changes), reaction)


def frontier(
    scenario: Scenario | str | Path,
    travel_times_s: Sequence[float] | FloatArray | None = None,
    strategy: str = "optimal",
    count: int = 40,
) -> "Frontier":
    """Compute the least energy over travel time, with a lower bound.

    Parameters
    ----------
    scenario : Scenario, str or Path
        As in `simulate`; its own travel time does not matter.
    travel_times_s : array of shape (m,), optional
        Times of the whole run, dwells included [s]; by default `count` of them, from just above the shortest time to
        twice as long, denser where the energy is steep.
    strategy : str
        The strategy that drives.
    count : int
        How many times, at least 2.

    Raises
    ------
    ScenarioError, InfeasibleLineError
        As in `solve`. Times that cannot be kept stand in `refused` of the result.
    StrategyRefusedError
        If there is no such strategy.
    """
    from railjoule.core.studies import tradeoff  # noqa: PLC0415  (slow to import)

    task = prepare_task(as_scenario(scenario))
    times = tradeoff.frontier_times(task, count) if travel_times_s is None else np.asarray(travel_times_s, dtype=float)
    return tradeoff.energy_time_frontier(task, times, strategy)
