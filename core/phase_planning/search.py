"""The best start / cruise / coast / brake run, by one search over the speed of the cruise.

Unknown are the speed v1 of the cruise, its length, and the speed v2 at which braking begins. For a v1, time and
distance decide the other two: v1 times the time that coasting and braking take, less the way that they cover, falls
with v2. From the least v1, whose run does not coast, to the greatest, whose run does not cruise, energy has one
minimum. A run that begins in motion reaches v1 by starting, by coasting or by braking.

Source: Rawicki, (44)-(55), for one part.
"""

import math

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.drive.kernels import driving_power
from railjoule.core.physics.resistance import running_resistance

SPEED, TIME, DISTANCE, ENERGY = range(4)
SLOPES = 3
START, COAST, BRAKE = range(3)
IN_TIME, TOO_LATE, TOO_EARLY = range(3)
HALVINGS = 60
EXACT = 1e-13
GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)
NARROWINGS, SCANNED = 32, 12
LEAST_BRAKED_SPEED2 = 1e-4
"""What the last brake takes off at least, in speed squared [m2/s2]: braking before a stop begins at 0.036 km/h or more.
From less it would be a cell of some micrometres, whose force is rounding far from the start of a line."""


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
    x = (speed - table[SPEED, low]) / step
    left, right = x * (1.0 - x) * (1.0 - x) * step, x * x * (x - 1.0) * step
    rise = x * x * (3.0 - 2.0 * x)
    return (
        table[1, low] + rise * (table[1, high] - table[1, low]) + left * table[4, low] + right * table[4, high],
        table[2, low] + rise * (table[2, high] - table[2, low]) + left * table[5, low] + right * table[5, high],
        table[3, low] + rise * (table[3, high] - table[3, low]) + left * table[6, low] + right * table[6, high],
    )


@njit(cache=True)
def between(table: FloatArray, low: float, high: float) -> tuple[float, float, float]:
    """Return time [s], distance [m] and energy [J] from one speed of a table to a higher one."""
    t1, s1, e1 = table_at(table, high)
    t0, s0, e0 = table_at(table, low)
    return t1 - t0, s1 - s0, e1 - e0


@njit(cache=True)
def _cruise_power(kind: int, parameters: FloatArray, resistance: FloatArray, speed: float) -> float:
    effort = running_resistance(resistance[0], resistance[1], resistance[2], speed, speed * speed)
    return driving_power(kind, parameters, effort, speed)[0]


@njit(cache=True)
def _run_down(
    coast: FloatArray, brake: FloatArray, cruise_speed: float, time: float, distance: float, final: float
) -> tuple[float, float, int]:
    """Return the speed at which braking begins, the length of the cruise, and whether the run is in time."""
    aim = cruise_speed * time - distance
    stop_time, stop_distance, _ = between(brake, final, cruise_speed)
    if cruise_speed * stop_time - stop_distance > aim:
        return cruise_speed, distance - stop_distance, TOO_LATE
    low, high = min(math.sqrt(final * final + LEAST_BRAKED_SPEED2), cruise_speed), cruise_speed
    coast_time, coast_distance, _ = between(coast, low, cruise_speed)
    last_time, last_distance, _ = between(brake, final, low)
    coast_time, coast_distance = coast_time + last_time, coast_distance + last_distance
    if cruise_speed * coast_time - coast_distance < aim:
        return low, distance - coast_distance, TOO_EARLY
    # regula falsi with halved ends (Illinois)
    above, below, kept = (
        cruise_speed * coast_time - coast_distance - aim,
        cruise_speed * stop_time - stop_distance - aim,
        0,
    )
    for _ in range(HALVINGS):
        if high - low <= EXACT * cruise_speed:
            break
        middle = (low * below - high * above) / (below - above) if below < above else 0.5 * (low + high)
        t_coast, s_coast, _ = between(coast, middle, cruise_speed)
        t_brake, s_brake, _ = between(brake, final, middle)
        excess = cruise_speed * (t_coast + t_brake) - (s_coast + s_brake) - aim
        if excess > 0.0:
            low, above = middle, excess
            below *= 0.5 if kept == 1 else 1.0
            kept = 1
        else:
            high, below = middle, excess
            above *= 0.5 if kept == -1 else 1.0
            kept = -1
        if excess == 0.0:
            low = high = middle
    speed = 0.5 * (low + high)
    cruise = distance - between(coast, speed, cruise_speed)[1] - between(brake, final, speed)[1]
    return speed, cruise, IN_TIME if cruise >= 0.0 else TOO_EARLY


@njit(cache=True)
def _approach(
    start: FloatArray,
    coast: FloatArray,
    brake: FloatArray,
    first: int,
    initial: float,
    cruise_speed: float,
    cycles: int,
    bottom_share: float,
) -> tuple[float, float, float]:
    """Return time, distance and energy until the cruise begins, further cycles included."""
    if first == START:
        time, distance, energy = between(start, initial, cruise_speed)
    elif first == COAST:
        time, distance, energy = between(coast, cruise_speed, initial)
    else:
        time, distance, energy = between(brake, cruise_speed, initial)
    if cycles > 1:
        again = float(cycles - 1)
        bottom = bottom_share * cruise_speed
        t_coast, s_coast, _ = between(coast, bottom, cruise_speed)
        t_start, s_start, e_start = between(start, bottom, cruise_speed)
        time += again * (t_coast + t_start)
        distance += again * (s_coast + s_start)
        energy += again * e_start
    return time, distance, energy


@njit(cache=True)
def _run_at(
    start: FloatArray,
    coast: FloatArray,
    brake: FloatArray,
    kind: int,
    parameters: FloatArray,
    resistance: FloatArray,
    task: FloatArray,
    first: int,
    cycles: int,
    bottom_share: float,
    cruise_speed: float,
) -> tuple[float, float, float, int]:
    """Return energy, braking speed, length of the cruise and timeliness of the run with a cruising speed."""
    distance, time, initial, final = task[0], task[1], task[2], task[3]
    t0, s0, e0 = _approach(start, coast, brake, first, initial, cruise_speed, cycles, bottom_share)
    rest = distance - s0 - between(brake, final, cruise_speed)[1]
    if rest < 0.0:
        # so fast that it cannot stop in time: as a run that is early, it needs a lower speed
        return math.inf, cruise_speed, rest, TOO_EARLY
    if time <= t0:
        return math.inf, cruise_speed, rest, TOO_LATE
    speed, cruise, when = _run_down(coast, brake, cruise_speed, time - t0, distance - s0, final)
    if when == IN_TIME or cruise >= 0.0:
        power = _cruise_power(kind, parameters, resistance, cruise_speed)
        energy = e0 + power * cruise / cruise_speed + between(brake, final, speed)[2]
    else:
        energy = math.inf
    return energy, speed, cruise, when


@njit(cache=True)
def _border(
    start: FloatArray,
    coast: FloatArray,
    brake: FloatArray,
    kind: int,
    parameters: FloatArray,
    resistance: FloatArray,
    task: FloatArray,
    first: int,
    cycles: int,
    bottom_share: float,
    low: float,
    high: float,
    asked: int,
) -> tuple[float, float]:
    """Return the two neighbouring speeds between which a run stops to be late, or begins to be early."""
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        when = _run_at(start, coast, brake, kind, parameters, resistance, task, first, cycles, bottom_share, middle)[3]
        below = when == TOO_LATE if asked == TOO_LATE else when != TOO_EARLY
        if below:
            low = middle
        else:
            high = middle
    return low, high


@njit(cache=True)
def _shortest_coast(
    coast: FloatArray, brake: FloatArray, distance: float, initial: float, final: float, low: float
) -> float:
    """Return the least speed to which a train can coast on its way and still brake."""
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


@njit(cache=True, nogil=True)
def search_run(
    start: FloatArray,
    coast: FloatArray,
    brake: FloatArray,
    kind: int,
    parameters: FloatArray,
    resistance: FloatArray,
    task: FloatArray,
    first: int,
    cycles: int,
    bottom_share: float,
    cruising: bool,
    coasting: bool,
) -> tuple[float, float, float, float]:
    """Return the run of least energy that reaches its cruise in one way.

    Parameters
    ----------
    start, coast, brake : array of shape (7, k)
        Tables of `tables`.
    kind, parameters
        The drive.
    resistance : array of shape (3,)
        Constant, linear and quadratic coefficient of all that resists.
    task : array of shape (4,)
        Distance [m], time [s], initial and final speed [m/s].
    first : int
        START, COAST or BRAKE: how the run reaches its cruising speed.
    cycles : int
        How often it starts.
    bottom_share : float
        Speed at which it starts again, over that of the cruise.
    cruising, coasting : bool
        Whether it may cruise before, and coast after the last start.

    Returns
    -------
    energy, cruise_speed, brake_speed, cruise : float
        Line energy without auxiliaries [J], infinite where there is no such run; speeds [m/s]; length [m].
    """
    initial, final = task[2], task[3]
    if first == START:
        low, high = max(initial, final), start[SPEED, start.shape[1] - 1]
        if initial == 0.0:
            low = max(low, 1e-6 * high)
    else:
        low, high = max(final, 1e-6 * initial), initial
        if first == COAST:
            low = _shortest_coast(coast, brake, distance=task[0], initial=initial, final=final, low=low)
    if not low <= high:
        return math.inf, 0.0, 0.0, 0.0
    same = (start, coast, brake, kind, parameters, resistance, task, first, cycles, bottom_share)
    slowest, fastest = low, high
    if _run_at(*same, low)[3] == TOO_LATE:
        _, slowest = _border(*same, low, high, TOO_LATE)
    if _run_at(*same, high)[3] == TOO_EARLY:
        fastest, _ = _border(*same, slowest, high, TOO_EARLY)
    if _run_at(*same, slowest)[3] != IN_TIME or fastest < slowest:
        return math.inf, 0.0, 0.0, 0.0
    if not coasting:
        fastest = slowest
    elif not cruising:
        slowest = fastest
    best, best_speed = math.inf, slowest
    width = (fastest - slowest) / SCANNED
    for i in range(SCANNED + 1):
        speed = fastest if i == SCANNED else slowest + i * width
        energy, _, _, when = _run_at(*same, speed)
        if when == IN_TIME and energy < best:
            best, best_speed = energy, speed
    left, right = max(best_speed - width, slowest), min(best_speed + width, fastest)
    inner_left, inner_right = right - GOLDEN * (right - left), left + GOLDEN * (right - left)
    at_left, at_right = _run_at(*same, inner_left)[0], _run_at(*same, inner_right)[0]
    for _ in range(NARROWINGS):
        if at_left < at_right:
            right, inner_right, at_right = inner_right, inner_left, at_left
            inner_left = right - GOLDEN * (right - left)
            at_left = _run_at(*same, inner_left)[0]
        else:
            left, inner_left, at_left = inner_left, inner_right, at_right
            inner_right = left + GOLDEN * (right - left)
            at_right = _run_at(*same, inner_right)[0]
    if min(at_left, at_right) < best:
        best_speed = inner_left if at_left < at_right else inner_right
    energy, brake_speed, cruise, _ = _run_at(*same, best_speed)
    return energy, best_speed, brake_speed, cruise
