"""From a power to the energy over a metre of the run, E = P(f, v) / v, with first and second derivatives."""

from railjoule.core.compiled import njit
from railjoule.core.drive.kinds import PowerTerms


@njit(cache=True, error_model="numpy")
def energy_per_metre(power: PowerTerms, speed: float) -> PowerTerms:
    """Return E [J/m] and E_f, E_v, E_ff, E_fv, E_vv for a power at a speed [m/s] and its derivatives.

    E_v = (P_v - E) / v, E_fv = (P_fv - E_f) / v, E_vv = (P_vv - 2 E_v) / v, as v E = P differentiated once and twice
    tells.
    """
    p, p_f, p_v, p_ff, p_fv, p_vv = power
    inverse = 1.0 / speed
    e, e_f = p * inverse, p_f * inverse
    e_v = (p_v - e) * inverse
    return e, e_f, e_v, p_ff * inverse, (p_fv - e_f) * inverse, (p_vv - 2.0 * e_v) * inverse
