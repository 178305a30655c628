"""Primal-dual interior-point method for the energy-optimal run over a mesh.

Problem: with w = v^2 at the nodes and the tractive effort f of each cell, minimise the line energy
sum h (e(f, v) + g(b, v)) + auxiliary power * time, b = f - D(w) the braking effort, subject to limits of effort,
speed, acceleration and to the timetable sum h / v <= T.

Method: Mehrotra's predictor and corrector on the full system, which eliminates cell by cell to a tridiagonal
one plus a rank-one term (`newton`). Barrier weights are proportional to length, so that graded meshes need
nothing else. The barrier never falls under a tenth of what the tolerance asks for: below that the residual of
the dual is rounding noise, which grows.

The stopping rule guarantees: the sum of slack times multiplier is below the tolerance times the energy, no
limit of effort is violated by more than 1e-8, no timetable by more than 1e-9, and the dual residual is small or at
its noise floor. `railjoule.core.bounds` proves how close the point is to the
global optimum.
"""

from typing import NamedTuple

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.drive.kernels import may_be_concave
from railjoule.core.interior_point import layout as ix
from railjoule.core.interior_point.cell import evaluate
from railjoule.core.interior_point.layout import ENVELOPE_EFFORTS, FAST, Work, allocate
from railjoule.core.interior_point.newton import factor_with_fallback
from railjoule.core.interior_point.start import TIME_WEIGHT, prepare
from railjoule.core.interior_point.step import complementarity, longest_steps, move, set_direction
from railjoule.core.physics.energy_balance import reference_energy
from railjoule.core.physics.mesh_data import MeshData, recuperation_at

CONVERGED, ITERATIONS_EXCEEDED = 0, 1
MAX_VIOLATION = 1e-8
"""Of a limit, in shares of the largest effort: well within the 1e-6 that a check allows."""
# Stricter than limits of effort, as arrivals are compared in seconds: 1e-8 of an hour would be 36 microseconds.
MAX_DELAY = 1e-9
"""By which share of its running time a run may be late."""
# Once the gap is met, the residual of the dual falls for a few iterations more, unless it is rounding already: in one
# case of ten with a tolerance of 1e-8. The multipliers that the proof takes are the better for each.
NOISE_FLOOR_PATIENCE = 6
NOISY_RESIDUAL = 1e-2
"""A relative residual of the dual beyond this is no noise, and the multipliers are of no use."""
# A pair far from the centre shortens all steps. Ordinarily six decades to either side are allowed; after three
# short steps in a row one decade, which sacrifices a pair's progress to let the others move.
LOOSE_WIDTH, TIGHT_WIDTH = 1e6, 10.0
SHORT_STEP = 0.3
SHORT_STEPS_BEFORE_TIGHT = 3
WHOLE_STEP, HALF_STEP = 0.99, 0.5
# Mehrotra's centring is the cube of what the affine step leaves of the gap. At least half is kept after a step so short
# that the affine direction is of no use, and never more than nine tenths, or the barrier would stand still.
MAX_CENTRING, CAUTIOUS_CENTRING, USELESS_STEP = 0.9, 0.5, 0.1
# The share of the way to the nearest bound that a step takes: closer to 1 as the barrier falls, for the last iterations
# to converge superlinearly.
BOUND_SHARE = 0.995
DUAL_SHARE = 0.1
"""Centring per unit of dual residual over gap: the barrier must not outrun the residual, which then becomes noise."""
MIN_BARRIER_SHARE = 0.1
"""Of the barrier that the tolerance asks for: under it the residual is noise, eps z / s, which grows as it falls."""


class Optimum(NamedTuple):
    """The result of the method, in SI.

    Parameters
    ----------
    speed2 : array of shape (n + 1,)
        Squares of speed at the nodes [m2/s2].
    traction_n, braking_n : array of shape (n,)
        Tractive and electric braking effort of each cell [N].
    multiplier : array of shape (12, n)
        Multipliers of the cells' constraints, rows as in `layout`: energy over effort [J/N].
    force_price : array of shape (n,)
        Derivative of the Lagrangian by the net force of each cell [J/N].
    price_of_time_w : float
        Multiplier of the timetable, auxiliary power not included [J/s].
    energy_j : float
        Line energy of the run with auxiliaries, dwells not included [J].
    relative_gap : float
        Sum of slack times multiplier over the energy.
    iterations : int
    status : int
        CONVERGED or ITERATIONS_EXCEEDED.
    """

    speed2: FloatArray
    traction_n: FloatArray
    braking_n: FloatArray
    multiplier: FloatArray
    force_price: FloatArray
    price_of_time_w: float
    energy_j: float
    relative_gap: float
    iterations: int
    status: int


@njit(cache=True, error_model="numpy", fastmath=FAST)
def dual_residual(mesh: MeshData, work: Work) -> float:
    """Return by how much the gradient of the Lagrangian fails to vanish, as an energy."""
    cells, rows, z = work.cells, work.rows, work.rows.multiplier
    total = 0.0
    for i in range(cells.traction.shape[0]):
        total += abs(cells.traction_gradient[i] - cells.force_price[i])
        if work.used[ix.FRICTION_POSITIVE] > 0.0:
            total += abs(cells.braking_gradient[i] + cells.force_price[i])
        if work.used[ix.DRAWN] > 0.0:
            total += abs(
                mesh.cell_length_m[i] * (1.0 - recuperation_at(mesh, i)) - z[ix.DRAWN, i] - z[ix.DRAWN_POSITIVE, i]
            )
    for i in range(work.nodes.speed2.shape[0]):
        if work.nodes.free[i] > 0.0:
            gradient = work.nodes.gradient[i] - z[ix.FLOOR, i] + z[ix.CEILING, i]
            total += abs(gradient) * work.nodes.speed2[i]
    for row in np.flatnonzero(work.used[: ix.CELL_ROWS]):
        for i in range(cells.traction.shape[0]):
            total += z[row, i] * abs(rows.residual[row, i])
    return total


@njit(cache=True, error_model="numpy", fastmath=FAST, nogil=True)
def minimise_energy(
    mesh: MeshData,
    fastest: FloatArray,
    shortest_time: float,
    running_time: float,
    tolerance: float,
    max_iterations: int,
    min_centring: float,
    exact_first: bool,
) -> Optimum:
    """Return the optimum of a meshed line.

    Parameters
    ----------
    mesh : MeshData
    fastest : array of shape (n + 1,)
        Squares of speed of the fastest run [m2/s2].
    shortest_time, running_time : float
        Time of that run, and time allowed without dwells [s]; the second must be larger.
    tolerance : float
        Wanted relative gap.
    max_iterations : int
    min_centring : float
        Lower bound of the centring; 0.2 ends the rare cycles that 1e-6 leaves.
    exact_first : bool
        Whether steps are taken with exact second derivatives where the problem is convex at the point, as in
        `factor_with_fallback`.
    """
    scale = mesh.traction.constant_n
    # where it is decided what the drive does, no power is tabulated
    relaxed = mesh.mode.shape[0] == 0
    efforts = ENVELOPE_EFFORTS if relaxed and may_be_concave(mesh.drive_kind) else 0
    work = allocate(mesh.cell_length_m.shape[0], efforts)
    time_slack, time_multiplier, weights = prepare(mesh, scale, fastest, shortest_time, running_time, work)
    length = mesh.cell_length_m.sum()
    time_weight = TIME_WEIGHT * length
    auxiliaries = mesh.auxiliary_power_w / scale
    step, iterations_close, short_steps, iteration = 1.0, 0, 0, 0
    status, energy, gap = ITERATIONS_EXCEEDED, 0.0, 1.0
    while iteration < max_iterations:
        before = energy
        energy, gross, time, violation = evaluate(mesh, scale, time_multiplier + auxiliaries, work)
        energy += auxiliaries * time
        time_residual = running_time - time - time_slack
        delay = (time - running_time) / running_time
        product = complementarity(work, 0.0, 0.0, time_slack, time_multiplier)
        barrier = product / weights
        reference = max(reference_energy(mesh, energy * scale, running_time) / scale, 0.01 * gross)
        gap = product / reference
        dual = (dual_residual(mesh, work) + time_multiplier * abs(time_residual)) / reference
        if violation < MAX_VIOLATION and delay < MAX_DELAY and gap < 1.5 * tolerance:
            iterations_close += 1
            # whole steps that change nothing any more: then what is left of the dual residual is noise, however large
            settled = step > WHOLE_STEP and abs(energy - before) < 0.1 * tolerance * reference
            patient = iterations_close >= NOISE_FLOOR_PATIENCE and (dual < NOISY_RESIDUAL or settled)
            if patient or (gap < tolerance and dual < 10.0 * tolerance):
                status = CONVERGED
                break
        least = min(barrier, MIN_BARRIER_SHARE * tolerance * reference / weights)
        response = factor_with_fallback(work, exact_first)
        if not np.isfinite(response):
            break  # no direction to step along: the point is returned with its gap, as not converged
        set_direction(mesh, work, response, 0.0, False, time_slack, time_multiplier, time_residual, 0.0)
        point, multipliers = longest_steps(work, time_slack, time_multiplier, 1.0)
        centring = (complementarity(work, point, multipliers, time_slack, time_multiplier) / product) ** 3
        if dual > gap:
            centring = max(centring, min(CAUTIOUS_CENTRING, DUAL_SHARE * dual / gap))
        centring = min(max(centring, min_centring), MAX_CENTRING)
        if step < USELESS_STEP:
            centring = max(centring, CAUTIOUS_CENTRING)
        aim = max(centring * barrier, least)
        set_direction(mesh, work, response, aim, True, time_slack, time_multiplier, time_residual, aim * time_weight)
        point, multipliers = longest_steps(work, time_slack, time_multiplier, max(BOUND_SHARE, 1.0 - barrier))
        step = min(point, multipliers)
        if not np.isfinite(step + work.time_step.sum()):
            break  # the same: a step that overflows would leave numbers that are none
        short_steps = short_steps + 1 if step < SHORT_STEP else 0
        width = LOOSE_WIDTH if short_steps < SHORT_STEPS_BEFORE_TIGHT else TIGHT_WIDTH
        # after a short step the target was not reached: pairs are kept around the barrier that there is
        centre = aim if step > HALF_STEP else max(barrier, least)
        move(work, point, multipliers, centre, width)
        time_slack += point * work.time_step[ix.TIME_SLACK]
        central = centre * time_weight / time_slack
        time_multiplier += multipliers * work.time_step[ix.TIME_MULTIPLIER]
        time_multiplier = min(max(time_multiplier, central / width), central * width)
        iteration += 1
    return Optimum(
        work.nodes.speed2,
        work.cells.traction * scale,
        work.cells.braking * scale,
        # an energy over an effort is a length, whatever both are scaled by
        work.rows.multiplier[: ix.CELL_ROWS, :-1].copy(),
        work.cells.force_price,
        time_multiplier * scale,
        energy * scale,
        gap,
        iteration,
        status,
    )
