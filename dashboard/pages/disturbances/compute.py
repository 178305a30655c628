"""Rides with events on the way: who reacts how, and what a later arrival saves."""

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
from railjoule.dashboard.work.refusals import named_refusals

REACTIONS: tuple[Reaction, ...] = get_args(Reaction)
# closer together at first, where each second saves most
DELAYS_S = (0.0, 1.0, 2.0, 4.0, 7.0, 10.0, 15.0, 20.0, 30.0, 45.0, 60.0)


@dataclass(frozen=True)
class RidesRequest:
    """A scenario, and its events by the keys of the scenario's file.

    Parameters
    ----------
    scenario : Scenario
    changes : mapping
        The events, and the delay that is accepted.
    as_driver : bool
        Whether the driver's smallest delay is accepted instead.
    """

    scenario: Scenario
    changes: Mapping[str, Any]
    as_driver: bool = False

    def disturbed(self) -> Scenario:
        """Return the scenario with its events; raises ScenarioError if a value is out of its bounds."""
        return self.scenario.replace(**self.changes)


@dataclass(frozen=True, eq=False)
class Rides:
    """One ride for each reaction.

    Parameters
    ----------
    rides : mapping
        By reaction.
    accepted_s : float
        The delay that is accepted [s].
    as_driver : bool
        Whether it is the driver's smallest one.
    """

    rides: Mapping[Reaction, DisturbedRun]
    accepted_s: float
    as_driver: bool

    @property
    def undisturbed(self) -> Any:
        """The plan of a train that knows of nothing."""
        return next(iter(self.rides.values())).planned


def compute_rides(request: RidesRequest) -> Rides:
    """Return the ride of each reaction.

    Raises
    ------
    RailjouleError
        If a value is out of its bounds, the plan cannot be kept or the line not be passed.
    """
    scenario = request.disturbed()
    with named_refusals(scenario):
        planned = solve_plan(scenario)
        if request.as_driver:
            scenario = accepting(scenario, smallest_delay_s(accepting(scenario, 0.0), planned))
        rides = {reaction: disturbed_run_of(scenario, reaction, planned) for reaction in REACTIONS}
        return Rides(rides, scenario.disturbance.accepted_delay_s, request.as_driver)


def accepting(scenario: Scenario, delay_s: float) -> Scenario:
    """Return a scenario whose train may arrive so much later than planned [s]."""
    disturbance = scenario.disturbance.model_copy(update={"accepted_delay_s": delay_s})
    return scenario.model_copy(update={"disturbance": disturbance})


def smallest_delay_s(scenario: Scenario, planned: Trajectory) -> float:
    """Return the delay of a driver who makes up time as fast as allowed, in whole tenths that he can keep [s]."""
    delay = disturbed_run_of(scenario, "driver", planned).delay_s
    # less than a hundredth above a tenth is what solvers leave of a timetable
    return max(math.ceil(10 * delay - 0.1) / 10, 0.0)


def disturbed_run_of(scenario: Scenario, reaction: Reaction, planned: Trajectory) -> DisturbedRun:
    """Return the ride of a reaction; without events the run that has its load and place; errors as `compute_rides`."""
    run = actual_run(scenario, reaction, planned)
    return run.disturbed or DisturbedRun(planned, run.actual, scenario.travel_time_s, (), ())


@dataclass(frozen=True, eq=False)
class LateArrivals:
    """Energy over the delay at the end, by reaction.

    Parameters
    ----------
    accepted_s : array of shape (n,)
        Delays that are accepted [s].
    delay_s, energy_kwh : mapping of arrays of shape (n,)
        Delay at the end [s] and energy [kWh] by reaction; NaN where not computed yet.
    """

    accepted_s: FloatArray
    delay_s: Mapping[Reaction, FloatArray]
    energy_kwh: Mapping[Reaction, FloatArray]


def compute_late_arrivals(request: RidesRequest) -> Iterator[LateArrivals]:
    """Yield energy over delay as it is computed; errors as `compute_rides`."""
    scenario = request.disturbed()
    # once: neither the delay that is accepted nor who reacts changes the plan
    planned = solve_plan(scenario)
    delays = {reaction: np.full(len(DELAYS_S), np.nan) for reaction in REACTIONS}
    energies = {reaction: np.full(len(DELAYS_S), np.nan) for reaction in REACTIONS}
    late = LateArrivals(frozen_array(DELAYS_S), {}, {})
    for k, accepted in enumerate(DELAYS_S):
        relaxed = accepting(scenario, accepted)
        for reaction in REACTIONS:
            try:
                ride = disturbed_run_of(relaxed, reaction, planned)
            # it stays NaN: one delay that cannot be had must not cost the others
            except RailjouleError:
                continue
            delays[reaction][k], energies[reaction][k] = ride.delay_s, ride.actual.energy_kwh
        # copies, as the next step writes on into these arrays
        yield replace(
            late,
            delay_s={reaction: frozen_array(values) for reaction, values in delays.items()},
            energy_kwh={reaction: frozen_array(values) for reaction, values in energies.items()},
        )
