"""Arrays that compiled code borrows."""

import sys

import numpy as np
import pytest

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import borrowed, copy_rows, njit, specialisations


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


@njit()
def _twice(number: float, share: float = 1.0) -> float:
    return 2.0 * share * number


@njit()
def _four_times(number: float) -> float:
    return _twice(_twice(number), share=1.0)


def test_a_kernel_that_another_calls_is_compiled_for_python_only_when_python_calls_it() -> None:
    assert _four_times(3.0) == 12.0
    within = specialisations(_twice)
    assert within > 0
    assert not _twice.signatures  # type: ignore[attr-defined]
    assert (_twice(3.0), _twice(3.0, share=0.5)) == (6.0, 3.0)
    assert specialisations(_twice) > within


@pytest.mark.parametrize("source", [np.arange(3.0), np.arange(6.0).reshape(3, 2)], ids=["numbers", "rows"])
def test_rows_are_copied_to_the_first_ones(source: FloatArray) -> None:
    target = np.full((5, *source.shape[1:]), -1.0)
    copy_rows(source, target)
    assert (target[:3] == source).all()
    assert (target[3:] == -1.0).all()
