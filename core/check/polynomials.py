"""Arrays of polynomials: coefficients of shape (k, m), constant first."""

import numpy as np

from railjoule.core.arrays import FloatArray

# two equal roots separate by the square root of the rounding, 1e-8, into the complex plane; 1e-6 keeps them
SPLIT_ROOT = 1e-6
"""Imaginary over real part up to which a root is one of two equal ones that rounding has split."""


def values(polynomial: FloatArray, at: FloatArray) -> FloatArray:
    """Return the values of polynomials of shape (k, m) at arguments of shape (k, l)."""
    return np.asarray(np.polynomial.polynomial.polyval(at, polynomial.T[:, :, None], tensor=False))


def product(first: FloatArray, second: FloatArray) -> FloatArray:
    """Return the products of polynomials of shape (k, m) and (k, l); shape (k, m + l - 1)."""
    result = np.zeros((len(first), first.shape[1] + second.shape[1] - 1))
    for power, coefficient in enumerate(first.T):
        result[:, power : power + second.shape[1]] += coefficient[:, None] * second
    return result


def real_roots(polynomial: FloatArray) -> FloatArray:
    """Return the real roots of polynomials of shape (k, m), NaN in the place of others; shape (k, m - 1).

    They are the eigenvalues of companion matrices. Polynomials whose last coefficient is 0 have none here.
    """
    degree = polynomial.shape[1] - 1
    companion = np.zeros((len(polynomial), degree, degree))
    companion[:, 1:, :-1] = np.eye(degree - 1)
    with np.errstate(divide="ignore", invalid="ignore"):
        companion[:, :, -1] = -polynomial[:, :-1] / polynomial[:, -1:]
    # eigvals refuses a whole stack for one NaN, so polynomials of lower degree are replaced and their roots dropped
    known = np.isfinite(companion.sum(axis=(1, 2)))
    roots = np.linalg.eigvals(np.where(known[:, None, None], companion, 0.0))
    real = known[:, None] & (np.abs(roots.imag) <= SPLIT_ROOT * np.abs(roots.real))
    return np.where(real, roots.real, np.nan)
