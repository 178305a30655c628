"""What a loss model answers."""

PowerTerms = tuple[float, float, float, float, float, float]
"""A power p [W] and its derivatives by effort f [N] and speed v [m/s]: p, p_f, p_v, p_ff, p_fv, p_vv."""
