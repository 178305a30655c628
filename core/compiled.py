"""Numba's decorators, in a form that tells type checkers that a function keeps its signature."""

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba
from numba.extending import register_jitable

from railjoule.core.arrays import FloatArray

Kernel = TypeVar("Kernel", bound=Callable[..., Any])
Value = TypeVar("Value", float, FloatArray)
"""What a formula is asked for and answers: a number, or as many as an array holds."""
Numbers = Any
"""What else it takes: a number, an array of them, or symbols of CasADi."""


def njit(**options: Any) -> Callable[[Kernel], Kernel]:
    """Return numba's decorator with these options; the annotations of a kernel are for readers and checkers only."""
    # numba types a kernel as Any, which would switch the type checker off in all that calls it
    return cast("Callable[[Kernel], Kernel]", numba.njit(**options))


def formula(function: Kernel) -> Kernel:
    """Let compiled code call a function that stays one of Python: of numbers there, of arrays or symbols elsewhere.

    So a rule of physics is written once for kernels, for arrays and for CasADi. It is compiled into its callers,
    without liberties of floating point: all of them get the same digits.
    """
    # no fastmath and error_model="numpy": the same order of operations and the same division by zero as in Python
    shared: Kernel = register_jitable(error_model="numpy")(function)
    return shared
