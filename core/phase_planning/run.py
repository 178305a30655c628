"""From a plan of phases to the nodes of a trajectory whose efforts are those of the phases, and whose time is kept.

In a cell the net force is constant, so a cell between two speeds has the length at which the effort at its mean speed
is that of the phase. Two of the speeds are moved until the sums of lengths and times are those of the plan.
"""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.errors import SolverError
from railjoule.core.phase_planning.plan import PhasePlan
from railjoule.core.phase_planning.search import MIN_BRAKED_SPEED2
from railjoule.core.phase_planning.tables import PhaseModel

# Speed from node to node: a cell has one effort, that of its mean speed. With 0.05 energies change by up to 5 ppm, with
# 0.2 by up to 16 ppm: the error falls as the square of the step
SPEED_STEP_MS = 0.1
# A cruise has one effort anyway: 5 or 40 cells change nothing. Charts and advice want to see it as more than one cell
CRUISE_CELLS = 20
# Nodes closer than this share of a step are one: a cell of no length has no force
SAME_NODE = 1e-3
# Newton's method starts close to its root and needs 3 to 4 steps; 6 give the same runs
MAX_STEPS = 12
# Distance and time are met this closely if rounding lets them, and to the second number in any case
TOLERANCE, WORST_TOLERANCE = 1e-11, 1e-9
# Step of difference quotients, over distance and speed: about the root of the rounding of time and distance
DIFFERENCE_STEP = 1e-6
# A cruise of less than this share of the distance may not be long enough to take up the differences: its length would
# become negative. From 1e-6 to 1e-2 the runs tried are the same
SHORTEST_CRUISE = 1e-4
# A braking speed that is less close to that of the cruise is one of its own, and may be moved
SAME_SPEED = 1e-6


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
    tables = {"start": "full_start", "coast": "coasting", "brake": "braking"}
    steps = np.arange(np.ceil(low / SPEED_STEP_MS), np.floor(high / SPEED_STEP_MS) + 1) * SPEED_STEP_MS
    inside = np.union1d(steps, getattr(model, tables[phase])[0])
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
    """Return a plan whose cells add up to its distance and time, by Newton's method on some of its numbers.

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

    def mismatch(values: FloatArray) -> FloatArray:
        speeds, lengths = _cells(model, with_values(values))
        time = np.sum(2 * lengths / (speeds[1:] + speeds[:-1]))
        difference: FloatArray = np.array([lengths.sum(), time])[: len(names)] - targets
        return difference

    values = np.array([getattr(plan, name) for name in names])
    for _ in range(MAX_STEPS):
        missing = mismatch(values)
        if (np.abs(missing) <= TOLERANCE * targets).all():
            return with_values(values)
        steps = DIFFERENCE_STEP * scales
        jacobian = np.column_stack([(mismatch(values + step) - missing) / step.sum() for step in np.diag(steps)])
        try:
            values = values - np.linalg.solve(jacobian, missing)
        except np.linalg.LinAlgError as error:
            raise SolverError("the phases cannot be moved to meet the distance and the time.") from error
    if (np.abs(missing) > WORST_TOLERANCE * targets).any():
        raise SolverError("the phases do not add up to the distance and the time.")
    return with_values(values)


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
