"""Drives with idle losses when they are on, and none when they are off: power jumps at zero effort.

If a drive may be switched at will within a cell, a mean effort f costs the least of share * p(f / share) over the
share of the cell in which it is on: up to the effort of least power per effort it is on for a part of the cell with
that one, a straight line through zero, and above it all the time. That is the convex hull of zero and the power p of a
drive that is on, if p is convex in the effort. The same holds for braking and the power that it generates. Nothing
ensures that the power of a map is convex: `envelope` has the table for it.
"""

import math

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.drive.kernels import has_standstill_brake, may_be_concave, smooth_power_when_on
from railjoule.core.drive.kinds import PowerTerms
from railjoule.core.interior_point.envelope import envelope_power
from railjoule.core.interior_point.layout import RAY_COUNT
from railjoule.core.physics.effort_limit import SLOWEST_MS, EffortLimit, max_effort_slope
from railjoule.core.physics.mesh_data import BRAKE, DRIVE, MeshData

# Line energy over work that an effort costs where a drive is off. Marginal energies of drives are about 1 / efficiency,
# so below ten wherever a run would use an effort: an optimum buys none, if the decision to be off leaves it a choice.
# Otherwise the problem stays solvable, and its run uses effort in cells that were to be off; a larger price would only
# widen the range of the problem's numbers.
FORBIDDING_PRICE = 10.0
# Second derivatives by effort are cut to this many times slope over effort: at a pull-out torque they have no limit.
# A Newton step against that slope is then no shorter than a hundredth of the effort; with less it would overshoot where
# losses are truly steep, with more it would stand still at the pull-out.
MAX_CURVATURE = 100.0
# where a search for a tangent begins, on the way from the anchor, and by what its steps widen until they bracket it
FIRST_FRACTION, WIDENING = 0.1, 2.0
NARROWINGS = 60
EXACT = 1e-6
"""How close a tangent need be found: the slope of its line is stationary there."""
# An effort below this share of the tangent point at about the same speed is taken for one on the line, without a look
# at the power there. Right as long as the tangent point falls by less than 30 % from the one speed to the other.
CLEARLY_LESS = 0.7
# efforts below it do not lower the cut of second derivatives any further: at zero it would leave none [N]
MIN_EFFORT_N = 1.0
# of one line in a table of rays
POINT, SLOPE, SLOPE_BY_SPEED = range(3)


@njit(cache=True)
def tangent(
    kind: int, parameters: FloatArray, braking: bool, speed: float, anchor: float, end: float, guess: float
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
    anchor, end : float
        Effort of the anchor and the end of the search [N]; from zero to the largest effort or the other way round. The
        end is returned if no tangent lies between.
    guess : float
        First guess [N]; zero if nothing is known.
    """
    # a bracket that may run either way: its inner end is the one at the anchor
    inner, outer = anchor, end
    y = guess if guess > 0.0 else anchor + FIRST_FRACTION * (end - anchor)
    power = smooth_power_when_on(kind, parameters, braking, y, speed)
    for _ in range(NARROWINGS):
        p, p_f, _, p_ff, _, _ = power
        distance = y - anchor
        # zero at the tangent point; of a convex power it rises with the distance
        residual = distance * p_f - p
        if residual >= 0.0:
            outer = y
        else:
            inner = y
        if abs(outer - inner) <= EXACT * abs(distance):
            break
        # exact where power is a constant and a square of the distance
        square = distance * distance - 2.0 * residual / p_ff if p_ff > 0.0 else -1.0
        step = anchor + math.copysign(math.sqrt(square), distance) if square > 0.0 else anchor
        if (step - inner) * (step - outer) >= 0.0:
            step = 0.5 * (inner + outer)
            if outer == end and y != end:
                step = end if WIDENING * abs(distance) > abs(end - anchor) else anchor + WIDENING * distance
        if abs(step - y) <= EXACT * abs(distance):
            break
        y = step
        power = smooth_power_when_on(kind, parameters, braking, y, speed)
    return y, power


@njit(cache=True)
def tangent_line(
    power: PowerTerms, anchor: float, tangent_point: float, point_by_speed: float, effort: float
) -> PowerTerms:
    """Return the power [W] on the line from an anchor to a power at an effort, and derivatives.

    Parameters
    ----------
    power : tuple
        Power at the tangent point and its derivatives.
    anchor, tangent_point, effort : float
        Efforts: where the line has no power, where it meets that one, and where it is asked for [N].
    point_by_speed : float
        How the tangent point varies with speed where it is a limit and no tangent, else zero [N s/m].
    """
    # The line's slope is m(v) = P(y, v) / d with d = y - a. A tangent has d P_f = P, so m does not change with y and
    # m_v = P_v / d. Differentiating the condition by v gives the point's own change, y_v = -(P_fv - m_v) / P_ff, hence
    #     m_vv = P_vv / d + (P_fv - m_v) y_v / d = P_vv / d - (P_fv - m_v)^2 / (d P_ff).
    # At a limit y_v is given, and m_v = P_v / d + (P_f - m) y_v / d; m_vv, which only sizes a step, goes without y_v.
    p, p_f, p_v, p_ff, p_fv, p_vv = _with_limited_curvature(power, tangent_point)
    distance = tangent_point - anchor
    slope, slope_v, slope_vv = p / distance, p_v / distance, p_vv / distance
    if point_by_speed != 0.0:
        slope_v += (p_f - slope) * point_by_speed / distance
    elif p_ff > 0.0:
        mixed = (p_fv - slope_v) / distance
        slope_vv -= mixed * mixed * distance / p_ff
    offset = effort - anchor
    return slope * offset, slope, slope_v * offset, 0.0, slope_v, slope_vv * offset


@njit(cache=True)
def hull_power(
    kind: int, parameters: FloatArray, braking: bool, limit: EffortLimit, effort: float, speed: float, guess: float
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
        Mean effort over the cell [N].
    speed : float
        Speed [m/s].
    guess : float
        The effort of least power per effort at about this speed [N]; zero if nothing is known.
    """
    largest, max_v = max_effort_slope(limit, speed)
    if effort > CLEARLY_LESS * guess:
        power = smooth_power_when_on(kind, parameters, braking, effort, speed)
        # beyond the tangent point the power is its own hull
        if effort >= largest or effort * power[1] >= power[0]:
            return _with_limited_curvature(power, effort), guess
    point, power = tangent(kind, parameters, braking, speed, 0.0, largest, min(guess, largest))
    return tangent_line(power, 0.0, point, max_v if point >= largest else 0.0, effort), point


@njit(cache=True)
def hull_with_standstill_brake(
    kind: int, parameters: FloatArray, limit: EffortLimit, effort: float, speed: float, guess: float
) -> tuple[PowerTerms, float]:
    """Return the same for a brake that another one may replace at no power, up to the same largest effort.

    Near standstill, where full electric braking would draw power, that is cheaper; between the two there is a line.
    """
    off = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    power, point = hull_power(kind, parameters, True, limit, effort, speed, guess)
    # where more effort still generates more, or the largest draws nothing, the other brake has nothing to spare
    if power[1] < 0.0:
        return power, point
    largest = limit.constant_n
    if smooth_power_when_on(kind, parameters, True, largest, speed)[0] <= 0.0:
        return power, point
    best, least = tangent(kind, parameters, True, speed, 0.0, largest, 0.0)
    if least[0] >= 0.0:
        return off, point
    # from no power at the largest effort, the other brake's, back to what the electric one generates at most
    end, least = tangent(kind, parameters, True, speed, largest, best, 0.0)
    if abs(effort) <= end:
        return power, point
    return tangent_line(least, largest, end, 0.0, effort), point


@njit(cache=True)
def _with_limited_curvature(power: PowerTerms, effort: float) -> PowerTerms:
    """Return a power whose second derivatives are no larger than an iteration can use."""
    p, p_f, p_v, p_ff, p_fv, p_vv = power
    greatest = MAX_CURVATURE * abs(p_f) / effort
    if abs(p_ff) <= greatest:
        return power
    cut = greatest / abs(p_ff)
    return p, p_f, p_v, p_ff * cut, p_fv * cut, p_vv * cut


@njit(cache=True, error_model="numpy")
def ray_step(mesh: MeshData) -> float:
    """Return the step of speed of a table of rays [m/s]."""
    step: float = math.sqrt(mesh.limit_speed2.max()) / (RAY_COUNT - 2)
    return step


@njit(cache=True, error_model="numpy")
def tabulate_rays(mesh: MeshData, rays: FloatArray) -> None:
    """Fill the lines from zero that touch the power of a drive, over speed.

    Parameters
    ----------
    mesh : MeshData
    rays : array of shape (2, RAY_COUNT, 3)
        Driving and braking: effort that the line touches [N], its slope [W/N] and the slope's derivative by speed.
    """
    kind, parameters, step = mesh.drive_kind, mesh.drive_parameters, ray_step(mesh)
    for side in range(2):
        limit, point = mesh.traction if side == 0 else mesh.braking, 0.0
        for k in range(RAY_COUNT):
            # at no effort the hull is its line; the point at one speed is the guess at the next
            power, point = hull_power(kind, parameters, side == 1, limit, 0.0, max(k * step, SLOWEST_MS), point)
            rays[side, k, POINT], rays[side, k, SLOPE], rays[side, k, SLOPE_BY_SPEED] = point, power[1], power[4]


@njit(cache=True, error_model="numpy")
def tabulated_power(
    mesh: MeshData, braking: bool, rays: FloatArray, effort: float, speed: float
) -> tuple[PowerTerms, float]:
    """Return the power of a drive that is switched at will [W] with its derivatives, and the effort that it touches.

    Parameters
    ----------
    mesh : MeshData
    braking : bool
        Whether it brakes.
    rays : array of shape (RAY_COUNT, 3)
        Lines of that side.
    effort, speed : float
        Mean effort over the cell [N] and speed [m/s].
    """
    step = ray_step(mesh)
    # not a number becomes a large negative integer: it must not lead out of the table
    k = max(min(int(speed / step), RAY_COUNT - 2), 0)
    x = speed / step - k
    point = rays[k, POINT] + x * (rays[k + 1, POINT] - rays[k, POINT])
    if effort >= point:
        power = smooth_power_when_on(mesh.drive_kind, mesh.drive_parameters, braking, effort, speed)
        return _with_limited_curvature(power, effort), point
    # Hermite's cubic: the slope and its derivative are continuous over speed, as Newton's rule needs them
    first, second = step * rays[k, SLOPE_BY_SPEED], step * rays[k + 1, SLOPE_BY_SPEED]
    difference = rays[k + 1, SLOPE] - rays[k, SLOPE]
    square, cube = 3.0 * difference - 2.0 * first - second, first + second - 2.0 * difference
    slope = ((cube * x + square) * x + first) * x + rays[k, SLOPE]
    slope_v = ((3.0 * cube * x + 2.0 * square) * x + first) / step
    slope_vv = (6.0 * cube * x + 2.0 * square) / (step * step)
    return (slope * effort, slope, slope_v * effort, 0.0, slope_v, slope_vv * effort), point


@njit(cache=True)
def switched_powers(
    mesh: MeshData,
    cell: int,
    rays: FloatArray,
    envelope: FloatArray,
    traction: float,
    braking: float,
    speed: float,
) -> tuple[PowerTerms, PowerTerms]:
    """Return the power taken for a tractive effort and the power generated by a braking effort in a cell.

    Parameters
    ----------
    mesh : MeshData
        Its `mode` holds the decision of each cell, if there is one.
    cell : int
    rays : array of shape (2, RAY_COUNT, 3)
        As tabulated.
    envelope : array of shape (2, RAY_COUNT, ENVELOPE_EFFORTS, 4)
        As tabulated, of a drive whose power may be concave.
    traction, braking : float
        Mean efforts over the cell [N].
    speed : float
        Its mean speed [m/s].
    """
    if mesh.mode.shape[0] > 0:
        return _decided_powers(mesh, mesh.mode[cell], traction, braking, speed)
    if may_be_concave(mesh.drive_kind):
        taken = envelope_power(mesh, envelope[0], traction, speed)
        return taken, _reversed(envelope_power(mesh, envelope[1], braking, speed))
    taken, _ = tabulated_power(mesh, False, rays[0], traction, speed)
    power, point = tabulated_power(mesh, True, rays[1], braking, speed)
    if power[1] >= 0.0 and has_standstill_brake(mesh.drive_kind, mesh.drive_parameters):
        power, _ = hull_with_standstill_brake(
            mesh.drive_kind, mesh.drive_parameters, mesh.braking, braking, speed, point
        )
    return taken, _reversed(power)


@njit(cache=True)
def _decided_powers(
    mesh: MeshData, mode: int, traction: float, braking: float, speed: float
) -> tuple[PowerTerms, PowerTerms]:
    """Return the same in a cell where it is decided what the drive does.

    Weak braking generates less than the drive takes: only the true power shows, as in driving, whether it had better
    be off. Off, it generates nothing, and brakes at no power only where another brake stands in for it.
    """
    kind, parameters = mesh.drive_kind, mesh.drive_parameters
    taken, power = _forbidden_power(traction, speed), _forbidden_power(braking, speed)
    if mode == DRIVE:
        true = smooth_power_when_on(kind, parameters, False, traction, speed)
        taken = _with_limited_curvature(true, max(traction, MIN_EFFORT_N))
    if mode == BRAKE:
        true = smooth_power_when_on(kind, parameters, True, braking, speed)
        power = _with_limited_curvature(true, max(braking, MIN_EFFORT_N))
    elif has_standstill_brake(kind, parameters):
        power = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    return taken, _reversed(power)


@njit(cache=True)
def _forbidden_power(effort: float, speed: float) -> PowerTerms:
    """Return the cost of an effort in a cell that is decided to have none [W], with its derivatives."""
    price = FORBIDDING_PRICE
    return price * effort * speed, price * speed, price * effort, 0.0, price, 0.0


@njit(cache=True)
def _reversed(power: PowerTerms) -> PowerTerms:
    """Return a power counted in the other direction."""
    p, p_f, p_v, p_ff, p_fv, p_vv = power
    return -p, -p_f, -p_v, -p_ff, -p_fv, -p_vv


@njit(cache=True)
def keep_larger_curvature(curvature: FloatArray, last: FloatArray) -> None:
    """Replace curvatures of driving and braking that fell since the last iteration by those that they had then.

    If second derivatives jump, as at the effort of least power per effort, Newton's steps would lead from one side
    to the other and back for ever; with the larger curvature of the two they do not overshoot.

    Parameters
    ----------
    curvature : array of shape (9, n)
        As in `layout.Work`.
    last : array of shape (6, n)
        Its first rows an iteration ago; brought up to date.
    """
    for i in range(curvature.shape[1]):
        for first in (0, 3):
            ff, fv, vv = curvature[first, i], curvature[first + 1, i], curvature[first + 2, i]
            if last[first, i] > ff:
                for row in range(first, first + 3):
                    curvature[row, i] = last[row, i]
            last[first, i], last[first + 1, i], last[first + 2, i] = ff, fv, vv
