"""Arrays that compiled code borrows."""

import sys

import numpy as np
import pytest

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import borrowed, njit


@njit()
def _count_at(array: FloatArray, place: int) -> float:
    value: float = array[place]
    return value


@njit()
def _sum_of_loan(array: FloatArray) -> float:
    loan, total = borrowed(array), 0.0
    for i in range(loan.shape[0]):
        total += _count_at(loan[::-1], i)
    return total


@pytest.mark.parametrize("kind", [np.float64, np.int64])
def test_a_borrowed_array_reads_the_same_memory_and_is_given_back(kind: type) -> None:
    array = np.arange(5, dtype=kind)
    before = sys.getrefcount(array)
    # 0 + 1 + 2 + 3 + 4, however often it is asked for
    assert [_sum_of_loan(array) for _ in range(3)] == [10.0, 10.0, 10.0]
    assert sys.getrefcount(array) == before
    array[4] = 14
    assert _sum_of_loan(array) == 20.0


def test_outside_compiled_code_it_is_the_array_itself() -> None:
    array = np.zeros(3)
    assert borrowed(array) is array
