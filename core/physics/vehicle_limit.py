"""Limits of the efforts of a vehicle: its own table in the file, and its drive."""

from functools import lru_cache

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.drive import Drive
from railjoule.core.errors import ScenarioError
from railjoule.core.physics.adhesion import adhesion_coefficient
from railjoule.core.physics.effort_limit import SLOWEST_MS, EffortLimit, fitted_limit, table_speeds
from railjoule.core.scenario import Vehicle
from railjoule.core.scenario.vehicle import Braking, Traction
from railjoule.core.units import MS_PER_KMH, N_PER_KN, W_PER_KW

Curve = tuple[tuple[float, float], ...]
# an effort that jumped with speed would leave a solver without slopes; over so little a train gains nothing
RAMP_MS = 0.01
"""A step of a curve is a ramp of this width, on the side of the higher effort [m/s]."""


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


def effort_limit(vehicle: Vehicle, drive: Drive, braking: bool = False, driven_n: float = np.inf) -> EffortLimit:
    """Return the limit of a vehicle and its drive in one direction, for compiled code.

    Parameters
    ----------
    vehicle, drive : Vehicle and Drive
    braking : bool
        Whether it is that of the electric brake.
    driven_n : float
        Adhesive weight of the driven axles [N], infinite where adhesion sets no limit.

    Raises
    ------
    ScenarioError
        If neither limits the effort.
    """
    limits = vehicle.braking if braking else vehicle.traction
    return _combined(limits, drive, vehicle.traction.max_speed_kmh * MS_PER_KMH, driven_n)


@lru_cache(maxsize=64)
def _combined(limits: Traction | Braking, drive: Drive, top_speed_ms: float, driven_n: float) -> EffortLimit:
    """Combine the limits of a vehicle's table with those of its drive and of adhesion; kept for the next call."""
    braking = isinstance(limits, Braking)
    steps = table_speeds(top_speed_ms)
    # the highest point of a curve counts as a constant limit: the table need only be close to what lies below that
    by_curve = max((effort * N_PER_KN for _, effort in limits.curve or ()), default=np.inf)
    by_drive_n = float(np.max(drive.effort_limit_n(steps, braking)))
    constant = min(_constant_n(limits), by_curve, by_drive_n, driven_n * float(adhesion_coefficient(0.0)))
    if not np.isfinite(constant):
        table = "braking" if braking else "traction"
        raise ScenarioError(f"vehicle.{table}.max_effort_kn is missing: this drive sets no limit of effort.")
    by_drive = np.isfinite(drive.weakening_limit_n(steps, braking)).any()
    power = np.inf if limits.max_power_kw is None else limits.max_power_kw * W_PER_KW
    # adhesion falls with speed and its power rises: what it leaves at the corner of effort and power it leaves always
    by_adhesion = driven_n * float(adhesion_coefficient(min(power / max(constant, 1e-9), top_speed_ms))) < constant
    # a mere limit of power is closed and exact: no table
    if not (limits.curve or limits.breakdown_speed_kmh is not None or by_drive or by_adhesion):
        return EffortLimit(constant, power)

    def varying(speed: FloatArray) -> FloatArray:
        by_vehicle = np.minimum(_varying_n(limits, speed), driven_n * adhesion_coefficient(speed))
        return np.minimum(drive.weakening_limit_n(speed, braking), by_vehicle)

    # a cubic across a corner of the curve would cut it off: pieces end there
    corners = np.append(limit_corners_ms(limits), drive.limit_corners_ms(braking))
    return fitted_limit(constant, varying, top_speed_ms, corners)


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
