"""What a loss model answers, and that a drive without effort is off."""

from railjoule.core.compiled import njit

PowerTerms = tuple[float, float, float, float, float, float]
"""A power p [W] and its derivatives by effort f [N] and speed v [m/s]: p, p_f, p_v, p_ff, p_fv, p_vv."""


@njit(cache=True)
def off_at_rounding(terms: PowerTerms, effort: float, negligible: float) -> PowerTerms:
    """Return the power of a drive that takes some as soon as it is on: none at an effort that is no more than rounding.

    Parameters
    ----------
    terms : PowerTerms
        Of the drive while it is on.
    effort, negligible : float
        Its effort, and the one up to which it counts as off [N].
    """
    p, p_f, p_v, p_ff, p_fv, p_vv = terms
    # slopes by effort stay: a solver at no effort must still see what the first newton costs
    if effort <= negligible:
        return 0.0, p_f, 0.0, p_ff, p_fv, 0.0
    return p, p_f, p_v, p_ff, p_fv, p_vv
