"""A drive that loses a fixed share of its power."""

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.drive.power_terms import PowerTerms

PARAMETERS = ("traction_efficiency", "braking_efficiency")


@njit(cache=True)
def driving_power(parameters: FloatArray, effort: float, speed: float) -> PowerTerms:
    """Line power [W] at a tractive effort [N] and speed [m/s], and its derivatives.

    Returns (p, dp/df, dp/dv, d2p/df2, d2p/dfdv, d2p/dv2).
    """
    per_wheel_power = 1.0 / parameters[0]
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
    share = parameters[1]
    return share * effort * speed, share * speed, share * effort, 0.0, share, 0.0
