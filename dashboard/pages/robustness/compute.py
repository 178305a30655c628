"""What becomes of a plan in reality: one run, a table of them, and what chance makes of it."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from railjoule.core import Scenario
from railjoule.core.simulation.following import Following, follow, plan_for, plan_knowing_load
from railjoule.core.studies.braking_sensors import BrakingSensors, study_braking_sensors
from railjoule.core.studies.montecarlo import monte_carlo_steps
from railjoule.core.studies.robust_plan import RobustPlan, UnreachedProbabilityError, robust_plan_steps
from railjoule.core.studies.sensitivity_table import Knows, sensitivity_steps
from railjoule.core.studies.table import StudyTable
from railjoule.dashboard.work.refusals import named_refusals


@dataclass(frozen=True)
class RealityRequest:
    """A scenario, and what is otherwise in reality, by the keys of the scenario's file."""

    scenario: Scenario
    changes: Mapping[str, Any]

    def scenario_in_reality(self) -> Scenario:
        """Return the scenario with its reality; raises ScenarioError if a value is out of its bounds."""
        return self.scenario.replace(**self.changes)


@dataclass(frozen=True, eq=False)
class Reality:
    """A plan, what became of it, and what a plan would have needed that knew the load.

    Parameters
    ----------
    following : Following
        The plan and the run.
    replanned_kwh : float or None
        Energy of the plan for the load that is really carried [kWh]; None if there is none.
    """

    following: Following
    replanned_kwh: float | None


def compute_reality(request: RealityRequest) -> Reality:
    """Return what becomes of a plan.

    Raises
    ------
    RailjouleError
        If a value is out of its bounds, the timetable cannot be kept or the line not be passed.
    """
    scenario = request.scenario_in_reality()
    with named_refusals(scenario):
        following = follow(plan_for(scenario), scenario)
    load = scenario.disturbance.actual_load_factor
    knowing = following.planned if load is None else plan_knowing_load(scenario, load)
    return Reality(following, None if knowing is None else knowing.energy_kwh)


@dataclass(frozen=True)
class TableRequest:
    """For which plan the table of loads and errors is asked, whether there and back, and what the train knows."""

    reality: RealityRequest
    both_directions: bool
    knows: Knows


def compute_table(request: TableRequest) -> Iterator[StudyTable]:
    """Yield the table of loads and errors as it fills; errors as `compute_reality`."""
    scenario = request.reality.scenario_in_reality()
    with named_refusals(scenario):
        yield from sensitivity_steps(scenario, both_directions=request.both_directions, knows=request.knows)


def compute_chance(request: RealityRequest) -> Iterator[StudyTable]:
    """Yield the runs that chance draws as they come; errors as `compute_reality`."""
    scenario = request.scenario_in_reality()
    with named_refusals(scenario):
        yield from monte_carlo_steps(scenario)


def compute_stops(request: RealityRequest) -> Iterator[BrakingSensors]:
    """Yield where the train stops with errors of measurement; errors as `compute_reality`."""
    scenario = request.scenario_in_reality()
    with named_refusals(scenario):
        yield study_braking_sensors(scenario)


@dataclass(frozen=True)
class RobustRequest:
    """The scenario with its distributions, the probability of an arrival on time, and the number of candidates."""

    reality: RealityRequest
    probability: float
    candidates: int


@dataclass(frozen=True, eq=False)
class RobustAnswer:
    """The robust plan, or the search for it so far, and the reason if no candidate is on time often enough."""

    found: RobustPlan
    refusal: str = ""


def compute_robust(request: RobustRequest) -> Iterator[RobustAnswer]:
    """Yield the search for a robust plan as its candidates come, then the plan; errors as `compute_reality`."""
    scenario = request.reality.scenario_in_reality()
    with named_refusals(scenario):
        steps = robust_plan_steps(scenario, request.probability, request.candidates)
        found = next(steps)
        yield RobustAnswer(found)
        try:
            for found in steps:
                yield RobustAnswer(found)
        except UnreachedProbabilityError as error:
            # the candidates stay in sight, and with them the best share that was reached
            yield RobustAnswer(found, str(error))
