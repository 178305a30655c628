"""A plan of phases, the best of several, and the nodes of a trajectory whose efforts are those of a plan's phases.

In a cell the net force is constant, so a cell between two speeds has the length at which the effort at its mean speed
is that of the phase. Two of the speeds are moved until the sums of lengths and times are those of the plan.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, TypeVar

import numpy as np
import scipy

from railjoule.core.arrays import FloatArray
from railjoule.core.errors import SolverError
from railjoule.core.phase_planning.search import MIN_BRAKED_SPEED2
from railjoule.core.phase_planning.tables import PhaseModel

FirstPhase = Literal["start", "coast", "brake"]
FIRST_PHASES: tuple[FirstPhase, ...] = ("start", "coast", "brake")
# Speed from node to node: a cell has one effort, that of its mean speed. With 0.05 energies change by up to 5 ppm, with
# 0.2 by up to 16 ppm: the error falls as the square of the step
SPEED_STEP_MS = 0.1
# A cruise has one effort anyway: 5 or 40 cells change nothing. Charts and advice want to see it as more than one cell
CRUISE_CELLS = 20
# Nodes closer than this share of a step are one: a cell of no length has no force
SAME_NODE = 1e-3
# Distance and time are met this closely in any case; the search asks for the first number
TOLERANCE, WORST_TOLERANCE = 1e-13, 1e-9
# A cruise of less than this share of the distance may not be long enough to take up the differences: its length would
# become negative. From 1e-6 to 1e-2 the runs tried are the same
SHORTEST_CRUISE = 1e-4
# A braking speed that is less close to that of the cruise is one of its own, and may be moved
SAME_SPEED = 1e-6
Plan = TypeVar("Plan", bound=Any)
"""It has an `energy_j`, infinite where there is no run."""
# Parabolas after a scan of plans; their accuracy ends them earlier: 6 or 24 give the same plans
MAX_STEPS = 12
# A parabola whose sides differ by more than this factor always halves the longer one, as below. 2, 8 or no bound at all
# change 8 ppm of a run's energy at most
MAX_UNEVEN = 4.0
# The marginal energy diverges at the shortest time: this share of the slack stands for none.
MIN_SLACK = 1e-9


@dataclass(frozen=True)
class PhasePlan:
    """One run from stop to stop, or from the place of a train: its phases and the speeds between them.

    Parameters
    ----------
    distance_m, running_time_s : float
        Distance [m] and time [s] of the run.
    initial_speed_ms, final_speed_ms : float
        Speeds at its ends [m/s].
    first : str
        Phase from the initial speed to that of the cruise: start, coast or brake.
    cruise_speed_ms, cruise_m : float
        Speed [m/s] and length [m] of the cruise, which may be zero.
    brake_speed_ms : float
        Speed at which braking begins [m/s]; that of the cruise where it does not coast.
    cycles : int
        Number of starts; between two starts it coasts.
    restart_speed_ms : float
        Speed at which it starts again [m/s].
    starting_current_a : float or None
        Current of its starts [A]; the largest one where None.
    energy_j : float
        Line energy without auxiliaries [J].
    fastest : bool
        Whether it is the fastest run, which leaves no choice.
    """

    distance_m: float
    running_time_s: float
    initial_speed_ms: float
    final_speed_ms: float
    first: FirstPhase
    cruise_speed_ms: float
    cruise_m: float
    brake_speed_ms: float
    cycles: int
    restart_speed_ms: float
    starting_current_a: float | None
    energy_j: float
    fastest: bool = False

    @property
    def legs(self) -> list[tuple[str, float, float]]:
        """Phases in order, with the speeds at their ends [m/s]; they may have no length."""
        cruise = self.cruise_speed_ms
        cycle = [("coast", cruise, self.restart_speed_ms), ("start", self.restart_speed_ms, cruise)]
        return [
            (self.first, self.initial_speed_ms, cruise),
            *cycle * (self.cycles - 1),
            ("cruise", cruise, cruise),
            ("coast", cruise, self.brake_speed_ms),
            ("brake", self.brake_speed_ms, self.final_speed_ms),
        ]


@dataclass(frozen=True)
class PlannedPhase:
    """One phase of a plan: its name, distance [m], time [s], speeds at its ends [m/s] and line energy [J]."""

    phase: str
    distance_m: float
    duration_s: float
    start_ms: float
    end_ms: float
    energy_j: float


def best_plan(plan_at: Callable[[float], Plan], low: float, high: float, count: int, accuracy: float) -> Plan:
    """Return the best plan over one number: a scan, then parabolas through the three best points.

    Parameters
    ----------
    plan_at : callable
        The plan at a number; its energy is infinite where there is none.
    low, high : float
        Range of the number.
    count : int
        Points of the scan, at least 2.
    accuracy : float
        Share of the range within which the number is found.
    """
    points = {float(x): plan_at(float(x)) for x in np.linspace(low, high, count)}
    for _ in range(MAX_STEPS):
        best = min(points, key=lambda x: points[x].energy_j)
        left = max((x for x in points if x < best), default=None)
        right = min((x for x in points if x > best), default=None)
        # no parabola at an end of the range, or beside a number without a plan: halve towards the known plans
        if left is None or right is None or not np.isfinite(points[best].energy_j):
            sides = [x for x in (left, right) if x is not None]
            middle = 0.5 * (best + sides[0])
        elif not np.isfinite(points[left].energy_j + points[right].energy_j):
            middle = 0.5 * (best + (left if np.isfinite(points[right].energy_j) else right))
        else:
            middle = _vertex(*((x, points[x].energy_j) for x in (left, best, right)))
        if min(abs(middle - x) for x in points) < accuracy * (high - low):
            break
        points[middle] = plan_at(middle)
    return points[min(points, key=lambda x: points[x].energy_j)]


def _vertex(left: tuple[float, float], best: tuple[float, float], right: tuple[float, float]) -> float:
    """Compute the minimum of the parabola through three points, or halve its longer side if that is much longer."""
    (a, fa), (b, fb), (c, fc) = left, best, right
    # successive parabolic interpolation: the zero of the derivative of Lagrange's polynomial
    p, q = (b - a) * (fb - fc), (b - c) * (fb - fa)
    x = b - 0.5 * ((b - a) * p - (b - c) * q) / (p - q) if p != q else 0.5 * (a + c)
    longer = a if b - a > c - b else c
    # on repeated steps to the same side, the other point stays far away and no longer represents the curvature
    return x if max(b - a, c - b) < MAX_UNEVEN * min(b - a, c - b) else 0.5 * (b + longer)


def equally_priced(
    prices: Sequence[Callable[[float], float]], shortest_s: Sequence[float], slack_s: float
) -> list[float]:
    """Return the times of parts with equal marginal energy per second that use all of the running time supplement.

    Parameters
    ----------
    prices : sequence of callable
        Marginal energy of each part [J/s] over its time beyond the shortest one [s]; falling.
    shortest_s : sequence of float
        Shortest time of each part [s].
    slack_s : float
        Time of all parts beyond the sum of these [s].
    """
    least, most = MIN_SLACK * slack_s, slack_s

    # At a price each part takes the time of that marginal energy; the lower the price, the more time all parts take. So
    # one price uses the slack: two nested root searches of monotone functions.
    def extra_at(price: float) -> FloatArray:
        def extra_time(price_of: Callable[[float], float]) -> float:
            if price_of(most) >= price:
                return most
            if price_of(least) <= price:
                return least
            root: float = scipy.optimize.brentq(lambda more: price_of(more) - price, least, most, xtol=least)
            return root

        return np.array([extra_time(price_of) for price_of in prices])

    low, high = min(price_of(most) for price_of in prices), max(price_of(least) for price_of in prices)
    price = scipy.optimize.brentq(lambda price: extra_at(price).sum() - slack_s, low, high, xtol=1e-9 * high)
    extra = extra_at(price)
    extra *= slack_s / extra.sum()
    return [time + more for time, more in zip(shortest_s, extra.tolist(), strict=True)]


def lay_out(model: PhaseModel, plan: PhasePlan) -> tuple[FloatArray, FloatArray]:
    """Return the nodes of a plan from its start at 0 [m] and the speeds there [m/s], shape (n + 1,).

    Distance and time are met to 1e-9.

    Raises
    ------
    SolverError
        If they cannot be met.
    """
    speeds, lengths = _cells(model, _adjusted(model, plan))
    # the rest of the tolerance is distributed over all cells, so that the last node lies exactly at the stop
    position = np.append(0.0, np.cumsum(lengths))
    position *= plan.distance_m / position[-1]
    position[-1] = plan.distance_m
    return position, speeds


def _cells(model: PhaseModel, plan: PhasePlan) -> tuple[FloatArray, FloatArray]:
    """Return the speeds at the nodes and the lengths of the cells of a plan."""
    speeds, lengths = [np.array([plan.initial_speed_ms])], []
    for phase, before, after in plan.legs:
        if phase == "cruise" and plan.cruise_m > 0:
            speeds.append(np.full(CRUISE_CELLS, before))
            lengths.append(np.full(CRUISE_CELLS, plan.cruise_m / CRUISE_CELLS))
        elif before != after:
            nodes = _speeds_between(model, phase, before, after)
            speeds.append(nodes[1:])
            lengths.append(_lengths(model, plan, phase, nodes))
    return np.concatenate(speeds), np.concatenate(lengths)


def _speeds_between(model: PhaseModel, phase: str, before: float, after: float) -> FloatArray:
    """Return speeds from one to another: equal steps, and the knots where the effort has a corner."""
    low, high = min(before, after), max(before, after)
    steps = np.arange(np.ceil(low / SPEED_STEP_MS), np.floor(high / SPEED_STEP_MS) + 1) * SPEED_STEP_MS
    inside = np.union1d(steps, model.table(phase)[0])
    # a node right at an end would make a cell without length
    inside = inside[(inside - low > SAME_NODE * SPEED_STEP_MS) & (high - inside > SAME_NODE * SPEED_STEP_MS)]
    inside = inside[np.append(True, np.diff(inside) > SAME_NODE * SPEED_STEP_MS)] if len(inside) else inside
    nodes = np.concatenate([[low], inside, [high]])
    return nodes if before < after else nodes[::-1]


def _lengths(model: PhaseModel, plan: PhasePlan, phase: str, speeds: FloatArray) -> FloatArray:
    """Return the lengths of cells [m] in which the effort at the mean speed is that of a phase.

    Work is the change of kinetic energy: F s = m (v1^2 - v0^2) / 2, hence s. Resistance counts with the mean of the
    squares of speed over the distance, as everywhere in a cell with constant force.
    """
    mean = 0.5 * (speeds[1:] + speeds[:-1])
    squares = speeds * speeds
    resistance = model.resistance_n(mean, 0.5 * (squares[1:] + squares[:-1]))
    if phase == "start":
        force = model.starting_effort_n(mean, plan.starting_current_a) - resistance
    elif phase == "brake":
        force = -model.braking_effort_n(mean) - resistance
    else:
        force = -resistance
    lengths: FloatArray = 0.5 * model.inertia_kg * np.diff(squares) / force
    return lengths


def _adjusted(model: PhaseModel, plan: PhasePlan) -> PhasePlan:
    """Return a plan whose cells add up to its distance and time."""
    for names in _adjustable(plan):
        try:
            moved = _moved(model, plan, names)
        except SolverError:
            continue
        if _is_driven_in_order(model, moved):
            return moved
    raise SolverError("no run with these phases meets the distance and the time exactly.")


def _is_driven_in_order(model: PhaseModel, plan: PhasePlan) -> bool:
    """Return whether a plan's train never turns round, and brakes last from a speed from which the search lets it."""
    lengths = _cells(model, plan)[1]
    least2 = plan.final_speed_ms**2 + MIN_BRAKED_SPEED2
    slows = plan.brake_speed_ms >= min(math.sqrt(least2) * (1 - SAME_SPEED), plan.cruise_speed_ms)
    return slows and plan.brake_speed_ms <= plan.cruise_speed_ms and plan.cruise_m >= 0 and bool((lengths > 0).all())


def _moved(model: PhaseModel, plan: PhasePlan, names: tuple[str, ...]) -> PhasePlan:
    """Return a plan whose cells add up to its distance and time, by a root search over some of its numbers.

    Raises
    ------
    SolverError
        If they cannot.
    """
    scales = np.array([plan.distance_m if name == "cruise_m" else plan.cruise_speed_ms for name in names])
    # a fastest run has no time to keep: its time is what comes out
    targets = np.array([plan.distance_m, plan.running_time_s])[: len(names)]
    restart_fraction = plan.restart_speed_ms / plan.cruise_speed_ms

    def with_values(values: FloatArray) -> PhasePlan:
        changed = replace(plan, **dict(zip(names, values.tolist(), strict=True)))
        changed = replace(changed, restart_speed_ms=restart_fraction * changed.cruise_speed_ms)
        if plan.brake_speed_ms == plan.cruise_speed_ms:
            changed = replace(changed, brake_speed_ms=changed.cruise_speed_ms)
        return changed

    def mismatch(shares: FloatArray) -> FloatArray:
        speeds, lengths = _cells(model, with_values(shares * scales))
        time = np.sum(2 * lengths / (speeds[1:] + speeds[:-1]))
        difference: FloatArray = np.array([lengths.sum(), time])[: len(names)] / targets - 1
        return difference

    found = scipy.optimize.root(mismatch, np.array([getattr(plan, name) for name in names]) / scales, tol=TOLERANCE)
    if not np.abs(found.fun).max() <= WORST_TOLERANCE:
        raise SolverError("the phases do not add up to the distance and the time.")
    return with_values(found.x * scales)


def _adjustable(plan: PhasePlan) -> Iterator[tuple[str, ...]]:
    """Yield which numbers of a plan may move: first those that the search left inside their bounds."""
    cruises = plan.cruise_m > SHORTEST_CRUISE * plan.distance_m
    coasts = plan.brake_speed_ms < plan.cruise_speed_ms * (1 - SAME_SPEED)
    if plan.fastest:
        yield ("cruise_m",) if cruises else ("cruise_speed_ms",)
        return
    if coasts:
        yield ("cruise_m" if cruises else "cruise_speed_ms", "brake_speed_ms")
    # a train that coasts almost to rest has no lower speed to brake from
    yield ("cruise_speed_ms", "cruise_m") if cruises or coasts else ("cruise_speed_ms", "brake_speed_ms")
