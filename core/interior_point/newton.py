"""Newton's step of the interior-point method: a tridiagonal system plus one rank-one term for the time.

Every cell is first condensed: what its constraints and its cost say on traction and on braking is gathered, each
as a weight on (effort + slope * mean speed)^2, with a remainder on the mean speed; then the efforts are
eliminated, and the nodes one after another.

Constraint k is g_k(f, v) with slack s and multiplier z; to second order its barrier adds z / s (dg)^2, which is
W_k (df + slope_k dv)^2. A sum of such squares is one square and a remainder (Lagrange's identity):

    sum W_k (f + slope_k v)^2 = W (f + slope v)^2 + remainder v^2,      W = sum W_k,   slope = sum W_k slope_k / W,
    remainder = sum over pairs k < l of W_k W_l / W (slope_k - slope_l)^2.

When several limits of a cell are active, their weights reach 1e12, and any difference of them would lose all
digits. So nothing here is subtracted: remainders are sums over pairs, and so are determinants (`cell_block`).
"""

import math

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.interior_point import layout as ix
from railjoule.core.interior_point.layout import FAST, Nodes, Work


@njit(cache=True, fastmath=FAST)
def positive_part(a: float, b: float, c: float) -> tuple[float, float, float]:
    """Return the positive semidefinite part of the symmetric matrix [[a, b], [b, c]]."""
    middle, half = 0.5 * (a + c), 0.5 * (a - c)
    radius = math.sqrt(half * half + b * b)
    high, low = middle + radius, middle - radius
    if low >= 0.0:
        return a, b, c
    if high <= 0.0:
        return 0.0, 0.0, 0.0
    # With one eigenvalue on either side of zero the positive part is high d d', and d d' = (M - low) / (high - low).
    weight = high / (high - low)
    return weight * (a - low), weight * b, weight * (c - low)


@njit(cache=True, error_model="numpy", fastmath=FAST)
def add_curvature(
    weight: float, slope: float, remainder: float, ff: float, fv: float, vv: float
) -> tuple[float, float, float]:
    """Add a curvature [[ff, fv], [fv, vv]] to weight (f + slope v)^2 + remainder v^2; return the new three."""
    # Completing the square of (weight + ff) f^2 + 2 (weight slope + fv) f v gives the slope
    # (weight slope + fv) / total. Written by its change, cross / total, nothing subtracts weight * slope^2 from
    # itself; what is added to the remainder is the curvature along (-slope, 1), where the square does not change.
    total = weight + ff
    cross = fv - ff * slope
    return total, slope + cross / total, remainder + vv - 2.0 * fv * slope + ff * slope * slope - cross * cross / total


@njit(cache=True, error_model="numpy", fastmath=FAST)
def condense(work: Work, exact: bool) -> FloatArray:
    """Gather weights, slopes and remainders of all cells, with the positive part of each cell's curvature.

    Parameters
    ----------
    work : Work
    exact : bool
        Whether the curvatures are taken as they are, not their positive part.

    Returns
    -------
    array of shape (n,)
        Weight on the mean speed squared in each cell.
    """
    rows, cells, curve = work.rows, work.cells, work.curvature
    # what a slack that changes costs to second order
    ratio = rows.multiplier / rows.slack
    on_speed = np.empty(cells.traction.shape[0])
    for i in range(on_speed.shape[0]):
        fixed = ratio[ix.TRACTION_POSITIVE, i] + ratio[ix.TRACTION_CONSTANT, i]
        over = ratio[ix.TRACTION_OVER_SPEED, i]
        # f >= 0 and f <= 1 depend on f only, slope 0; L(v) - f >= 0 has the slope -L'
        limit_slope = -rows.by_speed[ix.TRACTION_OVER_SPEED, i]
        weight = fixed + over
        slope = over * limit_slope / weight
        remainder = fixed * over / weight * limit_slope * limit_slope
        # the cost need not be convex in effort and speed: only its positive part keeps the step a descent
        ff, fv, vv = curve[ix.DRIVING_FF, i], curve[ix.DRIVING_FV, i], curve[ix.DRIVING_VV, i]
        if not exact:
            ff, fv, vv = positive_part(ff, fv, vv)
        cells.traction_weight[i], cells.traction_slope[i], on_speed[i] = add_curvature(
            weight, slope, remainder, ff, fv, vv
        )
        fixed = ratio[ix.BRAKING_POSITIVE, i] + ratio[ix.BRAKING_CONSTANT, i]
        over = ratio[ix.BRAKING_OVER_SPEED, i]
        limit_slope = -rows.by_speed[ix.BRAKING_OVER_SPEED, i]
        weight = fixed + over
        slope = over * limit_slope
        remainder = fixed * over * limit_slope * limit_slope
        if rows.weight[ix.DRAWN, i] > 0.0:
            first, second = ratio[ix.DRAWN_POSITIVE, i], ratio[ix.DRAWN, i]
            # psi is eliminated first: at its least, first psi^2 + second (psi + g_x x + g_v v)^2 is two springs in
            # series, the product over the sum, on (g_x x + g_v v)^2
            both = first * second / (first + second)
            by_x, by_v = rows.by_effort[ix.DRAWN, i], rows.by_speed[ix.DRAWN, i]
            cells.drawn_by_effort[i] = second / (first + second) * by_x
            cells.drawn_by_speed[i] = second / (first + second) * by_v
            weight += both * by_x * by_x
            slope += both * by_x * by_v
            # pairs of (by_x, by_v) with (1, 0) and with (1, limit_slope)
            remainder += both * (fixed * by_v * by_v + over * (by_v - by_x * limit_slope) ** 2)
        slope /= weight
        remainder /= weight
        xx, xv, vv = curve[ix.BRAKING_XX, i], curve[ix.BRAKING_XV, i], curve[ix.BRAKING_VV, i]
        if not exact:
            xx, xv, vv = positive_part(xx, xv, vv)
        weight, slope, remainder = add_curvature(weight, slope, remainder, xx, xv, vv)
        cells.electric_weight[i], cells.braking_slope[i] = weight, slope
        cells.braking_weight[i] = weight
        if work.used[ix.FRICTION_POSITIVE] > 0.0:
            q = ratio[ix.FRICTION_POSITIVE, i] + ratio[ix.FRICTION_CONSTANT, i]
            cells.friction_weight[i] = q
            # x + q is given by f and D, so the brakes share it like springs in series, too
            cells.braking_weight[i] = weight * q / (weight + q)
        on_speed[i] += remainder + (curve[ix.PRICED_VV, i] if exact else max(curve[ix.PRICED_VV, i], 0.0))
    return on_speed


@njit(cache=True, error_model="numpy", fastmath=FAST)
def cell_block(
    c0: float, c1: float, effort: float, u0: float, u1: float, speed: float, change: float, start: float, end: float
) -> tuple[float, float, float, float]:
    """Return the block of two nodes, sum of rank-one terms, and its determinant: (m00, m01, m11, determinant).

    Parameters
    ----------
    c0, c1, effort : float
        Coupling of the two nodes and weight that the eliminated efforts leave.
    u0, u1, speed : float
        Derivatives of the mean speed by w0 and w1, and its weight.
    change : float
        Weight on (w1 - w0)^2.
    start, end : float
        Weights on the nodes themselves.
    """
    m00 = effort * c0 * c0 + speed * u0 * u0 + change + start
    m01 = effort * c0 * c1 + speed * u0 * u1 - change
    m11 = effort * c1 * c1 + speed * u1 * u1 + change + end
    # The block is a sum of a_k d_k d_k', with the directions c, u, (1, -1), (1, 0) and (0, 1). By Cauchy and Binet its
    # determinant is the sum over pairs k < l of a_k a_l (d_k x d_l)^2, all terms positive; m00 m11 - m01^2 would take
    # the difference of two numbers of 1e24 that agree in all digits where one limit of effort is active.
    across = c0 * u1 - c1 * u0
    determinant = effort * speed * across * across + start * end
    determinant += change * (effort * (c0 + c1) ** 2 + speed * (u0 + u1) ** 2 + start + end)
    determinant += start * (effort * c1 * c1 + speed * u1 * u1) + end * (effort * c0 * c0 + speed * u0 * u0)
    return m00, m01, m11, determinant


@njit(cache=True, error_model="numpy", fastmath=FAST)
def factor(work: Work, forced: bool, exact: bool) -> bool:
    """Eliminate efforts and nodes; fill pivots and ratios; return whether all pivots are positive.

    With `forced`, those that rounding has made negative change sign, and the factors can still be used. With `exact`,
    curvatures are taken as they are: pivots are then positive only where the whole problem is convex at the point.
    """
    cells, nodes, rows, curve = work.cells, work.nodes, work.rows, work.curvature
    z, s = rows.multiplier, rows.slack
    on_node = z[ix.FLOOR] / s[ix.FLOOR] + z[ix.CEILING] / s[ix.CEILING]
    on_speed = condense(work, exact)
    limits_change = work.used[ix.ACCELERATION] > 0.0 or work.used[ix.DECELERATION] > 0.0
    n = on_speed.shape[0]
    left = on_node[0]
    for i in range(n):
        u0, u1 = cells.speed_by_start[i], cells.speed_by_end[i]
        total = cells.traction_weight[i] + cells.braking_weight[i]
        if not total > 0.0 or (exact and not min(cells.traction_weight[i], cells.electric_weight[i]) > 0.0):
            return False
        # With y = df + s_f dv and db = df - dD, the model W_f (df + s_f dv)^2 + W_b (db + s_b dv)^2 reads
        # W_f y^2 + W_b (y - dD - (s_f - s_b) dv)^2: eliminating y leaves two springs in series on the coupling
        # c dw = dD + (s_f - s_b) dv.
        difference = cells.traction_slope[i] - cells.braking_slope[i]
        c0, c1 = cells.force_by_start[i] + difference * u0, cells.force_by_end[i] + difference * u1
        cells.coupling_start[i], cells.coupling_end[i] = c0, c1
        both = cells.traction_weight[i] * cells.braking_weight[i] / total
        # The mean speed is concave in w: a cost that falls with it curves these upwards, one that rises downwards. The
        # latter is left out, lest the step climb; whether the point is the best one is for the proof to say.
        change, start, end = 0.0, max(curve[ix.START_WW, i], 0.0), max(curve[ix.END_WW, i], 0.0)
        if exact:
            start, end = curve[ix.START_WW, i], curve[ix.END_WW, i]
        if limits_change:
            change = z[ix.ACCELERATION, i] / s[ix.ACCELERATION, i] + z[ix.DECELERATION, i] / s[ix.DECELERATION, i]
            change *= cells.inertia[i] * cells.inertia[i]
        m00, m01, m11, determinant = cell_block(c0, c1, both, u0, u1, on_speed[i], change, start, end)
        right = m11
        nodes.inverse_pivot[i] = nodes.ratio[i] = 0.0
        if nodes.free[i] > 0.0:
            pivot = left + m00
            if not pivot > 0.0:
                if not forced:
                    return False
                pivot = max(abs(pivot), 1e-8 * abs(m00) + 1e-300)
            nodes.inverse_pivot[i] = 1.0 / pivot
            if nodes.free[i + 1] > 0.0:
                nodes.ratio[i] = m01 / pivot
            # equals m11 - m01^2 / pivot, without the subtraction
            right = (determinant + m11 * left) / pivot
        left = right + on_node[i + 1]
    nodes.inverse_pivot[n] = 0.0
    if nodes.free[n] > 0.0:
        if not (left > 0.0 or forced):
            return False
        nodes.inverse_pivot[n] = 1.0 / max(abs(left), 1e-300)
    return True


@njit(cache=True, fastmath=FAST)
def back_substitute(nodes: Nodes, vector: FloatArray) -> None:
    """Solve the tridiagonal system in place for one right-hand side of shape (n + 1,)."""
    last = vector.shape[0] - 1
    for i in range(1, last + 1):
        vector[i] -= nodes.ratio[i - 1] * vector[i - 1]
    vector[last] *= nodes.inverse_pivot[last]
    for i in range(last - 1, -1, -1):
        vector[i] = vector[i] * nodes.inverse_pivot[i] - nodes.ratio[i] * vector[i + 1]


@njit(cache=True, error_model="numpy", fastmath=FAST)
def factor_with_fallback(work: Work, exact_first: bool) -> float:
    """Factor the system so that the step is a descent; return the time's weight in the rank-one term.

    Not a number where there are no factors, as where a weight is not a number.

    Parameters
    ----------
    work : Work
    exact_first : bool
        Whether the exact curvatures are tried before their positive parts. If a cost is bilinear in effort and speed,
        the positive part of a cell makes steps short that the rest of the problem would allow.
    """
    nodes = work.nodes
    exact = exact_first and factor(work, False, True)
    if not exact and not factor(work, False, False) and not factor(work, True, False):
        return np.nan
    nodes.time_response[:] = nodes.time_gradient * nodes.free
    back_substitute(nodes, nodes.time_response)
    return float(np.sum(nodes.time_gradient * nodes.time_response))
