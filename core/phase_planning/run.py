"""From a plan of phases to the nodes of a trajectory whose efforts are those of the phases, and whose time is kept.

In a cell the net force is constant, so a cell between two speeds has the length at which the effort at its mean speed
is that of the phase. What these lengths and times differ from the tables is taken out by moving two of the speeds.
"""

from dataclasses import dataclass, replace

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.errors import SolverError
from railjoule.core.phase_planning.plan import PhasePlan
from railjoule.core.phase_planning.tables import PhaseModel

SPEED_STEP_MS = 0.1
CRUISE_CELLS = 20
MOST_STEPS = 12
EXACT = 1e-11
SHORTEST_CRUISE = 1e-4
"""A cruise of less than this share of the way may not be long enough to take up the differences."""


@dataclass(frozen=True, eq=False)
class PhaseRun:
    """The nodes of a planned run, from its start at 0.

    Parameters
    ----------
    position_m, speed_ms : array of shape (n + 1,)
        Nodes [m] and speeds there [m/s].
    """

    position_m: FloatArray
    speed_ms: FloatArray


def lay_out(model: PhaseModel, plan: PhasePlan) -> PhaseRun:
    """Return the nodes of a plan; distance and time are met to 1e-9.

    Raises
    ------
    SolverError
        If they cannot be met.
    """
    exact = _adjusted(model, plan)
    speeds, lengths = _cells(model, exact)
    position = np.append(0.0, np.cumsum(lengths))
    position *= plan.distance_m / position[-1]
    position[-1] = plan.distance_m
    return PhaseRun(position, speeds)


def _cells(model: PhaseModel, plan: PhasePlan) -> tuple[FloatArray, FloatArray]:
    """Return the speeds at the nodes and the lengths of the cells of a plan."""
    peak, bottom = plan.cruise_speed_ms, plan.bottom_speed_ms
    legs = [(plan.first, plan.initial_speed_ms, peak)]
    for _ in range(plan.cycles - 1):
        legs += [("coast", peak, bottom), ("start", bottom, peak)]
    speeds, lengths = [np.array([plan.initial_speed_ms])], []

    def drive(phase: str, before: float, after: float) -> None:
        if before != after:
            nodes = _speeds_between(model, plan, phase, before, after)
            speeds.append(nodes[1:])
            lengths.append(_lengths(model, plan, phase, nodes))

    for leg in legs:
        drive(*leg)
    if plan.cruise_m > 0:
        speeds.append(np.full(CRUISE_CELLS, peak))
        lengths.append(np.full(CRUISE_CELLS, plan.cruise_m / CRUISE_CELLS))
    drive("coast", peak, plan.brake_speed_ms)
    drive("brake", plan.brake_speed_ms, plan.final_speed_ms)
    return np.concatenate(speeds), np.concatenate(lengths)


def _speeds_between(model: PhaseModel, plan: PhasePlan, phase: str, before: float, after: float) -> FloatArray:
    """Return speeds from one to another: equal steps, and the knots where the effort has a corner."""
    low, high = min(before, after), max(before, after)
    knots = model.coasting[0] if phase == "coast" else model.braking[0] if phase == "brake" else model.full_start[0]
    steps = np.arange(np.ceil(low / SPEED_STEP_MS), np.floor(high / SPEED_STEP_MS) + 1) * SPEED_STEP_MS
    inside = np.unique(np.concatenate([steps, knots]))
    inside = inside[(inside > low) & (inside < high)]
    # a node right at an end would make a cell without length
    inside = inside[(inside - low > 1e-3 * SPEED_STEP_MS) & (high - inside > 1e-3 * SPEED_STEP_MS)]
    inside = inside[np.append(True, np.diff(inside) > 1e-3 * SPEED_STEP_MS)] if len(inside) else inside
    nodes = np.concatenate([[low], inside, [high]])
    return nodes if before < after else nodes[::-1]


def _lengths(model: PhaseModel, plan: PhasePlan, phase: str, speeds: FloatArray) -> FloatArray:
    """Return the lengths of cells [m] in which the effort at the mean speed is that of a phase."""
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
    names = _adjustable(plan)
    scales = np.array([plan.distance_m if name == "cruise_m" else plan.cruise_speed_ms for name in names])
    aims = np.array([plan.distance_m, plan.running_time_s])[: len(names)]
    share = plan.bottom_speed_ms / plan.cruise_speed_ms

    def with_values(values: FloatArray) -> PhasePlan:
        changed = replace(plan, **dict(zip(names, values.tolist(), strict=True)))
        changed = replace(changed, bottom_speed_ms=share * changed.cruise_speed_ms)
        if plan.brake_speed_ms == plan.cruise_speed_ms:
            changed = replace(changed, brake_speed_ms=changed.cruise_speed_ms)
        return changed

    def misses(values: FloatArray) -> FloatArray:
        speeds, lengths = _cells(model, with_values(values))
        time = np.sum(2 * lengths / (speeds[1:] + speeds[:-1]))
        miss: FloatArray = np.array([lengths.sum(), time])[: len(names)] - aims
        return miss

    values = np.array([getattr(plan, name) for name in names])
    for _ in range(MOST_STEPS):
        miss = misses(values)
        if (np.abs(miss) <= EXACT * aims).all():
            return with_values(values)
        steps = 1e-6 * scales
        slopes = np.column_stack([(misses(values + step) - miss) / step.sum() for step in np.diag(steps)])
        try:
            values = values - np.linalg.solve(slopes, miss)
        except np.linalg.LinAlgError as error:
            raise SolverError("the phases cannot be moved to meet the distance and the time.") from error
    if (np.abs(miss) > 1e-9 * aims).any():
        raise SolverError("the phases do not add up to the distance and the time.")
    return with_values(values)


def _adjustable(plan: PhasePlan) -> tuple[str, ...]:
    """Return which numbers of a plan may move: those that the search left inside their bounds."""
    cruises = plan.cruise_m > SHORTEST_CRUISE * plan.distance_m
    coasts = plan.brake_speed_ms < plan.cruise_speed_ms * (1 - 1e-6)
    if plan.fastest:
        return ("cruise_m",) if cruises else ("cruise_speed_ms",)
    if cruises and coasts:
        return ("cruise_m", "brake_speed_ms")
    return ("cruise_speed_ms", "cruise_m") if cruises else ("cruise_speed_ms", "brake_speed_ms")
