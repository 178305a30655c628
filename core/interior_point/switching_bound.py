"""A lower bound for drives whose power jumps at zero effort, of all runs that may switch them at will.

As in `certificate`, nodes are doubled and priced, and so is the net force of a cell. Then the least that efforts can
cost in a cell is a function of its mean speed v alone, and what remains is

    a0 v0^2 + a1 v1^2 + kappa / v + beta v + h gamma(v),    gamma(v) = min(0, min_f [p(f, v) / v - price f]) + braking.

A cell may share its time between driving, coasting, electric braking and a standstill brake, each within its limits: at
given prices its cost is linear in the shares, so that no mixture costs less than the cheapest of these modes.

Two properties of a drive that is on make this provable piece by piece: its power is convex in the effort, so that the
inner minimum has a tangent as its bound, and with the work of the shaft taken off, its losses do not fall with speed.
With losses as at the slower end of a piece, and the greatest limits of effort anywhere in it, gamma is the least of
functions that are linear in 1 / v, hence lies above its chord over 1 / v. Pieces are halved until they are good enough.
"""

import math

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.drive.kernels import power_when_on, shaft_force, work_bounds
from railjoule.core.interior_point.certificate import node_prices, returned_share
from railjoule.core.interior_point.layout import (
    ACCELERATION,
    BRAKING_OVER_SPEED,
    DECELERATION,
    DRAWN,
    ENVELOPE_EFFORTS,
    RAY_COUNT,
    TRACTION_OVER_SPEED,
)
from railjoule.core.interior_point.solver import Optimum
from railjoule.core.interior_point.start import SLOWEST_SPEED2
from railjoule.core.interior_point.switching import switched_powers, tabulate_hulls
from railjoule.core.physics.cell import force_slopes, mean_speed
from railjoule.core.physics.course_data import CourseData, cell_of
from railjoule.core.physics.effort_limit import EffortLimit, greatest_effort, largest_effort
from railjoule.core.physics.energy_per_metre import energy_per_metre
from railjoule.core.physics.reference import reference_energy

NARROWEST_SHARE = 1e-9
# A chord over 1 / v misses by the square of its width, and what it misses counts most where the cell is lowest: so the
# first pieces narrow towards that speed, and most cells need no halving.
FIRST_WIDTHS = (0.5, 0.25, 0.1, 0.04, 0.015)
"""Edges of the first pieces, as shares of the speed at which the least is expected."""
PRECISION = 0.1
"""How much of the tolerance the search for the cheapest effort may use up."""
STEPS = 60
EXACT = 1e-9
FIRST_EFFORT = 0.3
"""Share of the largest effort to begin with, where the neighbouring piece tells none."""

START, END, CONSTANT, TIME, BY_SPEED, PRICE, RETURNED, LENGTH, TOP_TRACTION, TOP_BRAKING = range(10)
"""What a priced cell is [J]: START w0 + END w1 + CONSTANT + TIME / v + BY_SPEED v, and over its LENGTH [m] efforts
at a PRICE per metre, up to TOP_TRACTION and TOP_BRAKING [N]; RETURNED is the share of generated energy that counts."""
COLUMNS = 10


@njit(cache=True, error_model="numpy")
def cheapest_effort(
    course: CourseData,
    braking: bool,
    share: float,
    price: float,
    loss_speed: float,
    speed: float,
    most: float,
    first: float,
    precision: float,
) -> tuple[float, float]:
    """Return a lower bound of energy per metre less a price times effort [N], at most 0, and the effort [N].

    Parameters
    ----------
    course : CourseData
        The drive.
    braking : bool
        Whether it brakes; then a `share` of what it generates counts, and the price is what braking costs.
    share, price : float
        Weight of the energy, and energy per work that an effort is worth.
    loss_speed, speed : float
        The losses are those at the first speed, the way is made at the second [m/s].
    most, first : float
        Largest effort, and where to begin [N].
    precision : float
        How far the bound may lie below the least [N].
    """
    # Convex in the effort y: the least lies between a point with a falling and one with a rising tangent, and not below
    # where these two meet. Newton's step finds the next point, halving the interval where it leaves it.
    kind, parameters = course.drive_kind, course.drive_parameters
    worth = -price if braking else price
    drawn, returned = work_bounds(kind, parameters)
    if share <= 0.0:
        return min(0.0, -worth * most), first
    # less than the least that any effort costs per work: none is worth it
    if worth <= (-share * returned if braking else drawn):
        return 0.0, first
    low, high, reach = 0.0, most, most
    value_low, slope_low = -math.inf, -math.inf
    value_high, slope_high = math.inf, math.inf
    y = first if 0.0 < first < most else FIRST_EFFORT * most
    least = -math.inf
    for _ in range(STEPS):
        p, p_f, _, p_ff, _, _ = power_when_on(kind, parameters, braking, y, loss_speed)
        work, work_f = shaft_force(kind, parameters, braking, y)
        value = share * (work + (p - work * loss_speed) / speed) - worth * y
        slope = share * (work_f + (p_f - work_f * loss_speed) / speed) - worth
        if slope >= 0.0:
            high = reach = y
            value_high, slope_high = value, slope
        elif slope >= slope_low:
            low, value_low, slope_low = y, value, slope
        else:
            # beyond the pull-out torque power is no longer convex: the tangent from below goes on
            reach = y
        # by convexity no effort is cheaper than where the tangents meet
        if slope_high == math.inf:
            least = value_low + slope_low * (most - low)
        elif slope_low == -math.inf:
            least = value_high - slope_high * high
        else:
            meet = (value_low - value_high + slope_high * high - slope_low * low) / (slope_high - slope_low)
            least = value_low + slope_low * (min(max(meet, low), high) - low)
        if least >= 0.0 or min(value_low if slope_low > -math.inf else math.inf, value_high) - least <= precision:
            break
        if reach - low <= EXACT * most:
            break
        step = y - slope * speed / (share * p_ff) if p_ff > 0.0 and reach == high else -1.0
        if slope < 0.0 and step >= reach and value_high == math.inf:
            step = 0.1 * low + 0.9 * reach
        if not low < step < reach:
            step = 0.5 * (low + reach)
        y = step
    return min(0.0, least), y


@njit(cache=True, error_model="numpy")
def effort_value(
    course: CourseData,
    cell: FloatArray,
    cheapest: FloatArray,
    slow: float,
    fast: float,
    speed: float,
    precision: float,
) -> float:
    """Return what the cheapest efforts of a cell add to it [J], with the least losses and greatest limits of a piece.

    Parameters
    ----------
    course : CourseData
    cell : array of shape (COLUMNS,)
    cheapest : array of shape (2,)
        The cheapest efforts found last [N]; brought up to date.
    slow, fast : float
        Ends of a piece: the losses are those at the slower one, the limits the greatest anywhere between them [m/s].
    speed : float
        At which the way is made [m/s].
    precision : float
        How far it may lie below the least [J].
    """
    price, share = cell[PRICE], cell[RETURNED]
    precision /= cell[LENGTH]
    most = min(greatest_effort(course.traction, slow, fast), cell[TOP_TRACTION])
    total, cheapest[0] = cheapest_effort(course, False, 1.0, price, slow, speed, most, cheapest[0], precision)
    most = min(greatest_effort(course.braking, slow, fast), cell[TOP_BRAKING])
    braking, cheapest[1] = cheapest_effort(course, True, share, price, slow, speed, most, cheapest[1], precision)
    # A standstill brake does it without power. Here every drive may: so what one would draw to brake never counts, and
    # only where it generates must its losses not fall with speed
    total += min(braking, price * most) + min(price, 0.0) * course.friction_effort_n
    value: float = cell[LENGTH] * total
    return value


@njit(cache=True, error_model="numpy")
def _rises(limit: EffortLimit, slow: float, fast: float) -> bool:
    """Return whether a limit may be greater anywhere between two speeds [m/s] than at the slower one."""
    return greatest_effort(limit, slow, fast) > largest_effort(limit, slow)


@njit(cache=True, error_model="numpy")
def piece_bound(
    cell: FloatArray, box: tuple[float, float, float, float], low: float, high: float, first: float, last: float
) -> tuple[float, float]:
    """Return a lower bound of a priced cell over mean speeds from `low` to `high` [m/s], and its value at `low`.

    Parameters
    ----------
    cell : array of shape (COLUMNS,)
    box : tuple
        Least and greatest speed at its start, then at its end [m/s].
    low, high : float
    first, last : float
        What efforts add at `low` and, with losses as there, at `high`, within the greatest limits between both.
    """
    # the chord over 1 / v
    by_inverse = (first - last) / (1.0 / low - 1.0 / high)
    constant = cell[CONSTANT] + first - by_inverse / low
    kappa, beta = cell[TIME] + by_inverse, cell[BY_SPEED]
    here = cell[CONSTANT] + first + cell[TIME] / low + beta * low
    a0, a1 = cell[START], cell[END]
    low0, high0, low1, high1 = box
    if a0 > 0.0 and a1 > 0.0 and low0 < high0 and low1 < high1:
        # Of all pairs with the mean v, a0 v0^2 + a1 (2 v - v0)^2 is least at v0 = 2 v a1 / (a0 + a1), where it is
        # 4 a0 a1 / (a0 + a1) v^2. That is a bound whether the pair lies in the box or not, and a value if it does.
        square = 4.0 * a0 * a1 / (a0 + a1)
        start = 2.0 * low * a1 / (a0 + a1)
        inside = low0 <= start <= high0 and low1 <= 2.0 * low - start <= high1
        value = here + square * low * low if inside else np.inf
        return constant + curve_bound(square, beta, kappa, low, high), value
    # With a factor that is not positive the parabola in v0 is concave, or its vertex lies outside 0 <= v0 <= 2 v: the
    # best pair has one speed s at an end of its range, and is own s^2 + other (2 v - s)^2.
    bound, value = np.inf, np.inf
    for side in range(4):
        fixed = box[side]
        own, other = (a0, a1) if side < 2 else (a1, a0)
        least, most = (low1, high1) if side < 2 else (low0, high0)
        left, right = max(low, 0.5 * (fixed + least)), min(high, 0.5 * (fixed + most))
        if left > right:
            continue
        offset = (own + other) * fixed * fixed
        curve = curve_bound(4.0 * other, beta - 4.0 * other * fixed, kappa, left, right)
        bound = min(bound, constant + offset + curve)
        if left == low:
            value = min(value, here + offset + 4.0 * other * low * (low - fixed))
    return bound, value


@njit(cache=True, error_model="numpy")
def curve_bound(square: float, linear: float, kappa: float, low: float, high: float) -> float:
    """Return a lower bound of square v^2 + linear v + kappa / v over [low, high], exact as the ends meet."""
    # The second derivative, 2 (square + kappa / v^3), is monotone in v, so its extremes are at the ends. If it is
    # nowhere negative, the tangent in the middle is a bound; else the lower end, less what a curve with that second
    # derivative can sag below its chord, max(f'') width^2 / 8.
    at_low, at_high = 2.0 * (square + kappa / low**3), 2.0 * (square + kappa / high**3)
    half = 0.5 * (high - low)
    if min(at_low, at_high) >= 0.0:
        v = 0.5 * (low + high)
        return (square * v + linear) * v + kappa / v - half * abs(2.0 * square * v + linear - kappa / (v * v))
    ends = min((square * low + linear) * low + kappa / low, (square * high + linear) * high + kappa / high)
    return ends - 0.5 * max(at_low, at_high, 0.0) * half * half


@njit(cache=True, error_model="numpy")
def least_of_cell(
    course: CourseData,
    cell: FloatArray,
    box: tuple[float, float, float, float],
    mean_speed: float,
    tolerance: float,
    budget: int,
) -> tuple[float, int]:
    """Return a lower bound of a priced cell over a box of its speeds, and how many pieces it took.

    Parameters
    ----------
    course : CourseData
    cell : array of shape (COLUMNS,)
    box : tuple
        Least and greatest speed at its start, then at its end [m/s].
    mean_speed : float
        Where the least is expected [m/s]; pieces are narrower there from the beginning.
    tolerance : float
        How much the bound may lie below the least.
    budget : int
        After so many pieces it is what it is.
    """
    bottom, top = 0.5 * (box[0] + box[2]), 0.5 * (box[1] + box[3])
    top = max(top, bottom * (1.0 + 1e-9))
    middle = min(max(mean_speed, bottom), top)
    edges = np.empty(2 * len(FIRST_WIDTHS) + 3)
    edges[0] = bottom
    count = 1
    for k in range(len(FIRST_WIDTHS)):
        edges[count] = middle * (1.0 - FIRST_WIDTHS[k])
        count += 1 if bottom < edges[count] < top else 0
    edges[count] = middle
    count += 1 if bottom < middle < top else 0
    for k in range(len(FIRST_WIDTHS) - 1, -1, -1):
        edges[count] = middle * (1.0 + FIRST_WIDTHS[k])
        count += 1 if bottom < edges[count] < top else 0
    edges[count] = top
    cheapest, precision = np.zeros(2), PRECISION * tolerance
    size = max(budget, count) + 1
    lows, highs, firsts, bounds = np.empty(size), np.empty(size), np.empty(size), np.empty(size)
    best = np.inf
    for k in range(count):
        low, high = edges[k], edges[k + 1]
        first = effort_value(course, cell, cheapest, low, high, low, precision)
        last = effort_value(course, cell, cheapest, low, high, high, precision)
        bound, value = piece_bound(cell, box, low, high, first, last)
        best = min(best, value)
        lows[k], highs[k], firsts[k], bounds[k] = low, high, first, bound
    while True:
        worst = 0
        for k in range(count):
            if bounds[k] < bounds[worst]:
                worst = k
        low, high = lows[worst], highs[worst]
        if bounds[worst] >= best - tolerance or count >= budget or high - low < NARROWEST_SHARE * high:
            return bounds[worst], count
        middle = math.sqrt(low * high) if low < 0.5 * high else 0.5 * (low + high)
        rises = _rises(course.traction, low, high) or _rises(course.braking, low, high)
        for start, end, place in ((low, middle, worst), (middle, high, count)):
            # a limit that falls is greatest at the slower end, which stays the same
            kept = place == worst and not rises
            first = firsts[worst] if kept else effort_value(course, cell, cheapest, start, end, start, precision)
            last = effort_value(course, cell, cheapest, start, end, end, precision)
            bound, value = piece_bound(cell, box, start, end, first, last)
            best = min(best, value)
            lows[place], highs[place], firsts[place], bounds[place] = start, end, first, bound
        count += 1


@njit(cache=True, error_model="numpy")
def price_switched_cells(course: CourseData, optimum: Optimum) -> tuple[FloatArray, float]:
    """Return the priced cells of a point, shape (n, COLUMNS), and the sum of the prices at both ends."""
    h, w, z = course.cell_length_m, optimum.speed2, optimum.multiplier
    n = h.shape[0]
    price_of_time = optimum.price_of_time_w + course.auxiliary_power_w
    tangents, over = np.zeros((4, n)), np.empty((2, n))
    rays, envelope = np.empty((2, RAY_COUNT, 3)), np.empty((2, RAY_COUNT, ENVELOPE_EFFORTS, 4))
    tabulate_hulls(course, rays, envelope)
    over[0], over[1] = z[TRACTION_OVER_SPEED], z[BRAKING_OVER_SPEED]
    returned = np.empty(n)
    for i in range(n):
        v = mean_speed(math.sqrt(w[i]), math.sqrt(w[i + 1]))
        f, x = max(optimum.traction_n[i], 0.0), max(optimum.braking_n[i], 0.0)
        taken, generated = switched_powers(course, i, rays, envelope, f, x, v)
        returned[i] = returned_share(course.recuperation_factor, z[DRAWN, i] / h[i])
        tangents[3, i] = h[i] * (energy_per_metre(taken, v)[2] - returned[i] * energy_per_metre(generated, v)[2])
    node = node_prices(course, optimum, price_of_time, over, tangents)
    cells = np.zeros((n, COLUMNS))
    inertia = 2.0 * course.half_inertia_kg
    top_traction, top_braking = course.traction.constant_n, course.braking.constant_n
    for i in range(n):
        c, cell, force = cells[i], cell_of(course, i), optimum.force_price[i]
        by_start, by_end = force_slopes(cell, 0.0, 0.0)
        rise = (z[ACCELERATION, i] - z[DECELERATION, i]) * cell.inertia
        c[CONSTANT] = force * cell.constant_n
        for row, limit in ((ACCELERATION, course.max_acceleration_ms2), (DECELERATION, course.max_deceleration_ms2)):
            if z[row, i] > 0.0:
                c[CONSTANT] -= z[row, i] * inertia * limit
        c[START] = node[i] + force * by_start - rise
        c[END] = force * by_end + rise - node[i + 1]
        c[TIME], c[BY_SPEED] = price_of_time * h[i], force * cell.linear
        c[PRICE], c[RETURNED], c[LENGTH] = force / h[i], returned[i], h[i]
        c[TOP_TRACTION], c[TOP_BRAKING] = cell.powered * top_traction, cell.powered * top_braking
    return cells, node[n] * w[n] - node[0] * w[0]


@njit(cache=True, error_model="numpy", nogil=True)
def switched_bound(
    course: CourseData, optimum: Optimum, fastest: FloatArray, running_time: float, tolerance: float, budget: int
) -> tuple[float, int]:
    """Return a lower bound of the energy [J], dwells not included, and how many pieces of speed it took.

    Parameters
    ----------
    course : CourseData
        Its machines are switched at will.
    optimum : Optimum
        Any point with multipliers.
    fastest : array of shape (n + 1,)
        Squares of speed of the fastest run [m2/s2].
    running_time : float
        Time allowed without dwells [s].
    tolerance : float
        How far the bound may lie below what the multipliers could prove, as a share of the energy.
    budget : int
        Pieces that may be looked at in each cell.
    """
    w, h = optimum.speed2, course.cell_length_m
    cells, ends = price_switched_cells(course, optimum)
    allowed = tolerance * reference_energy(course, optimum.energy_j, running_time) / h.sum()
    bound, pieces = ends - optimum.price_of_time_w * running_time, 0
    slowest = math.sqrt(SLOWEST_SPEED2)
    for i in range(h.shape[0]):
        low0, high0 = _range(course, fastest, w, slowest, i)
        low1, high1 = _range(course, fastest, w, slowest, i + 1)
        v = mean_speed(math.sqrt(w[i]), math.sqrt(w[i + 1]))
        box = low0, high0, low1, high1
        least, seen = least_of_cell(course, cells[i], box, v, allowed * h[i], budget)
        bound += least
        pieces += seen
    return min(bound, optimum.energy_j), pieces


@njit(cache=True)
def _range(
    course: CourseData, fastest: FloatArray, speed2: FloatArray, slowest: float, node: int
) -> tuple[float, float]:
    """Return the least and the greatest speed at a node [m/s]."""
    fixed = course.fixed_speed2[node]
    if fixed >= 0.0:
        return math.sqrt(fixed), math.sqrt(fixed)
    high = math.sqrt(fastest[node])
    return min(slowest, math.sqrt(speed2[node]), high), high
