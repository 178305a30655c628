"""The plan under actual conditions: one run, a table of runs, runs with events, random draws, robust plans.

Each function takes the scenario, and its differences from the plan by the keys of the scenario's file. It raises a
RailjouleError if a value is out of its bounds, or there is no such plan or run.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any, get_args

import numpy as np

from railjoule.core import RailjouleError, Scenario, Trajectory
from railjoule.core.arrays import FloatArray
from railjoule.core.scenario.disturbance import Reaction
from railjoule.core.simulation.actual_run import actual_run, solve_plan
from railjoule.core.simulation.disturbances import DisturbedRun
from railjoule.core.simulation.following import Following, follow, plan_for, plan_knowing_load
from railjoule.core.studies.braking_sensors import BrakingSensors, study_braking_sensors
from railjoule.core.studies.robust_plan import RobustPlan, UnreachedProbabilityError, robust_plan_steps
from railjoule.dashboard.work.runs import named_refusals

Changes = Mapping[str, Any]
Late = Mapping[Reaction, FloatArray]
"""Delay at the end [s] and energy [kWh] by reaction; shape (2, n), NaN where not computed yet."""
REACTIONS: tuple[Reaction, ...] = get_args(Reaction)
# closer together at first, where each second saves most
DELAYS_S = (0.0, 1.0, 2.0, 4.0, 7.0, 10.0, 15.0, 20.0, 30.0, 45.0, 60.0)


def steps(scenario: Scenario, changes: Changes, study: Callable[..., Iterator[Any]], *settings: Any) -> Iterator[Any]:
    """Yield the steps of a study of the core."""
    actual = scenario.replace(**changes)
    with named_refusals(actual):
        yield from study(actual, *settings)


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


def compute_reality(scenario: Scenario, changes: Changes) -> Reality:
    """Return the actual run of a plan."""
    scenario = scenario.replace(**changes)
    with named_refusals(scenario):
        following = follow(plan_for(scenario), scenario)
    known = plan_knowing_load(scenario) if scenario.disturbance.has_load else following.planned
    driven, time_s = following.actual.scenario, following.actual.travel_time_s
    later = driven.model_copy(update={"timetable": driven.timetable.with_travel_time(time_s)})
    # a window of arrival at the last station may be over by then
    equal = None if later.travel_time_s < time_s else plan_knowing_load(later)
    return Reality(following, *(None if plan is None else plan.energy_kwh for plan in (known, equal)))


def stop_steps(scenario: Scenario) -> Iterator[BrakingSensors]:
    """Yield the stopping places under errors of measurement."""
    yield study_braking_sensors(scenario)


# ---- events


@dataclass(frozen=True, eq=False)
class Rides:
    """One run with events for each reaction.

    Parameters
    ----------
    rides : mapping
        By reaction.
    accepted_s : float
        The accepted delay [s].
    as_driver : bool
        Whether it is the smallest delay that the driver reaches.
    """

    rides: Mapping[Reaction, DisturbedRun]
    accepted_s: float
    as_driver: bool

    @property
    def undisturbed(self) -> Trajectory:
        """The plan, in which there are no events."""
        return next(iter(self.rides.values())).planned


def compute_rides(scenario: Scenario, changes: Changes, as_driver: bool = False) -> Rides:
    """Return the run of each reaction to events; with `as_driver` each may be as late as the driver is at least."""
    scenario = scenario.replace(**changes)
    with named_refusals(scenario):
        planned = solve_plan(scenario)
        if as_driver:
            late_s = _disturbed_run(_accepting(scenario, 0.0), "driver", planned).delay_s
            # in whole tenths that can be kept; less than a hundredth above one is the tolerance of the solvers
            scenario = _accepting(scenario, max(math.ceil(10 * late_s - 0.1) / 10, 0.0))
        rides = {reaction: _disturbed_run(scenario, reaction, planned) for reaction in REACTIONS}
    return Rides(rides, scenario.disturbance.accepted_delay_s, as_driver)


def _accepting(scenario: Scenario, delay_s: float) -> Scenario:
    disturbance = scenario.disturbance.model_copy(update={"accepted_delay_s": delay_s})
    return scenario.model_copy(update={"disturbance": disturbance})


def _disturbed_run(scenario: Scenario, reaction: Reaction, planned: Trajectory) -> DisturbedRun:
    """Return the run of a reaction; without events the run under the actual load and position."""
    run = actual_run(scenario, reaction, planned)
    return run.disturbed or DisturbedRun(planned, run.actual, scenario.travel_time_s, (), ())


def compute_late_arrivals(scenario: Scenario, changes: Changes) -> Iterator[Late]:
    """Yield energy over the delay at the end step by step."""
    scenario = scenario.replace(**changes)
    # once, as neither the accepted delay nor the reaction changes the plan
    planned = solve_plan(scenario)
    late = {reaction: np.full((2, len(DELAYS_S)), np.nan) for reaction in REACTIONS}
    for k, accepted_s in enumerate(DELAYS_S):
        for reaction in REACTIONS:
            # an impossible delay stays NaN, and the others are computed all the same
            with suppress(RailjouleError):
                ride = _disturbed_run(_accepting(scenario, accepted_s), reaction, planned)
                late[reaction][:, k] = ride.delay_s, ride.actual.energy_kwh
        # copies, as the next step writes into these arrays
        yield {reaction: values.copy() for reaction, values in late.items()}


# ---- chance


@dataclass(frozen=True, eq=False)
class RobustAnswer:
    """The robust plan, or the search for it so far, and the reason if no candidate is on time often enough."""

    found: RobustPlan
    refusal: str = ""


def robust_steps(scenario: Scenario, probability: float, candidates: int) -> Iterator[RobustAnswer]:
    """Yield the search for a robust plan candidate by candidate, then the plan."""
    search = robust_plan_steps(scenario, probability, candidates)
    answer = RobustAnswer(next(search))
    try:
        yield answer
        for found in search:
            answer = RobustAnswer(found)
            yield answer
    except UnreachedProbabilityError as error:
        # the candidates stay in sight, and with them the largest share that was reached
        yield replace(answer, refusal=str(error))
