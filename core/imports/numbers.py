"""Numbers as tables of infrastructure write them: decimal commas, chainage, miles and chains, one in so many."""

import math
import re
from collections.abc import Iterable, Mapping
from typing import Literal

from railjoule.core.errors import ScenarioError
from railjoule.core.imports.cells import Cell
from railjoule.core.imports.units import KNOTS, Quantity, unit_words, without_unit
from railjoule.core.scenario._sentences import show
from railjoule.core.units import M_PER_KM, MS_PER_KMH

Decimal = Literal[".", ","]
M_PER_MILE = 1609.344
M_PER_CHAIN = M_PER_MILE / 80
M_PER_YARD = M_PER_MILE / 1760
M_PER_FOOT = M_PER_YARD / 3
POSITION_UNITS = {"m": 1.0, "km": M_PER_KM, "mi": M_PER_MILE, "ch": M_PER_CHAIN, "yd": M_PER_YARD, "ft": M_PER_FOOT}
"""Metres in one of each unit of length."""
COMPOUND_UNITS = {
    "pk": "kilometres and metres, 012+345",
    "mi.ch": "miles and chains, 12.34 or 12m 34ch",
    "mi.yd": "miles and yards, 12.0440 or 12m 440yd",
}
FACTORS: Mapping[str, Mapping[str, float]] = {
    "gradients": {
        "permille": 1.0,
        "percent": 10.0,
        "fraction": 1000.0,
        "per10000": 0.1,
        "ft/mi": 1000.0 * M_PER_FOOT / M_PER_MILE,
    },
    "limits": {"km/h": 1.0, "m/s": 1 / MS_PER_KMH, "mph": M_PER_MILE / M_PER_KM},
    "curves": POSITION_UNITS,
    "heights": POSITION_UNITS,
    "stations": {"s": 1.0, "min": 60.0, "h": 3600.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9},
}
"""Per mille, km/h, m and s in one of each unit that is proportional to them."""
RADIANS = {"rad": 1.0, "deg": math.pi / 180, "deg_arc": math.pi / 180}
CURVATURE_UNITS = {"1/m": 1.0, "1/km": 1 / M_PER_KM, "1/ft": 1 / M_PER_FOOT}
CHORD_M = 100 * M_PER_FOOT
"""The degree of curve is the angle of the arc over this chord, as North American railways define it; that of roads is
the angle over an arc of this length, 30.48 m."""
DEGREES = re.compile(
    r"(\d{1,3})\s*\u00b0\s*(?:(\d{1,2})\s*['\u2032\u2019]\s*)?(?:(\d{1,2}(?:\.\d+)?)\s*[\"\u2033\u201d]\s*)?"
)
"""Degrees, minutes and seconds of an angle."""
NO_SPEED = ("none", "walk", "signals", "variable", "implicit")
"""Texts of OpenStreetMap's `maxspeed` that are no number."""
LONGEST_NUMBER = 40
"""Characters of a number that is read; a longer one is none."""
THIN_SPACES = dict.fromkeys(map(ord, " \u00a0\u2007\u2009\u202f'\u2019"))
# \u2212 is the sign that word processors make of a hyphen between numbers
MINUS = str.maketrans("\u2212\u2013", "--")
KILOMETRES_METRES = re.compile(r"([+-]?)(\d+)\+(\d{3,}(?:[.,]\d+)?)")
BEFORE_ORIGIN = re.compile(r"000-(\d{3}(?:[.,]\d+)?)")
FEW_METRES = re.compile(r"[+-]?\d+\+\d{1,2}(?:[.,]\d+)?")
"""12 km and 50 m, 500 m, or a station of 50 ft."""
RANGE = re.compile(r"\d[\d.,]*-\d[\d.,-]*")
"""Two places, or a date."""
CHAINAGE_UNITS = ("m", "km", "pk")
"""Units in which a table may be that has places in km and m."""
MILES = re.compile(r"(\d+)\s*(?:mi|m|miles?)\.?\s*(\d+(?:[.,]\d+)?)\s*(ch|c|chains?|yd|y|yards?)\.?", re.IGNORECASE)
PLACES_WITH_UNITS = (KILOMETRES_METRES, BEFORE_ORIGIN, MILES)
RATIO = re.compile(r"([+-]?)\s*1\s*(?::|in|/)\s*([+-]?)\s*(\d[\d.,]*)\s*([RF]?)", re.IGNORECASE)
THOUSANDS = re.compile(r"(?<![\d.,])[1-9]\d{0,2}[.,]\d{3}(?!\d)")
LEVEL = {"level", "l", "1:inf", "1:\u221e", "\u221e", "palier", "eben"}
STRAIGHT = {"infinity", "infinite", "inf", "straight", "\u221e", "droit", "gerade", "alignement"}


def text_of_cell(cell: Cell) -> str:
    """Format a cell; a number as short as it can be read back."""
    if isinstance(cell, float):
        return str(int(cell)) if cell.is_integer() and abs(cell) < 1e15 else repr(cell)
    return cell.strip()


def decimal_mark(cells: Iterable[tuple[int, Cell]], separator: str, source: str) -> tuple[Decimal, int | None]:
    """Tell whether numbers have a decimal point or a decimal comma.

    Parameters
    ----------
    cells : iterable of (int, Cell)
        All cells that hold numbers, with their rows.
    separator : str
        The sign between cells.
    source : str
        The name of the file in errors.

    Returns
    -------
    decimal : str
        The sign.
    in_doubt : int or None
        A row whose number would be another with the other sign, where no row decides.

    Raises
    ------
    ScenarioError
        If some rows have the one and some the other.
    """
    sure: dict[Decimal, tuple[int, str]] = {}
    in_doubt: dict[Decimal, tuple[int, str]] = {}
    for number, cell in cells:
        if not isinstance(cell, str):
            continue
        points, commas = cell.count("."), cell.count(",")
        if points and commas:
            sure.setdefault("." if cell.rindex(".") > cell.rindex(",") else ",", (number, cell))
        elif points > 1 or commas > 1:
            sure.setdefault("," if points else ".", (number, cell))
        elif points or commas:
            # 1.234 may be a thousand and more, 0.234 may not; nor may what no comma for decimals stands beside
            is_doubtful = THOUSANDS.search(cell) and not (points and separator == ",")
            (in_doubt if is_doubtful else sure).setdefault("." if points else ",", (number, cell))
    if (mixed := sure if len(sure) == 2 else in_doubt if len(in_doubt) == 2 and not sure else None) is not None:
        (row, cell), (other_row, other) = mixed["."], mixed[","]
        raise ScenarioError(
            f"{source}: row {row} has {show(cell)} and row {other_row} {show(other)}; name the decimal sign, . or ,."
        )
    if sure or not in_doubt:
        return next(iter(sure), "."), None
    ((sign, (row, _)),) = in_doubt.items()
    # commas that separate cells can only be within quotes, where they part thousands
    return ("." if separator == "," else sign), row


def parse_cell(cell: Cell, decimal: Decimal) -> float:
    """Return the number in a cell.

    Raises
    ------
    ValueError
        If there is none; its text is the end of a sentence.
    """
    if isinstance(cell, float):
        if not math.isfinite(cell):
            raise ValueError("must be a finite number")
        return cell
    text = cell.translate(THIN_SPACES).translate(MINUS) if len(cell) <= LONGEST_NUMBER else ""
    thousands = "," if decimal == "." else "."
    if re.fullmatch(rf"[+-]?\d{{1,3}}(?:{re.escape(thousands)}\d{{3}})+(?:{re.escape(decimal)}\d*)?", text):
        text = text.replace(thousands, "")
    text = text.replace(decimal, ".", 1) if thousands not in text else ""
    if not re.fullmatch(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,3})?", text):
        if cell.strip().startswith("="):
            raise ValueError("is a formula; write what it gives")
        raise ValueError("must be a number" + (f" with the decimal sign {decimal}" if decimal == "," else ""))
    value = float(text)
    if not math.isfinite(value):
        raise ValueError("must be a finite number")
    return value


def parse_position(cell: Cell, unit: str, decimal: Decimal) -> float:
    """Read the position in a cell [m]; a notation that names its units precedes `unit`.

    Raises
    ------
    ValueError
        If there is none; its text is the end of a sentence.
    """
    text = text_of_cell(cell).translate(MINUS)
    if len(text) <= LONGEST_NUMBER:
        joined = text.replace(" ", "")
        if found := KILOMETRES_METRES.fullmatch(joined):
            if unit not in CHAINAGE_UNITS:
                raise ValueError(f"is in km and m, but the column is in {unit}")
            sign, kilometres, metres = found.groups()
            return math.copysign(int(kilometres) * M_PER_KM + float(metres.replace(",", ".")), -1 if sign == "-" else 1)
        if FEW_METRES.fullmatch(joined):
            raise ValueError("must have three digits of metres behind the +, as 12+050")
        if found := BEFORE_ORIGIN.fullmatch(joined):
            return -float(found[1].replace(",", "."))
        if RANGE.fullmatch(joined):
            raise ValueError("looks like a range or a date, and must be one place; 120 m before the origin is 000-120")
        if found := MILES.fullmatch(text):
            return _miles(found[1], float(found[2].replace(",", ".")), found[3][0].lower())
        number, own = without_unit(text, "positions")
        cell, unit = (number, own) if own else (cell, unit)
    value = parse_cell(cell, decimal)
    if unit not in ("mi.ch", "mi.yd"):
        # chainage without a plus: only whole kilometres, or kilometres with decimals
        return value * (M_PER_KM if unit == "pk" else POSITION_UNITS[unit])
    digits = 2 if unit == "mi.ch" else 4
    # through the rounded number, as a workbook keeps no zero at the end: 12.3 is 12 miles 30 chains
    miles, part = f"{abs(value):.{digits}f}".split(".")
    if abs(abs(value) - float(f"{miles}.{part}")) > 1e-9:
        raise ValueError(f"must have {digits} digits after the point, as {COMPOUND_UNITS[unit]}")
    return math.copysign(_miles(miles, float(part), unit[3]), value)


def parse_value(cell: Cell, kind: Quantity, unit: str, decimal: Decimal, stated: str | None = None) -> float:
    """Read the gradient [per mille, uphill positive], limit [km/h], radius [m] or other value in a cell.

    Parameters
    ----------
    cell : Cell
        A number; a unit behind it precedes that of the column, and '1:100' is a gradient in any column.
    kind, unit, decimal : str
        The quantity, the unit of the column and the decimal sign.
    stated : str or None
        The unit of heading or user, which the cell must not contradict.

    Raises
    ------
    ValueError
        If there is none, or in another unit than `stated`; its text is the end of a sentence.
    """
    text = text_of_cell(cell).translate(MINUS)
    if len(text) > LONGEST_NUMBER:
        return parse_cell(cell, decimal)
    if kind == "gradients" and (found := RATIO.fullmatch(text)):
        sign, other_sign, length, letter = found.groups()
        falls = (sign == "-") != (other_sign == "-") or letter.upper() == "F"
        return (-1 if falls else 1) * _one_in(parse_cell(length, decimal))
    if is_zero_in_words(text, kind):
        return 0.0
    if kind == "limits" and text.lower() in NO_SPEED:
        raise ValueError("is no speed; write a number, or leave the cell empty if no limit holds")
    if kind == "curves" and (angle := DEGREES.fullmatch(text)):
        text, decimal = f"{sum(float(part or 0) / 60**power for power, part in enumerate(angle.groups()))!r} deg", "."
    number, own = without_unit(text, kind)
    if own == "deg" and unit == "deg_arc":  # a cell does not distinguish them
        own = unit
    if own is not None:
        if stated is not None and own != stated:
            raise ValueError(f"is in {unit_words(own)}, but the column in {unit_words(stated)}")
        cell, unit = number, own
    if unit == KNOTS:
        raise ValueError("is in knots, which are not read; write km/h, of which a knot is 1.852")
    return _converted(parse_cell(cell, decimal), kind, unit)


def is_zero_in_words(text: str, kind: Quantity) -> bool:
    """Tell whether a cell means 'level' or 'straight'."""
    word = text.lower().replace(" ", "")
    return (kind == "gradients" and word in LEVEL) or (kind == "curves" and word in STRAIGHT)


def names_unit(cell: Cell, kind: Quantity) -> bool:
    """Tell whether a cell contains its unit."""
    text = text_of_cell(cell).translate(MINUS)
    if len(text) > LONGEST_NUMBER:
        return False
    if kind == "positions":
        joined = text.replace(" ", "")
        return any(form.fullmatch(joined) for form in PLACES_WITH_UNITS) or without_unit(text, kind)[1] is not None
    if kind == "curves" and DEGREES.fullmatch(text):
        return True
    return (kind == "gradients" and RATIO.fullmatch(text) is not None) or without_unit(text, kind)[1] is not None


def _converted(value: float, kind: Quantity, unit: str) -> float:
    if kind == "curves":
        value = abs(value)
    if unit in FACTORS.get(kind, {}):
        return value * FACTORS[kind][unit]
    if value == 0 or kind not in FACTORS:
        return value + 0.0  # level and straight are written as 0; no negative zero
    if unit == "ratio":
        return math.copysign(_one_in(abs(value)), value)
    if unit in CURVATURE_UNITS:
        return 1 / (value * CURVATURE_UNITS[unit])
    angle = RADIANS[unit] * value
    if kind == "gradients":
        if abs(angle) >= math.pi / 2:
            raise ValueError("must be less steep than a right angle")
        return 1000.0 * math.tan(angle)
    if unit == "deg_arc":
        return CHORD_M / angle
    if value >= 180:
        raise ValueError("must be below 180 degrees")
    return CHORD_M / 2 / math.sin(angle / 2)


def _one_in(length: float) -> float:
    if length == 0:
        raise ValueError("must not be one in 0")
    return 1000.0 / length


def _miles(miles: str, part: float, unit: str) -> float:
    """Add chains or yards to miles [m]."""
    most, name, metres = (80, "chains", M_PER_CHAIN) if unit == "c" else (1760, "yards", M_PER_YARD)
    if part >= most:
        raise ValueError(f"must have fewer than {most} {name}, and has {part:g}")
    return int(miles) * M_PER_MILE + part * metres
