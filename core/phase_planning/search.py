"""The best start / cruise / coast / brake run, by one search over the speed of the cruise.

Unknown are the speed v1 of the cruise, its length, and the speed v2 at which braking begins. For a v1, time and
distance decide the other two. Let T and S be what is left of time and distance at the end of the first start, t and s
what coasting and braking take; the cruise takes the rest of both, so that S - s = v1 (T - t), or

    v1 t - s = v1 T - S.

Its left side is the distance that is lost against holding v1. It falls as v2 rises, since coasting less loses less, so
that v2 is the root of a monotone function. From the least v1, whose run does not coast, to the greatest, whose run does
not cruise, energy has one minimum. A run that begins in motion reaches v1 by starting, by coasting or by braking.

Source: Rawicki, (44)-(55), for one part.
"""

import math
from typing import NamedTuple

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.drive.kernels import driving_power
from railjoule.core.golden_section import Bracket, inner_points, min_point, narrowed, next_point
from railjoule.core.physics.resistance import running_resistance

SPEED, TIME, DISTANCE, ENERGY = range(4)
DERIVATIVES = 3
"""So many rows below time, distance and energy stand their derivatives by speed."""
START, COAST, BRAKE = range(3)
IN_TIME, TOO_LATE, TOO_EARLY = range(3)
# a bisection of doubles has come to neighbouring numbers after 53 halvings; more cost nothing, fewer leave a run at the
# border of its range on the wrong side of it
HALVINGS = 60
# some hundreds of roundings of a speed: closer, the loss of distance, a difference of hundreds of metres, is noise
SPEED_TOLERANCE = 1e-13
# a scan in 12 steps finds the valley, 32 golden sections narrow it to 2 * 0.618^32 = 4e-7 of a step. In all scenarios
# tried energy over v1 has one minimum: 3 or 24 steps and 16 or 64 sections change energies by less than 0.001 ppm
NARROWINGS, SCANNED = 32, 12
# what the last brake takes off at least, in speed squared [m2/s2]: braking before a stop begins at 0.036 km/h or more.
# From less it would be a cell of some micrometres, whose force is rounding far from the start of a line
MIN_BRAKED_SPEED2 = 1e-4
# the slowest cruise, over the highest speed: at v1 = 0 a cruise of some length would take for ever
SLOWEST_CRUISE = 1e-6


class PhaseTables(NamedTuple):
    """A train on a line without changes, as the search takes it.

    Parameters
    ----------
    start, coast, brake : array of shape (7, k)
        Tables of `tables`: speed [m/s]; time [s], distance [m] and energy [J] from rest to it, or from it to rest; and
        the derivatives of these three by speed.
    drive_kind, drive_parameters : int and array
        What `railjoule.core.drive.kernels` take.
    resistance : tuple of 3 floats
        Constant, linear and quadratic coefficient of all that resists [N, N s/m, N s2/m2].
    """

    start: FloatArray
    coast: FloatArray
    brake: FloatArray
    drive_kind: int
    drive_parameters: FloatArray
    resistance: tuple[float, float, float]


class PhaseTask(NamedTuple):
    """The task of a run: distance [m], running time [s], and the speeds at its ends [m/s]."""

    distance_m: float
    running_time_s: float
    initial_speed_ms: float
    final_speed_ms: float


class Opening(NamedTuple):
    """How a run comes to its cruise.

    Parameters
    ----------
    first : int
        START, COAST or BRAKE: how it first reaches the speed of the cruise.
    cycles : int
        How often it starts; between two starts it coasts.
    restart_fraction : float
        Speed at which it starts again, over that of the cruise.
    """

    first: int
    cycles: int
    restart_fraction: float


@njit(cache=True)
def table_at(table: FloatArray, speed: float) -> tuple[float, float, float]:
    """Return time [s], distance [m] and energy [J] of a table at a speed [m/s]."""
    low, high = 0, table.shape[1] - 1
    while high - low > 1:
        middle = (low + high) // 2
        if table[SPEED, middle] <= speed:
            low = middle
        else:
            high = middle
    step = table[SPEED, high] - table[SPEED, low]
    # Hermite's cubic: h01 weighs the increase over the piece, h10 and h11 the derivatives at its ends
    x = (speed - table[SPEED, low]) / step
    h10, h11 = x * (1.0 - x) * (1.0 - x) * step, x * x * (x - 1.0) * step
    h01 = x * x * (3.0 - 2.0 * x)
    return (
        _on_cubic(table[TIME], table[TIME + DERIVATIVES], low, h01, h10, h11),
        _on_cubic(table[DISTANCE], table[DISTANCE + DERIVATIVES], low, h01, h10, h11),
        _on_cubic(table[ENERGY], table[ENERGY + DERIVATIVES], low, h01, h10, h11),
    )


@njit(cache=True)
def _on_cubic(value: FloatArray, derivative: FloatArray, low: int, h01: float, h10: float, h11: float) -> float:
    high = low + 1
    return float(value[low] + h01 * (value[high] - value[low]) + h10 * derivative[low] + h11 * derivative[high])


@njit(cache=True)
def between(table: FloatArray, low: float, high: float) -> tuple[float, float, float]:
    """Return time [s], distance [m] and energy [J] from one speed of a table to a higher one."""
    t1, s1, e1 = table_at(table, high)
    t0, s0, e0 = table_at(table, low)
    return t1 - t0, s1 - s0, e1 - e0


@njit(cache=True)
def _cruise_power(train: PhaseTables, speed: float) -> float:
    constant, linear, quadratic = train.resistance
    effort = running_resistance(constant, linear, quadratic, speed, speed * speed)
    return driving_power(train.drive_kind, train.drive_parameters, effort, speed)[0]


@njit(cache=True)
def _braking_speed(
    train: PhaseTables, cruise_speed: float, time: float, distance: float, final: float
) -> tuple[float, float, int]:
    """Return the speed at which braking begins, the length of the cruise, and whether the run is in time.

    Its equation is v1 t - s = v1 T - S, see above, for the time T and the distance S that the approach leaves.
    """
    coast, brake = train.coast, train.brake
    allowed_loss = cruise_speed * time - distance
    brake_time, brake_distance, _ = between(brake, final, cruise_speed)
    if cruise_speed * brake_time - brake_distance > allowed_loss:
        # even braking from v1, without coasting, loses too much
        return cruise_speed, distance - brake_distance, TOO_LATE
    low, high = min(math.sqrt(final * final + MIN_BRAKED_SPEED2), cruise_speed), cruise_speed
    coast_time, coast_distance, _ = between(coast, low, cruise_speed)
    last_time, last_distance, _ = between(brake, final, low)
    coast_time, coast_distance = coast_time + last_time, coast_distance + last_distance
    if cruise_speed * coast_time - coast_distance < allowed_loss:
        return low, distance - coast_distance, TOO_EARLY
    # regula falsi; an end that stays twice has its value halved (Illinois), or it might stay for ever
    value_low = cruise_speed * coast_time - coast_distance - allowed_loss
    value_high = cruise_speed * brake_time - brake_distance - allowed_loss
    moved_before = 0
    for _ in range(HALVINGS):
        if high - low <= SPEED_TOLERANCE * cruise_speed:
            break
        falls = value_high < value_low
        middle = (low * value_high - high * value_low) / (value_high - value_low) if falls else 0.5 * (low + high)
        t_coast, s_coast, _ = between(coast, middle, cruise_speed)
        t_brake, s_brake, _ = between(brake, final, middle)
        excess = cruise_speed * (t_coast + t_brake) - (s_coast + s_brake) - allowed_loss
        if excess > 0.0:
            low, value_low = middle, excess
            value_high *= 0.5 if moved_before == 1 else 1.0
            moved_before = 1
        else:
            high, value_high = middle, excess
            value_low *= 0.5 if moved_before == -1 else 1.0
            moved_before = -1
        if excess == 0.0:
            low = high = middle
    speed = 0.5 * (low + high)
    cruise = distance - between(coast, speed, cruise_speed)[1] - between(brake, final, speed)[1]
    # a cruise of negative length: v1 is reached, but only by a train that is early and has nothing left to cruise
    return speed, cruise, IN_TIME if cruise >= 0.0 else TOO_EARLY


@njit(cache=True)
def _approach(train: PhaseTables, opening: Opening, initial: float, cruise_speed: float) -> tuple[float, float, float]:
    """Return time [s], distance [m] and energy [J] until the cruise begins, further cycles included."""
    if opening.first == START:
        time, distance, energy = between(train.start, initial, cruise_speed)
    elif opening.first == COAST:
        time, distance, energy = between(train.coast, cruise_speed, initial)
    else:
        time, distance, energy = between(train.brake, cruise_speed, initial)
    if opening.cycles > 1:
        again = float(opening.cycles - 1)
        restart = opening.restart_fraction * cruise_speed
        t_coast, s_coast, _ = between(train.coast, restart, cruise_speed)
        t_start, s_start, e_start = between(train.start, restart, cruise_speed)
        time += again * (t_coast + t_start)
        distance += again * (s_coast + s_start)
        energy += again * e_start
    return time, distance, energy


@njit(cache=True)
def _run_at(
    train: PhaseTables, task: PhaseTask, opening: Opening, cruise_speed: float
) -> tuple[float, float, float, int]:
    """Return energy, braking speed, length of the cruise and timeliness of the run with a cruising speed."""
    final = task.final_speed_ms
    time, distance, energy = _approach(train, opening, task.initial_speed_ms, cruise_speed)
    rest = task.distance_m - distance - between(train.brake, final, cruise_speed)[1]
    if rest < 0.0:
        # so fast that it cannot stop in time: as a run that is early, it needs a lower speed
        return math.inf, cruise_speed, rest, TOO_EARLY
    if task.running_time_s <= time:
        return math.inf, cruise_speed, rest, TOO_LATE
    time_left, distance_left = task.running_time_s - time, task.distance_m - distance
    speed, cruise, when = _braking_speed(train, cruise_speed, time_left, distance_left, final)
    if when == IN_TIME or cruise >= 0.0:
        power = _cruise_power(train, cruise_speed)
        energy = energy + power * cruise / cruise_speed + between(train.brake, final, speed)[2]
    else:
        energy = math.inf
    return energy, speed, cruise, when


@njit(cache=True)
def _border(
    train: PhaseTables, task: PhaseTask, opening: Opening, low: float, high: float, outside: int
) -> tuple[float, float]:
    """Return the two neighbouring speeds between which runs stop to be too late, or begin to be too early."""
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        when = _run_at(train, task, opening, middle)[3]
        below = when == TOO_LATE if outside == TOO_LATE else when != TOO_EARLY
        if below:
            low = middle
        else:
            high = middle
    return low, high


@njit(cache=True)
def _shortest_coast(
    coast: FloatArray, brake: FloatArray, distance: float, initial: float, final: float, low: float
) -> float:
    """Return the least speed [m/s] to which a train can coast over a distance and still brake."""
    high = initial
    if between(coast, low, initial)[1] + between(brake, final, low)[1] <= distance:
        return low
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if between(coast, middle, initial)[1] + between(brake, final, middle)[1] <= distance:
            high = middle
        else:
            low = middle
    return high


@njit(cache=True)
def _cruise_range(train: PhaseTables, task: PhaseTask, opening: Opening) -> tuple[float, float]:
    """Return the least and the greatest cruising speed of runs in time [m/s]; the first is greater if there is none."""
    initial, final = task.initial_speed_ms, task.final_speed_ms
    if opening.first == START:
        low, high = max(initial, final), train.start[SPEED, train.start.shape[1] - 1]
        if initial == 0.0:
            low = max(low, SLOWEST_CRUISE * high)
    else:
        low, high = max(final, SLOWEST_CRUISE * initial), initial
        if opening.first == COAST:
            low = _shortest_coast(train.coast, train.brake, task.distance_m, initial, final, low)
    if not low <= high:
        return math.inf, -math.inf
    # slower runs are late, faster ones early: what is in time lies between two borders
    slowest, fastest = low, high
    if _run_at(train, task, opening, low)[3] == TOO_LATE:
        _, slowest = _border(train, task, opening, low, high, TOO_LATE)
    if _run_at(train, task, opening, high)[3] == TOO_EARLY:
        fastest, _ = _border(train, task, opening, slowest, high, TOO_EARLY)
    if _run_at(train, task, opening, slowest)[3] != IN_TIME:
        return math.inf, -math.inf
    return slowest, fastest


@njit(cache=True, nogil=True)
def search_run(
    train: PhaseTables, task: PhaseTask, opening: Opening, cruising: bool, coasting: bool
) -> tuple[float, float, float, float]:
    """Return the run of least energy that comes to its cruise in one way.

    Parameters
    ----------
    train : PhaseTables
        The train on its line.
    task : PhaseTask
        Distance, time and the speeds at the ends.
    opening : Opening
        How it comes to its cruise.
    cruising, coasting : bool
        Whether it may cruise before, and coast after the last start.

    Returns
    -------
    energy, cruise_speed, brake_speed, cruise : float
        Line energy without auxiliaries [J], infinite where there is no such run; speeds [m/s]; length [m].
    """
    slowest, fastest = _cruise_range(train, task, opening)
    if fastest < slowest:
        return math.inf, 0.0, 0.0, 0.0
    # time and distance leave no choice without coasting, where v1 is least, or without a cruise, where it is greatest
    if not coasting:
        fastest = slowest
    elif not cruising:
        slowest = fastest
    best, best_speed = math.inf, slowest
    width = (fastest - slowest) / SCANNED
    for i in range(SCANNED + 1):
        speed = fastest if i == SCANNED else slowest + i * width
        energy, _, _, when = _run_at(train, task, opening, speed)
        if when == IN_TIME and energy < best:
            best, best_speed = energy, speed
    left, right = max(best_speed - width, slowest), min(best_speed + width, fastest)
    inner_left, inner_right = inner_points(left, right)
    at_left = _run_at(train, task, opening, inner_left)[0]
    at_right = _run_at(train, task, opening, inner_right)[0]
    bracket = Bracket(left, inner_left, inner_right, right, at_left, at_right)
    for _ in range(NARROWINGS):
        bracket = narrowed(bracket, _run_at(train, task, opening, next_point(bracket))[0])
    if min(bracket.value_left, bracket.value_right) < best:
        best_speed = min_point(bracket)
    energy, brake_speed, cruise, _ = _run_at(train, task, opening, best_speed)
    return energy, best_speed, brake_speed, cruise
