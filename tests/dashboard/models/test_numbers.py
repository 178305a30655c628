import pytest

from railjoule.dashboard.models.numbers import parse_number


@pytest.mark.parametrize(
    ("text", "number"), [("12", 12.0), ("1,5", 1.5), ("\u22123", -3.0), ("1\u202f000", 1000.0), (" 7 ", 7.0)]
)
def test_numbers_as_people_type_them(text: str, number: float) -> None:
    assert parse_number(text, (None, None)) == number


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", "Not a number."),
        ("nan", "Not a number."),
        ("ten", "Not a number."),
        ("-1", "At least 0."),
        ("9", "At most 5."),
    ],
)
def test_what_is_no_number_or_out_of_bounds_is_refused(text: str, sentence: str) -> None:
    with pytest.raises(ValueError, match=sentence):
        parse_number(text, (0.0, 5.0))
