"""What of a drive's power the line gives and takes back: the rule of recuperation.

A drive that draws power P > 0 at its terminals, to drive or to brake near standstill, takes all of it from the line.
What it generates, -P, the line takes back in part: the recuperation factor r times it; resistors dissipate the rest. As
r lies between 0 and 1, the line's power is max(P, r P): kinked at zero, convex, and rising with P.
"""

import numpy as np

from railjoule.core.compiled import Numbers, Value, formula


@formula
def line_power(power: Value, recuperation_factor: float) -> Value:
    """Return the power taken from the line [W] for a power at the terminals [W]; negative goes back."""
    taken: Value = np.maximum(power, recuperation_factor * power)
    return taken


@formula
def smooth_line_power(taken: Value, generated: Numbers, drawn: Numbers, recuperation_factor: float) -> Value:
    """Return the same for a power taken to drive and one generated in braking, without the kink.

    `drawn` stands for what braking draws, max(0, -generated): a variable of its own that is bound by both from below,
    and that no optimum leaves above them. Where it is just that, this is `line_power` of taken - generated, if not both
    are above zero. It takes CasADi's symbols too.
    """
    power: Value = taken - recuperation_factor * generated + (1.0 - recuperation_factor) * drawn
    return power


@formula
def resistor_power(power: Value, recuperation_factor: float) -> Value:
    """Return what of a power at the terminals [W] brake resistors dissipate [W]: generated, and not taken back."""
    return line_power(power, recuperation_factor) - power
