from collections.abc import Callable

import pytest

from railjoule.core.validation import COMPARISONS, PAPERS
from railjoule.core.validation.table import Comparison, Row, Table, first_comparisons


def test_difference_is_relative_to_the_printed_number():
    assert Row("", "W", "Wh", 200.0, 201.0).difference_percent == pytest.approx(0.5)


def test_difference_of_negative_numbers_is_positive_where_the_computed_one_is_larger_in_size():
    assert Row("", "I_min", "A", -200.0, -201.0).difference_percent == pytest.approx(0.5)


@pytest.mark.parametrize("printed", [None, 0.0])
def test_nothing_printed_has_no_difference(printed):
    assert Row("", "W", "Wh", printed, 201.0).difference_percent is None


def test_percentages_differ_by_percentage_points():
    """0.1 % printed and 2.2 % computed are 2.1 points apart, not 2100 %; 0 % is a number like any other."""
    row = Row("", "overconsumption", "%", 0.1, 2.2)
    assert row.difference_points == row.difference == pytest.approx(2.1)
    assert not row.is_close
    assert Row("", "overconsumption", "%", 0.0, 0.9).is_close
    assert Row("", "W", "Wh", 200.0, 201.0).difference_points is None


@pytest.mark.parametrize(
    ("printed", "close"), [(200.0, True), (198.5, True), (198.0, False), (None, False), (0.0, False)]
)
def test_other_numbers_are_close_within_one_percent(printed, close):
    assert Row("", "W", "Wh", printed, 200.0).is_close == close


def test_a_comparison_is_computed_table_by_table() -> None:
    tables = [Table(f"table {k}", ()) for k in range(3)]
    asked: list[int] = []

    def computing(k: int) -> Callable[[], Table]:
        def compute() -> Table:
            asked.append(k)
            return tables[k]

        return compute

    comparison = Comparison("paper", "cited", tuple(computing(k) for k in range(3)), ())
    steps = comparison.steps()
    assert [len(next(steps).tables) for _ in range(2)] == [0, 1]
    assert asked == [0]
    assert comparison.validation().tables == tuple(tables)


def test_every_paper_is_known_both_ways() -> None:
    assert list(COMPARISONS) == list(PAPERS)


def test_a_printed_number_counts_once_by_its_first_comparison() -> None:
    first = Row("a", "W", "Wh", 2.0, 2.0, source="Table 1, a, W")
    again = Row("a", "W by parts", "Wh", 2.0, 3.0, source="Table 1, a, W")
    independent = Row("a", "W", "Wh", 2.0, 2.0)
    zero = Row("b", "v", "m/s", 0.0, 0.0, source="Table 1, b, v")
    assert first_comparisons([Table("", (independent, first)), Table("", (again, zero))]) == (first,)
