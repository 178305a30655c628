"""Drives that take power without effort when they are on, and none when they are off: power jumps at zero effort.

Where a drive may be switched at will within a cell, a mean effort f costs the least of share * p(f / share) over the
share of the way on which it is on: up to the effort of least power per effort it is on for a part of the cell with
that one, a straight line through zero, and above it all the time. That is the convex hull of zero and the power p of a
drive that is on, if p is convex in the effort. The same holds for braking and what it generates.
"""

import math

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.drive.kernels import has_standstill_brake, smooth_power_when_on
from railjoule.core.drive.power_terms import PowerTerms
from railjoule.core.interior_point.layout import RAY_COUNT
from railjoule.core.physics.course_data import CourseData
from railjoule.core.physics.effort_limit import EffortLimit, limit_over_speed

FORBIDDING_PRICE = 10.0
"""Line energy over work that an effort is said to cost where a drive is off: more than any effort is worth."""
GREATEST_BEND = 100.0
"""Second derivatives are cut to this many times slope over effort: at a pull-out torque they have no limit."""
FIRST_SHARE, WIDENING = 0.1, 2.0
NARROWINGS = 60
EXACT = 1e-6
"""How close a tangent need be found: the slope of its line is stationary there."""
CLEARLY_LESS = 0.7
SLOWEST = 1e-3
"""Speed that stands for none [m/s]."""


@njit(cache=True)
def tangent(
    kind: int, parameters: FloatArray, braking: bool, speed: float, anchor: float, other: float, near: float
) -> tuple[float, PowerTerms]:
    """Return the effort [N] at which the power touches a line through zero power at an anchor, and the power there.

    Parameters
    ----------
    kind, parameters : int and array
        The drive.
    braking : bool
        Whether it brakes.
    speed : float
        Speed [m/s].
    anchor, other : float
        Effort of the anchor and the end of the search [N]; from zero to the largest effort or the other way round. The
        end is returned if no tangent lies between.
    near : float
        Where to begin [N]; zero if nothing is known.
    """
    below, beyond = anchor, other
    y = near if near > 0.0 else anchor + FIRST_SHARE * (other - anchor)
    power = smooth_power_when_on(kind, parameters, braking, y, speed)
    for _ in range(NARROWINGS):
        p, p_f, _, p_ff, _, _ = power
        way = y - anchor
        rest = way * p_f - p
        if rest >= 0.0:
            beyond = y
        else:
            below = y
        if abs(beyond - below) <= EXACT * abs(way):
            break
        # exact where power is a constant and a square of the way from the anchor
        square = way * way - 2.0 * rest / p_ff if p_ff > 0.0 else -1.0
        step = anchor + math.copysign(math.sqrt(square), way) if square > 0.0 else anchor
        if (step - below) * (step - beyond) >= 0.0:
            step = 0.5 * (below + beyond)
            if beyond == other and y != other:
                step = other if WIDENING * abs(way) > abs(other - anchor) else anchor + WIDENING * way
        if abs(step - y) <= EXACT * abs(way):
            break
        y = step
        power = smooth_power_when_on(kind, parameters, braking, y, speed)
    return y, power


@njit(cache=True)
def ray(power: PowerTerms, anchor: float, touch: float, end_by_speed: float, effort: float) -> PowerTerms:
    """Return the power [W] on the line from an anchor to a power at an effort, and derivatives.

    `end_by_speed` is how that effort varies with speed [N s/m] where it is a limit and no tangent, else zero.
    """
    p, p_f, p_v, p_ff, p_fv, p_vv = _tamed(power, touch)
    way = touch - anchor
    slope, slope_v, slope_vv = p / way, p_v / way, p_vv / way
    if end_by_speed != 0.0:
        slope_v += (p_f - slope) * end_by_speed / way
    elif p_ff > 0.0:
        apart = (p_fv - slope_v) / way
        slope_vv -= apart * apart * way / p_ff
    on = effort - anchor
    return slope * on, slope, slope_v * on, 0.0, slope_v, slope_vv * on


@njit(cache=True)
def hull_power(
    kind: int, parameters: FloatArray, braking: bool, limit: EffortLimit, effort: float, speed: float, near: float
) -> tuple[PowerTerms, float]:
    """Return the power of a drive that is switched at will [W] with its derivatives, and the effort that it touches.

    Parameters
    ----------
    kind, parameters : int and array
        The drive.
    braking : bool
        Whether it brakes.
    limit : EffortLimit
        Of the effort.
    effort : float
        Mean effort over the way [N].
    speed : float
        Speed [m/s].
    near : float
        The effort of least power per effort at about this speed [N]; zero if nothing is known.
    """
    most, most_v = limit.constant_n, 0.0
    if limit.table.shape[0] > 0 or limit.power_w / speed < most:
        over, over_v, _ = limit_over_speed(limit, speed)
        if over < most:
            most, most_v = over, over_v
    if effort > CLEARLY_LESS * near:
        power = smooth_power_when_on(kind, parameters, braking, effort, speed)
        if effort >= most or effort * power[1] >= power[0]:
            return _tamed(power, effort), near
    touch, power = tangent(kind, parameters, braking, speed, 0.0, most, min(near, most))
    return ray(power, 0.0, touch, most_v if touch >= most else 0.0, effort), touch


@njit(cache=True)
def hull_with_standstill_brake(
    kind: int, parameters: FloatArray, limit: EffortLimit, effort: float, speed: float, near: float
) -> tuple[PowerTerms, float]:
    """Return the same for a brake that another one may replace at no power, up to the same largest effort.

    Near standstill, where full electric braking would draw power, that is cheaper; between the two there is a line.
    """
    off = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    power, touch = hull_power(kind, parameters, True, limit, effort, speed, near)
    if power[1] < 0.0:
        return power, touch
    most = limit.constant_n
    if smooth_power_when_on(kind, parameters, True, most, speed)[0] <= 0.0:
        return power, touch
    best, least = tangent(kind, parameters, True, speed, 0.0, most, 0.0)
    if least[0] >= 0.0:
        return off, touch
    end, least = tangent(kind, parameters, True, speed, most, best, 0.0)
    if abs(effort) <= end:
        return power, touch
    return ray(least, most, end, 0.0, effort), touch


@njit(cache=True)
def _tamed(power: PowerTerms, effort: float) -> PowerTerms:
    """Return a power whose second derivatives are no larger than an iteration can use."""
    p, p_f, p_v, p_ff, p_fv, p_vv = power
    greatest = GREATEST_BEND * abs(p_f) / effort
    if abs(p_ff) <= greatest:
        return power
    cut = greatest / abs(p_ff)
    return p, p_f, p_v, p_ff * cut, p_fv * cut, p_vv * cut


@njit(cache=True, error_model="numpy")
def ray_step(course: CourseData) -> float:
    """Return the step of speed of a table of rays [m/s]."""
    step: float = math.sqrt(course.largest_speed2.max()) / (RAY_COUNT - 2)
    return step


@njit(cache=True, error_model="numpy")
def tabulate_rays(course: CourseData, rays: FloatArray) -> None:
    """Fill the lines from zero that touch the power of a drive, over speed.

    Parameters
    ----------
    course : CourseData
    rays : array of shape (2, RAY_COUNT, 3)
        Driving and braking: effort that the line touches [N], its slope [W/N] and the slope's derivative by speed.
    """
    kind, parameters, step = course.drive_kind, course.drive_parameters, ray_step(course)
    for side in range(2):
        limit, near = course.traction if side == 0 else course.braking, 0.0
        for k in range(RAY_COUNT):
            power, near = hull_power(kind, parameters, side == 1, limit, 0.0, max(k * step, SLOWEST), near)
            rays[side, k, 0], rays[side, k, 1], rays[side, k, 2] = near, power[1], power[4]


@njit(cache=True, error_model="numpy")
def tabulated_power(
    course: CourseData, braking: bool, rays: FloatArray, effort: float, speed: float
) -> tuple[PowerTerms, float]:
    """Return the power of a drive that is switched at will [W] with its derivatives, and the effort that it touches.

    Parameters
    ----------
    course : CourseData
    braking : bool
        Whether it brakes.
    rays : array of shape (RAY_COUNT, 3)
        Lines of that side.
    effort, speed : float
        Mean effort over the way [N] and speed [m/s].
    """
    step = ray_step(course)
    # not a number becomes a large negative integer: it must not lead out of the table
    k = max(min(int(speed / step), RAY_COUNT - 2), 0)
    x = speed / step - k
    touch = rays[k, 0] + x * (rays[k + 1, 0] - rays[k, 0])
    if effort >= touch:
        power = smooth_power_when_on(course.drive_kind, course.drive_parameters, braking, effort, speed)
        return _tamed(power, effort), touch
    # Hermite's cubic
    first, second = step * rays[k, 2], step * rays[k + 1, 2]
    rise = rays[k + 1, 1] - rays[k, 1]
    square, cube = 3.0 * rise - 2.0 * first - second, first + second - 2.0 * rise
    slope = ((cube * x + square) * x + first) * x + rays[k, 1]
    slope_v = ((3.0 * cube * x + 2.0 * square) * x + first) / step
    slope_vv = (6.0 * cube * x + 2.0 * square) / (step * step)
    return (slope * effort, slope, slope_v * effort, 0.0, slope_v, slope_vv * effort), touch


@njit(cache=True)
def switched_powers(
    course: CourseData, cell: int, rays: FloatArray, traction: float, braking: float, speed: float
) -> tuple[PowerTerms, PowerTerms]:
    """Return the power taken for a tractive effort and the power generated by a braking effort in a cell.

    Parameters
    ----------
    course : CourseData
        Its `machines_on` tells which cells may be switched at will.
    cell : int
    rays : array of shape (2, RAY_COUNT, 3)
        As tabulated.
    traction, braking : float
        Mean efforts over the cell [N].
    speed : float
        Its mean speed [m/s].
    """
    kind, parameters = course.drive_kind, course.drive_parameters
    if course.machines_on.shape[0] == 0:
        taken, _ = tabulated_power(course, False, rays[0], traction, speed)
    elif course.machines_on[cell] > 0.0:
        taken = _tamed(smooth_power_when_on(kind, parameters, False, traction, speed), max(traction, 1.0))
    else:
        price = FORBIDDING_PRICE
        taken = price * traction * speed, price * speed, price * traction, 0.0, price, 0.0
    power, touch = tabulated_power(course, True, rays[1], braking, speed)
    if power[1] >= 0.0 and has_standstill_brake(kind, parameters):
        power, _ = hull_with_standstill_brake(kind, parameters, course.braking, braking, speed, touch)
    p, p_f, p_v, p_ff, p_fv, p_vv = power
    return taken, (-p, -p_f, -p_v, -p_ff, -p_fv, -p_vv)


@njit(cache=True)
def keep_larger_curvature(curvature: FloatArray, last: FloatArray) -> None:
    """Replace curvatures of driving and braking that fell since the last iteration by those that they had then.

    Where second derivatives jump, as at the effort of least power per effort, Newton's steps would lead from one side
    to the other and back for ever; with the larger curvature of the two they do not overshoot.

    Parameters
    ----------
    curvature : array of shape (9, n)
        As in `layout.Work`.
    last : array of shape (6, n)
        What its first rows were; brought up to date.
    """
    for i in range(curvature.shape[1]):
        for first in (0, 3):
            ff, fv, vv = curvature[first, i], curvature[first + 1, i], curvature[first + 2, i]
            if last[first, i] > ff:
                for row in range(first, first + 3):
                    curvature[row, i] = last[row, i]
            last[first, i], last[first + 1, i], last[first + 2, i] = ff, fv, vv
