"""Numba's `njit`, in a form that tells type checkers that a compiled function keeps its signature."""

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba

Kernel = TypeVar("Kernel", bound=Callable[..., Any])


def njit(**options: Any) -> Callable[[Kernel], Kernel]:
    """Return numba's decorator with these options; the annotations of a kernel are for readers and checkers only."""
    return cast("Callable[[Kernel], Kernel]", numba.njit(**options))
