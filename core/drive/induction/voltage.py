"""The voltage limit of a machine: its square as a polynomial in the ratio of the currents.

With q = |Iy| / Ix, and s = 1 driving or -1 generating, the frequency is w1 = w + s g q, g = R_W / L_W, and

    D(q, w) = |U|^2 / Ix^2 = (R_S - w1 sigma L_S s q)^2 + (R_S s q + w1 L_S)^2 = d0 + d1 q + d2 q^2 + d3 q^3 + d4 q^4.

A torque needs kappa = Ix |Iy| = Ix^2 q, so it keeps the voltage where kappa D <= U_m^2 q: between two ratios, the
smaller of which has the larger flux. Beyond the larger one the machine has pulled out.
Source: Rawicki, (6)-(8), (18)-(21), (37)-(38).
"""

import math
from typing import NamedTuple

from railjoule.core.compiled import njit
from railjoule.core.drive.induction.machine import Machine, leakage_share, slip_rate

# Newton's rule doubles its digits: it ends at rounding after some ten steps, the rest is a guard
ROOT_STEPS = 40
EXACT = 1e-14
# where it ends without that, its root still counts if the voltage is met to this share
NEARLY_EXACT = 1e-9


class Quartic(NamedTuple):
    """Coefficients d0 to d4 of a polynomial."""

    d0: float
    d1: float
    d2: float
    d3: float
    d4: float


@njit(cache=True)
def voltage_quartic(machine: Machine, sign: float, rotor_rads: float) -> Quartic:
    """Return D(q) [ohm2] at an electrical rotor frequency [rad/s]; `sign` is 1 driving, -1 generating."""
    r, ls, g, sigma = (
        machine.stator_resistance_ohm,
        machine.stator_inductance_h,
        slip_rate(machine),
        leakage_share(machine),
    )
    w, both = rotor_rads, r * ls * (1.0 - sigma)
    # with L_S and sigma multiplied out; what stator resistance and leakage have in common is R_S L_S (1 - sigma)
    leakage = ls * ls * sigma * sigma
    return Quartic(
        r * r + ls * ls * w * w,
        2.0 * sign * w * (g * ls * ls + both),
        r * r + ls * ls * g * g + leakage * w * w + 2.0 * both * g,
        2.0 * sign * w * g * leakage,
        leakage * g * g,
    )


@njit(cache=True)
def quartic_by_frequency(machine: Machine, sign: float, rotor_rads: float) -> Quartic:
    """Return the coefficients of dD/dw."""
    r, ls, g, sigma = (
        machine.stator_resistance_ohm,
        machine.stator_inductance_h,
        slip_rate(machine),
        leakage_share(machine),
    )
    leakage = ls * ls * sigma * sigma
    return Quartic(
        2.0 * ls * ls * rotor_rads,
        2.0 * sign * (g * ls * ls + r * ls * (1.0 - sigma)),
        2.0 * leakage * rotor_rads,
        2.0 * sign * g * leakage,
        0.0,
    )


@njit(cache=True)
def value(quartic: Quartic, ratio: float) -> float:
    """Return the value of a polynomial."""
    return (((quartic.d4 * ratio + quartic.d3) * ratio + quartic.d2) * ratio + quartic.d1) * ratio + quartic.d0


@njit(cache=True)
def slope(quartic: Quartic, ratio: float) -> float:
    """Return the first derivative of a polynomial."""
    return ((4.0 * quartic.d4 * ratio + 3.0 * quartic.d3) * ratio + 2.0 * quartic.d2) * ratio + quartic.d1


@njit(cache=True)
def second_derivative(quartic: Quartic, ratio: float) -> float:
    """Return the second derivative of a polynomial."""
    return (12.0 * quartic.d4 * ratio + 6.0 * quartic.d3) * ratio + 2.0 * quartic.d2


@njit(cache=True)
def convex_until(quartic: Quartic) -> float:
    """Return the ratio up to which a polynomial is convex: infinite unless the field of a generator can stand."""
    # D'' = 12 d4 q^2 + 6 d3 q + 2 d2 falls below zero only between two positive roots, with d3 < 0: generating
    discriminant = 36.0 * quartic.d3 * quartic.d3 - 96.0 * quartic.d4 * quartic.d2
    if quartic.d3 >= 0.0 or discriminant <= 0.0 or quartic.d4 == 0.0:
        return math.inf
    return (-6.0 * quartic.d3 - math.sqrt(discriminant)) / (24.0 * quartic.d4)


@njit(cache=True)
def pull_out_ratio(quartic: Quartic) -> float:
    """Return the ratio of the greatest torque under the voltage, where D = q dD/dq."""
    # kappa = U_m^2 q / D is greatest where D = q D'; the root of only the quadratic part of D is sqrt(d0 / d2)
    q, until = math.sqrt(quartic.d0 / quartic.d2), convex_until(quartic)
    for _ in range(ROOT_STEPS):
        excess = value(quartic, q) - q * slope(quartic, q)
        curvature = q * second_derivative(quartic, q)
        if curvature <= 0.0:
            break
        step = excess / curvature
        # never more than half of the way to zero, or to where D turns concave and the slope of the excess its sign
        q = min(max(q + step, 0.5 * q), 0.5 * (q + until))
        if abs(step) <= EXACT * q:
            break
    return q


@njit(cache=True)
def ratio_within_voltage(quartic: Quartic, strength: float, voltage2: float, ratio: float) -> float:
    """Return the ratio nearest to a given one at which the voltage carries a torque; negative if none does.

    Parameters
    ----------
    quartic : Quartic
        D.
    strength : float
        kappa, product of both currents [A2].
    voltage2 : float
        U_m^2 [V2].
    ratio : float
        Wanted Iy / Ix, at which the voltage is too high.
    """
    q, slope_before, excess, until = ratio, 0.0, voltage2, convex_until(quartic)
    # Newton's rule comes from the side where the excess is positive and does not pass its root as long as it is convex;
    # a generator's is not where its field all but stands, far beyond the pull-out
    for _ in range(ROOT_STEPS):
        if q >= until:
            return -1.0
        excess = strength * value(quartic, q) - voltage2 * q
        gradient = strength * slope(quartic, q) - voltage2
        if excess <= 0.0:
            return q
        # past the least excess without a root: no ratio keeps the voltage at this torque
        if gradient * slope_before < 0.0 or gradient == 0.0:
            return -1.0
        step = excess / gradient
        q -= step
        if q <= 0.0:
            return -1.0
        if abs(step) <= EXACT * q:
            return q
        slope_before = gradient
    return q if abs(excess) <= NEARLY_EXACT * voltage2 * q else -1.0
