"""The jerk limit: a run that drives a plan with tractive and braking efforts that change at a limited rate.

With m the inertia, F the effort and u = F / m, the limit is |du/dt| <= j. At a stand u is what holds the train, so that
its acceleration begins and ends at zero. In a cell u is constant; the rate is taken between the middles of two cells.

The plan's speeds are never exceeded, so that all limits stay kept. Three steps give the run between two stops:

1. forward, u rises at the rate j at most: starts, and the ends of coasting or of a limit;
2. backward, the same for the brakes: stops, and the beginnings of lower limits;
3. falling u: with t the time, u + j t must rise over distance, so that w / 2 + the integral of (D / m + j t) over
   distance is convex, with w the speed squared and D the resistance of train and line. The largest such w below
   that of step 2 is its lower convex hull.

A start to the acceleration a reaches any higher speed later by a / (2 j), and so does a stop. The plan is therefore
made for less time, until the run takes the time of the timetable. A jerk limit only removes runs: lower bounds stay
valid.
"""

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np

from railjoule.core.arrays import FloatArray, midpoints
from railjoule.core.bounds import every_run_statement
from railjoule.core.errors import StrategyRefusedError, TimetableError
from railjoule.core.lower_bound import Bound
from railjoule.core.motion import MeshedLine, build_meshed_line
from railjoule.core.motion.mesh import SHORTEST_CELL_M
from railjoule.core.physics.mesh_data import electric_limit_n, tractive_limit_n
from railjoule.core.task import Task
from railjoule.core.trajectory import Trajectory, make_trajectory

STEPS_PER_RAMP, LONGEST_STEP_S = 16, 0.5
"""Cells take at most this share of the longest ramp of the effort, and this time [s]."""
ROUNDS = 3
"""Resistances and times of the steps are those of the round before, the plan's at first."""
EARLY_S, MAX_PLANS = 1e-3, 12
"""The run may be early by so many seconds, after at most so many plans."""
NOTICEABLE_S = 0.05
BISECTIONS = 60
SAME_SPEED2 = 1e-12
"""A square of speed this close to the plan's lies on it, as a share."""


def limit_jerk(task: Task, plan: Callable[[Task], Trajectory], run: Trajectory) -> Trajectory:
    """Return a run within the jerk limit of its vehicle that takes the time of a run without it.

    Parameters
    ----------
    task : Task
    plan : callable
        The strategy of the run.
    run : Trajectory
        Its run over the task, with its bound; returned as it is for a vehicle without a jerk limit.

    Raises
    ------
    StrategyRefusedError
        If the line has neutral sections or passing points, or two stops are too close to each other.
    TimetableError
        If no run within the jerk limit keeps the timetable.
    """
    jerk = task.scenario.vehicle.max_jerk_ms3
    if jerk is None:
        return run
    for key in ("neutral_sections", "passing_points"):
        if getattr(task.scenario.line, key):
            raise StrategyRefusedError(f"finds no run with vehicle.max_jerk_ms3 on a line with {key}.")
    limited = _limited(task, run, jerk)
    if run.strategy != "fastest":
        limited = _in_time(task, plan, run, limited, jerk)
    more_kwh = limited.energy_kwh - run.energy_kwh
    longer_s = limited.travel_time_s - run.travel_time_s
    later = f" and {longer_s:+.1f} s" if abs(longer_s) >= NOTICEABLE_S else " in the same time"
    note = (
        f"Efforts change at {jerk:g} m/s3 at most: {more_kwh:+.3f} kWh{later} against the run without this limit. "
        "Optimum and bound are those of a train without it, which no run within it undercuts."
    )
    kept = replace(limited, notes=(*run.notes, note), reference=run.reference, solve_time_s=run.solve_time_s)
    return kept.with_bound(None if run.bound is None else _every_run(task, run.bound))


def _every_run(task: Task, bound: Bound) -> Bound:
    """Return a bound that also covers runs over other nodes."""
    if bound.covers_every_run:
        return bound
    statement = every_run_statement(task, bound.every_run_j)
    return replace(bound, energy_j=bound.every_run_j, statement=statement, position_m=None, slowest_ms=0.0)


def _in_time(
    task: Task, plan: Callable[[Task], Trajectory], run: Trajectory, limited: Trajectory, jerk: float
) -> Trajectory:
    """Return the run within the jerk limit of a plan for less time that arrives with the run without it."""
    due, sparing = run.travel_time_s, 0.0
    for _ in range(MAX_PLANS):
        late = limited.travel_time_s - due
        if -EARLY_S <= late <= 0:
            break
        # towards the middle of what is allowed; the time that the limit costs hardly varies with the plan
        sparing += late + 0.5 * EARLY_S
        before = limited
        limited = _limited(task, _sooner(task, plan, sparing, jerk), jerk)
        if abs(limited.travel_time_s - before.travel_time_s) < 0.1 * EARLY_S:
            # a plan with given speeds takes the time that it takes
            break
    return limited


def _sooner(task: Task, plan: Callable[[Task], Trajectory], sparing_s: float, jerk: float) -> Trajectory:
    """Return the plan for less time."""
    try:
        return plan(replace(task, running_time_s=task.running_time_s - sparing_s))
    except TimetableError:
        fastest = make_trajectory(task.scenario, task.mesh, "fastest", task.fastest_speed2)
        shortest = _limited(task, fastest, jerk).travel_time_s
        raise TimetableError(task.travel_time_s, shortest, task.scenario.travel_time_key) from None


def _limited(task: Task, run: Trajectory, jerk: float) -> Trajectory:
    """Return the fastest run within the jerk limit that nowhere exceeds the speeds of another run."""
    standing, waits_s = np.diff(run.position_m) == 0, np.diff(run.time_s)
    stands_m, nodes, speed2 = run.position_m[:-1][standing], run.nodes_m, run.node_speed_ms**2
    inner = stands_m[(stands_m > nodes[0]) & (stands_m < nodes[-1])]
    stops = [0, *np.searchsorted(nodes, inner).tolist(), len(nodes) - 1]
    legs = [_leg_nodes(nodes[a : b + 1], speed2[a : b + 1], jerk) for a, b in pairwise(stops)]
    position = np.concatenate([legs[0], *(leg[1:] for leg in legs[1:])])
    mesh = build_meshed_line(task.scenario, *task.end_speeds_ms, position)
    borders = np.append(0, np.cumsum([len(leg) - 1 for leg in legs]))
    cap2 = np.interp(position, nodes, speed2)
    cap2[borders] = speed2[stops]
    found2 = cap2.copy()
    for first, last in pairwise(borders.tolist()):
        part = mesh.between(first, last)
        found2[first : last + 1] = _between_stops(part, cap2[first : last + 1], jerk)
    dwell = np.zeros(len(position))
    dwell[np.searchsorted(position, stands_m)] = waits_s[standing]
    return make_trajectory(
        task.scenario,
        replace(mesh, dwell_s=dwell),
        run.strategy,
        found2,
        price_of_time_w=run.price_of_time_w,
        iterations=run.iterations,
    )


def _leg_nodes(position_m: FloatArray, speed2: FloatArray, jerk: float) -> FloatArray:
    """Return nodes between two stops that resolve the ramps of the effort [m]."""
    length, speed = np.diff(position_m), np.sqrt(speed2)
    acceleration = 0.5 * np.diff(speed2) / length
    step = min(np.abs(acceleration).max() / jerk / STEPS_PER_RAMP, LONGEST_STEP_S)
    times = np.append(0.0, np.cumsum(2 * length / (speed[:-1] + speed[1:])))
    at = np.arange(step, times[-1], step)
    cell = np.clip(np.searchsorted(times, at) - 1, 0, len(length) - 1)
    since = at - times[cell]
    even = position_m[cell] + (speed[cell] + 0.5 * acceleration[cell] * since) * since
    # from a stand the train covers j t^3 / 6
    ramp = jerk / 6 * np.arange(step, np.abs(acceleration).max() / jerk, step) ** 3
    soft = np.concatenate(
        [
            position_m[0] + ramp if speed2[0] == 0 else [],
            position_m[-1] - ramp if speed2[-1] == 0 else [],
        ]
    )
    nodes = np.unique(np.concatenate([position_m, even, soft]))
    nodes = nodes[(nodes >= position_m[0]) & (nodes <= position_m[-1])]
    # borders of the line lie on nodes of the plan: those stay
    own = np.isin(nodes, position_m)
    gap = np.diff(nodes) > SHORTEST_CELL_M
    kept: FloatArray = nodes[own | (np.append(gap, True) & np.insert(gap, 0, True))]
    return kept


def _between_stops(mesh: MeshedLine, plan2: FloatArray, jerk: float) -> FloatArray:
    """Return squares of speed from one stop to the next, below those of a plan, within the jerk limit."""
    data, length = mesh.data, mesh.data.cell_length_m
    inertia, found2 = 2 * data.half_inertia_kg, plan2
    planned = mesh.net_force_n(plan2) / inertia
    for _ in range(ROUNDS):
        resisting = (data.line_force_n + mesh.running_resistance_n(found2)) / inertia
        mean_ms = midpoints(np.sqrt(found2))
        # no more than the plan itself uses, so that catching up with it adds no brakes that it spares
        pull = np.minimum(tractive_limit_n(data, mean_ms) / inertia, max(planned.max(), 0.0))
        brake = (electric_limit_n(data, mean_ms) + data.friction_effort_n) / inertia
        brake = np.minimum(brake, max(-planned.min(), 0.0))
        up = np.minimum(pull - resisting, data.max_acceleration_ms2)
        down = np.minimum(brake + resisting, data.max_deceleration_ms2)
        risen2 = _risen(plan2, length, resisting, up, jerk)
        risen2 = _risen(risen2[::-1], length[::-1], -resisting[::-1], down[::-1], jerk)[::-1]
        # both passes may jump through zero at one node; what is left of that is little
        risen2 = _risen(risen2, length, resisting, up, jerk, jumps=False)
        found2 = _hull(risen2, length, resisting, jerk)
        if np.any(found2[1:-1] <= 0):
            place = mesh.position_m[1 + int(np.argmin(found2[1:-1]))]
            raise StrategyRefusedError(
                f"finds no run with vehicle.max_jerk_ms3 = {jerk:g} at {place:.0f} m: it needs a larger jerk there."
            )
    return found2


def _risen(
    cap2: FloatArray, length: FloatArray, resisting: FloatArray, most: FloatArray, jerk: float, jumps: bool = True
) -> FloatArray:
    """Return the fastest run below a cap whose effort rises at a limited rate; squares of speed [m2/s2].

    With `jumps`, the effort on the cap may jump up to zero: the pass from the other end rounds that.
    """
    speed2, time_before, effort, on_cap = [float(cap2[0])], 0.0, float(resisting[0]), bool(cap2[0] > 0)
    free = on_cap
    for cap, h, d, a_max in zip(cap2[1:].tolist(), length.tolist(), resisting.tolist(), most.tolist(), strict=True):
        w = speed2[-1]
        v = w**0.5
        a = min((cap - w) / (2 * h), a_max)
        base = (max(effort, 0.0) if on_cap and jumps else effort) + 0.5 * jerk * time_before
        # a run that enters in motion may do so under any effort
        if not free and a + d > base:
            low, high = min(base - d, a), a
            for _ in range(BISECTIONS):
                middle = 0.5 * (low + high)
                reached = w + 2 * h * middle
                if reached <= 0 or middle + d <= base + jerk * h / (v + reached**0.5):
                    low = middle
                else:
                    high = middle
            a = low
        reached = max(w + 2 * h * a, 0.0)
        on_cap, free = reached >= cap * (1 - SAME_SPEED2), False
        reached = cap if on_cap else reached
        time_before = 2 * h / (v + reached**0.5) if v + reached > 0 else 0.0
        effort = (reached - w) / (2 * h) + d
        speed2.append(reached)
    return np.array(speed2)


def _hull(speed2: FloatArray, length: FloatArray, resisting: FloatArray, jerk: float) -> FloatArray:
    """Return the fastest run below another one whose effort falls at a limited rate; squares of speed [m2/s2]."""
    speed = np.sqrt(speed2)
    duration = 2 * length / np.maximum(speed[:-1] + speed[1:], 1e-9)
    middle_s = np.cumsum(duration) - 0.5 * duration
    added = np.append(0.0, np.cumsum((resisting + jerk * middle_s) * length))
    place, value = np.append(0.0, np.cumsum(length)).tolist(), (0.5 * speed2 + added).tolist()
    hull = [0]
    for node in range(1, len(place)):
        while len(hull) > 1:
            a, b = hull[-2:]
            if (value[b] - value[a]) * (place[node] - place[b]) <= (value[node] - value[b]) * (place[b] - place[a]):
                break
            hull.pop()
        hull.append(node)
    lowest = np.interp(place, np.array(place)[hull], np.array(value)[hull])
    found2: FloatArray = 2 * (lowest - added)
    found2[hull] = speed2[hull]
    return found2
