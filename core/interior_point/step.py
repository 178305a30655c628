"""Right-hand sides, steps and step lengths of the interior-point method."""

import numpy as np

from railjoule.core.compiled import njit
from railjoule.core.interior_point import layout as ix
from railjoule.core.interior_point.layout import FAST, Work
from railjoule.core.interior_point.newton import back_substitute
from railjoule.core.physics.mesh_data import MeshData, recuperation_at

# From Mehrotra's corrector the product of the two predictor steps can exceed the target by orders where one pair is
# nearly active; unbounded it pushes other pairs off the centre. 10 leaves the corrector as it is in ordinary
# iterations; leaving the corrector out after short steps fails 261 of 2,000 random tasks.
LONGEST_CORRECTION = 10.0
"""The second-order term is kept within this many targets."""
TINY = 1e-300
"""Keeps the ratio of constraints that are not there, 0 / 0, at zero."""
# The slack of the floor is only right to first order, so w itself is watched: at w = 0 the mean speed has an infinite
# derivative. A smaller share lets a node fall so low that the next steps are short; a larger one slows the first steps.
SHORTEST_SPEED2 = 0.03
"""No speed squared falls under this share of itself in one step."""


@njit(cache=True, error_model="numpy", fastmath=FAST)
def set_targets(work: Work, barrier: float, second_order: bool) -> None:
    """Fill what slack times multiplier is aimed at, over the slack, and what it adds to the right-hand side.

    With `second_order`, Mehrotra's correction takes the product of the last steps into account.
    """
    rows = work.rows
    for row in np.flatnonzero(work.used):
        for i in range(rows.slack.shape[1]):
            aim = barrier * rows.weight[row, i]
            if second_order:
                product = rows.slack_step[row, i] * rows.multiplier_step[row, i]
                aim -= min(max(product, -LONGEST_CORRECTION * aim), LONGEST_CORRECTION * aim)
            s, z = rows.slack[row, i], rows.multiplier[row, i]
            rows.target[row, i] = aim / s
            rows.rhs[row, i] = (aim - z * (s + rows.residual[row, i])) / s


@njit(cache=True, error_model="numpy", fastmath=FAST)
def set_right_side(mesh: MeshData, work: Work) -> None:
    """Fill the right-hand sides of the efforts, and that of the nodes into `nodes.speed2_step`."""
    h, cells, rows, used = mesh.cell_length_m, work.cells, work.rows, work.used
    right, rhs, z = work.nodes.speed2_step, work.rows.rhs, work.rows.multiplier
    right[:] = rhs[ix.FLOOR] + z[ix.FLOOR] - rhs[ix.CEILING] - z[ix.CEILING]
    friction = used[ix.FRICTION_POSITIVE] > 0.0
    for i in range(h.shape[0]):
        over = rhs[ix.TRACTION_OVER_SPEED, i]
        traction = rhs[ix.TRACTION_POSITIVE, i] - rhs[ix.TRACTION_CONSTANT, i] - over
        traction -= cells.traction_gradient[i]
        speed = over * rows.by_speed[ix.TRACTION_OVER_SPEED, i] - cells.speed_gradient[i]
        over = rhs[ix.BRAKING_OVER_SPEED, i]
        electric = rhs[ix.BRAKING_POSITIVE, i] - rhs[ix.BRAKING_CONSTANT, i] - over
        electric -= cells.braking_gradient[i]
        speed += over * rows.by_speed[ix.BRAKING_OVER_SPEED, i]
        if used[ix.DRAWN] > 0.0:
            over = rhs[ix.DRAWN, i]
            price = h[i] * (1.0 - recuperation_at(mesh, i))
            drawn = over + rhs[ix.DRAWN_POSITIVE, i] - price
            drawn += z[ix.DRAWN, i] + z[ix.DRAWN_POSITIVE, i]
            cells.drawn_right[i] = drawn
            electric += over * rows.by_effort[ix.DRAWN, i] - cells.drawn_by_effort[i] * drawn
            speed += over * rows.by_speed[ix.DRAWN, i] - cells.drawn_by_speed[i] * drawn
        braking = electric
        if friction:
            q = rhs[ix.FRICTION_POSITIVE, i] - rhs[ix.FRICTION_CONSTANT, i] + cells.force_price[i]
            cells.friction_right[i] = q
            # Minimising W_x (dx + s dv)^2 / 2 + W_q dq^2 / 2 - R_x dx - R_q dq with dx + dq = db leaves the weight
            # W_x W_q / (W_x + W_q) and R_b = (R_x W_q + R_q W_x) / (W_x + W_q) on db; what R_x does to dv stays.
            share = cells.friction_weight[i] / (cells.electric_weight[i] + cells.friction_weight[i])
            braking = electric * share + q * (1.0 - share)
            speed += (braking - electric) * cells.braking_slope[i]
        cells.traction_right[i], cells.electric_right[i] = traction, electric
        # In y = df + s_f dv, with db = y - s_f dv - dD, the linear terms are (R_f + R_b) (s_f dv - y) + R_b dD; the y
        # that minimises W_f y^2 / 2 + W_b (y - c dw)^2 / 2 puts (R_f + R_b) W_b / (W_f + W_b) on the coupling c.
        both = traction + braking
        speed -= both * cells.traction_slope[i]
        coupling = both * cells.braking_weight[i] / (cells.traction_weight[i] + cells.braking_weight[i])
        u0, u1 = cells.speed_by_start[i], cells.speed_by_end[i]
        right[i] += coupling * cells.coupling_start[i] - braking * cells.force_by_start[i] + speed * u0
        right[i + 1] += coupling * cells.coupling_end[i] - braking * cells.force_by_end[i] + speed * u1
    for row, sign in ((ix.ACCELERATION, -1.0), (ix.DECELERATION, 1.0)):
        if used[row] > 0.0:
            for i in range(h.shape[0]):
                change = sign * cells.inertia[i] * (rhs[row, i] + z[row, i])
                right[i] -= change
                right[i + 1] += change
    right *= work.nodes.free


@njit(cache=True, error_model="numpy", fastmath=FAST)
def expand(work: Work) -> None:
    """Recover the steps of efforts, slacks and multipliers from those of the nodes."""
    cells, rows, used, step = work.cells, work.rows, work.used, work.nodes.speed2_step
    friction = used[ix.FRICTION_POSITIVE] > 0.0
    for i in range(cells.traction.shape[0]):
        dv = cells.speed_by_start[i] * step[i] + cells.speed_by_end[i] * step[i + 1]
        coupling = cells.coupling_start[i] * step[i] + cells.coupling_end[i] * step[i + 1]
        force = cells.force_by_start[i] * step[i] + cells.force_by_end[i] * step[i + 1]
        braking = electric = cells.electric_right[i]
        if friction:
            share = cells.friction_weight[i] / (cells.electric_weight[i] + cells.friction_weight[i])
            braking = electric * share + cells.friction_right[i] * (1.0 - share)
        total = cells.traction_weight[i] + cells.braking_weight[i]
        # y = df + s_f dv of `set_right_side`, now that dw is known
        df = (cells.braking_weight[i] * coupling + cells.traction_right[i] + braking) / total
        df -= cells.traction_slope[i] * dv
        dx = df - force
        if friction:
            # of db, both brakes take what makes W_x (dx + s dv) - R_x = W_q dq - R_q
            db, slope = dx, cells.braking_slope[i] * dv
            dx = cells.friction_weight[i] * (db + slope) + electric - cells.friction_right[i]
            dx = dx / (cells.electric_weight[i] + cells.friction_weight[i]) - slope
            rows.slack_step[ix.FRICTION_POSITIVE, i] = rows.residual[ix.FRICTION_POSITIVE, i] + db - dx
            rows.slack_step[ix.FRICTION_CONSTANT, i] = rows.residual[ix.FRICTION_CONSTANT, i] - db + dx
        cells.traction_step[i], cells.braking_step[i] = df, dx
        for row, sign in ((ix.TRACTION_POSITIVE, 1.0), (ix.TRACTION_CONSTANT, -1.0)):
            rows.slack_step[row, i] = rows.residual[row, i] + sign * df
        for row, sign in ((ix.BRAKING_POSITIVE, 1.0), (ix.BRAKING_CONSTANT, -1.0)):
            rows.slack_step[row, i] = rows.residual[row, i] + sign * dx
        for row, effort in ((ix.TRACTION_OVER_SPEED, df), (ix.BRAKING_OVER_SPEED, dx)):
            if rows.weight[row, i] > 0.0:
                rows.slack_step[row, i] = rows.residual[row, i] - effort + rows.by_speed[row, i] * dv
        if rows.weight[ix.DRAWN, i] > 0.0:
            weight = rows.multiplier[ix.DRAWN, i] / rows.slack[ix.DRAWN, i]
            weight += rows.multiplier[ix.DRAWN_POSITIVE, i] / rows.slack[ix.DRAWN_POSITIVE, i]
            drawn = cells.drawn_right[i] / weight - cells.drawn_by_effort[i] * dx - cells.drawn_by_speed[i] * dv
            cells.drawn_step[i] = drawn
            rows.slack_step[ix.DRAWN_POSITIVE, i] = rows.residual[ix.DRAWN_POSITIVE, i] + drawn
            generated = rows.by_effort[ix.DRAWN, i] * dx + rows.by_speed[ix.DRAWN, i] * dv
            rows.slack_step[ix.DRAWN, i] = rows.residual[ix.DRAWN, i] + drawn + generated
        for row, sign in ((ix.ACCELERATION, -1.0), (ix.DECELERATION, 1.0)):
            if used[row] > 0.0:
                change = sign * cells.inertia[i] * (step[i + 1] - step[i])
                rows.slack_step[row, i] = rows.residual[row, i] + change
    for i in range(step.shape[0]):
        if work.nodes.free[i] > 0.0:
            moved = work.nodes.speed2[i] + step[i]
            rows.slack_step[ix.FLOOR, i] = moved - work.nodes.floor[i] - rows.slack[ix.FLOOR, i]
            rows.slack_step[ix.CEILING, i] = work.nodes.ceiling[i] - moved - rows.slack[ix.CEILING, i]
    for k in np.flatnonzero(used):
        for i in range(rows.slack.shape[1]):
            z = rows.multiplier[k, i]
            rows.multiplier_step[k, i] = rows.target[k, i] - z - z / rows.slack[k, i] * rows.slack_step[k, i]


@njit(cache=True, error_model="numpy", fastmath=FAST)
def set_direction(
    mesh: MeshData,
    work: Work,
    response: float,
    barrier: float,
    second_order: bool,
    time_slack: float,
    time_multiplier: float,
    time_residual: float,
    time_aim: float,
) -> None:
    """Fill all steps for a target of the barrier.

    Parameters
    ----------
    mesh : MeshData
    work : Work
        Factored.
    response : float
        What `factor_with_fallback` returned.
    barrier : float
        Target of slack times multiplier per unit of weight.
    second_order : bool
        Whether the steps that stand in `work` correct the target.
    time_slack, time_multiplier, time_residual, time_aim : float
        The constraint of the timetable, and its own target of slack times multiplier.
    """
    nodes, step = work.nodes, work.nodes.speed2_step
    set_targets(work, barrier, second_order)
    set_right_side(mesh, work)
    back_substitute(nodes, step)
    along = np.sum(nodes.time_gradient * step)
    if second_order:
        product = work.time_step[ix.TIME_SLACK] * work.time_step[ix.TIME_MULTIPLIER]
        time_aim -= min(max(product, -LONGEST_CORRECTION * time_aim), LONGEST_CORRECTION * time_aim)
    # the timetable couples all cells: a rank-one term, solved by Sherman and Morrison's formula
    weight = time_multiplier / time_slack
    price_step = time_aim / time_slack - time_multiplier + weight * (along - time_residual)
    price_step /= 1.0 + weight * response
    step[:] = (step - nodes.time_response * price_step) * nodes.free
    work.time_step[ix.TIME_SLACK] = response * price_step - along + time_residual
    work.time_step[ix.TIME_MULTIPLIER] = price_step
    expand(work)


@njit(cache=True, error_model="numpy", fastmath=FAST)
def longest_steps(work: Work, time_slack: float, time_multiplier: float, fraction: float) -> tuple[float, float]:
    """Return the longest steps of point and multipliers, at most 1, that stop at `fraction` of the way to a bound."""
    # the most negative relative steps of slacks and multipliers
    rows, slack = work.rows, min(work.time_step[ix.TIME_SLACK] / time_slack, 0.0)
    multiplier = min(work.time_step[ix.TIME_MULTIPLIER] / time_multiplier, 0.0)
    for row in np.flatnonzero(work.used):
        for i in range(rows.slack.shape[1]):
            slack = min(slack, rows.slack_step[row, i] / rows.slack[row, i])
            multiplier = min(multiplier, rows.multiplier_step[row, i] / (rows.multiplier[row, i] + TINY))
    # the floor's slack need not be exact yet, so w itself is kept above zero
    speed2 = 0.0
    for i in range(work.nodes.speed2.shape[0]):
        if work.nodes.free[i] > 0.0:
            speed2 = min(speed2, work.nodes.speed2_step[i] / work.nodes.speed2[i])
    point = min(1.0, -fraction / slack) if slack < 0.0 else 1.0
    if speed2 < 0.0:
        point = min(point, -(1.0 - SHORTEST_SPEED2) / speed2)
    return point, min(1.0, -fraction / multiplier) if multiplier < 0.0 else 1.0


@njit(cache=True, error_model="numpy", fastmath=FAST)
def complementarity(work: Work, point: float, multipliers: float, time_slack: float, time_multiplier: float) -> float:
    """Return the sum of slack times multiplier of all constraints after steps of given lengths."""
    rows, time_step = work.rows, work.time_step
    total: float = time_slack + point * time_step[ix.TIME_SLACK]
    total *= time_multiplier + multipliers * time_step[ix.TIME_MULTIPLIER]
    for row in np.flatnonzero(work.used):
        for i in range(rows.slack.shape[1]):
            s = rows.slack[row, i] + point * rows.slack_step[row, i]
            total += s * (rows.multiplier[row, i] + multipliers * rows.multiplier_step[row, i])
    return total


@njit(cache=True, error_model="numpy", fastmath=FAST)
def move(work: Work, point: float, multipliers: float, barrier: float, width: float) -> None:
    """Move the point, its slacks and its multipliers, and keep each pair within a factor `width` of the centre."""
    cells, rows = work.cells, work.rows
    work.nodes.speed2[:] += point * work.nodes.speed2_step
    cells.traction[:] += point * cells.traction_step
    cells.braking[:] += point * cells.braking_step
    cells.drawn[:] += point * cells.drawn_step
    for row in np.flatnonzero(work.used):
        for i in range(rows.slack.shape[1]):
            s = rows.slack[row, i] + point * rows.slack_step[row, i]
            z = rows.multiplier[row, i] + multipliers * rows.multiplier_step[row, i]
            # a pair that left the centre far behind would take many short steps to come back
            centre = barrier * rows.weight[row, i] / s
            rows.slack[row, i] = s
            rows.multiplier[row, i] = min(max(z, centre / width), centre * width)
