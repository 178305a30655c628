"""By how much residuals that hang together over time make a fit less certain."""

import numpy as np

from railjoule.core.arrays import FloatArray

WINDOW_S = 30.0
"""Over this time sums of residuals are compared with those of independent ones: gusts and drifts are shorter."""
FEWEST_FREEDOM = 5.0


def scale_freedom(step_s: FloatArray) -> float:
    """Return the degrees of freedom of a variance by such windows, 1.5 for each that fits into the time of the steps.

    That is the equivalent number of Bartlett's estimate. Fewer than `FEWEST_FREEDOM` are never returned: the deviations
    of single samples are known better.
    """
    return max(1.5 * float(np.sum(step_s)) / WINDOW_S, FEWEST_FREEDOM)


def noise_inflation(residual: FloatArray, jacobian: FloatArray, bread: FloatArray, step_s: FloatArray) -> float:
    """Return the factor on the deviations of residuals by their correlation over time; at least 1.

    Independent errors almost cancel in a sum over many samples, those of a gust or a drift do not. The mean square of
    the sums of all windows (Bartlett's estimate of the variance at frequency zero) is divided by its expectation for
    independent residuals of variance 1, of which the fit has taken its share.

    Parameters
    ----------
    residual : array of shape (n,)
        Residuals of variance 1, if the errors are as assumed.
    jacobian : array of shape (n, unknowns)
        Their derivatives.
    bread : array of shape (unknowns, unknowns)
        Inverse of the product of the whole Jacobian with itself.
    step_s : array of shape (n,)
        Times between samples [s].
    """
    if not len(residual):
        return 1.0
    length = min(max(round(WINDOW_S / float(np.median(step_s))), 1), len(residual))
    sums, slopes = _window_sums(residual[:, None], length)[:, 0], _window_sums(jacobian, length)
    expected = length * len(residual) - float(np.sum((slopes @ bread) * slopes))
    return float(np.sqrt(max(float(np.sum(sums**2)) / expected, 1.0)))


def _window_sums(values: FloatArray, length: int) -> FloatArray:
    """Return sums over all windows of a length, with fewer values at both ends; shape (n + length - 1, columns)."""
    total = np.concatenate([np.zeros((length, values.shape[1])), np.cumsum(values, axis=0)])
    total = np.concatenate([total, np.repeat(total[-1:], length - 1, axis=0)])
    sums: FloatArray = total[length:] - total[:-length]
    return sums
