"""Numba's decorators, in a form that tells type checkers that a function keeps its signature."""

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba
from numba.extending import intrinsic, overload, register_jitable

from railjoule.core.arrays import FloatArray, IntArray

Kernel = TypeVar("Kernel", bound=Callable[..., Any])
Array = TypeVar("Array", FloatArray, IntArray)
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


def _copy_without_owner(_types: Any, array: Any) -> Any:
    """Return the type and the code of a copy of an array's structure, all but the pointers to what owns its data."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        view = context.make_array(signature.args[0])(context, builder, arguments[0])
        # null: numba counts references by the first, and the second leads back to Python's array
        view.meminfo, view.parent = view.meminfo.type(None), view.parent.type(None)
        return view._getvalue()

    return array(array), generate


_without_owner: Any = intrinsic(_copy_without_owner)


def borrowed(array: Array) -> Array:
    """Return the same array for use within a compiled function, without a count of its references.

    Numba counts a reference, atomically, each time that an array enters a function which LLVM does not inline: five
    nanoseconds for each of a handful of arrays, several times for each cell, are more than the physics of a cell. An
    array without an owner is not counted. So a loop borrows its arrays once. The lender must outlive the loan, as an
    argument of the compiled function does: never return a borrowed array, nor keep it. Outside compiled code it is
    the array itself.
    """
    return array


@overload(borrowed)
def _borrowed_in_compiled_code(array: Any) -> Callable[[Any], Any]:
    def without_owner(array: Any) -> Any:
        return _without_owner(array)

    return without_owner
