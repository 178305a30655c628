"""Runs of Liashenko, Yatsko 2025 that tables, claims and figures share; each is computed once."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.citation import printed_numbers
from railjoule.core.energy import share_above
from railjoule.core.scenario import Scenario, load_scenario
from railjoule.core.simulation.following import Following, follow, plan_for, plan_knowing_load
from railjoule.core.studies.sensitivity_table import sensitivity
from railjoule.core.trajectory import Trajectory

PAPER = "liashenko-2025"
BOTH_DIRECTIONS = (False, True)
"""Values of `line.reverse` over which (12) adds energies."""
MIN_SHOWN = 0.05
"""A difference [percentage points] or delay [s] below this reads as 0.0."""


@dataclass(frozen=True, eq=False)
class ComparedTable:
    """One of Tables 4 to 7 beside railjoule's, over m position errors and k loads.

    Parameters
    ----------
    place : str
        Its name in the paper.
    scenario : Scenario
        The plan is for its load.
    errors_m, loads : array of shape (m,), (k,)
        Position errors [m] and load factors.
    printed, by_plan, by_load : array of shape (m, k)
        Overconsumption: printed; computed by (12), over the plan; computed over the plan for the actual load [%].
    load_change : array of shape (k,)
        Energy of the plan for each load over that of the plan [%].
    delay_s, stop_error_m : array of shape (m, k)
        As in `StudyTable`.
    """

    place: str
    scenario: Scenario
    errors_m: FloatArray
    loads: FloatArray
    printed: FloatArray
    by_plan: FloatArray
    by_load: FloatArray
    load_change: FloatArray
    delay_s: FloatArray
    stop_error_m: FloatArray

    @property
    def planned_error(self) -> int:
        """Row without a position error."""
        return int(np.flatnonzero(self.errors_m == 0)[0])

    @property
    def planned_load(self) -> int:
        """Column of the load of the plan."""
        return int(np.flatnonzero(self.loads == self.scenario.vehicle.load_factor)[0])

    def mass_change(self, load_factor: float) -> float:
        """Return the mass at a load over that of the plan, minus 1."""
        planned = self.scenario.vehicle.total_mass_kg
        return self.scenario.replace(**{"vehicle.load_factor": load_factor}).vehicle.total_mass_kg / planned - 1


@dataclass(frozen=True, eq=False)
class Example:
    """The run of one of Figures 3 to 6.

    Parameters
    ----------
    place : str
        Its name in the paper.
    scenario : Scenario
        With its disturbance.
    following : Following
        The plan and the actual run.
    own_plan : Trajectory
        The plan for the actual load.
    """

    place: str
    scenario: Scenario
    following: Following
    own_plan: Trajectory

    @property
    def by_load(self) -> float:
        """Share by which the energy lies above that of the plan for the actual load."""
        return share_above(self.following.actual.energy_kwh, self.own_plan.energy_kwh)


@cache
def paper_numbers() -> dict[str, Any]:
    """Return the content of the paper's file."""
    return printed_numbers(PAPER)


@cache
def compared_table(place: str) -> ComparedTable:
    """Return one of Tables 4 to 7 beside railjoule's."""
    paper = paper_numbers()
    entry = next(entry for entry in paper["table"] if entry["place"] == place)
    # the grid of the paper and not that of the study, which may change
    errors, loads = ([float(value) for value in paper[key]] for key in ("coordinate_errors_m", "load_factors"))
    table = sensitivity(load_scenario(entry["scenario"]), loads, errors)
    return ComparedTable(
        place=place,
        scenario=table.scenario,
        errors_m=np.array(errors),
        loads=np.array(loads),
        printed=np.array(entry["overconsumption_percent"]),
        by_plan=100 * table.overconsumption.T,
        by_load=100 * table.over_replanned.T,
        load_change=100 * share_above(table.replanned_kwh, table.planned_energy_kwh),
        delay_s=table.delay_s.T,
        stop_error_m=table.stop_error_m.T,
    )


def compared_tables() -> tuple[ComparedTable, ...]:
    """Return Tables 4 to 7 beside railjoule's."""
    return tuple(compared_table(entry["place"]) for entry in paper_numbers()["table"])


@cache
def example(place: str) -> Example:
    """Return the run of one of Figures 3 to 6."""
    entry = next(entry for entry in paper_numbers()["figure"] if entry["place"] == place)
    scenario = load_scenario(entry["scenario"])
    return Example(place, scenario, follow(plan_for(scenario), scenario), plan_knowing(scenario))


def both_directions(scenario: Scenario, **changes: Any) -> tuple[Scenario, ...]:
    """Return a scenario with changes, there and back."""
    return tuple(scenario.replace(**changes, **{"line.reverse": reverse}) for reverse in BOTH_DIRECTIONS)


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
