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

H_PER_MH = 1e-3
"""Henrys in one millihenry."""

M_PER_MM = 1e-3
"""Metres in one millimetre."""

# not 9.80665, so that results can be compared with the papers: 0.03 per cent of the weight
STANDARD_GRAVITY_MS2 = 9.81
"""Acceleration of gravity [m/s2], the value that all four papers use."""
