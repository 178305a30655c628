"""The run of the literal regulator, as one that the train can drive, or a refusal with its reason.

Between its steps of time the regulator sees the forces of the line in the mean over the cells of the mesh. Over the
steps themselves they differ a little, and so do efforts: the run follows the speeds of the regulator as closely as the
limits of efforts and accelerations allow, and where it asks for nothing, the train coasts.
"""

from dataclasses import replace

import numpy as np

from railjoule.core.arrays import BoolArray, FloatArray, frozen_array
from railjoule.core.budget import current_budget, rounded_up
from railjoule.core.errors import StrategyRefusedError
from railjoule.core.limit_search.literal import (
    ARRIVED,
    GOES_ON,
    STANDS,
    Relay,
    literal_regulation,
    literal_trip,
)
from railjoule.core.limit_search.problem import SetSpeedRun
from railjoule.core.motion import MeshedLine, build_meshed_line
from railjoule.core.motion.driving import drive
from railjoule.core.strategies.plain_line import check_accelerations, require_line_without
from railjoule.core.task import Task
from railjoule.core.trajectory import make_trajectory
from railjoule.core.units import MS_PER_KMH

# limits may be given for any time
LONGEST_SHARE = 3.0
"""A trip may take so many times as long as planned."""
# over less, rounding of places and speeds would be all of the force
SHORTEST_STEP_M = 1e-5
"""Steps of time that move by less are joined."""
PASSED_SHARE = 1e-6
"""A limit of speed counts as passed where it is exceeded by more than this share, as in the check of a run."""


def literal_run(task: Task, limits_ms: FloatArray, boundaries_m: FloatArray) -> SetSpeedRun:
    """Return the run of the literal regulator.

    Parameters
    ----------
    task : Task
        Train and line.
    limits_ms : array of shape (k,)
        Of the sections [m/s].
    boundaries_m : array of shape (k - 1,)
        Between them [m].

    Raises
    ------
    StrategyRefusedError
        If the line has stops or neutral sections on its way or the train a braking curve, the regulator takes too many
        steps, or drives no run that the train can.
    """
    options = task.scenario.search
    require_literal(task)
    relay = Relay(
        options.dead_zone_kmh * MS_PER_KMH,
        options.regulation_speed_kmh * MS_PER_KMH,
        options.full_effort_time_s,
        options.effort_rate_share,
        options.time_step_s,
    )
    regulation, curve = literal_regulation(task.mesh, options.stop_deceleration_ms2, relay.dead_zone_ms)
    max_steps = int(LONGEST_SHARE * task.running_time_s / options.time_step_s) + 1
    position, speed2, effort, standing, switches, status = literal_trip(
        task.mesh.data, regulation, curve, boundaries_m, limits_ms, relay, max_steps
    )
    if status != ARRIVED:
        raise StrategyRefusedError(_failure(task, status, position[-1], speed2[-1]))
    places, wanted2, coasts = _joined(position, speed2, effort)
    mesh = build_meshed_line(task.scenario, float(np.sqrt(speed2[0])), 0.0, position_m=places)
    # not into a stand, nor past the speed that is prescribed at the end
    coasts[0] &= wanted2[0] > 0.0
    coasts[-1] = False
    driven2, stand = drive(mesh.data, wanted2, float(wanted2[0]), coasts=coasts)
    if stand >= 0 or driven2[-1] < 0.0:
        raise StrategyRefusedError(_failure(task, STANDS, float(mesh.position_m[stand - 1]), 0.0))
    if driven2[-1] > 0.0:
        raise StrategyRefusedError(_overshoot(task, float(mesh.position_m[-1]), float(driven2[-1])))
    _require_limits(task, mesh, driven2)
    check_accelerations(mesh, driven2)
    # the time in which effort grows at the start has no distance: the run has it as a dwell
    dwell = frozen_array(np.where(np.arange(len(mesh.position_m)) == 0, standing, 0.0))
    return SetSpeedRun(replace(mesh, dwell_s=dwell), driven2, limits_ms, boundaries_m, switches)


def require_literal(task: Task) -> None:
    """Refuse a task that the literal regulator cannot drive at all; errors as `literal_run`."""
    require_line_without(task, "neutral_sections", "traction_limits", "rail_conditions")
    if (task.mesh.data.fixed_speed2[1:-1] == 0.0).any():
        raise StrategyRefusedError(
            "needs a line without stops between its ends for the literal regulator, or a search for each inter-station "
            "run (search.inter_station_runs = 'separate')."
        )
    if np.isfinite(task.mesh.permitted_deceleration_ms2):
        # it reacts in steps of time, and would pass the curve by what it drives in one
        raise StrategyRefusedError(
            "needs a train without a permitted deceleration (vehicle.braking.permitted_deceleration) for the literal "
            "regulator."
        )
    most, step_s = current_budget().cell_count, task.scenario.search.time_step_s
    if task.running_time_s > most * step_s:
        raise StrategyRefusedError(
            f"takes at most {most:,} steps of the literal regulator, and search.time_step_s = {step_s:g} makes "
            f"{task.running_time_s / step_s:,.0f}. Use {rounded_up(task.running_time_s / most):g} s or more."
        )


def literal_cost(task: Task, limits_ms: FloatArray, boundaries_m: FloatArray) -> tuple[float, float]:
    """Return time [s] and net energy at the line [J] of the literal regulator's run, infinite where it drives none.

    Arguments as for `literal_run`.
    """
    try:
        run = literal_run(task, limits_ms, boundaries_m)
    except StrategyRefusedError:
        return np.inf, np.inf
    made = make_trajectory(task.scenario, run.mesh, "speed_limits", run.speed2)
    return made.travel_time_s, made.energy.net_j


def _joined(
    position_m: FloatArray, speed2: FloatArray, effort_n: FloatArray
) -> tuple[FloatArray, FloatArray, BoolArray]:
    """Return places and squares of speed without steps that hardly move, and in which cells there is no effort."""
    kept = np.append(True, np.diff(position_m) > SHORTEST_STEP_M)
    # the end stays where it is, and its neighbour gives way
    kept[-1] = True
    if position_m[-1] - position_m[kept][-2] <= SHORTEST_STEP_M and kept.sum() > 2:
        kept[np.flatnonzero(kept)[-2]] = False
    nodes = np.flatnonzero(kept)
    # effort k + 1 leads from place k to the next one; a joined cell coasts if all its steps do
    coasts = np.logical_and.reduceat(effort_n[1:] == 0.0, nodes[:-1])
    return position_m[nodes], speed2[nodes], coasts


def _with_step(task: Task) -> str:
    return f"with the literal regulator and search.time_step_s = {task.scenario.search.time_step_s:g}"


def _failure(task: Task, status: int, place_m: float, speed2: float) -> str:
    """Return why a trip did not arrive."""
    if status == GOES_ON:
        return f"does not arrive within {LONGEST_SHARE * task.running_time_s:.0f} s {_with_step(task)}."
    if status == STANDS:
        return f"comes to a stand at {place_m:.1f} m of {task.mesh.position_m[-1]:.1f} m {_with_step(task)}."
    return _overshoot(task, place_m, speed2)


def _overshoot(task: Task, place_m: float, speed2: float) -> str:
    """Return by how much a train passes the end of the line that brakes fully from a place and a square of speed."""
    # at half of the speed, the mean one of a train that slows down evenly to rest
    data, end_m = task.mesh.data, task.mesh.position_m[-1]
    speed = np.array([0.5 * np.sqrt(speed2)])
    brake = float(data.braking.effort_n(speed)[0]) + data.friction_effort_n
    resisting = float(task.mesh.running_resistance_n(np.full(task.mesh.cell_count + 1, 0.25 * speed2))[-1])
    deceleration = (brake + resisting + float(data.line_force_n[-1])) / (2 * data.half_inertia_kg)
    deceleration = min(deceleration, data.max_deceleration_ms2)
    if deceleration <= 0:
        return f"cannot stop at the end of the line {_with_step(task)}: its brakes do not hold it there."
    beyond = place_m + speed2 / (2 * deceleration) - end_m
    return (
        f"passes the end of the line by {beyond:.2g} m {_with_step(task)}, even with all its brakes from "
        f"{np.sqrt(speed2) / MS_PER_KMH:.2g} km/h at {end_m - place_m:.2g} m before it."
    )


def _require_limits(task: Task, mesh: MeshedLine, speed2: FloatArray) -> None:
    """Refuse a run that is too fast for line or vehicle: a relay passes its mark by as much as it takes to react."""
    line = task.mesh
    places = np.union1d(line.position_m, mesh.position_m)
    # v^2 is linear within a cell: between two neighbours of these places it is greatest at one of them
    between2 = np.interp(places, mesh.position_m, speed2)
    middle = 0.5 * (places[1:] + places[:-1])
    limit = line.cell_limit_ms[np.searchsorted(line.position_m, middle) - 1]
    excess = np.sqrt(np.maximum(between2[1:], between2[:-1])) - limit
    worst = int(np.argmax(excess / limit))
    if excess[worst] > PASSED_SHARE * limit[worst]:
        raise StrategyRefusedError(
            f"passes the speed limit of {limit[worst] / MS_PER_KMH:.4g} km/h by {excess[worst] / MS_PER_KMH:.2g} km/h "
            f"at {middle[worst]:.0f} m {_with_step(task)}."
        )
