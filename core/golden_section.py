"""The golden section for compiled code: the least value of a function of one number within a bracket.

SciPy's `minimize_scalar` is Python, which a compiled kernel cannot call, and it takes the function as an argument: to
numba each function is a type of its own, so that a search of ours that takes one would be compiled for every caller. So
the search is turned around: it says which point comes next, and its caller computes the value there.
"""

import math
from typing import NamedTuple

from railjoule.core.compiled import njit

# with this share of the width one of the two inner points stays an inner point when the bracket is narrowed, so that
# a narrowing costs one value: left + g^2 w of the old bracket is left + g (g w) of the new one, since g^2 = 1 - g
GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)


class Bracket(NamedTuple):
    """An interval that holds a minimum, with two points inside and the values there.

    Parameters
    ----------
    left, right : float
        Its ends.
    inner_left, inner_right : float
        The points inside, each 0.618 of the width away from the farther end.
    value_left, value_right : float
        The values at the points inside; infinite where the function has none.
    """

    left: float
    inner_left: float
    inner_right: float
    right: float
    value_left: float
    value_right: float


@njit(cache=True, error_model="numpy")
def inner_points(left: float, right: float) -> tuple[float, float]:
    """Return the two points inside of an interval at which a bracket begins."""
    return right - GOLDEN * (right - left), left + GOLDEN * (right - left)


@njit(cache=True, error_model="numpy")
def next_point(bracket: Bracket) -> float:
    """Return the point whose value narrows a bracket."""
    if bracket.value_left < bracket.value_right:
        return bracket.inner_right - GOLDEN * (bracket.inner_right - bracket.left)
    return bracket.inner_left + GOLDEN * (bracket.right - bracket.inner_left)


@njit(cache=True, error_model="numpy")
def narrowed(bracket: Bracket, value: float) -> Bracket:
    """Return a bracket without the end beside its greater value, given the value at its next point."""
    # the inner point that stays takes its value along: only the new one is computed
    point = next_point(bracket)
    if bracket.value_left < bracket.value_right:
        return Bracket(bracket.left, point, bracket.inner_left, bracket.inner_right, value, bracket.value_left)
    return Bracket(bracket.inner_left, bracket.inner_right, point, bracket.right, bracket.value_right, value)


@njit(cache=True, error_model="numpy")
def lowest_point(bracket: Bracket) -> float:
    """Return the better one of the two points inside."""
    return bracket.inner_left if bracket.value_left < bracket.value_right else bracket.inner_right
