import pytest

from railjoule.core.validation.table import Row


def test_difference_is_relative_to_the_printed_number():
    assert Row("", "W", "Wh", 200.0, 201.0).difference_percent == pytest.approx(0.5)


def test_difference_of_negative_numbers_is_positive_where_ours_is_larger_in_size():
    assert Row("", "I_min", "A", -200.0, -201.0).difference_percent == pytest.approx(0.5)


@pytest.mark.parametrize("printed", [None, 0.0])
def test_nothing_printed_has_no_difference(printed):
    assert Row("", "W", "Wh", printed, 201.0).difference_percent is None
