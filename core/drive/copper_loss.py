"""A drive that loses power only in the windings of its motors: loss = coefficient * effort^2.

Source: Ftorek et al. 2025, (11), with the current i_q = effort / (motors * torque per ampere * gear ratio / radius).
"""

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.drive.power_terms import PowerTerms

PARAMETERS = ("loss_coefficient",)
LOSS_COEFFICIENT = 0


@njit(cache=True)
def driving_power(parameters: FloatArray, effort: float, speed: float) -> PowerTerms:
    """Line power [W] at a tractive effort [N] and speed [m/s], and its derivatives.

    Returns (p, dp/df, dp/dv, d2p/df2, d2p/dfdv, d2p/dv2).
    """
    coefficient = parameters[LOSS_COEFFICIENT]
    loss = coefficient * effort
    return effort * speed + loss * effort, speed + 2.0 * loss, effort, 2.0 * coefficient, 1.0, 0.0


@njit(cache=True)
def generated_power(parameters: FloatArray, effort: float, speed: float) -> PowerTerms:
    """Electrical power [W] generated at an electric braking effort [N] and speed [m/s], and its derivatives.

    Negative near standstill, where the windings lose more than the wheels give.
    """
    coefficient = parameters[LOSS_COEFFICIENT]
    loss = coefficient * effort
    return effort * speed - loss * effort, speed - 2.0 * loss, effort, -2.0 * coefficient, 1.0, 0.0
