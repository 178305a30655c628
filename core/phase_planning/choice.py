"""Choices between plans: the best one over a number, and the best division of a time over several."""

from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import numpy as np
import scipy

from railjoule.core.arrays import FloatArray

Plan = TypeVar("Plan", bound=Any)
"""It has an `energy_j`, infinite where there is no run."""
# Parabolas after the scan; their accuracy ends them earlier: 6 or 24 give the same plans
MAX_STEPS = 12
# A parabola whose sides differ by more than this factor always halves the longer one, as below. 2, 8 or no bound at all
# change 8 ppm of a run's energy at most
MAX_UNEVEN = 4.0
# The marginal energy diverges at the shortest time: this share of the slack stands for none.
MIN_SLACK = 1e-9


def best_plan(plan_at: Callable[[float], Plan], low: float, high: float, count: int, accuracy: float) -> Plan:
    """Return the best plan over one number: a scan, then parabolas through the three best points.

    Parameters
    ----------
    plan_at : callable
        The plan at a number; its energy is infinite where there is none.
    low, high : float
        Range of the number.
    count : int
        Points of the scan, at least 2.
    accuracy : float
        Share of the range within which the number is found.
    """
    points = {float(x): plan_at(float(x)) for x in np.linspace(low, high, count)}
    for _ in range(MAX_STEPS):
        best = min(points, key=lambda x: points[x].energy_j)
        left = max((x for x in points if x < best), default=None)
        right = min((x for x in points if x > best), default=None)
        # no parabola at an end of the range, or beside a number without a plan: halve towards the known plans
        if left is None or right is None or not np.isfinite(points[best].energy_j):
            sides = [x for x in (left, right) if x is not None]
            middle = 0.5 * (best + sides[0])
        elif not np.isfinite(points[left].energy_j + points[right].energy_j):
            middle = 0.5 * (best + (left if np.isfinite(points[right].energy_j) else right))
        else:
            middle = _vertex(*((x, points[x].energy_j) for x in (left, best, right)))
        if min(abs(middle - x) for x in points) < accuracy * (high - low):
            break
        points[middle] = plan_at(middle)
    return points[min(points, key=lambda x: points[x].energy_j)]


def _vertex(left: tuple[float, float], best: tuple[float, float], right: tuple[float, float]) -> float:
    """Compute the minimum of the parabola through three points, or halve its longer side if that is much longer."""
    (a, fa), (b, fb), (c, fc) = left, best, right
    # successive parabolic interpolation: the zero of the derivative of Lagrange's polynomial
    p, q = (b - a) * (fb - fc), (b - c) * (fb - fa)
    x = b - 0.5 * ((b - a) * p - (b - c) * q) / (p - q) if p != q else 0.5 * (a + c)
    longer = a if b - a > c - b else c
    # on repeated steps to the same side, the other point stays far away and no longer represents the curvature
    return x if max(b - a, c - b) < MAX_UNEVEN * min(b - a, c - b) else 0.5 * (b + longer)


def equally_priced(
    prices: Sequence[Callable[[float], float]], shortest_s: Sequence[float], slack_s: float
) -> list[float]:
    """Return the times of parts with equal marginal energy per second that use all of the running time supplement.

    Parameters
    ----------
    prices : sequence of callable
        Marginal energy of each part [J/s] over its time beyond the shortest one [s]; falling.
    shortest_s : sequence of float
        Shortest time of each part [s].
    slack_s : float
        Time of all parts beyond the sum of these [s].
    """
    least, most = MIN_SLACK * slack_s, slack_s

    # At a price each part takes the time of that marginal energy; the lower the price, the more time all parts take. So
    # one price uses the slack: two nested root searches of monotone functions.
    def extra_at(price: float) -> FloatArray:
        def extra_time(price_of: Callable[[float], float]) -> float:
            if price_of(most) >= price:
                return most
            if price_of(least) <= price:
                return least
            root: float = scipy.optimize.brentq(lambda more: price_of(more) - price, least, most, xtol=least)
            return root

        return np.array([extra_time(price_of) for price_of in prices])

    low, high = min(price_of(most) for price_of in prices), max(price_of(least) for price_of in prices)
    price = scipy.optimize.brentq(lambda price: extra_at(price).sum() - slack_s, low, high, xtol=1e-9 * high)
    extra = extra_at(price)
    extra *= slack_s / extra.sum()
    return [time + more for time, more in zip(shortest_s, extra.tolist(), strict=True)]
