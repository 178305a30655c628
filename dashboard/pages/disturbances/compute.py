"""Rides with events on the way: who reacts how, and what a later arrival saves."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, get_args

import numpy as np

from railjoule.core import RailjouleError, Scenario, Trajectory
from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.scenario.disturbance import Reaction
from railjoule.core.simulate.actual_run import actual_run, plan_of
from railjoule.core.simulate.disturbances import DisturbedRun
from railjoule.dashboard.work.refusals import named_refusals

REACTIONS: tuple[Reaction, ...] = get_args(Reaction)
# closer together at first, where each second saves most
DELAYS_S = (0.0, 1.0, 2.0, 4.0, 7.0, 10.0, 15.0, 20.0, 30.0, 45.0, 60.0)


@dataclass(frozen=True)
class RidesRequest:
    """A scenario, and its events by the keys of the scenario's file."""

    scenario: Scenario
    changes: Mapping[str, Any]

    def disturbed(self) -> Scenario:
        """Return the scenario with its events; raises ScenarioError if a value is out of its bounds."""
        return self.scenario.with_(**self.changes)


@dataclass(frozen=True, eq=False)
class Rides:
    """One ride for each reaction.

    Parameters
    ----------
    rides : mapping
        By reaction.
    """

    rides: Mapping[Reaction, DisturbedRun]

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
        planned = plan_of(scenario)
        return Rides({reaction: disturbed_run_of(scenario, reaction, planned) for reaction in REACTIONS})


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
    planned = plan_of(scenario)
    delays = {reaction: np.full(len(DELAYS_S), np.nan) for reaction in REACTIONS}
    energies = {reaction: np.full(len(DELAYS_S), np.nan) for reaction in REACTIONS}
    late = LateArrivals(frozen_array(DELAYS_S), {}, {})
    for k, accepted in enumerate(DELAYS_S):
        relaxed = scenario.disturbance.model_copy(update={"accepted_delay_s": accepted})
        for reaction in REACTIONS:
            try:
                ride = disturbed_run_of(scenario.model_copy(update={"disturbance": relaxed}), reaction, planned)
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
