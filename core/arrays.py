"""The array types of the core."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]
ComplexArray = NDArray[np.complex128]


def frozen_array(values: Iterable[float] | FloatArray) -> FloatArray:
    """Return a contiguous array of floats that cannot be written to; `values` is copied if it can."""
    # a copy, and only then locked: the caller may go on writing to what it has
    array = np.array(values, dtype=np.float64)
    array.setflags(write=False)
    return array


def midpoints(values: FloatArray) -> FloatArray:
    """Return the means of neighbouring values; shape (n - 1,) for n of them."""
    return 0.5 * (values[:-1] + values[1:])
