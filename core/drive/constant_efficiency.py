"""A drive that loses a fixed share of its power."""

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.drive.power_terms import PowerTerms

PARAMETERS = ("traction_efficiency", "braking_efficiency")
TRACTION_EFFICIENCY, BRAKING_EFFICIENCY = range(len(PARAMETERS))


@njit(cache=True)
def driving_power(parameters: FloatArray, effort: float, speed: float) -> PowerTerms:
    """Line power [W] at a tractive effort [N] and speed [m/s], and its derivatives.

    Returns (p, dp/df, dp/dv, d2p/df2, d2p/dfdv, d2p/dv2).
    """
    per_wheel_power = 1.0 / parameters[TRACTION_EFFICIENCY]
    return (
        effort * speed * per_wheel_power,
        speed * per_wheel_power,
        effort * per_wheel_power,
        0.0,
        per_wheel_power,
        0.0,
    )


@njit(cache=True)
def generated_power(parameters: FloatArray, effort: float, speed: float) -> PowerTerms:
    """Electrical power [W] generated at an electric braking effort [N] and speed [m/s], and its derivatives."""
    efficiency = parameters[BRAKING_EFFICIENCY]
    return efficiency * effort * speed, efficiency * speed, efficiency * effort, 0.0, efficiency, 0.0


@njit(cache=True)
def work_bounds(parameters: FloatArray) -> tuple[float, float]:
    """Return the least line energy per work of traction, and the most energy generated per work of braking."""
    return 1.0 / parameters[TRACTION_EFFICIENCY], parameters[BRAKING_EFFICIENCY]
