"""Golden section search for compiled code: the minimum of a function of one number within a bracket.

A compiled kernel cannot call SciPy's `minimize_scalar`. A search that takes the function as an argument would be
compiled for every caller, since each function is a type of its own in numba. So the control is inverted: the search
returns the next point, and its caller computes the value there.
"""

import math
from typing import NamedTuple

from railjoule.core.compiled import njit

# With this share of the width, one of the two inner points stays an inner point of the narrower bracket, so that a step
# costs one value: left + g^2 w of the old bracket is left + g (g w) of the new one, since g^2 = 1 - g.
GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)


class Bracket(NamedTuple):
    """An interval with a minimum inside, two inner points, and their values.

    Parameters
    ----------
    left, right : float
        Its ends.
    inner_left, inner_right : float
        The inner points, each at 0.618 of the width from the farther end.
    value_left, value_right : float
        The values at the inner points; infinite where the function has none.
    """

    left: float
    inner_left: float
    inner_right: float
    right: float
    value_left: float
    value_right: float


@njit(cache=True, error_model="numpy")
def inner_points(left: float, right: float) -> tuple[float, float]:
    """Return the two inner points of the first bracket of an interval."""
    return right - GOLDEN * (right - left), left + GOLDEN * (right - left)


@njit(cache=True, error_model="numpy")
def next_point(bracket: Bracket) -> float:
    """Return the point whose value narrows the bracket."""
    if bracket.value_left < bracket.value_right:
        return bracket.inner_right - GOLDEN * (bracket.inner_right - bracket.left)
    return bracket.inner_left + GOLDEN * (bracket.right - bracket.inner_left)


@njit(cache=True, error_model="numpy")
def narrowed(bracket: Bracket, value: float) -> Bracket:
    """Return the bracket without the end beside the larger value, given the value at the next point."""
    # the remaining inner point keeps its value: only the new one is computed
    point = next_point(bracket)
    if bracket.value_left < bracket.value_right:
        return Bracket(bracket.left, point, bracket.inner_left, bracket.inner_right, value, bracket.value_left)
    return Bracket(bracket.inner_left, bracket.inner_right, point, bracket.right, bracket.value_right, value)


@njit(cache=True, error_model="numpy")
def min_point(bracket: Bracket) -> float:
    """Return the inner point with the smaller value."""
    return bracket.inner_left if bracket.value_left < bracket.value_right else bracket.inner_right
