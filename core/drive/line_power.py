"""The rule of recuperation: the supply power of a drive's power at its terminals.

A drive that takes power P > 0 at its terminals, to drive or to brake near standstill, takes all of it from the supply.
Of the power that it generates, -P, the supply takes back the recuperation factor r; resistors dissipate the rest. As r
lies between 0 and 1, the supply power is max(P, r P): kinked at zero, convex, and rising with P.
"""

import numpy as np

from railjoule.core.compiled import Numbers, Value, formula


@formula
def line_power(power: Value, recuperation_factor: float) -> Value:
    """Return the supply power [W] for a power at the terminals [W]; negative is recuperated."""
    taken: Value = np.maximum(power, recuperation_factor * power)
    return taken


@formula
def smooth_supply_power(taken: Value, generated: Numbers, drawn: Numbers, recuperation_factor: float) -> Value:
    """Return the supply power without the kink, for a power taken to drive and one generated in braking [W].

    `drawn` is a variable for max(0, -generated), bounded by both from below; no optimum leaves it above them. With that
    value, and unless both powers are above zero, this is `line_power` of taken - generated. It takes CasADi's symbols
    too.
    """
    power: Value = taken - recuperation_factor * generated + (1.0 - recuperation_factor) * drawn
    return power


@formula
def resistor_power(power: Value, recuperation_factor: float) -> Value:
    """Return the part of a power at the terminals that brake resistors dissipate [W]: generated, not recuperated."""
    return line_power(power, recuperation_factor) - power
