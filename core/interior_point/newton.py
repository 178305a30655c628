"""Newton's step of the interior-point method: a tridiagonal system plus one rank-one term for the time.

Every cell is first condensed: what its constraints and its cost ask of traction and of braking is gathered, each
as a weight on (effort + slope * mean speed)^2, with a remainder on the mean speed; then the efforts are
eliminated, and the nodes one after another. Weights of constraints are combined without subtraction, the
remainder as a sum over pairs, W_k W_l / W (slope_k - slope_l)^2, and each pivot comes from the determinant of a
cell's block as a sum over pairs of rank-one terms: when several limits of a cell are active their weights reach
1e12, and a difference would lose all digits.
"""

import math

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.interior_point.layout import (
    ACCELERATION,
    BRAKING_CONSTANT,
    BRAKING_OVER_SPEED,
    BRAKING_POSITIVE,
    DECELERATION,
    DRAWN,
    DRAWN_POSITIVE,
    FAST,
    FRICTION_CONSTANT,
    FRICTION_POSITIVE,
    TRACTION_CONSTANT,
    TRACTION_OVER_SPEED,
    TRACTION_POSITIVE,
    Nodes,
    Work,
)


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
    share = high / (high - low)
    return share * (a - low), share * b, share * (c - low)


@njit(cache=True, error_model="numpy", fastmath=FAST)
def add_curvature(
    weight: float, slope: float, remainder: float, ff: float, fv: float, vv: float
) -> tuple[float, float, float]:
    """Add a curvature [[ff, fv], [fv, vv]] to weight (f + slope v)^2 + remainder v^2; return the new three."""
    total = weight + ff
    bent = fv - ff * slope
    return total, slope + bent / total, remainder + vv - 2.0 * fv * slope + ff * slope * slope - bent * bent / total


@njit(cache=True, error_model="numpy", fastmath=FAST)
def condense(work: Work) -> FloatArray:
    """Gather weights, slopes and remainders of all cells, with the positive part of each cell's curvature.

    Returns
    -------
    array of shape (n,)
        Weight on the mean speed squared in each cell.
    """
    rows, cells, curve = work.rows, work.cells, work.curvature
    z, s = rows.multiplier, rows.slack
    n = z.shape[1]
    on_speed = np.empty(n)
    for i in range(n):
        alone = z[TRACTION_POSITIVE, i] / s[TRACTION_POSITIVE, i] + z[TRACTION_CONSTANT, i] / s[TRACTION_CONSTANT, i]
        over = z[TRACTION_OVER_SPEED, i] / s[TRACTION_OVER_SPEED, i]
        lean = -rows.by_speed[TRACTION_OVER_SPEED, i]
        weight = alone + over
        slope = over * lean / weight
        # the pair of (1, 0) and (1, lean): as a difference of squares it would lose all digits
        remainder = alone * over / weight * lean * lean
        ff, fv, vv = curve[0, i], curve[1, i], curve[2, i]
        bb, bv, braking_vv, mean = curve[3, i], curve[4, i], curve[5, i], curve[6, i]
        ff, fv, vv = positive_part(ff, fv, vv)
        bb, bv, braking_vv = positive_part(bb, bv, braking_vv)
        mean = max(mean, 0.0)
        cells.traction_weight[i], cells.traction_slope[i], speed = add_curvature(weight, slope, remainder, ff, fv, vv)
        alone = z[BRAKING_POSITIVE, i] / s[BRAKING_POSITIVE, i] + z[BRAKING_CONSTANT, i] / s[BRAKING_CONSTANT, i]
        over = z[BRAKING_OVER_SPEED, i] / s[BRAKING_OVER_SPEED, i]
        lean = -rows.by_speed[BRAKING_OVER_SPEED, i]
        weight = alone + over
        slope = over * lean
        remainder = alone * over * lean * lean
        if work.used[DRAWN] > 0.0:
            first = z[DRAWN_POSITIVE, i] / s[DRAWN_POSITIVE, i]
            second = z[DRAWN, i] / s[DRAWN, i]
            # psi is eliminated first: two springs in series
            both = first * second / (first + second)
            by_x, by_v = rows.by_effort[DRAWN, i], rows.by_speed[DRAWN, i]
            cells.drawn_by_effort[i] = second / (first + second) * by_x
            cells.drawn_by_speed[i] = second / (first + second) * by_v
            weight += both * by_x * by_x
            slope += both * by_x * by_v
            remainder += both * (alone * by_v * by_v + over * (by_v - by_x * lean) ** 2)
        slope /= weight
        remainder /= weight
        weight, slope, remainder = add_curvature(weight, slope, remainder, bb, bv, braking_vv)
        cells.electric_weight[i], cells.braking_slope[i] = weight, slope
        cells.braking_weight[i] = weight
        if work.used[FRICTION_POSITIVE] > 0.0:
            q = z[FRICTION_POSITIVE, i] / s[FRICTION_POSITIVE, i] + z[FRICTION_CONSTANT, i] / s[FRICTION_CONSTANT, i]
            cells.friction_weight[i] = q
            # the brakes share an effort like springs in series, too
            cells.braking_weight[i] = weight * q / (weight + q)
        on_speed[i] = speed + remainder + mean
    return on_speed


@njit(cache=True, error_model="numpy", fastmath=FAST)
def cell_block(
    lean0: float, lean1: float, both: float, u0: float, u1: float, speed: float, rise: float, start: float, end: float
) -> tuple[float, float, float, float]:
    """Return the block of two nodes, sum of rank-one terms, and its determinant: (m00, m01, m11, determinant).

    Parameters
    ----------
    lean0, lean1, both : float
        Direction and weight that the eliminated efforts leave.
    u0, u1, speed : float
        Direction and weight of the mean speed.
    rise : float
        Weight on (w1 - w0)^2.
    start, end : float
        Weights on the nodes themselves.
    """
    m00 = both * lean0 * lean0 + speed * u0 * u0 + rise + start
    m01 = both * lean0 * lean1 + speed * u0 * u1 - rise
    m11 = both * lean1 * lean1 + speed * u1 * u1 + rise + end
    across = lean0 * u1 - lean1 * u0
    determinant = both * speed * across * across + start * end
    determinant += rise * (both * (lean0 + lean1) ** 2 + speed * (u0 + u1) ** 2 + start + end)
    determinant += start * (both * lean1 * lean1 + speed * u1 * u1) + end * (both * lean0 * lean0 + speed * u0 * u0)
    return m00, m01, m11, determinant


@njit(cache=True, error_model="numpy", fastmath=FAST)
def factor(work: Work, forced: bool) -> bool:
    """Eliminate efforts and nodes; fill pivots and ratios; return whether all pivots are positive.

    With `forced`, those that rounding has made negative are turned round, and the factors are of use all the same.
    """
    cells, nodes, rows, curve = work.cells, work.nodes, work.rows, work.curvature
    on_node = work.bounds.multiplier[0] / work.bounds.slack[0] + work.bounds.multiplier[1] / work.bounds.slack[1]
    on_speed = condense(work)
    limited_rise = work.used[ACCELERATION] > 0.0 or work.used[DECELERATION] > 0.0
    n = on_speed.shape[0]
    left = on_node[0]
    for i in range(n):
        u0, u1 = cells.speed_by_start[i], cells.speed_by_end[i]
        total = cells.traction_weight[i] + cells.braking_weight[i]
        if not total > 0.0:
            return False
        apart = cells.traction_slope[i] - cells.braking_slope[i]
        lean0, lean1 = cells.force_by_start[i] + apart * u0, cells.force_by_end[i] + apart * u1
        cells.lean_start[i], cells.lean_end[i] = lean0, lean1
        both = cells.traction_weight[i] * cells.braking_weight[i] / total
        # falling with the mean speed bends these the right way; rising is left to the proof
        rise, start, end = 0.0, max(curve[7, i], 0.0), max(curve[8, i], 0.0)
        if limited_rise:
            rise = rows.multiplier[ACCELERATION, i] / rows.slack[ACCELERATION, i]
            rise += rows.multiplier[DECELERATION, i] / rows.slack[DECELERATION, i]
            rise *= cells.rise_factor[i] * cells.rise_factor[i]
        m00, m01, m11, determinant = cell_block(lean0, lean1, both, u0, u1, on_speed[i], rise, start, end)
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
def factor_with_fallback(work: Work) -> float:
    """Factor the system so that the step goes downhill; return the time's weight in the rank-one term.

    Not a number where no factors can be had, as where a weight is none.
    """
    nodes = work.nodes
    if not factor(work, False) and not factor(work, True):
        return np.nan
    nodes.time_response[:] = nodes.time_gradient * nodes.free
    back_substitute(nodes, nodes.time_response)
    return np.sum(nodes.time_gradient * nodes.time_response)
