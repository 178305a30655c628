"""Runs of Liashenko, Yatsko 2025 that tables, claims and figures share; each is computed once."""

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.citation import printed_numbers
from railjoule.core.energy import share_above
from railjoule.core.scenario import Scenario, load_scenario
from railjoule.core.simulation.following import Following, follow, plan_for, plan_knowing_load
from railjoule.core.studies.sensitivity_table import sensitivity
from railjoule.core.studies.table import StudyTable
from railjoule.core.trajectory import Trajectory

PAPER = printed_numbers("liashenko-2025")
"""The content of the file of the paper; not to be changed."""
MIN_SHOWN = 0.05
"""A difference [percentage points] or delay [s] below this reads as 0.0."""


@cache
def compared_table(place: str) -> StudyTable:
    """Return one of Tables 4 to 7 beside railjoule's, over loads and position errors.

    The columns are those of `sensitivity`, and overconsumption [%] as `printed`, `by_plan`, computed by (12), and
    `by_load`, over the plan for the actual load.
    """
    entry = next(entry for entry in PAPER["table"] if entry["place"] == place)
    # the grid of the paper and not that of the study, which may change
    loads, errors = ([float(value) for value in PAPER[key]] for key in ("load_factors", "coordinate_errors_m"))
    table = sensitivity(load_scenario(entry["scenario"]), loads, errors)
    columns = {
        **table.columns,
        "printed": np.transpose(entry["overconsumption_percent"]),
        "by_plan": 100 * table.overconsumption,
        "by_load": 100 * table.over_replanned,
    }
    return replace(table, columns=columns)


def compared_tables() -> tuple[StudyTable, ...]:
    """Return Tables 4 to 7 beside railjoule's."""
    return tuple(compared_table(entry["place"]) for entry in PAPER["table"])


@cache
def example(place: str) -> tuple[Following, Trajectory]:
    """Return the run of one of Figures 3 to 6, and the plan for its actual load."""
    entry = next(entry for entry in PAPER["figure"] if entry["place"] == place)
    scenario = load_scenario(entry["scenario"])
    return follow(plan_for(scenario), scenario), plan_knowing(scenario)


def both_directions(scenario: Scenario, **changes: Any) -> tuple[Scenario, ...]:
    """Return a scenario with changes, there and back: the runs over which (12) adds energies."""
    return tuple(scenario.replace(**changes, **{"line.reverse": reverse}) for reverse in (False, True))


def above_own_time(scenarios: Sequence[Scenario]) -> float:
    """Return the share by which actual runs lie above plans for their load that take as long as they do.

    Parameters
    ----------
    scenarios : sequence of Scenario
        With their disturbance; energies add up.
    """
    energy = planned = 0.0
    for scenario in scenarios:
        actual = follow(plan_for(scenario), scenario).actual
        energy += actual.energy_kwh
        planned += plan_knowing(scenario.replace(**{"timetable.travel_time_s": actual.travel_time_s})).energy_kwh
    return share_above(energy, planned)


def plan_knowing(scenario: Scenario, load_factor: float | None = None) -> Trajectory:
    """Return the plan for a load, by default the actual one of the scenario."""
    load: Any = scenario.disturbance.actual_load_factor if load_factor is None else load_factor
    plan = plan_knowing_load(scenario, load)
    # the shipped plans all keep their time with each load
    assert plan is not None
    return plan


def rms(differences: FloatArray) -> float:
    """Return the root mean square of differences."""
    return float(np.sqrt(np.mean(np.square(differences))))
