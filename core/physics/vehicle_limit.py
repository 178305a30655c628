"""Limits of the efforts of a vehicle: its own table in the file, its drive, and what a place of the line leaves."""

from functools import lru_cache

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.drive import Drive
from railjoule.core.errors import ScenarioError
from railjoule.core.physics.adhesion import adhesion_coefficient
from railjoule.core.physics.effort_limit import SLOWEST_MS, EffortLimit, fitted_limit, table_speeds
from railjoule.core.physics.place_limits import UNLIMITED, PlaceLimits
from railjoule.core.scenario import Vehicle
from railjoule.core.scenario.vehicle import Braking, Traction
from railjoule.core.units import MS_PER_KMH, N_PER_KN, W_PER_KW

# halved as often, any bracket of efforts is below rounding
HALVINGS = 60
Curve = tuple[tuple[float, float], ...]
# an effort that jumped with speed would leave a solver without slopes; over so little a train gains nothing
RAMP_MS = 0.01
"""A step of a curve is a ramp of this width, on the side of the higher effort [m/s]."""
# an interior point needs some room below a limit: ten times what the fit of a table may take away
LEAST_SHARE = 1e-5
"""A point of a curve without effort has this share of the largest one."""


def curve_effort_n(curve: Curve, speed_ms: FloatArray) -> FloatArray:
    """Return the effort of a curve [N] at speeds [m/s], straight between its points [km/h, kN].

    Beyond its last point the power of that one goes on: what a motor gives at its limit of voltage, not what it pulls.
    A step, two points at one speed, is a ramp of at most `RAMP_MS` on the side of the higher effort: at the step itself
    and everywhere else the effort is at most that of the curve.
    """
    speed = np.asarray(speed_ms, dtype=float)
    places, efforts = _without_steps(curve)
    # 1 up to the last point, and from there its speed over the actual one: P = F v stays
    beyond = np.minimum(1.0, places[-1] / np.maximum(speed, places[-1]))
    effort: FloatArray = np.interp(speed, places, efforts) * beyond
    return effort


def _without_steps(curve: Curve) -> tuple[FloatArray, FloatArray]:
    """Return rising speeds [m/s] and efforts [N] of the points of a curve, its steps as ramps."""
    points = np.array(curve)
    places, efforts = points[:, 0] * MS_PER_KMH, points[:, 1] * N_PER_KN
    efforts = np.maximum(efforts, LEAST_SHARE * efforts.max())
    ramped, rise = places.copy(), np.zeros(len(places))
    for i in np.flatnonzero(np.diff(places) == 0):
        # the higher point moves away from the step, but not to the next point
        higher, beyond = (i, i - 1) if efforts[i] > efforts[i + 1] else (i + 1, i + 2)
        side = -1 if higher == i else 1
        free = abs(places[beyond] - places[i]) if 0 <= beyond < len(places) else RAMP_MS
        width = min(RAMP_MS, 0.5 * free)
        ramped[higher] = places[i] + side * width
        if 0 <= beyond < len(places):
            # the curve's own effort there, or the line from there on would lie above it
            rise[higher] = (efforts[beyond] - efforts[higher]) * width / free
    return ramped, efforts + rise


def vehicle_limit_n(
    vehicle: Vehicle, speed_ms: FloatArray, braking: bool = False, driven_n: float = np.inf
) -> FloatArray:
    """Return the largest effort [N] that a vehicle's own limits allow, not its drive's; shape as the speeds'.

    Infinite where it sets none. `driven_n` is the adhesive weight of the driven axles [N].
    """
    limits, speed = vehicle.braking if braking else vehicle.traction, np.asarray(speed_ms, dtype=float)
    return np.minimum(
        np.minimum(_varying_n(limits, speed), _constant_n(limits)), driven_n * adhesion_coefficient(speed)
    )


def effort_limit(
    vehicle: Vehicle,
    drive: Drive,
    braking: bool = False,
    driven_n: float = np.inf,
    place: PlaceLimits = UNLIMITED,
    tabulated: bool = False,
) -> EffortLimit:
    """Return the limit of a vehicle and its drive in one direction, for compiled code.

    Parameters
    ----------
    vehicle, drive : Vehicle and Drive
    braking : bool
        Whether it is that of the electric brake.
    driven_n : float
        Adhesive weight of the driven axles [N], infinite where adhesion sets no limit.
    place : PlaceLimits
        Limits of traction by place. They do not hold for the brake.
    tabulated : bool
        Whether even a mere limit of power gets a table.

    Raises
    ------
    ScenarioError
        If neither limits the effort.
    """
    limits = vehicle.braking if braking else vehicle.traction
    supply_w = np.inf
    if not braking and np.isfinite(place.max_current_a) and vehicle.line_voltage_v is not None:
        supply_w = place.max_current_a * vehicle.line_voltage_v - vehicle.auxiliary_power_kw * W_PER_KW
    # what does not change a limit is left out, so that equal ones are found again
    by_place = (1.0, np.inf, np.inf) if braking else (place.effort_factor, place.max_effort_n, place.max_power_w)
    top_ms = vehicle.traction.max_speed_kmh * MS_PER_KMH
    return _combined(limits, drive, top_ms, driven_n, by_place, supply_w, tabulated)


@lru_cache(maxsize=64)
def _combined(
    limits: Traction | Braking,
    drive: Drive,
    top_speed_ms: float,
    driven_n: float,
    by_place: tuple[float, float, float],
    supply_w: float,
    tabulated: bool,
) -> EffortLimit:
    """Combine the limits of a vehicle's table with those of its drive, of adhesion and of a place; kept for later."""
    braking = isinstance(limits, Braking)
    factor, most_n, most_w = by_place
    steps = table_speeds(top_speed_ms)
    # the highest point of a curve counts as a constant limit: the table need only be close to what lies below that
    by_curve = max((effort * N_PER_KN for _, effort in limits.curve or ()), default=np.inf)
    by_drive_n = float(np.max(drive.effort_limit_n(steps, braking)))
    own_n = min(_constant_n(limits), by_curve, by_drive_n)
    constant = min(factor * own_n, most_n, driven_n * float(adhesion_coefficient(0.0)))
    if not np.isfinite(constant):
        table = "braking" if braking else "traction"
        raise ScenarioError(f"vehicle.{table}.max_effort_kn is missing: this drive sets no limit of effort.")
    by_drive = np.isfinite(drive.weakening_limit_n(steps, braking)).any()
    power = min(np.inf if limits.max_power_kw is None else factor * limits.max_power_kw * W_PER_KW, most_w)
    # adhesion falls with speed and its power rises: what it leaves at the corner of effort and power it leaves always
    by_adhesion = driven_n * float(adhesion_coefficient(min(power / max(constant, 1e-9), top_speed_ms))) < constant
    has_shape = limits.curve or limits.breakdown_speed_kmh is not None or by_drive or by_adhesion
    # a mere limit of power is closed and exact: no table
    if not (has_shape or tabulated or np.isfinite(supply_w)):
        return EffortLimit(constant, power)

    def varying(speed: FloatArray) -> FloatArray:
        own = factor * np.minimum(drive.weakening_limit_n(speed, braking), _varying_n(limits, speed))
        by_wheels = np.minimum(most_w / np.maximum(speed, SLOWEST_MS), driven_n * adhesion_coefficient(speed))
        effort = np.minimum(own, by_wheels)
        if np.isinf(supply_w):
            return effort
        # a drive may have no values above the top speed
        return _within_supply_n(drive, np.minimum(effort, constant), np.minimum(speed, top_speed_ms), supply_w)

    # a cubic across a corner of the curve would cut it off: pieces end there
    corners = np.append(limit_corners_ms(limits), drive.limit_corners_ms(braking))
    return fitted_limit(constant, varying, top_speed_ms, corners)


def _within_supply_n(drive: Drive, effort_n: FloatArray, speed_ms: FloatArray, supply_w: float) -> FloatArray:
    """Return efforts [N] lowered until the drive takes no more than a power [W]; none where its idle losses do."""
    speed = np.maximum(speed_ms, SLOWEST_MS)
    low, high = np.zeros(effort_n.shape), effort_n
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        # a machine that cannot give an effort has no power for it
        fits = drive.electrical_power_w(middle, speed) <= supply_w
        low, high = np.where(fits, middle, low), np.where(fits, high, middle)
    return np.where(drive.electrical_power_w(effort_n, speed) <= supply_w, effort_n, low)


def limit_corners_ms(limits: Traction | Braking) -> FloatArray:
    """Return the speeds [m/s] at which what varies with speed of a vehicle's own limits has corners; shape (k,)."""
    corners = [*_without_steps(limits.curve)[0]] if limits.curve else []
    if limits.breakdown_speed_kmh is not None:
        corners.append(limits.breakdown_speed_kmh * MS_PER_KMH)
    return np.array(corners)


def _constant_n(limits: Traction | Braking) -> float:
    return np.inf if limits.max_effort_kn is None else limits.max_effort_kn * N_PER_KN


def _varying_n(limits: Traction | Braking, speed_ms: FloatArray) -> FloatArray:
    """Return the part of a vehicle's own limits that varies with speed [N]; infinite where none does."""
    if limits.breakdown_speed_kmh is None:
        return _before_breakdown_n(limits, speed_ms)
    # with the constant one, or the effort would jump at a breakdown below the corner of the power
    effort = np.minimum(_before_breakdown_n(limits, speed_ms), _constant_n(limits))
    breakdown = np.array(limits.breakdown_speed_kmh * MS_PER_KMH)
    at_breakdown = np.minimum(_before_breakdown_n(limits, breakdown), _constant_n(limits))
    # The pull-out torque of an induction machine falls with the square of flux, which falls with 1 / v at full voltage
    beyond = at_breakdown * (breakdown / np.maximum(speed_ms, breakdown)) ** 2
    return np.where(speed_ms > breakdown, np.minimum(effort, beyond), effort)


def _before_breakdown_n(limits: Traction | Braking, speed_ms: FloatArray) -> FloatArray:
    effort = np.full(speed_ms.shape, np.inf)
    if limits.max_power_kw is not None:
        effort = np.minimum(effort, limits.max_power_kw * W_PER_KW / np.maximum(speed_ms, SLOWEST_MS))
    return np.minimum(effort, curve_effort_n(limits.curve, speed_ms)) if limits.curve else effort
