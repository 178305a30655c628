"""What a vehicle's file states of its largest efforts over speed, by the words of the file format alone."""

from collections.abc import Sequence

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.scenario.vehicle import Braking, Traction
from railjoule.core.units import MS_PER_KMH, N_PER_KN, W_PER_KW

# at standstill power limits nothing; this only avoids the division by zero
STANDSTILL_MS = 1e-9


def curve_limit_n(curve: Sequence[tuple[float, float]], speed_ms: FloatArray) -> FloatArray:
    """Return the effort of a curve [N] at speeds [m/s], linear between its points [km/h, kN]; same shape.

    Beyond the last point the power stays: F v = F_last v_last.
    """
    kmh, kn = np.array(curve).T
    last_ms, last_n = kmh[-1] * MS_PER_KMH, kn[-1] * N_PER_KN
    inside = np.interp(speed_ms, kmh * MS_PER_KMH, kn * N_PER_KN)
    limit: FloatArray = np.where(speed_ms > last_ms, last_n * last_ms / np.maximum(speed_ms, STANDSTILL_MS), inside)
    return limit


def stated_limit_n(limits: Traction | Braking, speed_ms: FloatArray) -> FloatArray:
    """Return the largest effort [N] that effort, power and curve of a file leave; infinite where it states none."""
    limit = np.full(np.shape(speed_ms), np.inf)
    if limits.max_effort_kn is not None:
        limit = np.minimum(limit, limits.max_effort_kn * N_PER_KN)
    if limits.max_power_kw is not None:
        limit = np.minimum(limit, limits.max_power_kw * W_PER_KW / np.maximum(speed_ms, STANDSTILL_MS))
    if limits.curve is not None:
        limit = np.minimum(limit, curve_limit_n(limits.curve, speed_ms))
    return limit


def limit_beyond_breakdown_n(limits: Traction | Braking, speed_ms: FloatArray) -> FloatArray:
    """Return what is left of the effort at the breakdown speed [N]: F v^2 stays beyond it; infinite below and without.

    Shape as the speeds' [m/s].
    """
    if limits.breakdown_speed_kmh is None:
        return np.full(np.shape(speed_ms), np.inf)
    breakdown_ms = limits.breakdown_speed_kmh * MS_PER_KMH
    constant = float(stated_limit_n(limits, np.array([breakdown_ms]))[0]) * breakdown_ms**2
    limit: FloatArray = np.where(speed_ms > breakdown_ms, constant / np.maximum(speed_ms, STANDSTILL_MS) ** 2, np.inf)
    return limit
