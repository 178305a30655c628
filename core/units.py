"""Factors between the SI units of the core and the units that people read."""

MS_PER_KMH = 1 / 3.6
"""Metres per second in one kilometre per hour."""

J_PER_KWH = 3.6e6
"""Joules in one kilowatt hour."""

STANDARD_GRAVITY_MS2 = 9.81
"""Acceleration of gravity [m/s2], the value that all four papers use."""
