"""Resistance of a train: running resistance, and the forces of gradients, curves and tunnels.

Running resistance is A + B v + C v^2 (Davis), A in N, B in N s/m, C in N s2/m2, and near standstill a starting
resistance S that falls evenly to nothing at a speed v_e: S (1 - v / v_e). Over a cell of the mesh it is taken at
the mean square of speed, which is exact: with a constant net force v^2 is linear in the distance. Its linear part is
taken at the mean of both ends' speeds, which is the mean over time. The starting resistance is taken at its mean over
the distance: its work is exact, however many cells a start takes.
"""

from typing import TYPE_CHECKING

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import Numbers, Value, formula
from railjoule.core.units import MS_PER_KMH, N_PER_KN, STANDARD_GRAVITY_MS2

if TYPE_CHECKING:
    # at run time, each change of the input models would compile all kernels again
    from railjoule.core.scenario import Vehicle

SAME_SPEED_MS = 1e-12
"""Keeps ratios of differences of speeds defined where both are equal."""


@formula
def running_resistance(constant: Numbers, linear: Numbers, quadratic: Numbers, speed: Value, speed2: Value) -> Value:
    """Return A + B v + C v^2 [N] at a speed [m/s] and its square [m2/s2], or at the means of both over a cell."""
    resistance: Value = constant + linear * speed + quadratic * speed2
    return resistance


@formula
def resistance_slope(linear: Numbers, quadratic: Numbers, speed: Value) -> Value:
    """Return the derivative of A + B v + C v^2 by the speed [N s/m]."""
    slope: Value = linear + 2.0 * quadratic * speed
    return slope


@formula
def starting_resistance(starting_n: Numbers, ends_ms: Numbers, speed: Value) -> Value:
    """Return S (1 - v / v_e) [N] at a speed [m/s], 0 from v_e on."""
    share = 1.0 - speed / ends_ms
    resistance: Value = 0.5 * starting_n * (share + abs(share))
    return resistance


@formula
def mean_starting_resistance(starting_n: Numbers, ends_ms: Numbers, start_speed2: Value, end_speed2: Value) -> Value:
    """Return the mean over the distance of S (1 - v / v_e) [N] between two squares of speed [m2/s2].

    As v^2 is linear over the distance, it is the integral of 2 S (1 - v / v_e) v dv from one speed to the other, but at
    most to v_e, over the difference of the squares.
    """
    one, other = np.sqrt(start_speed2), np.sqrt(end_speed2)
    slow, fast = np.minimum(one, other), np.maximum(one, other)
    a, b = np.minimum(slow, ends_ms), np.minimum(fast, ends_ms)
    # a difference of cubes over one of squares, without the difference itself, which may be zero
    below = (b - a + SAME_SPEED_MS) / (fast - slow + SAME_SPEED_MS)
    factor = a + b - (2.0 / 3.0) * (a * a + a * b + b * b) / ends_ms
    resistance: Value = starting_n * below * (factor + SAME_SPEED_MS) / (slow + fast + SAME_SPEED_MS)
    return resistance


@formula
def mean_starting_slopes(
    starting_n: float, ends_ms: float, start_speed2: float, end_speed2: float
) -> tuple[float, float]:
    """Return the derivatives of `mean_starting_resistance` by both squares of speed [N s2/m2]."""
    rise, mean_ms = end_speed2 - start_speed2, np.sqrt(0.5 * (start_speed2 + end_speed2))
    if mean_ms <= 0.0:
        # infinite at rest, where the force rises with the square of speed all the same
        return 0.0, 0.0
    if abs(rise) <= 1e-6 * (start_speed2 + end_speed2):
        half = -0.25 * starting_n / (ends_ms * mean_ms) if mean_ms < ends_ms else 0.0
        return half, half
    mean = mean_starting_resistance(starting_n, ends_ms, start_speed2, end_speed2)
    at_start = starting_resistance(starting_n, ends_ms, np.sqrt(start_speed2))
    at_end = starting_resistance(starting_n, ends_ms, np.sqrt(end_speed2))
    return (mean - at_start) / rise, (at_end - mean) / rise


@formula
def mean_starting_curvatures(
    starting_n: float, ends_ms: float, start_speed2: float, end_speed2: float
) -> tuple[float, float]:
    """Return the second derivatives of `mean_starting_resistance` by each square of speed above zero; it is convex."""
    rise, mean_ms = end_speed2 - start_speed2, np.sqrt(0.5 * (start_speed2 + end_speed2))
    if abs(rise) <= 1e-3 * (start_speed2 + end_speed2):
        third = starting_n / (12.0 * ends_ms * mean_ms**3) if mean_ms < ends_ms else 0.0
        return third, third
    by_start, by_end = mean_starting_slopes(starting_n, ends_ms, start_speed2, end_speed2)
    one, other = np.sqrt(start_speed2), np.sqrt(end_speed2)
    start_slope = -0.5 * starting_n / (ends_ms * one) if 0.0 < one < ends_ms else 0.0
    end_slope = -0.5 * starting_n / (ends_ms * other) if 0.0 < other < ends_ms else 0.0
    return max((2.0 * by_start - start_slope) / rise, 0.0), max((end_slope - 2.0 * by_end) / rise, 0.0)


def starting_terms(vehicle: "Vehicle") -> tuple[float, float]:
    """Return the starting resistance at rest [N], and the speed at which it ends [m/s], 1 where there is none."""
    resistance = vehicle.resistance
    starting_n = total_weight_kn(vehicle) * resistance.starting_n_per_kn + resistance.starting_n
    ends_kmh = resistance.starting_ends_at_kmh
    return starting_n, 1.0 if ends_kmh is None else ends_kmh * MS_PER_KMH


def resistance_coefficients(vehicle: "Vehicle", head_wind_ms: float = 0.0) -> tuple[float, float, float]:
    """Return A [N], B [N s/m] and C [N s2/m2] in the open: specific terms times the weight, and absolute terms.

    With a wind w against the train [m/s] the air meets it at v + w: C (v + w)^2 = C w^2 + 2 C w v + C v^2.
    """
    specific, weight_kn = vehicle.specific_resistance, total_weight_kn(vehicle)
    absolute = vehicle.resistance.absolute
    # each power of the speed brings one factor from km/h to m/s
    linear = (weight_kn * specific.linear_n_per_kn_per_kmh + absolute[1]) / MS_PER_KMH
    quadratic = (weight_kn * specific.quadratic_n_per_kn_per_kmh2 + absolute[2]) / MS_PER_KMH**2
    return (
        weight_kn * specific.constant_n_per_kn + absolute[0] + quadratic * head_wind_ms**2,
        linear + 2 * quadratic * head_wind_ms,
        quadratic,
    )


def gradient_force_n(vehicle: "Vehicle", gradient_permille: FloatArray) -> FloatArray:
    """Return the force of gradients against the train [N]: weight times rise over length, which is taken for the sine.

    At 40 per mille, steep for a railway, sine and tangent differ by 0.08 %.
    """
    # kN times per mille is N
    return total_weight_kn(vehicle) * gradient_permille


def curve_force_n(vehicle: "Vehicle", curvature_per_m: FloatArray) -> FloatArray:
    """Return the force of curves against the train [N]: weight in kN times a constant over the radius.

    The form of traction rules, whose constant is 600 to 800 m N/kN.
    """
    return total_weight_kn(vehicle) * vehicle.resistance.curve_constant_m_n_per_kn * curvature_per_m


def total_weight_kn(vehicle: "Vehicle") -> float:
    """Return the weight of vehicle and passengers [kN], so a force in N over it is in per mille."""
    return vehicle.total_mass_kg * STANDARD_GRAVITY_MS2 / N_PER_KN
