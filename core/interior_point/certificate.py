"""A lower bound of the energy of every run on the mesh, from the multipliers of one point.

Dual function: for any price of time lambda >= 0 and any node prices p,

    E >= sum over cells of min [cost + lambda h / v + p_start w0 - p_end w1] + p_n w_n - p_0 w_0 - lambda T,

as every node may be doubled and its copies priced. Within a cell the limits over speed and the net force are
priced too, costs are replaced by a tangent plane (they are convex in effort and speed), and efforts are left to
their constant limits. What remains is a function of the two speeds alone, whose global minimum over a box is known
in closed form (`box`). The bound holds for any multipliers, converged or not.

Where a cell is lowest elsewhere than at the point, the sum of minima is too low. Then the speeds of the nodes are
cut into intervals, the best chain of intervals is found by dynamic programming, and every interval through which
no better run can pass is dropped, until none is left: that proves the point. Forces that a pair of intervals
needs are charged, or forbid it.
"""

import math

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.drive.kernels import driving_power, generated_power, work_bounds
from railjoule.core.interior_point.box import box_minimum
from railjoule.core.interior_point.layout import (
    ACCELERATION,
    BRAKING_OVER_SPEED,
    DECELERATION,
    DRAWN,
    TRACTION_OVER_SPEED,
)
from railjoule.core.interior_point.solver import Optimum
from railjoule.core.physics.cell import Cell, duration, force_slopes, mean_speed, mean_speed_slope, needed_force
from railjoule.core.physics.course_data import CourseData, cell_of
from railjoule.core.physics.effort_limit import (
    TABLE_STEP_MS,
    EffortLimit,
    limit_over_speed,
    piece_at,
    supplied_effort,
)
from railjoule.core.physics.energy_per_metre import energy_per_metre
from railjoule.core.physics.resistance import running_resistance

NOISE = 1e-6
"""Multipliers below this share of the cell's length are taken for zero."""
FORCE_ROUNDING = 1e-6
"""A box whose least force exceeds the largest effort by more than this share of it holds no run."""
LARGEST_RAISE = 1e-3
"""The price of time is raised by at most this share to pay for limits over speed."""
LOOSE = 1e-10
"""A cell is loose if its minimum lies lower than the point by this share of the energy."""


(
    CONSTANT,
    START,
    END,
    TIME,
    POWER,
    BY_SPEED,
    MEAN_SPEED,
    BY_TRACTION,
    BY_BRAKING,
    BY_FRICTION,
    OVER_TRACTION,
    OVER_BRAKING,
    TOP_TRACTION,
    TOP_BRAKING,
    TOP_FRICTION,
    MOTION,
) = range(16)
"""Columns of a priced cell: it is CONSTANT + START w0 + END w1 + (TIME - POWER) / v + BY_SPEED v [J], less what limits
over speed cost that are tables, plus what efforts cost beyond the price of the net force. From MOTION on stands what
that force depends on, and the supply, as in `physics.cell.Cell`."""
COLUMNS = MOTION + 6


@njit(cache=True, error_model="numpy")
def usable_prices(course: CourseData, optimum: Optimum) -> tuple[float, FloatArray]:
    """Return the price of time [J/s] and the prices of limits over speed [J/N], noise taken out.

    A limit's price may exceed what the time in its cell is worth; where that is little, time becomes dearer.
    """
    h, z = course.cell_length_m, optimum.multiplier
    auxiliaries = course.auxiliary_power_w
    over = np.empty((2, h.shape[0]))
    needed = 0.0
    for i in range(h.shape[0]):
        over[0, i], over[1, i] = z[TRACTION_OVER_SPEED, i], z[BRAKING_OVER_SPEED, i]
        for side in range(2):
            if over[side, i] < NOISE * h[i]:
                over[side, i] = 0.0
        needed = max(needed, _power_price(course, over, i) / h[i])
    price = optimum.price_of_time_w
    if price + auxiliaries < needed < (price + auxiliaries) * (1.0 + LARGEST_RAISE):
        price = needed * (1.0 + 1e-12) - auxiliaries
    return price, over


@njit(cache=True)
def _power_price(course: CourseData, over_speed: FloatArray, i: int) -> float:
    """Return what the limits that are hyperbolas of speed cost in a cell, times its mean speed [W m]."""
    price = 0.0
    if over_speed[0, i] > 0.0 and course.traction.table.shape[0] == 0:
        price += over_speed[0, i] * course.traction.power_w
    if over_speed[1, i] > 0.0 and course.braking.table.shape[0] == 0:
        price += over_speed[1, i] * course.braking.power_w
    return price


@njit(cache=True, error_model="numpy")
def energy_tangents(course: CourseData, optimum: Optimum) -> FloatArray:
    """Return the tangent planes of the cells' line energies: rows constant, by traction, by braking, by mean speed.

    Of the two rates at which a braking drive exchanges energy with the line, the mixture that the multipliers tell
    is taken: it lies below both.
    """
    h, w = course.cell_length_m, optimum.speed2
    tangents = np.empty((4, h.shape[0]))
    for i in range(h.shape[0]):
        v = mean_speed(math.sqrt(w[i]), math.sqrt(w[i + 1]))
        f, x = max(optimum.traction_n[i], 0.0), max(optimum.braking_n[i], 0.0)
        power = driving_power(course.drive_kind, course.drive_parameters, f, v)
        e, e_f, e_v, _, _, _ = energy_per_metre(power, v)
        power = generated_power(course.drive_kind, course.drive_parameters, x, v)
        g, g_x, g_v, _, _, _ = energy_per_metre(power, v)
        share = returned_share(course.recuperation_factor, optimum.multiplier[DRAWN, i] / h[i])
        tangents[0, i] = h[i] * (e - e_f * f - e_v * v - share * (g - g_x * x - g_v * v))
        tangents[1, i] = h[i] * e_f
        tangents[2, i] = -h[i] * share * g_x
        tangents[3, i] = h[i] * (e_v - share * g_v)
    return tangents


@njit(cache=True)
def returned_share(recuperation_factor: float, drawn_price: float) -> float:
    """Return at which rate generated energy counts in a bound: between the recuperation factor and 1.

    `line_power` is the larger of the two, so any mixture is a lower bound; the multiplier of drawing, over the cell's
    length, names the one that is exact at the point.
    """
    return recuperation_factor + min(max(drawn_price, 0.0), 1.0 - recuperation_factor)


@njit(cache=True, error_model="numpy")
def node_prices(
    course: CourseData, optimum: Optimum, price_of_time: float, over_speed: FloatArray, tangents: FloatArray
) -> FloatArray:
    """Return the price of speed squared at each node, the mean of what its two cells say; shape (n + 1,).

    What a cell says is the derivative of its Lagrangian by the square of speed at that node: the price of the net force
    times its derivative, what the limits of acceleration are worth, and all that varies with the mean speed - priced
    time, the energy's tangent, limits over speed - times the derivative of that.
    """
    # Of a cell with node prices p0 and p1, what depends on w is nu D(w0, w1) + rise (w1 - w0) + B(v) + p0 w0 - p1 w1,
    # where nu is the price of the net force D, and B' = by_speed. It is stationary at the point if
    #     p0 = rise - nu dD/dw0 - B' dv/dw0    and    p1 = rise + nu dD/dw1 + B' dv/dw1,
    # as `right` of its first node and `left` of its second one have it; any other prices prove less, none too much.
    h, w, z = course.cell_length_m, optimum.speed2, optimum.multiplier
    n = h.shape[0]
    left, right = np.zeros(n + 1), np.zeros(n + 1)
    traction, braking = course.traction, course.braking
    for i in range(n):
        v0, v1 = math.sqrt(w[i]), math.sqrt(w[i + 1])
        v, cell = mean_speed(v0, v1), cell_of(course, i)
        u0 = mean_speed_slope(v0) if v0 > 0.0 else 0.0
        u1 = mean_speed_slope(v1) if v1 > 0.0 else 0.0
        by_start, by_end = force_slopes(cell, u0, u1)
        force = optimum.force_price[i]
        rise = (z[ACCELERATION, i] - z[DECELERATION, i]) * cell.inertia
        by_speed = tangents[3, i] - price_of_time * duration(h[i], v) / v
        if over_speed[0, i] > 0.0:
            by_speed -= over_speed[0, i] * limit_over_speed(traction, v)[1]
        if over_speed[1, i] > 0.0:
            by_speed -= over_speed[1, i] * limit_over_speed(braking, v)[1]
        right[i] = rise - force * by_start - by_speed * u0
        left[i + 1] = rise + force * by_end + by_speed * u1
    # at an active limit of speed they differ by its multiplier: the middle leaves both cells above their minimum
    prices = 0.5 * (left + right)
    prices[0], prices[n] = right[0], left[n]
    return prices


@njit(cache=True, error_model="numpy")
def price_cells(course: CourseData, optimum: Optimum) -> tuple[FloatArray, float, float]:
    """Return the priced cells of a point, shape (n, COLUMNS), the sum of its end prices, and the price of time."""
    h, w, z = course.cell_length_m, optimum.speed2, optimum.multiplier
    n = h.shape[0]
    time, over = usable_prices(course, optimum)
    price_of_time = time + course.auxiliary_power_w
    tangents = energy_tangents(course, optimum)
    node = node_prices(course, optimum, price_of_time, over, tangents)
    cells = np.zeros((n, COLUMNS))
    inertia = 2.0 * course.half_inertia_kg
    top_traction, top_braking = course.traction.constant_n, course.braking.constant_n
    for i in range(n):
        c, cell = cells[i], cell_of(course, i)
        force = optimum.force_price[i]
        rise = (z[ACCELERATION, i] - z[DECELERATION, i]) * cell.inertia
        for column in range(6):
            c[MOTION + column] = cell[column]
        by_start, by_end = force_slopes(cell, 0.0, 0.0)
        c[CONSTANT] = tangents[0, i] + force * cell.constant_n
        for row, limit in ((ACCELERATION, course.max_acceleration_ms2), (DECELERATION, course.max_deceleration_ms2)):
            if z[row, i] > 0.0:
                c[CONSTANT] -= z[row, i] * inertia * limit
        c[START] = node[i] + force * by_start - rise
        c[END] = force * by_end + rise - node[i + 1]
        c[TIME], c[POWER] = price_of_time * h[i], _power_price(course, over, i)
        c[BY_SPEED] = tangents[3, i] + force * cell.linear
        c[MEAN_SPEED] = mean_speed(math.sqrt(w[i]), math.sqrt(w[i + 1]))
        c[BY_TRACTION], c[BY_BRAKING], c[BY_FRICTION] = tangents[1, i] - force, tangents[2, i] + force, force
        c[OVER_TRACTION], c[OVER_BRAKING] = over[0, i], over[1, i]
        c[TOP_TRACTION], c[TOP_BRAKING] = cell.powered * top_traction, cell.powered * top_braking
        c[TOP_FRICTION] = course.friction_effort_n
    return cells, node[n] * w[n] - node[0] * w[0], time


@njit(cache=True)
def _largest_excess(c: FloatArray, x0: float, x1: float, value: float, slope: float) -> float:
    """Return an upper bound of a cubic piece less the line of a value and slope at x0, over [x0, x1]."""
    first = ((c[4] * x0 + c[3]) * x0 + c[2]) * x0 + c[1] - value
    last = ((c[4] * x1 + c[3]) * x1 + c[2]) * x1 + c[1] - value - slope * (x1 - x0)
    third = (x1 - x0) / 3.0
    second = first + third * ((3.0 * c[4] * x0 + 2.0 * c[3]) * x0 + c[2] - slope)
    before_last = last - third * ((3.0 * c[4] * x1 + 2.0 * c[3]) * x1 + c[2] - slope)
    # a cubic lies below the highest of its Bezier points
    highest: float = max(first, second, before_last, last)
    return highest


@njit(cache=True)
def table_majorant(limit: EffortLimit, v: float, low: float, high: float) -> tuple[float, float, float]:
    """Return (value, slope, half curvature) at `v` of a parabola that lies above a table's limit on [low, high].

    It touches the table at `v`, which lies in [low, high], unless a parabola a little higher there is much flatter:
    near a kink the table is strongly curved over a very short way.
    """
    # A piece that holds v or touches it asks for a curvature, one further away for an excess over the tangent, which
    # the parabola must have reached there.
    value, slope, half = limit_over_speed(limit, v)
    beside, lift, beyond = 0.5 * half, 0.0, 0.0
    first, last = piece_at(limit, low), piece_at(limit, high)
    for piece in range(first, last + 1):
        c = limit.table[piece]
        start = low if piece == first else c[0]
        end = high if piece == last else limit.table[piece + 1, 0]
        x0, x1 = start - c[0], end - c[0]
        excess = _largest_excess(c, x0, x1, value + slope * (start - v), slope)
        if start - TABLE_STEP_MS <= v <= end + TABLE_STEP_MS:
            beside = max(beside, c[3] + 3.0 * c[4] * x0, c[3] + 3.0 * c[4] * x1)
            lift = max(lift, excess)
        elif excess > 0.0:
            beyond = max(beyond, excess / min((start - v) ** 2, (end - v) ** 2))
    reach = max(v - low, high - v) ** 2
    if lift + beyond * reach < max(beside, beyond) * reach:
        return value + lift, slope, beyond
    return value, slope, max(beside, beyond)


@njit(cache=True, error_model="numpy")
def cell_minimum(
    cell: FloatArray,
    traction: EffortLimit,
    braking: EffortLimit,
    low0: float,
    high0: float,
    low1: float,
    high1: float,
) -> float:
    """Return a lower bound of a priced cell over a box of its two speeds, exact but for the force it needs.

    Infinite if no force fits. The force that the box needs at least is charged, at constant limits of effort. If
    limits over speed cost more than the time is worth, standing still would gain without end: then the better of
    two bounds is taken, with those prices as they are or lowered until they do not.

    Parameters
    ----------
    cell : array of shape (COLUMNS,)
    traction, braking : EffortLimit
    low0, high0, low1, high1 : float
        The box: speeds at start and end [m/s].
    """
    motion = Cell(
        cell[MOTION], cell[MOTION + 1], cell[MOTION + 2], cell[MOTION + 3], cell[MOTION + 4], cell[MOTION + 5]
    )
    slow, fast = mean_speed(low0, low1), mean_speed(high0, high1)
    # the force falls with the speed at the start and rises with that at the end and with the mean one
    least = needed_force(motion, high0 * high0, low1 * low1, slow)
    most = needed_force(motion, low0 * low0, high1 * high1, fast)
    # of the largest effort anywhere: where there is none, a point still has what its solver leaves
    strongest, rounding = cell[TOP_TRACTION], FORCE_ROUNDING * traction.constant_n
    if traction.table.shape[0] == 0 and slow > 0.0:
        strongest = supplied_effort(traction, motion.powered, slow)
    if least > strongest + rounding or -most > cell[TOP_BRAKING] + cell[TOP_FRICTION] + rounding:
        return np.inf
    most = min(most, strongest)
    share = 1.0
    if cell[POWER] > cell[TIME]:
        share = cell[TIME] / cell[POWER]
    best = _priced_minimum(cell, traction, braking, share, least, most, low0, high0, low1, high1)
    if share < 1.0:
        best = max(best, _priced_minimum(cell, traction, braking, 0.0, least, most, low0, high0, low1, high1))
        if slow > 0.0:
            best = max(best, _priced_minimum(cell, traction, braking, 1.0, least, most, low0, high0, low1, high1))
    return best


@njit(cache=True)
def effort_minimum(
    by_traction: float, by_braking: float, top_traction: float, top_braking: float, least: float, most: float
) -> float:
    """Return the least cost of efforts f, b >= 0 with a difference in [least, most], each up to its largest [N]."""
    if by_traction + by_braking < 0.0:
        return min(by_traction, 0.0) * top_traction + min(by_braking, 0.0) * top_braking
    by_f = by_traction * (max(least, 0.0) if by_traction > 0.0 else min(max(most, 0.0), top_traction))
    by_b = by_braking * (max(-most, 0.0) if by_braking > 0.0 else min(max(-least, 0.0), top_braking))
    return by_f + by_b


@njit(cache=True, error_model="numpy")
def _priced_minimum(
    cell: FloatArray,
    traction: EffortLimit,
    braking: EffortLimit,
    share: float,
    least: float,
    most: float,
    low0: float,
    high0: float,
    low1: float,
    high1: float,
) -> float:
    """Return the minimum of a cell with a `share` of the prices of limits over speed and a force in [least, most]."""
    by_traction = cell[BY_TRACTION] + share * cell[OVER_TRACTION]
    by_braking = cell[BY_BRAKING] + share * cell[OVER_BRAKING]
    constant, top_braking = cell[CONSTANT], cell[TOP_BRAKING]
    if cell[TOP_FRICTION] > 0.0:
        constant += min(by_braking, 0.0) * top_braking + min(cell[BY_FRICTION], 0.0) * cell[TOP_FRICTION]
        by_braking, top_braking = max(min(by_braking, cell[BY_FRICTION]), 0.0), 0.0
    constant += effort_minimum(by_traction, by_braking, cell[TOP_TRACTION], top_braking, least, most)
    beta, gamma = cell[BY_SPEED], 0.0
    low, high = 0.5 * (low0 + low1), 0.5 * (high0 + high1)
    v = min(max(cell[MEAN_SPEED], low), high)
    if cell[OVER_TRACTION] > 0.0 and traction.table.shape[0] > 0:
        price = share * cell[OVER_TRACTION]
        value, slope, half = table_majorant(traction, v, low, high)
        constant -= price * (value - slope * v + half * v * v)
        beta -= price * (slope - 2.0 * half * v)
        gamma -= price * half
    if cell[OVER_BRAKING] > 0.0 and braking.table.shape[0] > 0:
        price = share * cell[OVER_BRAKING]
        value, slope, half = table_majorant(braking, v, low, high)
        constant -= price * (value - slope * v + half * v * v)
        beta -= price * (slope - 2.0 * half * v)
        gamma -= price * half
    kappa = cell[TIME] - share * cell[POWER]
    if share < 1.0:
        kappa = max(kappa, 0.0)
    minimum: float = constant + box_minimum(cell[START], cell[END], kappa, beta, gamma, low0, high0, low1, high1)
    return minimum


@njit(cache=True, error_model="numpy")
def tangent_minimum(
    cell: FloatArray, v0: float, v1: float, low0: float, high0: float, low1: float, high1: float
) -> tuple[float, float]:
    """Return a priced cell's value at speeds v0, v1 and a lower bound over a box, by its tangent plane there.

    The bound is minus infinity unless the cell is convex in the squares of speed over the whole box, which it is if
    it falls with the mean speed: kappa >= 0 and kappa >= beta v^2 at the greatest one. Tables do not count here.
    """
    kappa, beta = cell[TIME] - cell[POWER], cell[BY_SPEED]
    v = 0.5 * (v0 + v1)
    top = 0.5 * (high0 + high1)
    value = cell[CONSTANT] + cell[START] * v0 * v0 + cell[END] * v1 * v1 + kappa / v + beta * v
    value += min(cell[BY_TRACTION] + cell[OVER_TRACTION], 0.0) * cell[TOP_TRACTION]
    value += min(cell[BY_BRAKING] + cell[OVER_BRAKING], 0.0) * cell[TOP_BRAKING]
    value += min(cell[BY_FRICTION], 0.0) * cell[TOP_FRICTION]
    # All but G(v) = kappa / v + beta v is linear in w. The Hessian of G(v(w)) is G'' v_w v_w' + G' v_ww with v_ww <= 0,
    # as the mean speed is concave: positive if G'' = 2 kappa / v^3 >= 0 and G' = beta - kappa / v^2 <= 0 over the whole
    # box, which its greatest v decides. A convex function lies above its tangent plane.
    if kappa < 0.0 or kappa < beta * top * top:
        return value, -np.inf
    slope = 0.25 * (beta - kappa / (v * v))
    bound = value
    if high0 > low0:
        by_start = cell[START] + slope / v0
        bound += min(by_start * (high0 * high0 - v0 * v0), by_start * (low0 * low0 - v0 * v0), 0.0)
    if high1 > low1:
        by_end = cell[END] + slope / v1
        bound += min(by_end * (high1 * high1 - v1 * v1), by_end * (low1 * low1 - v1 * v1), 0.0)
    return value, bound


@njit(cache=True, error_model="numpy")
def fastest_of_better_runs(
    course: CourseData, optimum: Optimum, fastest: FloatArray, running_time: float
) -> FloatArray:
    """Return the greatest speeds [m/s] of any run that needs no more energy than the point; shape (n + 1,).

    What a train has in speed at a node it has drawn before and gives back at most in part.
    """
    # No drive takes less than `drawn` per work at the wheels, nor returns more than `returned` per work of braking, and
    # drawn >= returned: so energy >= drawn * work and energy >= returned * work both hold for any work of either sign.
    # With the first up to node i and the second after it,
    #     E >= drawn (before + half (w_i - w_0)) + returned (after + half (w_n - w_i)),
    # which bounds w_i by an energy E that a better run must not exceed.
    h, w = course.cell_length_m, optimum.speed2
    n = h.shape[0]
    drawn, returned = work_bounds(course.drive_kind, course.drive_parameters)
    returned *= course.recuperation_factor
    speeds = np.sqrt(fastest)
    if drawn <= returned * (1.0 + 1e-9):
        return speeds
    half = course.half_inertia_kg
    work = h * (course.resistance_constant_n + course.line_force_n)
    length = h.sum()
    mean = length / running_time
    # the resistance that varies with speed is convex in it: over a time and a length, it costs least at one speed
    drag = running_resistance(0.0, course.resistance_linear, course.resistance_quadratic.min(), mean, mean * mean)
    energy = optimum.energy_j - returned * drag * length
    before, after = 0.0, work.sum()
    for i in range(n + 1):
        left = energy - drawn * (before - half * w[0]) - returned * (after + half * w[n])
        most = left / ((drawn - returned) * half)
        speeds[i] = min(speeds[i], math.sqrt(max(most, w[i])))
        if i < n:
            before += work[i]
            after -= work[i]
    return speeds
