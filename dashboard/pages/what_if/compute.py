"""The plan under actual conditions: one run, a table of runs, runs with events, random draws, robust plans."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, get_args

import numpy as np

from railjoule.core import RailjouleError, Scenario, Trajectory
from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.scenario.disturbance import Reaction
from railjoule.core.simulation.actual_run import actual_run, solve_plan
from railjoule.core.simulation.disturbances import DisturbedRun
from railjoule.core.simulation.following import Following, follow, plan_for, plan_knowing_load
from railjoule.core.studies.braking_sensors import BrakingSensors, study_braking_sensors
from railjoule.core.studies.montecarlo import monte_carlo_steps
from railjoule.core.studies.robust_plan import RobustPlan, UnreachedProbabilityError, robust_plan_steps
from railjoule.core.studies.sensitivity_table import Knows, sensitivity_steps
from railjoule.core.studies.table import StudyTable
from railjoule.dashboard.work.runs import named_refusals

REACTIONS: tuple[Reaction, ...] = get_args(Reaction)
# closer together at first, where each second saves most
DELAYS_S = (0.0, 1.0, 2.0, 4.0, 7.0, 10.0, 15.0, 20.0, 30.0, 45.0, 60.0)


@dataclass(frozen=True)
class Conditions:
    """A scenario, and its differences from the plan, by the keys of the scenario's file."""

    scenario: Scenario
    changes: Mapping[str, Any]

    def actual(self) -> Scenario:
        """Return the scenario with its differences; raises ScenarioError if a value is out of its bounds."""
        return self.scenario.replace(**self.changes)


# ---- load and position


@dataclass(frozen=True, eq=False)
class Reality:
    """A plan, its actual run, and the energy of plans that know the load.

    Parameters
    ----------
    following : Following
        The plan and the run.
    replanned_kwh : float or None
        Energy of the plan for the actual load [kWh]; None if there is none.
    equal_kwh : float or None
        Energy of the plan for the actual load that arrives when the run did [kWh]; None if there is none.
    """

    following: Following
    replanned_kwh: float | None
    equal_kwh: float | None


def compute_reality(conditions: Conditions) -> Reality:
    """Return the actual run of a plan.

    Raises
    ------
    RailjouleError
        If a value is out of its bounds, or there is no such plan or run.
    """
    scenario = conditions.actual()
    with named_refusals(scenario):
        following = follow(plan_for(scenario), scenario)
    known = plan_knowing_load(scenario) if scenario.disturbance.has_load else following.planned
    return Reality(following, None if known is None else known.energy_kwh, _energy_at_equal_arrival(following))


def _energy_at_equal_arrival(following: Following) -> float | None:
    scenario, time_s = following.actual.scenario, following.actual.travel_time_s
    scenario = scenario.model_copy(update={"timetable": scenario.timetable.with_travel_time(time_s)})
    # a window of arrival at the last station may be over by then
    if scenario.travel_time_s < time_s:
        return None
    equal = plan_knowing_load(scenario)
    return None if equal is None else equal.energy_kwh


def compute_table(conditions: Conditions, both_directions: bool, known: Knows) -> Iterator[StudyTable]:
    """Yield the table of loads and position errors step by step; errors as `compute_reality`."""
    scenario = conditions.actual()
    with named_refusals(scenario):
        yield from sensitivity_steps(scenario, both_directions=both_directions, knows=known)


def compute_stops(conditions: Conditions) -> Iterator[BrakingSensors]:
    """Yield the stopping places under errors of measurement; errors as `compute_reality`."""
    scenario = conditions.actual()
    with named_refusals(scenario):
        yield study_braking_sensors(scenario)


# ---- events


@dataclass(frozen=True, eq=False)
class Rides:
    """One run with events for each reaction.

    Parameters
    ----------
    conditions : Conditions
        The scenario with its events.
    rides : mapping
        By reaction.
    accepted_s : float
        The accepted delay [s].
    as_driver : bool
        Whether it is the smallest delay that the driver reaches.
    """

    conditions: Conditions
    rides: Mapping[Reaction, DisturbedRun]
    accepted_s: float
    as_driver: bool

    @property
    def undisturbed(self) -> Trajectory:
        """The plan, in which there are no events."""
        return next(iter(self.rides.values())).planned


def compute_rides(conditions: Conditions, as_driver: bool = False) -> Rides:
    """Return the run of each reaction to events.

    Parameters
    ----------
    conditions : Conditions
        The scenario with its events and the accepted delay.
    as_driver : bool
        Whether the smallest delay that the driver reaches is accepted instead.

    Raises
    ------
    RailjouleError
        If a value is out of its bounds, or there is no such plan or run.
    """
    scenario = conditions.actual()
    with named_refusals(scenario):
        planned = solve_plan(scenario)
        if as_driver:
            scenario = _accepting(scenario, _smallest_delay_s(_accepting(scenario, 0.0), planned))
        rides = {reaction: _disturbed_run(scenario, reaction, planned) for reaction in REACTIONS}
        return Rides(conditions, rides, scenario.disturbance.accepted_delay_s, as_driver)


def _accepting(scenario: Scenario, delay_s: float) -> Scenario:
    disturbance = scenario.disturbance.model_copy(update={"accepted_delay_s": delay_s})
    return scenario.model_copy(update={"disturbance": disturbance})


def _smallest_delay_s(scenario: Scenario, planned: Trajectory) -> float:
    """Return the delay of a driver who makes up time as fast as allowed, in whole tenths that can be kept [s]."""
    delay = _disturbed_run(scenario, "driver", planned).delay_s
    # less than a hundredth above a tenth is the tolerance of the solvers
    return max(math.ceil(10 * delay - 0.1) / 10, 0.0)


def _disturbed_run(scenario: Scenario, reaction: Reaction, planned: Trajectory) -> DisturbedRun:
    """Return the run of a reaction; without events the run under the actual load and position."""
    run = actual_run(scenario, reaction, planned)
    return run.disturbed or DisturbedRun(planned, run.actual, scenario.travel_time_s, (), ())


@dataclass(frozen=True, eq=False)
class LateArrivals:
    """Energy over the delay at the end, by reaction.

    Parameters
    ----------
    accepted_s : array of shape (n,)
        Accepted delays [s].
    delay_s, energy_kwh : mapping of arrays of shape (n,)
        Delay at the end [s] and energy [kWh] by reaction; NaN where not computed yet.
    """

    accepted_s: FloatArray
    delay_s: Mapping[Reaction, FloatArray]
    energy_kwh: Mapping[Reaction, FloatArray]


def compute_late_arrivals(conditions: Conditions) -> Iterator[LateArrivals]:
    """Yield energy over delay step by step; errors as `compute_rides`."""
    scenario = conditions.actual()
    # once, as neither the accepted delay nor the reaction changes the plan
    planned = solve_plan(scenario)
    delays = {reaction: np.full(len(DELAYS_S), np.nan) for reaction in REACTIONS}
    energies = {reaction: np.full(len(DELAYS_S), np.nan) for reaction in REACTIONS}
    late = LateArrivals(frozen_array(DELAYS_S), {}, {})
    for k, accepted in enumerate(DELAYS_S):
        relaxed = _accepting(scenario, accepted)
        for reaction in REACTIONS:
            try:
                ride = _disturbed_run(relaxed, reaction, planned)
            # an impossible delay stays NaN, and the others are computed all the same
            except RailjouleError:
                continue
            delays[reaction][k], energies[reaction][k] = ride.delay_s, ride.actual.energy_kwh
        # copies, as the next step writes into these arrays
        yield replace(
            late,
            delay_s={reaction: frozen_array(values) for reaction, values in delays.items()},
            energy_kwh={reaction: frozen_array(values) for reaction, values in energies.items()},
        )


# ---- chance


def compute_chance(conditions: Conditions) -> Iterator[StudyTable]:
    """Yield the random runs step by step; errors as `compute_reality`."""
    scenario = conditions.actual()
    with named_refusals(scenario):
        yield from monte_carlo_steps(scenario)


@dataclass(frozen=True, eq=False)
class RobustAnswer:
    """The robust plan, or the search for it so far, and the reason if no candidate is on time often enough."""

    found: RobustPlan
    refusal: str = ""


def compute_robust(conditions: Conditions, probability: float, candidates: int) -> Iterator[RobustAnswer]:
    """Yield the search for a robust plan candidate by candidate, then the plan; errors as `compute_reality`."""
    scenario = conditions.actual()
    with named_refusals(scenario):
        steps = robust_plan_steps(scenario, probability, candidates)
        found = next(steps)
        yield RobustAnswer(found)
        try:
            for found in steps:
                yield RobustAnswer(found)
        except UnreachedProbabilityError as error:
            # the candidates stay in sight, and with them the largest share that was reached
            yield RobustAnswer(found, str(error))
