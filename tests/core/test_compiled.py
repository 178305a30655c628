"""Kernels, interpreted and compiled, and the arrays that compiled code borrows."""

import pickle
import sys

import numpy as np
import pytest

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import MODE, borrowed, copy_rows, njit


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
    assert _twice.within.signatures  # type: ignore[attr-defined]
    assert not _twice.entry.signatures  # type: ignore[attr-defined]
    assert (_twice(3.0), _twice(3.0, share=0.5)) == (6.0, 3.0)
    assert _twice.entry.signatures  # type: ignore[attr-defined]


@njit()
def _power(number: float, exponent: int) -> float:
    return number**exponent


@njit()
def _sum_of_powers(number: float) -> float:
    return _power(number, 1) + _power(number, 2) + _power(number, 3)


def test_a_number_in_the_code_needs_no_version_of_its_own() -> None:
    assert _sum_of_powers(2.0) == 14.0
    assert len(_power.within.signatures) == 1  # type: ignore[attr-defined]


@njit()
def _depth(number: float) -> float:
    return _four_times(number)


def test_a_kernel_and_all_that_it_calls_are_interpreted_until_the_solver_is_compiled(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    calls: list[float] = []
    monkeypatch.setattr(MODE, "is_compiled", False)
    monkeypatch.setattr(MODE, "interpreted_s", 0.0)
    monkeypatch.setattr(MODE, "before_interpreting", lambda: calls.append(MODE.interpreted_s))
    assert _depth(3.0) == 12.0
    assert not _depth.entry.signatures  # type: ignore[attr-defined]
    # once for the kernel that Python calls, before it has taken any time
    assert calls == [0.0]
    assert MODE.interpreted_s > 0.0


def test_the_last_interpreted_call_may_begin_the_compilation(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(MODE, "is_compiled", False)
    monkeypatch.setattr(MODE, "before_interpreting", lambda: setattr(MODE, "is_compiled", True))
    assert _depth(2.0) == 8.0
    assert _depth.entry.signatures  # type: ignore[attr-defined]


@njit(error_model="numpy")
def _share(part: float, whole: float) -> float:
    return part / whole


def test_a_division_by_zero_that_python_refuses_is_left_to_compiled_code(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(MODE, "is_compiled", False)
    monkeypatch.setattr(MODE, "before_interpreting", lambda: None)
    monkeypatch.setattr("railjoule.core.compiled.compile_now", lambda: None)
    assert _share(1.0, 2.0) == 0.5
    assert not _share.entry.signatures  # type: ignore[attr-defined]
    assert _share(1.0, 0.0) == float("inf")


def test_a_kernel_is_pickled_by_its_name() -> None:
    assert pickle.loads(pickle.dumps(copy_rows)) is copy_rows


@pytest.mark.parametrize("source", [np.arange(3.0), np.arange(6.0).reshape(3, 2)], ids=["numbers", "rows"])
def test_rows_are_copied_to_the_first_ones(source: FloatArray) -> None:
    target = np.full((5, *source.shape[1:]), -1.0)
    copy_rows(source, target)
    assert (target[:3] == source).all()
    assert (target[3:] == -1.0).all()
