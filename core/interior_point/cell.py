"""The cells of the problem: cost, constraints, and their derivatives at the present point."""

import math

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.drive.kernels import driving_power, generated_power, has_idle_losses
from railjoule.core.drive.kinds import PowerTerms
from railjoule.core.drive.line_power import smooth_supply_power
from railjoule.core.interior_point import layout as ix
from railjoule.core.interior_point.layout import FAST, Work
from railjoule.core.interior_point.switching import keep_larger_curvature, switched_powers
from railjoule.core.physics.cell import (
    duration,
    force_slopes,
    mean_speed,
    mean_speed_curvature,
    mean_speed_slope,
    needed_force,
)
from railjoule.core.physics.effort_limit import EffortLimit, limit_over_speed
from railjoule.core.physics.energy_balance import energy_per_metre
from railjoule.core.physics.mesh_data import MeshData, limits_at, scaled_cell_at, shared_by_cells
from railjoule.core.physics.resistance import mean_starting_curvatures


@njit(cache=True, error_model="numpy", fastmath=FAST)
def scaled_energy_per_metre(power: PowerTerms, scale: float, speed: float) -> PowerTerms:
    """Return the energy per metre of a power and its derivatives, energies and efforts over the effort `scale` [N]."""
    e, e_f, e_v, e_ff, e_fv, e_vv = energy_per_metre(power, speed)
    return e / scale, e_f, e_v / scale, e_ff * scale, e_fv, e_vv / scale


@njit(cache=True, error_model="numpy", fastmath=FAST)
def evaluate(mesh: MeshData, scale: float, time_price: float, work: Work) -> tuple[float, float, float, float]:
    """Evaluate cost, constraints, gradients and curvatures of all cells at the present point.

    Parameters
    ----------
    mesh : MeshData
    scale : float
        The effort that 1 stands for [N].
    time_price : float
        Cost of a second, scaled: multiplier of the timetable plus auxiliary power.
    work : Work
        Reads the point and its multipliers; fills residuals, gradients, curvatures.

    Returns
    -------
    (energy, gross_energy, travel_time, violation) : floats
        Scaled energy without auxiliaries, the sum of its sizes, time [s], largest violation of a limit.
    """
    h, w, free = mesh.cell_length_m, work.nodes.speed2, work.nodes.free
    cells, rows, z, used = work.cells, work.rows, work.rows.multiplier, work.used
    kind, parameters = mesh.drive_kind, mesh.drive_parameters
    idles, shared = has_idle_losses(mesh.drive_kind), shared_by_cells(mesh)
    friction = used[ix.FRICTION_POSITIVE] > 0.0
    work.nodes.time_gradient[:] = 0.0
    work.nodes.gradient[:] = 0.0
    energy = gross = total_time = 0.0
    v0 = math.sqrt(w[0])
    for i in range(h.shape[0]):
        v1 = math.sqrt(w[i + 1])
        v = mean_speed(v0, v1)
        t = duration(h[i], v)
        total_time += t
        # a fixed node may stand still: no derivative, rather than one over zero
        u0 = mean_speed_slope(v0) if free[i] > 0.0 else 0.0
        u1 = mean_speed_slope(v1) if free[i + 1] > 0.0 else 0.0
        cell = scaled_cell_at(mesh, i, scale)
        train, pulling, electric, _ = limits_at(shared, i)
        share = train.recuperation_factor
        force = needed_force(cell, w[i], w[i + 1], v)
        d0, d1 = force_slopes(cell, w[i], w[i + 1], u0, u1)
        f = cells.traction[i]
        # without friction brakes the electric brake does all: one variable less
        x = cells.braking[i] if friction else f - force
        cells.braking[i] = x
        if idles:
            efforts = max(f, 0.0) * scale, max(x, 0.0) * scale
            taken, generated = switched_powers(mesh, i, work.rays, work.envelope, *efforts, v)
        else:
            taken = driving_power(kind, parameters, max(f, 0.0) * scale, v)
            generated = generated_power(kind, parameters, max(x, 0.0) * scale, v)
        taken, generated = scaled_energy_per_metre(taken, scale, v), scaled_energy_per_metre(generated, scale, v)
        e, g = taken[0], generated[0]
        energy += h[i] * smooth_supply_power(e, g, cells.drawn[i], share)
        gross += h[i] * abs(e)
        largest = (
            cell.supply_share * (pulling.constant_n / scale),
            cell.supply_share * (electric.constant_n / scale),
            train.friction_effort_n / scale,
        )
        _fill_constant_rows(work, i, (f, x, f - force - x), largest)
        # Of g, what braking generates, the supply takes its share; where braking draws (g < 0) all of it is paid for:
        # cost -share g + (1 - share) psi with psi >= 0, psi >= -g. The multiplier of the latter acts on g like a share.
        returned = h[i] * share
        if used[ix.DRAWN] > 0.0:
            returned += z[ix.DRAWN, i]
            rows.residual[ix.DRAWN_POSITIVE, i], rows.residual[ix.DRAWN, i] = cells.drawn[i], cells.drawn[i] + g
            rows.by_effort[ix.DRAWN, i], rows.by_speed[ix.DRAWN, i] = generated[1], generated[2]
        _fill_derivatives(work, i, h[i], v, (taken, generated), returned, time_price * t)
        _add_over_speed(pulling, ix.TRACTION_OVER_SPEED, i, (f, v), scale, work, cells.traction_gradient)
        _add_over_speed(electric, ix.BRAKING_OVER_SPEED, i, (x, v), scale, work, cells.braking_gradient)
        # D acts through the brake that balances the cell, q = f - D - x, or x = f - D where there is no friction: the
        # Lagrangian's derivative by D is minus that by this brake's effort
        price = z[ix.FRICTION_CONSTANT, i] - z[ix.FRICTION_POSITIVE, i] if friction else cells.braking_gradient[i]
        cells.force_by_start[i], cells.force_by_end[i] = d0, d1
        cells.speed_by_start[i], cells.speed_by_end[i], cells.inertia[i] = u0, u1, cell.inertia
        cells.force_price[i] = -price
        _scatter_to_nodes(work, i, t / v, cells.speed_gradient[i] - price * cell.linear)
        if cell.starting_n > 0.0:
            by_start, by_end = mean_starting_curvatures(cell.starting_n, cell.starting_ends_ms, w[i], w[i + 1])
            work.curvature[ix.START_WW, i] -= price * by_start if free[i] > 0.0 else 0.0
            work.curvature[ix.END_WW, i] -= price * by_end if free[i + 1] > 0.0 else 0.0
        v0 = v1
    if idles:
        keep_larger_curvature(work.curvature, work.last_curvature)
    _limit_change_of_speed(mesh, scale, work)
    return energy, gross, total_time, _finish_residuals(work)


@njit(cache=True, error_model="numpy", fastmath=FAST)
def _fill_constant_rows(
    work: Work, i: int, efforts: tuple[float, float, float], largest: tuple[float, float, float]
) -> None:
    """Evaluate the limits of effort that no speed changes.

    Parameters
    ----------
    efforts : tuple
        Traction, electric and friction braking: f, x and q.
    largest : tuple
        The largest of them, that of traction 1 unless the place lowers it.
    """
    residual = work.rows.residual
    f, x, q = efforts
    residual[ix.TRACTION_POSITIVE, i] = f
    residual[ix.TRACTION_CONSTANT, i] = largest[0] - f
    residual[ix.BRAKING_POSITIVE, i] = x
    residual[ix.BRAKING_CONSTANT, i] = largest[1] - x
    if work.used[ix.FRICTION_POSITIVE] > 0.0:
        residual[ix.FRICTION_POSITIVE, i] = q
        residual[ix.FRICTION_CONSTANT, i] = largest[2] - q


@njit(cache=True, error_model="numpy", fastmath=FAST)
def _fill_derivatives(
    work: Work,
    i: int,
    length_m: float,
    speed: float,
    energies: tuple[PowerTerms, PowerTerms],
    returned: float,
    priced_time: float,
) -> None:
    """Fill the derivatives of a cell's Lagrangian by f, x and v, but for the limits over speed.

    Parameters
    ----------
    length_m : float
        h [m].
    speed : float
        v [m/s].
    energies : tuple
        Energy per metre taken to drive, e, and generated in braking, g, with derivatives.
    returned : float
        Factor by which the Lagrangian falls with g.
    priced_time : float
        Time of the cell times what a second costs.
    """
    # L = h e(f, v) - returned g(x, v) + price t(v) - the multipliers times their rows; as t = h / v, t' = -t / v and
    # t'' = 2 t / v^2
    _, e_f, e_v, e_ff, e_fv, e_vv = energies[0]
    _, g_x, g_v, g_xx, g_xv, g_vv = energies[1]
    cells, curve, z = work.cells, work.curvature, work.rows.multiplier
    cells.traction_gradient[i] = length_m * e_f - z[ix.TRACTION_POSITIVE, i] + z[ix.TRACTION_CONSTANT, i]
    cells.braking_gradient[i] = z[ix.BRAKING_CONSTANT, i] - z[ix.BRAKING_POSITIVE, i] - returned * g_x
    cells.speed_gradient[i] = length_m * e_v - returned * g_v - priced_time / speed
    curve[ix.DRIVING_FF, i], curve[ix.DRIVING_FV, i], curve[ix.DRIVING_VV, i] = (
        length_m * e_ff,
        length_m * e_fv,
        length_m * e_vv,
    )
    curve[ix.BRAKING_XX, i], curve[ix.BRAKING_XV, i] = -returned * g_xx, -returned * g_xv
    curve[ix.BRAKING_VV, i] = -returned * g_vv
    curve[ix.PRICED_VV, i] = 2.0 * priced_time / (speed * speed)


@njit(cache=True, error_model="numpy", fastmath=FAST)
def _add_over_speed(
    limit: EffortLimit, row: int, i: int, at: tuple[float, float], scale: float, work: Work, by_effort: FloatArray
) -> None:
    """Evaluate a limit of effort L(v), and add it to the derivatives of the cell's Lagrangian.

    Parameters
    ----------
    limit : EffortLimit
    row : int
        Of traction or braking.
    at : tuple
        The effort, scaled, and the cell's mean speed [m/s].
    scale : float
        The effort that 1 stands for [N].
    work : Work
    by_effort : array of shape (n,)
        Derivatives of the Lagrangian by that effort.
    """
    rows, z = work.rows, work.rows.multiplier[row, i]
    if rows.weight[row, i] <= 0.0:
        return
    effort, speed = at
    largest, slope, curvature = limit_over_speed(limit, speed)
    rows.residual[row, i] = largest / scale - effort
    rows.by_speed[row, i] = slope / scale
    # -z (L(v) - effort)
    by_effort[i] += z
    work.cells.speed_gradient[i] -= z * (slope / scale)
    work.curvature[ix.PRICED_VV, i] -= z * (curvature / scale)


@njit(cache=True, error_model="numpy", fastmath=FAST)
def _scatter_to_nodes(work: Work, i: int, time_by_speed: float, by_mean_speed: float) -> None:
    """Add what a cell's Lagrangian and time vary with w to its two nodes.

    Parameters
    ----------
    time_by_speed : float
        Minus the derivative of the cell's time by its mean speed [s2/m].
    by_mean_speed : float
        Derivative of the Lagrangian by the mean speed, that of the net force included.
    """
    cells, nodes, curve = work.cells, work.nodes, work.curvature
    w, speed, force = nodes.speed2, cells.speed_gradient[i], cells.force_price[i]
    u0, u1 = cells.speed_by_start[i], cells.speed_by_end[i]
    nodes.gradient[i] += speed * u0 + force * cells.force_by_start[i]
    nodes.gradient[i + 1] += speed * u1 + force * cells.force_by_end[i]
    nodes.time_gradient[i] -= time_by_speed * u0
    nodes.time_gradient[i + 1] -= time_by_speed * u1
    # chain rule: what depends on v has the curvature L_vv v_w^2, which `newton` builds, and L_v v_ww, which is this
    curve[ix.START_WW, i] = by_mean_speed * mean_speed_curvature(u0, w[i]) if u0 > 0.0 else 0.0
    curve[ix.END_WW, i] = by_mean_speed * mean_speed_curvature(u1, w[i + 1]) if u1 > 0.0 else 0.0


@njit(cache=True, error_model="numpy", fastmath=FAST)
def _limit_change_of_speed(mesh: MeshData, scale: float, work: Work) -> None:
    """Evaluate the limits of acceleration and deceleration."""
    w, inertia, z = work.nodes.speed2, work.cells.inertia, work.rows.multiplier
    for row, sign, limit in (
        (ix.ACCELERATION, -1.0, mesh.max_acceleration_ms2),
        (ix.DECELERATION, 1.0, mesh.max_deceleration_ms2),
    ):
        if work.used[row] <= 0.0:
            continue
        largest = 2.0 * mesh.half_inertia_kg * limit / scale
        for i in range(inertia.shape[0]):
            work.rows.residual[row, i] = largest + sign * inertia[i] * (w[i + 1] - w[i])
            price = sign * inertia[i] * z[row, i]
            work.nodes.gradient[i] += price
            work.nodes.gradient[i + 1] -= price


@njit(cache=True, error_model="numpy", fastmath=FAST)
def _finish_residuals(work: Work) -> float:
    """Subtract the slacks from the values of the constraints; return the largest violation of a cell's."""
    rows, nodes, violation = work.rows, work.nodes, 0.0
    rows.residual[ix.FLOOR], rows.residual[ix.CEILING] = nodes.speed2 - nodes.floor, nodes.ceiling - nodes.speed2
    for row in np.flatnonzero(work.used):
        for i in range(rows.slack.shape[1]):
            if rows.weight[row, i] > 0.0:
                violation = max(violation, -rows.residual[row, i] if row < ix.CELL_ROWS else 0.0)
                rows.residual[row, i] -= rows.slack[row, i]
    return violation
