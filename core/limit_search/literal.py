"""The literal regulator in steps of time: a relay with a dead zone whose effort changes at a limited rate.

Below V - dV it asks for full effort, above V + dV for full braking, between them for none; (5) leaves out the half of
that zone above V, where none is taken. Effort rises at the fastest rate up to a speed V_min and at a share of it above;
it falls, and the brake rises, at the fastest (6). Between steps of time effort is constant, and speed is integrated by
the fourth-order rule of Runge and Kutta. The switching of such a relay depends on its step: steps of 0.1 s and of
0.002 s differ by some percent in energy.

The paper leaves these rules open; railjoule uses those of a train that can be driven:

- The line's own limits are kept a dead zone below, for a relay swings about its mark by as much.
- For them and for its stop the train brakes along the curve of `railjoule.core.limit_search.regulation`, which asks for
  no more than its brakes give at each speed and gradient. It begins once it would be above that curve after the time in
  which its effort falls to none, or in which it builds up the brake, and one step of time, for it decides once a step.
- Efforts and accelerations stay within their limits.
- A constant effort within the limits of the brake leads from the last step to rest at the end of the line. There is
  no run if the regulator comes too fast for that.

Source: Shtompel, Khvorost 2025, (2), (4)-(6).
"""

import math
from typing import NamedTuple

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.limit_search.regulation import Regulation, braking_curves, make_regulation
from railjoule.core.motion.meshed_line import MeshedLine
from railjoule.core.physics.cell import NEARLY_AT_REST_MS
from railjoule.core.physics.effort_limit import max_effort
from railjoule.core.physics.mesh_data import MeshData
from railjoule.core.physics.resistance import running_resistance, starting_resistance

# A train that is above a curve at full brakes never comes back to it, and in steps of time it always is a little. With
# more it brakes earlier where brakes are weak; where they are not, the deceleration asked for decides, and nothing
# changes.
BRAKE_RESERVE = 0.1
"""Share of the brakes' efforts and of the vehicle's largest deceleration that the curve leaves; assumed."""
# one comparison at the end would not do: the train is the fastest where it begins to slow down, and may come to rest
# before the brake is built up
RAMP_POINTS = 8
"""So often on its way to the full brake a train is compared with the curve."""
GOES_ON, ARRIVED, STANDS, OVERSHOOTS = range(4)


class Relay(NamedTuple):
    """Settings of the literal regulator.

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


def literal_regulation(
    mesh: MeshedLine, stop_deceleration_ms2: float, dead_zone_ms: float
) -> tuple[Regulation, FloatArray]:
    """Return the line's limits for the literal regulator, and its braking curve at the nodes [m2/s2].

    Parameters
    ----------
    mesh : MeshedLine
        Train and line.
    stop_deceleration_ms2 : float
        Of braking ahead [m/s2].
    dead_zone_ms : float
        How far below the line's limits it keeps [m/s].
    """
    data, left = mesh.data, 1.0 - BRAKE_RESERVE
    regulation = make_regulation(mesh, stop_deceleration_ms2, False)
    regulation = regulation._replace(
        deceleration_ms2=min(stop_deceleration_ms2, left * data.max_deceleration_ms2),
        top_speed2=np.maximum(np.sqrt(regulation.top_speed2) - dead_zone_ms, 0.0) ** 2,
        bound_speed2=np.maximum(np.sqrt(regulation.bound_speed2) - dead_zone_ms, 0.0) ** 2,
    )
    weaker = data._replace(braking=data.braking.lowered(BRAKE_RESERVE), friction_effort_n=left * data.friction_effort_n)
    # no sections: for those the literal regulator does not brake ahead
    curve, _ = braking_curves(weaker, regulation, np.empty(0), np.array([np.inf]))
    return regulation, curve


class Motion(NamedTuple):
    """The state of a train after a step of time.

    Parameters
    ----------
    place_m, speed_ms, effort_n : float
        Place [m], speed [m/s], and the effort that led there, braking negative [N].
    braking : bool
        Whether the regulator follows the braking curve.
    request : int
        Requested effort: 1 driving, 0 none, -1 braking.
    cell, section : int
        In which the train is.
    """

    place_m: float
    speed_ms: float
    effort_n: float
    braking: bool
    request: int
    cell: int
    section: int


@njit(cache=True)
def _resisting_n(mesh: MeshData, number: int, speed: float) -> float:
    """Return the resistance to the train in a cell [N]."""
    a, b, c = mesh.resistance_constant_n, mesh.resistance_linear, mesh.resistance_quadratic[number]
    resisting: float = mesh.line_force_n[number] + running_resistance(a, b, c, speed, speed * speed)
    return resisting + starting_resistance(mesh.starting_n, mesh.starting_ends_ms, speed)


@njit(cache=True)
def _strongest_brake_n(mesh: MeshData, speed: float) -> float:
    return max_effort(mesh.braking, max(speed, NEARLY_AT_REST_MS)) + mesh.friction_effort_n


@njit(cache=True)
def _within_limits(mesh: MeshData, effort: float, speed: float, resisting: float) -> float:
    """Return an effort [N] cut to the limits of effort and acceleration at a speed [m/s]."""
    mass = 2.0 * mesh.half_inertia_kg
    most = min(max_effort(mesh.traction, max(speed, NEARLY_AT_REST_MS)), mass * mesh.max_acceleration_ms2 + resisting)
    least = max(-_strongest_brake_n(mesh, speed), resisting - mass * mesh.max_deceleration_ms2)
    return max(min(effort, most), least)


@njit(cache=True)
def _step(mesh: MeshData, number: int, effort: float, speed: float, step_s: float) -> tuple[float, float]:
    """Return distance [m] and speed [m/s] after a step of time at one effort, by the rule of Runge and Kutta."""
    mass = 2.0 * mesh.half_inertia_kg
    # below rest the resistance would push, so it is taken at rest there; that the train stops shows in the result
    k1 = (effort - _resisting_n(mesh, number, speed)) / mass
    k2 = (effort - _resisting_n(mesh, number, max(speed + 0.5 * step_s * k1, 0.0))) / mass
    k3 = (effort - _resisting_n(mesh, number, max(speed + 0.5 * step_s * k2, 0.0))) / mass
    k4 = (effort - _resisting_n(mesh, number, max(speed + step_s * k3, 0.0))) / mass
    # the same rule for the place, whose four slopes are the speeds v, v + h k1 / 2, v + h k2 / 2, v + h k3
    distance = step_s * (speed + step_s * (k1 + k2 + k3) / 6.0)
    return distance, speed + step_s * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0


@njit(cache=True)
def _relay_request(mesh: MeshData, relay: Relay, limit_ms: float, speed: float) -> float:
    """Return the effort that (5) asks for [N]; braking is negative."""
    if speed < limit_ms - relay.dead_zone_ms:
        return max_effort(mesh.traction, max(speed, NEARLY_AT_REST_MS))
    if speed > limit_ms + relay.dead_zone_ms:
        return -max_effort(mesh.braking, max(speed, NEARLY_AT_REST_MS))
    return 0.0


@njit(cache=True)
def _curve_at(position_m: FloatArray, curve_speed2: FloatArray, cell: int, place: float) -> float:
    """Return the square of speed [m2/s2] that the braking curve has at a place [m], in a cell or later."""
    last = position_m.shape[0] - 2
    while cell < last and position_m[cell + 1] <= place:
        cell += 1
    share = min((place - position_m[cell]) / (position_m[cell + 1] - position_m[cell]), 1.0)
    speed2: float = curve_speed2[cell] + share * (curve_speed2[cell + 1] - curve_speed2[cell])
    return speed2


@njit(cache=True)
def _must_brake(
    mesh: MeshData,
    position_m: FloatArray,
    curve_speed2: FloatArray,
    motion: Motion,
    brake: float,
    rate: float,
    step_s: float,
) -> bool:
    """Return whether a train that changes its effort to a brake [N] from the next step on would pass the curve."""
    mass = 2.0 * mesh.half_inertia_kg
    acceleration = (motion.effort_n - _resisting_n(mesh, motion.cell, motion.speed_ms)) / mass
    place = motion.place_m + step_s * (motion.speed_ms + 0.5 * step_s * acceleration)
    speed = motion.speed_ms + step_s * acceleration
    # effort falls evenly with time and the acceleration with it, the resistance taken as it is now; speed and place are
    # the integrals, v + a t - j t^2 / 2 and v t + a t^2 / 2 - j t^3 / 6
    jerk, duration = rate / mass, max(motion.effort_n + brake, 0.0) / rate
    for number in range(RAMP_POINTS + 1):
        t = duration * number / RAMP_POINTS
        later = max(speed + t * (acceleration - 0.5 * t * jerk), 0.0)
        at = place + t * (speed + t * (0.5 * acceleration - t * jerk / 6.0))
        if at > position_m[-1] or later * later > _curve_at(position_m, curve_speed2, motion.cell, at):
            return True
        if later <= 0.0:
            break
    return False


@njit(cache=True)
def _request(
    mesh: MeshData,
    regulation: Regulation,
    curve_speed2: FloatArray,
    limit_ms: float,
    relay: Relay,
    rate: float,
    motion: Motion,
) -> tuple[float, bool]:
    """Return the effort that relay and braking curve ask for [N], and whether it is the curve that does."""
    requested = _relay_request(mesh, relay, limit_ms, motion.speed_ms)
    mass, speed, place = 2.0 * mesh.half_inertia_kg, motion.speed_ms, motion.place_m
    resisting = _resisting_n(mesh, motion.cell, speed)
    brake = min(max(mass * regulation.deceleration_ms2 - resisting, 0.0), _strongest_brake_n(mesh, speed))
    # the speed that the curve has after the time in which the brake can be built up or taken off again
    reach = min(speed * (brake / rate + 2.0 * relay.time_step_s), regulation.position_m[-1] - place)
    if reach <= 0.0:
        return requested, False
    wanted2 = _curve_at(regulation.position_m, curve_speed2, motion.cell, place + reach)
    # dv/dt = dv^2/ds / 2: the acceleration with which the train meets the curve there
    change2 = (wanted2 - speed * speed) / (2.0 * reach)
    if motion.braking and change2 < 0.0:
        return min(requested, mass * change2 + resisting), True
    if _must_brake(mesh, regulation.position_m, curve_speed2, motion, brake, rate, relay.time_step_s):
        # effort takes its time to fall: it falls as fast as it can until the train is on the curve, or slow enough
        return min(requested, -brake), change2 < 0.0
    return requested, False


@njit(cache=True)
def _end_of(mesh: MeshData, relay: Relay, motion: Motion, remaining: float) -> int:
    """Return how a trip ends whose next step passes its end or comes to rest: one effort shall lead to rest there."""
    deceleration = motion.speed_ms * motion.speed_ms / (2.0 * remaining)
    # half of the speed is the mean one of a train that slows down evenly to rest, in 2 s / v
    resisting = _resisting_n(mesh, motion.cell, 0.5 * motion.speed_ms)
    effort = resisting - 2.0 * mesh.half_inertia_kg * deceleration
    cut = _within_limits(mesh, effort, 0.5 * motion.speed_ms, resisting)
    if cut > effort:
        return OVERSHOOTS
    # that time no longer than the regulator takes to change its effort anyhow, or the train would creep
    creeps = 2.0 * remaining > motion.speed_ms * max(relay.full_effort_time_s, relay.time_step_s)
    return STANDS if creeps or cut < effort else ARRIVED


@njit(cache=True)
def _advance(
    mesh: MeshData,
    regulation: Regulation,
    curve_speed2: FloatArray,
    borders_m: FloatArray,
    limits_ms: FloatArray,
    relay: Relay,
    motion: Motion,
) -> tuple[Motion, int]:
    """Return the state of a train after a step of time, and whether it goes on from there or how the trip ends."""
    place, speed, cell, section = motion.place_m, motion.speed_ms, motion.cell, motion.section
    while cell < regulation.top_speed2.shape[0] - 1 and regulation.position_m[cell + 1] <= place:
        cell += 1
    while section < borders_m.shape[0] and borders_m[section] <= place:
        section += 1
    here = Motion(place, speed, motion.effort_n, motion.braking, motion.request, cell, section)
    rate = max_effort(mesh.traction, NEARLY_AT_REST_MS) / relay.full_effort_time_s
    limit = min(limits_ms[section], math.sqrt(regulation.top_speed2[cell]))
    requested, braking = _request(mesh, regulation, curve_speed2, limit, relay, rate, here)
    slow = requested > motion.effort_n >= 0.0 and speed >= relay.regulation_speed_ms
    change = rate * relay.time_step_s * (relay.effort_rate_share if slow else 1.0)
    effort = motion.effort_n + min(max(requested - motion.effort_n, -change), change)
    resisting = _resisting_n(mesh, cell, speed)
    effort = _within_limits(mesh, effort, speed, resisting)
    moved, after = _step(mesh, cell, effort, speed, relay.time_step_s)
    middle = 0.5 * (speed + max(after, 0.0))
    cut = _within_limits(mesh, effort, middle, resisting)
    if cut != effort:
        # a limit of power or motors holds at the mean speed of the step
        effort = cut
        moved, after = _step(mesh, cell, effort, speed, relay.time_step_s)
    request = 1 if requested > 0.0 else -1 if requested < 0.0 else 0
    remaining = regulation.position_m[-1] - place
    if speed <= 0.0 and after <= 0.0:
        # the effort grows until it moves the train, or is all there is
        return Motion(place, 0.0, effort, braking, request, cell, section), GOES_ON if effort < requested else STANDS
    if moved >= remaining or after <= 0.0 or (braking and 2.0 * remaining <= speed * relay.time_step_s):
        return Motion(place, speed, effort, braking, request, cell, section), _end_of(mesh, relay, here, remaining)
    return Motion(place + moved, after, effort, braking, request, cell, section), GOES_ON


@njit(cache=True, error_model="numpy", nogil=True)
def literal_trip(
    mesh: MeshData,
    regulation: Regulation,
    curve_speed2: FloatArray,
    borders_m: FloatArray,
    limits_ms: FloatArray,
    relay: Relay,
    max_steps: int,
) -> tuple[FloatArray, FloatArray, FloatArray, float, int, int]:
    """Drive once with the relay.

    Parameters
    ----------
    mesh, regulation : MeshData, Regulation
        Train and line, and a regulator that does not brake ahead for sections.
    curve_speed2 : array of shape (n + 1,)
        Squares of speed from which braking keeps the line's limits and stops, at the nodes [m2/s2].
    borders_m : array of shape (k - 1,)
        Between sections, rising [m].
    limits_ms : array of shape (k,)
        Of the sections [m/s].
    relay : Relay
        How the regulator is set.
    max_steps : int
        A trip of more steps goes on at its end.

    Returns
    -------
    position_m, speed2, effort_n : array of shape (m,)
        Places [m] and squares of speed [m2/s2], one for each step of time that moves, and efforts that led there [N].
    standing_s, switches, status : float and ints
        For how long the train stood at its start while effort grew [s], how often the effort asked for changed between
        driving, none and braking, and how it ended.
    """
    w0 = max(mesh.fixed_speed2[0], 0.0)
    motion, status = Motion(regulation.position_m[0], math.sqrt(w0), 0.0, False, 0, 0, 0), GOES_ON
    position, speed2, effort = np.empty(max_steps + 1), np.empty(max_steps + 1), np.zeros(max_steps + 1)
    position[0], speed2[0] = motion.place_m, w0
    nodes, switches, standing = 1, 0, 0.0
    # a step that does not move the train counts as well: one whose effort never suffices would stand for ever
    for _ in range(max_steps):
        then, status = _advance(mesh, regulation, curve_speed2, borders_m, limits_ms, relay, motion)
        switches += then.request != motion.request
        if status == ARRIVED:
            position[nodes], speed2[nodes], effort[nodes] = regulation.position_m[-1], 0.0, then.effort_n
            nodes += 1
        if status != GOES_ON:
            break
        if then.place_m > motion.place_m:
            speed = then.speed_ms
            position[nodes], speed2[nodes], effort[nodes] = then.place_m, speed * speed, then.effort_n
            nodes += 1
        else:
            standing += relay.time_step_s
        motion = then
    return position[:nodes], speed2[:nodes], effort[:nodes], standing, switches, status
