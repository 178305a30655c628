"""Resistance of a train: running resistance, and the forces of gradients, curves and tunnels.

Running resistance is A + B v + C v^2 (Davis), A in N, B in N s/m, C in N s2/m2. Over a cell of the mesh it is taken at
the mean square of speed, which is exact: with a constant net force v^2 is linear in the distance. Its linear part is
taken at the mean of both ends' speeds, which is the mean over time.
"""

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import Numbers, Value, formula
from railjoule.core.scenario import Vehicle
from railjoule.core.units import MS_PER_KMH, N_PER_KN, STANDARD_GRAVITY_MS2


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


def resistance_coefficients(vehicle: Vehicle, head_wind_ms: float = 0.0) -> tuple[float, float, float]:
    """Return A [N], B [N s/m] and C [N s2/m2] in the open: specific terms times the weight, and absolute terms.

    With a wind w against the train [m/s] the air meets it at v + w: C (v + w)^2 = C w^2 + 2 C w v + C v^2.
    """
    resistance, specific, weight_kn = vehicle.resistance, vehicle.specific_resistance, total_weight_kn(vehicle)
    # each power of the speed brings one factor from km/h to m/s
    linear = (weight_kn * specific.linear_n_per_kn_per_kmh + resistance.linear_n_per_kmh) / MS_PER_KMH
    quadratic = (weight_kn * specific.quadratic_n_per_kn_per_kmh2 + resistance.quadratic_n_per_kmh2) / MS_PER_KMH**2
    return (
        weight_kn * specific.constant_n_per_kn + resistance.constant_n + quadratic * head_wind_ms**2,
        linear + 2 * quadratic * head_wind_ms,
        quadratic,
    )


def gradient_force_n(vehicle: Vehicle, gradient_permille: FloatArray) -> FloatArray:
    """Return the force of gradients against the train [N]: weight times rise over length, which is taken for the sine.

    At 40 per mille, steep for a railway, sine and tangent differ by 0.08 %.
    """
    # kN times per mille is N
    return total_weight_kn(vehicle) * gradient_permille


def curve_force_n(vehicle: Vehicle, curvature_per_m: FloatArray) -> FloatArray:
    """Return the force of curves against the train [N]: weight in kN times a constant over the radius.

    The form of traction rules, whose constant is 600 to 800 m N/kN.
    """
    return total_weight_kn(vehicle) * vehicle.resistance.curve_constant_m_n_per_kn * curvature_per_m


def total_weight_kn(vehicle: Vehicle) -> float:
    """Return the weight of vehicle and passengers [kN], so a force in N over it is in per mille."""
    return vehicle.total_mass_kg * STANDARD_GRAVITY_MS2 / N_PER_KN
