"""The printed regulator in steps of time: a relay with a dead zone whose effort changes at a limited rate.

Below V - dV it asks for full effort, above V + dV for full braking, between them for none; (5) tells nothing of the
half of that zone above V, where none is taken. Effort rises at the fastest rate up to a speed V_min and at a share of
it above; it falls, and the brake rises, at the fastest (6). The paper has no rule for a stop: along the braking curve
of the line's own limits and stops the regulator brakes as that curve asks. Between steps of time effort is constant
and speed is integrated by the fourth-order rule of Runge and Kutta. Such a relay does not converge with its step: where
it switches, and how often, hangs on it.

Source: Shtompel, Khvorost 2025, (2), (4)-(6).
"""

import math
from typing import NamedTuple

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.limit_search.way import Way, braking_curves
from railjoule.core.physics.course_data import CourseData
from railjoule.core.physics.effort_limit import largest_effort
from railjoule.core.physics.resistance import running_resistance

LOOK_AHEAD_S = 1.0
LEAST_LOOK_AHEAD_M = 0.05
STOPPED_MS = 0.02
NEAR_STOP_M = 0.02
NEAR_ENOUGH_M = 0.5
LONGEST_STANDING_S = 60.0
BRAKING_SHARE = 0.7
"""The regulator begins to brake for the line once its curve asks for this share of the deceleration."""
GOES_ON, ARRIVED, STANDS = range(3)


class Relay(NamedTuple):
    """How the printed regulator is set.

    Parameters
    ----------
    dead_zone_ms : float
        Half of the zone around a limit in which it asks for nothing [m/s].
    regulation_speed_ms : float
        Up to there effort rises at the fastest rate [m/s].
    full_effort_time_s : float
        From none to full effort at that rate [s].
    effort_rate_share : float
        Rate above that speed over the fastest.
    time_step_s : float
        Its step of time [s].
    """

    dead_zone_ms: float
    regulation_speed_ms: float
    full_effort_time_s: float
    effort_rate_share: float
    time_step_s: float


@njit(cache=True)
def _asked(course: CourseData, relay: Relay, limit_ms: float, speed: float) -> float:
    """Return the effort that (5) asks for [N]; braking is negative."""
    if speed < limit_ms - relay.dead_zone_ms:
        return largest_effort(course.traction, max(speed, 1e-9))
    if speed > limit_ms + relay.dead_zone_ms:
        return -largest_effort(course.braking, max(speed, 1e-9))
    return 0.0


@njit(cache=True)
def _resisting_n(course: CourseData, number: int, speed: float) -> float:
    """Return what resists the train in a cell [N]."""
    a, b, c = course.resistance_constant_n, course.resistance_linear, course.resistance_quadratic[number]
    resisting: float = course.line_force_n[number] + running_resistance(a, b, c, speed, speed * speed)
    return resisting


@njit(cache=True)
def _step(course: CourseData, number: int, effort: float, speed: float, step_s: float) -> tuple[float, float]:
    """Return way [m] and speed [m/s] after a step of time at one effort, by Runge and Kutta's fourth-order rule."""
    mass = 2.0 * course.half_inertia_kg
    k1 = (effort - _resisting_n(course, number, speed)) / mass
    k2 = (effort - _resisting_n(course, number, max(speed + 0.5 * step_s * k1, 0.0))) / mass
    k3 = (effort - _resisting_n(course, number, max(speed + 0.5 * step_s * k2, 0.0))) / mass
    k4 = (effort - _resisting_n(course, number, max(speed + step_s * k3, 0.0))) / mass
    way = step_s * (speed + step_s * (k1 + k2 + k3) / 6.0)
    return way, speed + step_s * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0


@njit(cache=True, error_model="numpy", nogil=True)
def literal_trip(
    course: CourseData,
    way: Way,
    borders_m: FloatArray,
    limits_ms: FloatArray,
    relay: Relay,
    position_m: FloatArray,
    speed2: FloatArray,
) -> tuple[int, float, int, int]:
    """Drive once as printed; fill places [m] and squares of speed [m2/s2], one for each step of time that moves.

    Parameters
    ----------
    course, way : CourseData, Way
        What the train obeys; the way of a regulator that does not brake ahead for sections.
    borders_m : array of shape (k - 1,)
        Between sections, rising [m].
    limits_ms : array of shape (k,)
        Of the sections [m/s].
    relay : Relay
        How the regulator is set.
    position_m, speed2 : array of shape (m,)
        What is filled.

    Returns
    -------
    (nodes, standing_s, switches, status) : ints and float
        How many nodes the trip has, for how long the train stood at its start while effort grew [s], how often the
        effort asked for changed between driving, none and braking, and how it ended.
    """
    curve, _ = braking_curves(course, way, borders_m, limits_ms)
    n = way.top_speed2.shape[0]
    stop = way.position_m[n]
    rate = largest_effort(course.traction, 1e-9) / relay.full_effort_time_s
    w0 = max(course.fixed_speed2[0], 0.0)
    place, speed, effort, standing = way.position_m[0], math.sqrt(w0), 0.0, 0.0
    position_m[0], speed2[0] = place, w0
    nodes, switches, before, braking = 1, 0, 0.0, False
    cell = ahead = section = 0
    while nodes < position_m.shape[0]:
        while cell < n - 1 and way.position_m[cell + 1] <= place:
            cell += 1
        while section < borders_m.shape[0] and borders_m[section] <= place:
            section += 1
        asked = _asked(course, relay, limits_ms[section], speed)
        # the speed that the braking curve has a little further on asks for a deceleration
        reach = min(max(speed * LOOK_AHEAD_S, LEAST_LOOK_AHEAD_M), stop - place)
        ahead = max(ahead, cell)
        while ahead < n - 1 and way.position_m[ahead + 1] <= place + reach:
            ahead += 1
        share = (place + reach - way.position_m[ahead]) / (way.position_m[ahead + 1] - way.position_m[ahead])
        wanted2 = curve[ahead] + share * (curve[ahead + 1] - curve[ahead])
        rise = (wanted2 - speed * speed) / (2.0 * max(reach, 1e-6))
        braking = rise < (0.0 if braking else -BRAKING_SHARE * way.deceleration_ms2)
        if braking:
            most = largest_effort(course.braking, max(speed, 1e-9)) + course.friction_effort_n
            curve_effort = 2.0 * course.half_inertia_kg * rise + _resisting_n(course, cell, speed)
            asked = min(asked, max(curve_effort, -most))
        kind = math.copysign(1.0, asked) if asked != 0.0 else 0.0
        switches += kind != before
        before = kind
        slow = asked > effort >= 0.0 and speed >= relay.regulation_speed_ms
        change = rate * relay.time_step_s * (relay.effort_rate_share if slow else 1.0)
        effort += min(max(asked - effort, -change), change)
        moved, after = _step(course, cell, effort, speed, relay.time_step_s)
        if after <= 0.0 and nodes == 1:
            standing += relay.time_step_s
            if standing > LONGEST_STANDING_S:
                return nodes, standing, switches, STANDS
            continue
        at_the_end = place + moved >= stop - NEAR_STOP_M
        if at_the_end or after <= (STOPPED_MS if braking else 0.0):
            if stop - place > NEAR_ENOUGH_M:
                return nodes, standing, switches, STANDS
            position_m[nodes], speed2[nodes] = stop, 0.0
            return nodes + 1, standing, switches, ARRIVED
        place, speed = place + moved, after
        position_m[nodes], speed2[nodes] = place, speed * speed
        nodes += 1
    return nodes, standing, switches, GOES_ON
