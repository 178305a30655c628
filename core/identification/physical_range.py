"""The most likely parameters within the range that a train can have, and intervals of the same fit.

A fit without bounds gives an estimate e with a covariance S. Its loss near e is the distance

    Q(x) = (x - e)' S^-1 (x - e)

so the most likely parameters in the range are those of the least Q there, and the interval of a parameter holds all of
its values for which some parameters in the range have Q no more than the square of the quantile above that least one
(profile likelihood). Where the estimate lies in the range, and its interval too, that is e with the usual interval.
"""

from dataclasses import dataclass

import numpy as np
import scipy

from railjoule.core.arrays import FloatArray

EXACT = 1e-6
"""Ends of intervals are found to within this share of their deviation."""


@dataclass(frozen=True, eq=False)
class Range:
    """Bounds of n parameters, and an estimate of them without bounds.

    Parameters
    ----------
    estimate : array of shape (n,)
        The estimate.
    covariance : array of shape (n, n)
        Its covariance.
    low, high : array of shape (n,)
        Bounds.
    """

    estimate: FloatArray
    covariance: FloatArray
    low: FloatArray
    high: FloatArray

    @property
    def deviation(self) -> FloatArray:
        """Standard deviations of the estimate; shape (n,)."""
        deviation: FloatArray = np.sqrt(np.diag(self.covariance))
        return deviation

    def nearest(self, point: FloatArray | None = None) -> tuple[FloatArray, float]:
        """Return the parameters in the range that are nearest to a point, the estimate by default, and their Q."""
        point = self.estimate if point is None else point
        return self._nearest(point, self.low, self.high)

    def interval(self, index: int, quantile: float) -> tuple[float, float]:
        """Return the ends of the interval of a parameter.

        Parameters
        ----------
        index : int
            Which of the parameters.
        quantile : float
            Of the distribution of an estimate over its deviation, such as 1.96 for 95 %.
        """
        best, least = self.nearest()
        allowed = least + quantile**2
        low, high = (self._end(index, sign, float(best[index]), allowed) for sign in (-1, 1))
        return low, high

    def _end(self, index: int, sign: int, best: float, allowed: float) -> float:
        step = self.covariance[:, index] / self.deviation[index] * np.sqrt(allowed)
        farthest = self.estimate + sign * step
        if np.all((farthest >= self.low) & (farthest <= self.high)):
            return float(farthest[index])
        bound = float((self.low, self.high)[sign > 0][index])
        end = sign * min(sign * float(farthest[index]), sign * bound)

        def excess(value: float) -> float:
            low, high = self.low.copy(), self.high.copy()
            low[index] = high[index] = value
            return self._nearest(self.estimate, low, high)[1] - allowed

        if excess(end) <= 0 or end == best:
            return end
        return float(scipy.optimize.brentq(excess, best, end, xtol=EXACT * self.deviation[index]))

    def _nearest(self, point: FloatArray, low: FloatArray, high: FloatArray) -> tuple[FloatArray, float]:
        """Return the nearest parameters within some bounds, of which those of one may be equal."""
        free = low < high
        nearest = np.clip(point, low, high)
        if np.array_equal(nearest, point):
            return nearest, 0.0
        root = np.linalg.inv(np.linalg.cholesky(self.covariance))
        target = root @ point - root[:, ~free] @ nearest[~free]
        found = scipy.optimize.lsq_linear(root[:, free], target, (low[free], high[free]), method="bvls")
        nearest[free] = found.x
        return nearest, float(np.sum((root @ (nearest - point)) ** 2))
