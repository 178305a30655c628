"""The largest efforts that a scenario states for its vehicle and rails, from its own keys.

With `line.rail_condition`, the driven axles transmit at most mu(v) times their weight, in driving and in electric
braking, and all brakes together at most mu(v) times the weight of the braked axles. On dry rails (Curtius, Kniffler,
1944), with v in km/h, mu(v) = 7.5 / (v + 44) + 0.161; on wet rails it is `wet_share` of that.
"""

from collections.abc import Sequence

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.scenario import Scenario
from railjoule.core.scenario.vehicle import Braking, Traction
from railjoule.core.units import MS_PER_KMH, N_PER_KN, STANDARD_GRAVITY_MS2, W_PER_KW

# at standstill power limits nothing; this only avoids the division by zero
STANDSTILL_MS = 1e-9
KMH_PER_MS = 3.6


def stated_limits_n(limits: Traction | Braking, speed_ms: FloatArray) -> dict[str, FloatArray]:
    """Return the largest efforts [N] by what states them: effort, power, curve, breakdown; shape as the speeds'.

    Beyond the last point of a curve its power stays, F v = F_last v_last. Beyond the breakdown speed F v^2 stays as it
    is there, and the limit is infinite below.
    """
    speed, stated = np.maximum(speed_ms, STANDSTILL_MS), {}
    if limits.max_effort_kn is not None:
        stated["effort"] = np.full(np.shape(speed_ms), limits.max_effort_kn * N_PER_KN)
    if limits.max_power_kw is not None:
        stated["power"] = limits.max_power_kw * W_PER_KW / speed
    if limits.curve is not None:
        stated["curve"] = _curve_limit_n(limits.curve, speed)
    if limits.breakdown_speed_kmh is not None:
        breakdown = np.array([limits.breakdown_speed_kmh * MS_PER_KMH])
        without = stated_limits_n(limits.model_copy(update={"breakdown_speed_kmh": None}), breakdown)
        constant = min(float(limit[0]) for limit in without.values()) * breakdown**2
        stated["breakdown"] = np.where(speed_ms > breakdown, constant / speed**2, np.inf)
    return stated


def _curve_limit_n(curve: Sequence[tuple[float, float]], speed_ms: FloatArray) -> FloatArray:
    kmh, kn = np.array(curve).T
    last_ms, last_n = kmh[-1] * MS_PER_KMH, kn[-1] * N_PER_KN
    inside = np.interp(speed_ms, kmh * MS_PER_KMH, kn * N_PER_KN)
    limit: FloatArray = np.where(speed_ms > last_ms, last_n * last_ms / speed_ms, inside)
    return limit


def adhesion_limits_n(scenario: Scenario, speed_ms: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the largest forces of the driven and of the braked axles [N] at speeds [m/s]; infinite without a limit."""
    vehicle, condition = scenario.vehicle, scenario.line.rail_condition
    adhesion = vehicle.adhesion
    if condition is None or adhesion.driven_mass_share is None:
        unlimited = np.full(len(speed_ms), np.inf)
        return unlimited, unlimited
    mass_kg = vehicle.tare_kg + vehicle.load_factor * vehicle.capacity_passengers * vehicle.passenger_mass_kg
    wet = adhesion.wet_share if condition == "wet" else 1.0
    force_n = wet * (7.5 / (KMH_PER_MS * speed_ms + 44) + 0.161) * mass_kg * STANDARD_GRAVITY_MS2
    return adhesion.driven_mass_share * force_n, adhesion.braked_mass_share * force_n
