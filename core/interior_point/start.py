"""A strictly feasible start: the fastest run, slowed down and capped until it is nearly as slow as the timetable."""

import math

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.drive.kernels import (
    generated_power,
    has_idle_losses,
    has_standstill_brake,
    may_be_concave,
    may_draw_while_braking,
)
from railjoule.core.interior_point import layout as ix
from railjoule.core.interior_point.envelope import tabulate_envelope
from railjoule.core.interior_point.layout import Work
from railjoule.core.interior_point.switching import tabulate_rays
from railjoule.core.motion.passes import running_time as running_time_of
from railjoule.core.physics.cell import mean_speed, needed_force
from railjoule.core.physics.effort_limit import EffortLimit, limit_over_speed
from railjoule.core.physics.energy_balance import energy_per_metre
from railjoule.core.physics.mesh_data import MeshData, limits_at, scaled_cell_at, shared_by_cells

SLOWEST_SPEED2 = 0.01
"""Floor of speed squared at inner nodes [m2/s2], 0.36 km/h: at rest a crest would have an infinite derivative."""
# In scaled units, and of the order of the energy per metre of an ordinary run, whose mean effort is some hundredths of
# the largest: the first centre then lies where cost and limits weigh about the same.
FIRST_BARRIER = 0.03
# The timetable is one constraint against several of each cell, whose weights add up to some lengths of the line. With
# this share 10,000 random tasks, half of them with stops, all converge.
TIME_WEIGHT = 0.2
"""Weight of the timetable in the barrier, as a share of the line's length."""
MAX_SLACK = 1.0
"""The start uses no more slack than this share of the shortest time, lest it creep where 1 / v and noise are large."""


@njit(cache=True, error_model="numpy")
def start_speeds(
    mesh: MeshData, fastest: FloatArray, shortest_time: float, running_time: float, speed2: FloatArray
) -> None:
    """Fill `speed2` with min(c fastest, cap); c and the cap give 90 % of the slack to the time, if it is not too much.

    Scaling all squares of speed by c keeps every force between that of the fastest run and that of standing
    still, so the start is strictly feasible however tight the timetable is.
    """
    # In a tight timetable half of the slack that is used goes to scaling; in a generous one scaling ends at
    # sqrt(0.85) of the speed and the cap does the rest, as capped runs resemble the optimum more. A tenth of the
    # slack is left over, so that the timetable, too, is strictly met.
    h, fixed = mesh.cell_length_m, mesh.fixed_speed2
    wanted = shortest_time + 0.9 * min(running_time - shortest_time, MAX_SLACK * shortest_time)
    tight = (shortest_time / wanted) ** 2
    c = max(tight, 0.85)
    if tight > 0.85:
        c = (shortest_time / (shortest_time + 0.45 * (running_time - shortest_time))) ** 2
    high = math.sqrt(fastest.max())
    low = 1e-3 * high
    # bisection for the cap, over its logarithm while its scale is unknown; 5e-4 of the speed is all that a start needs
    for _ in range(40):
        cap = math.sqrt(low * high) if low < 0.1 * high else 0.5 * (low + high)
        speed2[:] = np.where(fixed >= 0.0, fixed, np.minimum(c * fastest, cap * cap))
        if running_time_of(h, speed2) > wanted:
            low = cap
        else:
            high = cap
        if high - low < 5e-4 * high:
            break
    speed2[:] = np.where(fixed >= 0.0, fixed, np.minimum(c * fastest, high * high))


@njit(cache=True)
def _use_limits(mesh: MeshData, fastest: FloatArray, work: Work) -> None:
    """Mark the constraints that a run can reach, and give each its weight."""
    h, weight = mesh.cell_length_m, work.rows.weight
    shared, may_draw = shared_by_cells(mesh), may_draw_while_braking(mesh.drive_kind)
    may_draw = may_draw and not has_standstill_brake(mesh.drive_kind, mesh.drive_parameters)
    for i in range(h.shape[0]):
        top_speed = mean_speed(math.sqrt(fastest[i]), math.sqrt(fastest[i + 1]))
        for row in (ix.TRACTION_POSITIVE, ix.TRACTION_CONSTANT, ix.BRAKING_POSITIVE, ix.BRAKING_CONSTANT):
            weight[row, i] = h[i]
        powered, (train, traction, braking, _) = mesh.supply_share[i] >= 1.0, limits_at(shared, i)
        if powered and _binds(traction, top_speed):
            weight[ix.TRACTION_OVER_SPEED, i] = h[i]
        if powered and _binds(braking, top_speed):
            weight[ix.BRAKING_OVER_SPEED, i] = h[i]
        if may_draw and train.recuperation_factor < 1.0:
            weight[ix.DRAWN_POSITIVE, i] = weight[ix.DRAWN, i] = h[i]
        if train.friction_effort_n > 0.0:
            weight[ix.FRICTION_POSITIVE, i] = weight[ix.FRICTION_CONSTANT, i] = h[i]
        if mesh.max_acceleration_ms2 < np.inf:
            weight[ix.ACCELERATION, i] = h[i]
        if mesh.max_deceleration_ms2 < np.inf:
            weight[ix.DECELERATION, i] = h[i]
    for row in range(ix.CELL_ROWS):
        work.used[row] = 1.0 if weight[row].max() > 0.0 else 0.0
    work.used[ix.FLOOR] = work.used[ix.CEILING] = 1.0


@njit(cache=True)
def _binds(limit: EffortLimit, top_speed: float) -> bool:
    """Return whether a limit over speed can be reached below the constant one up to a speed."""
    if limit.table.shape[0] > 0:
        return True
    return limit.power_w < np.inf and limit.power_w / top_speed < limit.constant_n


@njit(cache=True, error_model="numpy")
def prepare(
    mesh: MeshData, scale: float, fastest: FloatArray, shortest_time: float, running_time: float, work: Work
) -> tuple[float, float, float]:
    """Fill the work arrays with a start; return slack and multiplier of the timetable, and the sum of weights.

    Parameters
    ----------
    mesh : MeshData
    scale : float
        The effort that 1 stands for [N].
    fastest : array of shape (n + 1,)
        Squares of speed of the fastest run [m2/s2].
    shortest_time, running_time : float
        Time of the fastest run, and time allowed without dwells [s].
    work : Work
    """
    h, nodes, rows = mesh.cell_length_m, work.nodes, work.rows
    n, w = h.shape[0], work.nodes.speed2
    start_speeds(mesh, fastest, shortest_time, running_time, w)
    _use_limits(mesh, fastest, work)
    # where it is decided what the drive does, no power is a line: nothing would read the table
    if has_idle_losses(mesh.drive_kind) and mesh.mode.shape[0] == 0:
        if may_be_concave(mesh.drive_kind):
            tabulate_envelope(mesh, work.envelope)
        else:
            tabulate_rays(mesh, work.rays)
    for i in range(n + 1):
        nodes.free[i] = 1.0 if math.isnan(mesh.fixed_speed2[i]) else 0.0
        nodes.floor[i] = min(SLOWEST_SPEED2, 0.25 * w[i])
        nodes.ceiling[i] = mesh.limit_speed2[i]
        if nodes.free[i] > 0.0:
            rows.slack[ix.FLOOR, i] = w[i] - nodes.floor[i]
            rows.slack[ix.CEILING, i] = max(nodes.ceiling[i] - w[i], 1e-3 * nodes.ceiling[i])
            length = 0.5 * ((h[i - 1] if i > 0 else 0.0) + (h[i] if i < n else 0.0))
            rows.weight[ix.FLOOR, i] = rows.weight[ix.CEILING, i] = length
    _start_cells(mesh, scale, work)
    rows.multiplier[:] = FIRST_BARRIER * rows.weight / rows.slack
    time_weight = TIME_WEIGHT * h.sum()
    time_slack = max(running_time - running_time_of(h, w), 0.01 * (running_time - shortest_time))
    return time_slack, FIRST_BARRIER * time_weight / time_slack, rows.weight.sum() + time_weight


@njit(cache=True, error_model="numpy")
def _start_cells(mesh: MeshData, scale: float, work: Work) -> None:
    """Put the efforts of the cells inside their intervals, and fill the slacks of their constraints."""
    h, w, rows, cells = mesh.cell_length_m, work.nodes.speed2, work.rows, work.cells
    shared = shared_by_cells(mesh)
    inertia = mesh.half_inertia_kg / scale
    for i in range(h.shape[0]):
        v = mean_speed(math.sqrt(w[i]), math.sqrt(w[i + 1]))
        cell = scaled_cell_at(mesh, i, scale)
        train, traction, braking, _ = limits_at(shared, i)
        top_traction = cell.supply_share * (traction.constant_n / scale)
        top_braking, top_friction = cell.supply_share * (braking.constant_n / scale), train.friction_effort_n / scale
        rise = cell.inertia * (w[i + 1] - w[i])
        force = needed_force(cell, w[i], w[i + 1], v)
        over_traction, over_braking = np.inf, np.inf
        if rows.weight[ix.TRACTION_OVER_SPEED, i] > 0.0:
            over_traction = limit_over_speed(traction, v)[0] / scale
        if rows.weight[ix.BRAKING_OVER_SPEED, i] > 0.0:
            over_braking = limit_over_speed(braking, v)[0] / scale
        electric = min(top_braking, over_braking)
        low = max(force, 0.0)
        # a tenth into the interval: most of an optimal run coasts or uses little effort
        f = low + 0.1 * max(min(top_traction, over_traction, electric + top_friction + force) - low, 0.0)
        b = f - force
        x = b if top_friction <= 0.0 else 0.5 * (max(b - top_friction, 0.0) + min(b, electric))
        power = generated_power(mesh.drive_kind, mesh.drive_parameters, max(x, 0.0) * scale, v)
        generated = energy_per_metre(power, v)[0] / scale
        drawn = max(-generated, 0.0) + 1e-2 if rows.weight[ix.DRAWN, i] > 0.0 else 0.0
        cells.traction[i], cells.braking[i], cells.drawn[i] = f, x, drawn
        rows.slack[ix.TRACTION_POSITIVE, i] = f
        rows.slack[ix.TRACTION_CONSTANT, i] = top_traction - f
        rows.slack[ix.TRACTION_OVER_SPEED, i] = over_traction - f
        rows.slack[ix.BRAKING_POSITIVE, i] = x
        rows.slack[ix.BRAKING_CONSTANT, i] = top_braking - x
        rows.slack[ix.BRAKING_OVER_SPEED, i] = over_braking - x
        rows.slack[ix.DRAWN_POSITIVE, i] = drawn
        rows.slack[ix.DRAWN, i] = drawn + generated
        rows.slack[ix.FRICTION_POSITIVE, i] = b - x
        rows.slack[ix.FRICTION_CONSTANT, i] = top_friction - b + x
        rows.slack[ix.ACCELERATION, i] = 2.0 * inertia * mesh.max_acceleration_ms2 - rise
        rows.slack[ix.DECELERATION, i] = 2.0 * inertia * mesh.max_deceleration_ms2 + rise
    for row in range(ix.CELL_ROWS):
        for i in range(h.shape[0]):
            rows.slack[row, i] = max(rows.slack[row, i], 1e-3) if rows.weight[row, i] > 0.0 else 1.0
