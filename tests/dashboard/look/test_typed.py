import pytest

from railjoule.dashboard.look.typed import clock, parse_number, parse_time


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


@pytest.mark.parametrize(
    ("text", "seconds"),
    [
        ("150", 150.0),
        ("150,5", 150.5),
        ("2:30", 150.0),
        ("2:30,5", 150.5),
        ("90:00", 5400.0),
        ("1:02:03", 3723.0),
        ("2 min 30 s", 150.0),
        ("2min30s", 150.0),
        ("2 min 30", 150.0),
        ("2.5 min", 150.0),
        ("1 h 2 min 3 s", 3723.0),
        ("1 h", 3600.0),
        ("150 s", 150.0),
        ("2 Minutes 30 Seconds", 150.0),
        (" 0:45 ", 45.0),
    ],
)
def test_times_as_people_type_them(text: str, seconds: float) -> None:
    assert parse_time(text, (0.0, 86_400.0)) == seconds


@pytest.mark.parametrize("text", ["", "2:75", "2:5", "1:60:00", ":30", "2:", "1:2:3:4", "2 km", "soon", "min", "-2:30"])
def test_what_is_no_time_is_named_with_the_forms_it_may_have(text: str) -> None:
    with pytest.raises(ValueError, match=r"is not a time: write seconds, .* such as 150, 2:30 or 1:02:03\.$") as error:
        parse_time(text, (0.0, 86_400.0))
    assert repr(text) in str(error.value)


@pytest.mark.parametrize(
    ("text", "sentence"), [("25:00:00", "At most 86400."), ("0:00", "At least 1."), ("-5", "At least 1.")]
)
def test_times_have_bounds(text: str, sentence: str) -> None:
    with pytest.raises(ValueError, match=f"^{sentence}$"):
        parse_time(text, (1.0, 86_400.0))


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(150.0, "2:30"), (150.5, "2:30.5"), (3723.0, "1:02:03"), (59.96, "1:00"), (86_400.0, "24:00:00")],
)
def test_times_as_on_a_clock(seconds: float, text: str) -> None:
    assert clock(seconds) == text
