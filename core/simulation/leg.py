"""A part of a run as places and speeds, which can be cut, joined to others, and made a trajectory."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.energy import share_above, total_energy
from railjoule.core.motion import build_meshed_line
from railjoule.core.scenario import Scenario
from railjoule.core.trajectory import Trajectory, make_trajectory

# Nodes closer than this are one: positions of events and stations come through several sums, and a cell so short would
# be all rounding.
SAME_PLACE_M = 1e-6
CELL_FIELDS = (
    "tractive_effort_n",
    "electric_braking_n",
    "friction_braking_n",
    "max_effort_n",
    "max_braking_n",
    "supply_power_w",
    "current_a",
    "supply_current_a",
    "gradient_permille",
)
"""Fields of a trajectory with one value a cell."""


@dataclass(frozen=True, eq=False)
class DrivenPlan:
    """A plan and the run of a train that followed it.

    Parameters
    ----------
    planned, actual : Trajectory
        The run as planned, and as driven.
    """

    planned: Trajectory
    actual: Trajectory

    @property
    def stop_error_m(self) -> float:
        """How far beyond the end of its plan the train came to stand [m]."""
        return float(self.actual.position_m[-1] - self.planned.position_m[-1])

    @property
    def overconsumption(self) -> float:
        """Share by which the energy lies above that of the plan; NaN where that is no measure."""
        return share_above(self.actual.energy.net_j, self.planned.energy.net_j)


@dataclass(frozen=True, eq=False)
class Leg:
    """A part of a run, driven by one vehicle.

    Parameters
    ----------
    scenario : Scenario
        The vehicle, and the line with what is known of it.
    position_m, speed2 : array of shape (n + 1,)
        Nodes [m] and squares of speed there [m2/s2].
    dwell_s : array of shape (n + 1,)
        How long the train stands at each node [s].
    """

    scenario: Scenario
    position_m: FloatArray
    speed2: FloatArray
    dwell_s: FloatArray

    @property
    def arrival_s(self) -> FloatArray:
        """Time of arrival at each node from the leg's start [s]; shape (n + 1,)."""
        speed = np.sqrt(self.speed2)
        duration = 2 * np.diff(self.position_m) / (speed[1:] + speed[:-1])
        arrival: FloatArray = np.append(0.0, np.cumsum(duration + self.dwell_s[:-1]))
        return arrival

    @property
    def duration_s(self) -> float:
        """Time of the whole leg, dwells included [s]."""
        return float(self.arrival_s[-1] + self.dwell_s[-1])

    def place_at(self, time_s: float) -> float:
        """Return the position of the train at a time from the leg's start [m]."""
        arrival = self.arrival_s
        node = int(np.searchsorted(arrival, time_s, side="right")) - 1
        if node >= len(arrival) - 1:
            return float(self.position_m[-1])
        # arrival is before the dwell, so a time within it gives a negative remainder
        since = time_s - arrival[node] - self.dwell_s[node]
        if since <= 0:
            return float(self.position_m[node])
        length = self.position_m[node + 1] - self.position_m[node]
        before, after = np.sqrt(self.speed2[node]), np.sqrt(self.speed2[node + 1])
        # constant force within a cell: the course of v^2 is linear, that of position a parabola in time
        acceleration = (after**2 - before**2) / (2 * length)
        return float(
            min(self.position_m[node] + (before + 0.5 * acceleration * since) * since, self.position_m[node + 1])
        )

    def until(self, place_m: float) -> "Leg":
        """Return the part up to a place [m], its dwell there included."""
        count = int(np.searchsorted(self.position_m, place_m + SAME_PLACE_M, side="right"))
        nodes = Leg(self.scenario, self.position_m[:count], self.speed2[:count], self.dwell_s[:count])
        if place_m - nodes.position_m[-1] <= SAME_PLACE_M:
            return nodes
        speed2 = np.interp(place_m, self.position_m, self.speed2)
        return Leg(
            self.scenario,
            np.append(nodes.position_m, place_m),
            np.append(nodes.speed2, speed2),
            np.append(nodes.dwell_s, 0.0),
        )

    def beyond(self, place_m: float) -> "Leg":
        """Return the part from a place [m] on, without the dwell there."""
        beyond = self.position_m > place_m + SAME_PLACE_M
        return replace(
            self,
            position_m=np.append(place_m, self.position_m[beyond]),
            speed2=np.append(np.interp(place_m, self.position_m, self.speed2), self.speed2[beyond]),
            dwell_s=np.append(0.0, self.dwell_s[beyond]),
        )

    def then(self, other: "Leg") -> "Leg":
        """Return this leg and one of the same vehicle that begins where this one ends."""
        # a dwell at the joint may be known to either leg
        return Leg(
            other.scenario,
            np.append(self.position_m, other.position_m[1:]),
            np.append(self.speed2, other.speed2[1:]),
            np.concatenate([self.dwell_s[:-1], [self.dwell_s[-1] + other.dwell_s[0]], other.dwell_s[1:]]),
        )

    def effort_at(self, place_m: float) -> float:
        """Return the effort at the wheels just before a place [N]; braking is negative."""
        cell = int(np.clip(np.searchsorted(self.position_m, place_m, side="left") - 1, 0, len(self.position_m) - 2))
        nodes = slice(cell, cell + 2)
        mesh = build_meshed_line(self.scenario, position_m=self.position_m[nodes])
        return float(mesh.net_force_n(self.speed2[nodes])[0])

    def trajectory(self, strategy: str) -> Trajectory:
        """Return the trajectory of this leg."""
        mesh = build_meshed_line(self.scenario, position_m=self.position_m)
        mesh = replace(mesh, dwell_s=self.dwell_s)
        return make_trajectory(self.scenario, mesh, strategy, self.speed2)


def make_leg(run: Trajectory) -> Leg:
    """Return the leg of a trajectory."""
    # a trajectory has a dwell as a cell without length, a leg as a time at its node
    standing = np.diff(run.position_m) == 0
    kept = np.append(True, ~standing)
    dwell = np.zeros(len(run.position_m))
    dwell[:-1][standing] = np.diff(run.time_s)[standing]
    return Leg(run.scenario, run.position_m[kept], run.speed_ms[kept] ** 2, dwell[kept])


def append_leg(legs: Sequence[Leg], leg: Leg) -> tuple[Leg, ...]:
    """Return legs and one more; one without length adds its dwell to the last."""
    if len(leg.position_m) > 1:
        return (*legs, leg)
    if not legs or leg.dwell_s[-1] <= 0:
        return tuple(legs)
    last = legs[-1]
    longer = replace(last, dwell_s=np.append(last.dwell_s[:-1], last.dwell_s[-1] + leg.dwell_s[-1]))
    return (*legs[:-1], longer)


def join_legs(legs: Sequence[Leg], scenario: Scenario, strategy: str) -> Trajectory:
    """Return one trajectory of legs that follow one another, whose vehicles may differ."""
    runs = [leg.trajectory(strategy) for leg in legs]
    joined: dict[str, Any] = {}
    for name in CELL_FIELDS:
        parts = [getattr(run, name) for run in runs]
        # a drive without a current on one side leaves none for the whole: half a curve would look like zero
        joined[name] = None if any(part is None for part in parts) else frozen_array(np.concatenate(parts))
    for name in ("position_m", "speed_ms", "time_s", "supply_energy_j"):
        parts = [getattr(run, name) for run in runs]
        # time and energy of each leg begin at zero
        before = np.cumsum([0.0, *(part[-1] for part in parts)]) if name in ("time_s", "supply_energy_j") else None
        rest = [part[1:] if before is None else before[k] + part[1:] for k, part in enumerate(parts)]
        joined[name] = frozen_array(np.concatenate([parts[0][:1], *rest]))
    return replace(runs[0], scenario=scenario, energy=total_energy([run.energy for run in runs]), **joined)
