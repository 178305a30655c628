"""Numba's decorators, in a form that tells type checkers that a function keeps its signature."""

from collections.abc import Callable
from functools import partial
from types import FunctionType
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
    """Return numba's decorator with these options; the annotations of a kernel are for readers and checkers only.

    What a kernel needs to be called from Python, which unpacks and counts each array of a course, takes numba and LLVM
    longer than many a kernel itself. So a kernel that another one calls is compiled without: only what Python calls has
    it, and is compiled once more where both do.
    """
    # nobody calls a kernel from C
    compiler: Any = partial(numba.njit, **options, no_cfunc_wrapper=True)

    def decorate(function: FunctionType) -> Any:
        kernel: Any = compiler()(function)
        if kernel is function:  # with NUMBA_DISABLE_JIT
            return kernel
        kernel.within = compiler(no_cpython_wrapper=True)(_renamed(function))
        # what typing and lowering of a call within compiled code ask of the function that is called
        kernel.get_call_template, kernel.get_overload = kernel.within.get_call_template, kernel.within.get_overload
        return kernel

    # numba types a kernel as Any, which would switch the type checker off in all that calls it
    return cast("Callable[[Kernel], Kernel]", decorate)


def _renamed(function: FunctionType) -> FunctionType:
    """Return a function with another name for numba's cache, whose files know a kernel by its name and place alone."""
    name, defaults, closure = f"{function.__qualname__}.within", function.__defaults__, function.__closure__
    same = FunctionType(function.__code__, function.__globals__, function.__name__, defaults, closure)
    same.__module__, same.__qualname__, same.__kwdefaults__ = function.__module__, name, function.__kwdefaults__
    return same


def specialisations(kernel: Any) -> int:
    """Return how many times a kernel has been compiled, or loaded, for the types of its arguments."""
    return len(kernel.signatures) + len(kernel.within.signatures)


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


@njit(cache=True)
def copy_rows(source: Array, target: Array) -> None:
    """Copy all rows of an array to the first ones of another.

    Instead of an assignment to a slice: to that numba adds the sentence of its error, which takes long to compile.
    """
    for i in range(source.shape[0]):
        if source.ndim == 1:
            target[i] = source[i]
        else:
            for k in range(source.shape[1]):
                target[i, k] = source[i, k]
