"""Trips under speed limits by any regulator, and what the printed one makes of its step of time."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from railjoule.core.errors import ScenarioError, StrategyRefusedError
from railjoule.core.scenario import Scenario
from railjoule.core.strategies.speed_limits import literal_trajectory, speed_limits
from railjoule.core.task import prepare_task
from railjoule.core.trajectory import Trajectory
from railjoule.core.units import MS_PER_KMH


@dataclass(frozen=True)
class LiteralRun:
    """What the printed regulator makes of limits with one step of time.

    Parameters
    ----------
    time_step_s : float
        The step [s].
    energy_kwh, travel_time_s : float
        Net energy at the line [kWh] and time of the run [s]; NaN where there is none.
    refusal : str
        Why there is no run that the train can drive; empty where there is one.
    """

    time_step_s: float
    energy_kwh: float
    travel_time_s: float
    refusal: str = ""


def drive_under_limits(scenario: Scenario, limits_kmh: Sequence[float], regulator: str | None = None) -> Trajectory:
    """Return the trip of a scenario under limits [km/h] of the sections that its table [search] names.

    Parameters
    ----------
    scenario : Scenario
        Train, line and sections; its timetable does not bind the trip.
    limits_kmh : sequence of float
        One for each section [km/h].
    regulator : str, optional
        'brake', 'coast' or 'literal'; the scenario's own where absent.

    Raises
    ------
    ScenarioError
        If there are more or fewer limits than sections, or one is out of bounds.
    StrategyRefusedError
        If the regulator drives no run that the train can: it comes to a stand, say, or brakes too late.
    """
    changes = {"limits_kmh": tuple(float(limit) for limit in limits_kmh)}
    if regulator is not None:
        if regulator not in ("literal", "brake", "coast"):
            raise ScenarioError(f"search.regulator = {regulator!r} must be 'literal', 'brake' or 'coast'.")
        changes["regulator"] = regulator  # type: ignore[assignment]
    search = scenario.search.model_copy(update=changes)
    return speed_limits(prepare_task(scenario.model_copy(update={"search": search})))


def literal_spread(
    scenario: Scenario, limits_kmh: Sequence[float], time_steps_s: Sequence[float]
) -> tuple[LiteralRun, ...]:
    """Return the printed regulator's run for each of several steps of time [s], or why it drives none.

    Parameters
    ----------
    scenario : Scenario
        Train, line and sections.
    limits_kmh : sequence of float
        One for each section [km/h].
    time_steps_s : sequence of float
        Steps of time [s].
    """
    # the printed rule looks ahead by its step, so each step makes another run, and no step is the true one
    runs = []
    for step in time_steps_s:
        search = scenario.search.model_copy(update={"time_step_s": float(step)})
        task = prepare_task(scenario.model_copy(update={"search": search}))
        limits = np.array(limits_kmh, dtype=float) * MS_PER_KMH
        try:
            run = literal_trajectory(task, limits, np.array(search.boundaries_m))
        except StrategyRefusedError as error:
            runs.append(LiteralRun(float(step), np.nan, np.nan, str(error)))
        else:
            runs.append(LiteralRun(float(step), run.energy_kwh, run.travel_time_s))
    return tuple(runs)
