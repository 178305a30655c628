import math
import re

import pytest

from railjoule.core.errors import ScenarioError
from railjoule.core.imports.numbers import decimal_mark, parse_cell, parse_position, parse_value


@pytest.mark.parametrize(
    ("cell", "decimal", "value"),
    [
        ("12.5", ".", 12.5),
        ("12,5", ",", 12.5),
        ("1 234,5", ",", 1234.5),
        ("1.234,5", ",", 1234.5),
        ("1,234.5", ".", 1234.5),
        ("12'345", ".", 12345.0),
        ("\u22123.2", ".", -3.2),
        (".5", ".", 0.5),
        ("1e3", ".", 1000.0),
        (7.25, ",", 7.25),
    ],
)
def test_numbers_as_people_write_them(cell, decimal, value):
    assert parse_cell(cell, decimal) == value


@pytest.mark.parametrize(
    "cell",
    ["", "abc", "1,5", "1.2.3", "nan", "inf", "1e999", "0x10", "1_000", "12 km", "9" * 50, math.nan, math.inf],
)
def test_what_is_no_number_is_refused(cell):
    with pytest.raises(ValueError, match=r"must be a (finite )?number"):
        parse_cell(cell, ".")


def test_a_formula_is_called_one():
    with pytest.raises(ValueError, match=r"is a formula"):
        parse_cell("=A1+5", ".")


@pytest.mark.parametrize(
    ("cells", "separator", "decimal", "in_doubt"),
    [
        (["1.5", "2"], ",", ".", None),
        (["1,5", "2"], ";", ",", None),
        (["1.234,5"], ";", ",", None),
        (["1,234.5", "7.5"], ";", ".", None),
        (["12,345"], ";", ",", 2),
        (["12,345"], ",", ".", 2),
        (["12,345", "1,5"], ";", ",", None),
        (["1,234,567"], ";", ".", None),
        (["1.234", "12.345"], ";", ".", 2),
        (["1.234", "12.345"], ",", ".", None),
        (["1.234", "1,5"], ";", ",", None),
        (["0.234", "0.345"], ";", ".", None),
        (["0,234", "0,345"], ";", ",", None),
        (["1", "012+345"], ";", ".", None),
    ],
)
def test_the_decimal_sign_is_told_from_all_rows(cells, separator, decimal, in_doubt):
    assert decimal_mark(enumerate(cells, 2), separator, "a.csv") == (decimal, in_doubt)


@pytest.mark.parametrize("cells", [["1.5", "1,5"], ["1.234", "1,234"]])
def test_two_decimal_signs_in_one_table_are_refused(cells):
    told = f"a.csv: row 2 has '{cells[0]}' and row 3 '{cells[1]}'; name the decimal sign"
    with pytest.raises(ScenarioError, match=f"^{re.escape(told)}"):
        decimal_mark(enumerate(cells, 2), ";", "a.csv")


# 1 mile = 1609.344 m, 80 chains, 1760 yards
@pytest.mark.parametrize(
    ("cell", "unit", "position_m"),
    [
        ("350", "m", 350.0),
        ("0.35", "km", 350.0),
        (0.35, "km", 350.0),
        ("012+345", "m", 12345.0),
        ("012+345.5", "pk", 12345.5),
        ("000-120", "pk", -120.0),
        ("-0+120", "pk", -120.0),
        ("12", "pk", 12000.0),
        ("500 m", "km", 500.0),
        ("12m", "km", 12.0),
        ("12.5 km", "m", 12500.0),
        ("2m 40ch", "m", 2.5 * 1609.344),
        ("2 mi 440 yd", "m", 2.25 * 1609.344),
        ("2.40", "mi.ch", 2.5 * 1609.344),
        (2.4, "mi.ch", 2.5 * 1609.344),
        ("2.0440", "mi.yd", 2.25 * 1609.344),
        ("3", "mi", 3 * 1609.344),
        ("40", "ch", 0.5 * 1609.344),
        ("100", "ft", 30.48),
    ],
)
def test_positions_in_all_notations(cell, unit, position_m):
    assert parse_position(cell, unit, ".") == pytest.approx(position_m, abs=1e-9)


@pytest.mark.parametrize(
    ("cell", "unit", "words"),
    [
        ("2m 85ch", "m", "fewer than 80 chains"),
        ("2.85", "mi.ch", "fewer than 80 chains"),
        ("2.401", "mi.ch", "must have 2 digits after the point"),
        ("2.1800", "mi.yd", "fewer than 1760 yards"),
        ("north end", "m", "must be a number"),
        # core.md, B4: these were -100 m, -100,250 m and -2,024,001 m
        ("0-100", "m", "looks like a range or a date"),
        ("100-250", "m", "looks like a range or a date"),
        ("2024-01", "m", "looks like a range or a date"),
        ("12+50", "m", "three digits of metres behind the \\+"),
        ("12+345", "ft", "is in km and m, but the column is in ft"),
    ],
)
def test_positions_that_are_none(cell, unit, words):
    with pytest.raises(ValueError, match=words):
        parse_position(cell, unit, ".")


def test_one_in_nothing_is_refused():
    with pytest.raises(ValueError, match="one in 0"):
        parse_value("1:0", "gradients", "ratio", ".")


@pytest.mark.parametrize(
    ("cell", "kind", "unit", "value"),
    [
        ("1 in 200 F", "gradients", "permille", -5.0),
        ("1:-80", "gradients", "ratio", -12.5),
        ("Level", "gradients", "ratio", 0.0),
        ("1.5\u00b0", "gradients", "permille", 26.1859),
        # OpenStreetMap contains such limits of lines in miles
        ("40 mph", "limits", "km/h", 64.37376),
        ("-300", "curves", "m", 300.0),
        ("infinity", "curves", "m", 0.0),
        ("0", "curves", "1/m", 0.0),
    ],
)
def test_special_spellings_of_values_are_read(cell, kind, unit, value):
    assert parse_value(cell, kind, unit, ".") == pytest.approx(value, rel=1e-5)
