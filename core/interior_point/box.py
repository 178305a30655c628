"""The global minimum of a priced cell over a box of its two speeds, in closed form.

A priced cell is a0 v0^2 + a1 v1^2 + kappa / v + beta v + gamma v^2 with v = (v0 + v1) / 2. Its minimum lies on a
corner of the box or at a stationary point of an edge or of the inside, each a root of a cubic in v.
"""

import math

from railjoule.core.compiled import njit

# Newton's steps inside a bracket that shrinks: a few suffice, 100 bisections would reach rounding by themselves.
# SciPy's root finders take a function, which compiled code cannot pass on.
ROOT_STEPS = 100


@njit(cache=True, error_model="numpy")
def cubic_value(cubic: float, square: float, constant: float, v: float) -> float:
    """Return cubic v^3 + square v^2 - constant."""
    return (cubic * v + square) * v * v - constant


@njit(cache=True, error_model="numpy")
def cubic_root(cubic: float, square: float, constant: float, low: float, high: float) -> float:
    """Return the root of `cubic_value` in [low, high], where it is monotone; -1 if there is none."""
    at_low = cubic_value(cubic, square, constant, low)
    at_high = cubic_value(cubic, square, constant, high)
    if at_low * at_high > 0.0:
        return -1.0
    rising = at_high > at_low
    v = 0.5 * (low + high)
    for _ in range(ROOT_STEPS):
        value = cubic_value(cubic, square, constant, v)
        if (value > 0.0) == rising:
            high = v
        else:
            low = v
        slope = (3.0 * cubic * v + 2.0 * square) * v
        step = v - value / slope if slope != 0.0 else low
        if not low < step < high:
            step = 0.5 * (low + high)
        if abs(step - v) <= 1e-14 * v:
            return step
        v = step
    return v


@njit(cache=True, error_model="numpy")
def pair_value(a0: float, a1: float, kappa: float, beta: float, gamma: float, v0: float, v1: float) -> float:
    """Return a0 v0^2 + a1 v1^2 + kappa / v + beta v + gamma v^2 with v = (v0 + v1) / 2."""
    v = 0.5 * (v0 + v1)
    # without a compiler, Python refuses to divide by zero
    per_speed = 0.0 if kappa == 0.0 else kappa / v if v > 0.0 else math.copysign(math.inf, kappa)
    return a0 * v0 * v0 + a1 * v1 * v1 + per_speed + (beta + gamma * v) * v


@njit(cache=True, error_model="numpy")
def edge_minimum(
    a0: float, a1: float, kappa: float, beta: float, gamma: float, v0: float, low: float, high: float
) -> float:
    """Return the minimum of `pair_value` over v1 in [low, high] at a fixed v0."""
    best = min(pair_value(a0, a1, kappa, beta, gamma, v0, low), pair_value(a0, a1, kappa, beta, gamma, v0, high))
    # with v1 = 2 v - v0, v^2 / 2 times the derivative by v is (4 a1 + gamma) v^3 + (beta / 2 - 2 a1 v0) v^2 - kappa / 2
    cubic, square, constant = 4.0 * a1 + gamma, 0.5 * beta - 2.0 * a1 * v0, 0.5 * kappa
    first, last = 0.5 * (v0 + low), 0.5 * (v0 + high)
    # on either side of its turning point the cubic is monotone
    turn = -2.0 * square / (3.0 * cubic) if cubic != 0.0 else first
    turn = min(max(turn, first), last)
    for part in range(2):
        v = (
            cubic_root(cubic, square, constant, first, turn)
            if part == 0
            else cubic_root(cubic, square, constant, turn, last)
        )
        if v > 0.0:
            best = min(best, pair_value(a0, a1, kappa, beta, gamma, v0, min(max(2.0 * v - v0, low), high)))
    return best


@njit(cache=True, error_model="numpy")
def box_minimum(
    a0: float, a1: float, kappa: float, beta: float, gamma: float, low0: float, high0: float, low1: float, high1: float
) -> float:
    """Return the global minimum of `pair_value` over v0 in [low0, high0], v1 in [low1, high1]; v > 0 if kappa < 0."""
    best = min(
        edge_minimum(a0, a1, kappa, beta, gamma, low0, low1, high1),
        edge_minimum(a0, a1, kappa, beta, gamma, high0, low1, high1),
        edge_minimum(a1, a0, kappa, beta, gamma, low1, low0, high0),
        edge_minimum(a1, a0, kappa, beta, gamma, high1, low0, high0),
    )
    if a0 * a1 <= 0.0 or low0 == high0 or low1 == high1:
        return best
    # inside, both derivatives vanish: 2 a0 v0 = 2 a1 v1 = -dG/dv / 2, so v1 = ratio v0 and one unknown is left
    ratio = a0 / a1
    half = 0.5 * (1.0 + ratio)
    first, last = max(low0, low1 / ratio) * half, min(high0, high1 / ratio) * half
    if first >= last:
        return best
    cubic, square, constant = 2.0 * a0 / half + gamma, 0.5 * beta, 0.5 * kappa
    turn = -2.0 * square / (3.0 * cubic) if cubic != 0.0 else first
    turn = min(max(turn, first), last)
    for part in range(2):
        v = (
            cubic_root(cubic, square, constant, first, turn)
            if part == 0
            else cubic_root(cubic, square, constant, turn, last)
        )
        if v > 0.0:
            best = min(best, pair_value(a0, a1, kappa, beta, gamma, v / half, ratio * v / half))
    return best
