"""Factors between the SI units of the core and the units that people read."""

MS_PER_KMH = 1 / 3.6
"""Metres per second in one kilometre per hour."""

J_PER_WH = 3600.0
"""Joules in one watt hour."""

J_PER_KWH = 3.6e6
"""Joules in one kilowatt hour."""

N_PER_KN = 1e3
"""Newtons in one kilonewton."""

W_PER_KW = 1e3
"""Watts in one kilowatt."""

KG_PER_T = 1e3
"""Kilograms in one tonne."""

M_PER_KM = 1e3
"""Metres in one kilometre."""

H_PER_MH = 1e-3
"""Henrys in one millihenry."""

M_PER_MM = 1e-3
"""Metres in one millimetre."""

MAX_DIGITS = 12
"""Difference above which two numbers are not equal by rounding."""

VACUUM_PERMEABILITY_H_PER_M = 1.25663706127e-6
"""Magnetic constant mu_0 [H/m], CODATA 2022."""

# not 9.80665, so that results can be compared with the papers: 0.03 per cent of the weight
STANDARD_GRAVITY_MS2 = 9.81
"""Acceleration of gravity [m/s2], the value that all four papers use."""


def distinct_numbers(one: float, other: float, digits: int = 4) -> tuple[str, str]:
    """Return two numbers in words, with enough digits to differ, but no fewer than asked for."""
    for count in range(digits, MAX_DIGITS):
        words = plain_number(one, count), plain_number(other, count)
        if words[0] != words[1]:
            return words
    return plain_number(one, MAX_DIGITS), plain_number(other, MAX_DIGITS)


def plain_number(value: float, digits: int) -> str:
    """Return a number with so many digits that count, never with an exponent."""
    # fixed-point, as the format g turns to exponents below 1e-4; from there on 15 places hold 12 digits
    rounded = float(f"{value:.{digits}g}")
    return (
        f"{rounded:.15f}".rstrip("0").rstrip(".")
        if abs(rounded) < 1
        else f"{rounded:.{digits}f}".rstrip("0").rstrip(".")
    )
