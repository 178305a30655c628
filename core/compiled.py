"""Decorators for functions that numba compiles, and that Python interprets until the compiled code is available."""

import threading
import time
from collections.abc import Callable
from functools import cached_property, update_wrapper
from importlib import import_module
from types import FunctionType
from typing import Any, TypeVar, cast

import numba
from numba.extending import intrinsic, models, overload, register_jitable, register_model, typeof_impl

from railjoule.core.arrays import FloatArray, IntArray
from railjoule.core.kernel_cache import has_all_kernels, use_kernel_cache

Function = TypeVar("Function", bound=Callable[..., Any])
Array = TypeVar("Array", FloatArray, IntArray)
Value = TypeVar("Value", float, FloatArray)
"""Argument and result of a formula: a number or an array."""
Numbers = Any
"""Other arguments: a number, an array, or symbols of CasADi."""
PATIENCE_S = 2.0
"""A process whose interpreted kernels have taken longer than this compiles before it goes on."""

use_kernel_cache()


class _Thread(threading.local):
    is_interpreting = False
    """Whether a kernel of this thread is interpreted, and with it all kernels that it calls."""


_THREAD = _Thread()


class Mode:
    """How kernels that Python calls run: compiled, or interpreted until compiled code is available."""

    def __init__(self) -> None:
        self.interpreted_s = 0.0
        """Time that interpreted kernels have taken in this process [s]."""
        self.is_saving = True
        """Whether compiled code is saved; False once that has failed."""
        self.before_interpreting: Callable[[], None] = compile_when_slow
        """Called before each kernel that Python calls while it is interpreted."""

    @cached_property
    def is_compiled(self) -> bool:
        """Whether compiled code is called; assign to switch."""
        return bool(_CONFIG.DISABLE_JIT) or has_all_kernels()


def compile_when_slow() -> None:
    """Compile all kernels once interpreted ones have taken too long."""
    if MODE.interpreted_s > PATIENCE_S:
        compile_now()


def compile_now() -> None:
    """Wait until all kernels are compiled."""
    # by name, so that the keys of kernels do not contain the modules that it imports
    import_module("railjoule.core.compilation").require_compiled()


class Kernel:
    """A function that is compiled; Python interprets it until all kernels are.

    An interpreted kernel returns the same numbers about a hundred times slower: half a second for an optimum of a usual
    line. The code with which Python calls a kernel unpacks and counts each array of a mesh, and often takes longer to
    compile than the kernel itself. So there are two compiled forms, and each is compiled only where it is used.

    Parameters
    ----------
    function : function
        The annotations are for readers and type checkers only.
    options : dict
        Numba's.
    """

    def __init__(self, function: FunctionType, options: dict[str, Any]) -> None:
        update_wrapper(self, function)
        self.py_func = function
        self._options = options

    @cached_property
    def entry(self) -> Any:
        """The compiled form that Python calls."""
        return self._form(self.py_func)

    @cached_property
    def within(self) -> Any:
        """The compiled form that other kernels call."""
        return self._form(_renamed(self.py_func), no_cpython_wrapper=True)

    def _form(self, function: FunctionType, **options: bool) -> Any:
        cached = self._options.get("cache", False) and MODE.is_saving
        # no kernel is called from C
        return _NJIT(**{**self._options, **options, "cache": cached}, no_cfunc_wrapper=True)(function)

    def __call__(self, *arguments: Any, **named: Any) -> Any:
        """Return the function's result."""
        if _THREAD.is_interpreting:
            return self.py_func(*arguments, **named)
        if not MODE.is_compiled:
            MODE.before_interpreting()
        if MODE.is_compiled:
            return self.entry(*arguments, **named)
        return self._interpret(arguments, named)

    def _interpret(self, arguments: tuple[Any, ...], named: dict[str, Any]) -> Any:
        began_s = time.perf_counter()
        _THREAD.is_interpreting = True
        try:
            return self.py_func(*arguments, **named)
        except ZeroDivisionError:
            # compiled code divides like NumPy; it writes all results of the interrupted call again
            _THREAD.is_interpreting = False
            compile_now()
            return self.entry(*arguments, **named)
        finally:
            _THREAD.is_interpreting = False
            MODE.interpreted_s += time.perf_counter() - began_s

    def __reduce__(self) -> str:
        """Pickle a kernel by its name, like a function."""
        return self.py_func.__qualname__


MODE = Mode()
_UNLITERAL: Any = numba.types.unliteral
_CONFIG: Any = numba.config
_NJIT: Any = numba.njit


class KernelType(numba.types.Dispatcher):
    """The type of a kernel within compiled code, which compiles no version of its own for a literal argument."""

    def get_call_type(self, context: Any, args: Any, kws: Any) -> Any:
        """Return the signature of a call, in which literal numbers and flags have their general types."""
        plain = {name: _UNLITERAL(kind) for name, kind in kws.items()}
        return super().get_call_type(context, tuple(map(_UNLITERAL, args)), plain)


register_model(KernelType)(models.OpaqueModel)


@typeof_impl.register(Kernel)
def _type_of_kernel(kernel: Kernel, _context: Any) -> Any:
    return KernelType(kernel.within)


def njit(**options: Any) -> Callable[[Function], Function]:
    """Return a decorator that makes a function a `Kernel`, with these options of numba."""

    def decorate(function: FunctionType) -> Any:
        return function if _CONFIG.DISABLE_JIT else Kernel(function, options)

    # a kernel is called like its function, and type checkers see the function
    return cast("Callable[[Function], Function]", decorate)


def _renamed(function: FunctionType) -> FunctionType:
    """Return a function with another name for numba's cache, whose files are named after the function."""
    name, defaults, closure = f"{function.__qualname__}.within", function.__defaults__, function.__closure__
    same = FunctionType(function.__code__, function.__globals__, function.__name__, defaults, closure)
    same.__module__, same.__qualname__, same.__kwdefaults__ = function.__module__, name, function.__kwdefaults__
    return same


def formula(function: Function) -> Function:
    """Let compiled code call a function with numbers, which Python also calls with arrays or symbols.

    A rule of physics is thus written once for kernels, arrays and CasADi. It is compiled into its callers without
    relaxed floating point, so that all of them get the same digits.
    """
    # no fastmath and error_model="numpy": the same order of operations and the same division by zero as in Python
    shared: Function = register_jitable(error_model="numpy")(function)
    return shared


def _copy_without_owner(_types: Any, array: Any) -> Any:
    """Return type and code of a copy of an array's structure, without the pointers to the owner of its data."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        view = context.make_array(signature.args[0])(context, builder, arguments[0])
        # null: numba counts references by the first, and the second leads back to Python's array
        view.meminfo, view.parent = view.meminfo.type(None), view.parent.type(None)
        return view._getvalue()

    return array(array), generate


_without_owner: Any = intrinsic(_copy_without_owner)


def borrowed(array: Array) -> Array:
    """Return the same array for use within a compiled function, without a count of its references.

    Numba counts a reference, atomically, each time an array enters a function that LLVM does not inline. At five
    nanoseconds for each array, several times for each cell, this takes longer than the physics of a cell. An array
    without an owner is not counted, so a loop borrows its arrays once. The owner must outlive the borrowed array, as an
    argument of the compiled function does: never return or store a borrowed array. Outside compiled code it is the
    array itself.
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

    An assignment to a slice takes longer to compile, because numba adds the text of its error.
    """
    for i in range(source.shape[0]):
        if source.ndim == 1:
            target[i] = source[i]
        else:
            for k in range(source.shape[1]):
                target[i, k] = source[i, k]
