"""Numbers as tables of infrastructure write them: decimal commas, chainage, miles and chains, one in so many."""

import math
import re
from collections.abc import Iterable
from typing import Literal

from railjoule.core.errors import ScenarioError
from railjoule.core.imports.cells import Cell
from railjoule.core.scenario._sentences import show

Decimal = Literal[".", ","]
M_PER_KM = 1000.0
M_PER_MILE = 1609.344
M_PER_CHAIN = M_PER_MILE / 80
M_PER_YARD = M_PER_MILE / 1760
POSITION_UNITS = {"m": 1.0, "km": M_PER_KM, "mi": M_PER_MILE, "ch": M_PER_CHAIN, "yd": M_PER_YARD, "ft": M_PER_YARD / 3}
"""Metres in one of each unit of length."""
COMPOUND_UNITS = {
    "pk": "kilometres and metres, 012+345",
    "mi.ch": "miles and chains, 12.34 or 12m 34ch",
    "mi.yd": "miles and yards, 12.0440 or 12m 440yd",
}
LONGEST_NUMBER = 40
"""Characters of a number that is read; a longer one is none."""
THIN_SPACES = dict.fromkeys(map(ord, " \u00a0\u2007\u2009\u202f'\u2019"))
# \u2212 is the sign that word processors make of a hyphen between numbers
MINUS = str.maketrans("\u2212\u2013", "--")
KILOMETRES_METRES = re.compile(r"([+-]?)(\d+)([+-])(\d+(?:[.,]\d+)?)")
MILES = re.compile(r"(\d+)\s*(?:mi|m|miles?)\.?\s*(\d+(?:[.,]\d+)?)\s*(ch|c|chains?|yd|y|yards?)\.?", re.IGNORECASE)
WITH_UNIT = re.compile(r"([^a-z]+)(km|mi|ch|yd|ft|m)", re.IGNORECASE)
"""A number with its unit behind it; 12m alone is metres."""
RATIO = re.compile(r"([+-]?)\s*1\s*(?::|in|/)\s*([+-]?)\s*(\d[\d.,]*)\s*([RF]?)", re.IGNORECASE)
LEVEL = {"level", "l", "1:inf", "1:\u221e", "\u221e", "palier", "eben"}
STRAIGHT = {"infinity", "infinite", "inf", "straight", "\u221e", "droit", "gerade", "alignement"}


def text_of_cell(cell: Cell) -> str:
    """Return a cell as text; a number as short as it can be read back."""
    if isinstance(cell, float):
        return str(int(cell)) if cell.is_integer() and abs(cell) < 1e15 else repr(cell)
    return cell.strip()


def decimal_of(cells: Iterable[tuple[int, Cell]], separator: str, source: str) -> tuple[Decimal, int | None]:
    """Tell whether numbers have a decimal point or a decimal comma.

    Parameters
    ----------
    cells : iterable of (int, Cell)
        All cells that hold numbers, with their rows.
    separator : str
        What stands between cells.
    source : str
        What errors call the file.

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
    in_doubt = None
    for number, cell in cells:
        if not isinstance(cell, str):
            continue
        points, commas = cell.count("."), cell.count(",")
        if points and commas:
            sure.setdefault("." if cell.rindex(".") > cell.rindex(",") else ",", (number, cell))
        elif points > 1 or commas > 1:
            sure.setdefault("," if points else ".", (number, cell))
        elif commas and re.search(r"\b\d{1,3},\d{3}\b", cell):
            in_doubt = number if in_doubt is None else in_doubt
        elif points or commas:
            sure.setdefault("." if points else ",", (number, cell))
    if len(sure) == 2:
        (row, cell), (other_row, other) = sure["."], sure[","]
        raise ScenarioError(
            f"{source}: row {row} has {show(cell)} and row {other_row} {show(other)}; name the decimal sign, . or ,."
        )
    if sure:
        return next(iter(sure)), None
    # commas that separate cells can only be within quotes, where they part thousands
    return ("." if separator == "," or in_doubt is None else ","), in_doubt


def number_of(cell: Cell, decimal: Decimal) -> float:
    """Return the number in a cell.

    Raises
    ------
    ValueError
        If it holds none; the text says what it must be.
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


def position_of(cell: Cell, unit: str, decimal: Decimal) -> float:
    """Return the position in a cell [m]; a notation that names its units goes before `unit`.

    Raises
    ------
    ValueError
        If it holds none; the text says what it must be.
    """
    text = text_of_cell(cell).translate(MINUS)
    if len(text) <= LONGEST_NUMBER:
        if found := KILOMETRES_METRES.fullmatch(text.replace(" ", "")):
            return _chainage(*found.groups())
        if found := MILES.fullmatch(text):
            return _miles(*found.groups())
        if found := WITH_UNIT.fullmatch(text):
            cell, unit = found[1].strip(), found[2].lower()
    if unit == "pk":
        # chainage without a plus: the whole kilometres alone, or kilometres with decimals
        return number_of(cell, decimal) * M_PER_KM
    if unit in COMPOUND_UNITS:
        return _decimal_miles(cell, unit, decimal)
    return number_of(cell, decimal) * POSITION_UNITS[unit]


def gradient_of(cell: Cell, unit: str, decimal: Decimal) -> float:
    """Return the gradient in a cell [per mille], uphill positive; '1:100' is read in any unit.

    Raises
    ------
    ValueError
        If it holds none; the text says what it must be.
    """
    text = text_of_cell(cell).translate(MINUS)
    if text.lower().replace(" ", "") in LEVEL:
        return 0.0
    if len(text) <= LONGEST_NUMBER and (found := RATIO.fullmatch(text)):
        sign, other_sign, length, letter = found.groups()
        falls = (sign == "-") != (other_sign == "-") or letter.upper() == "F"
        return (-1 if falls else 1) * _one_in(number_of(length, decimal))
    if isinstance(cell, str):
        cell = text.removesuffix("%").removesuffix("\u2030")
    value = number_of(cell, decimal)
    if unit == "ratio":
        return math.copysign(_one_in(abs(value)), value)
    return value * (10.0 if unit == "percent" else 1.0)


def radius_of(cell: Cell, decimal: Decimal) -> float:
    """Return the radius in a cell [m], without the side to which it bends; 0 is straight.

    Raises
    ------
    ValueError
        If it holds none; the text says what it must be.
    """
    if text_of_cell(cell).lower() in STRAIGHT:
        return 0.0
    return abs(number_of(cell, decimal))


def _one_in(length: float) -> float:
    if length == 0:
        raise ValueError("must not be one in 0")
    return 1000.0 / length


def _chainage(sign: str, kilometres: str, joint: str, metres: str) -> float:
    value = int(kilometres) * M_PER_KM + float(metres.replace(",", "."))
    # '000-120' is how places before the origin are written
    return -value if sign == "-" or joint == "-" else value


def _miles(miles: str, rest: str, unit: str) -> float:
    part = float(rest.replace(",", "."))
    return int(miles) * M_PER_MILE + (_chains(part) if unit[0].lower() == "c" else _yards(part))


def _decimal_miles(cell: Cell, unit: str, decimal: Decimal) -> float:
    """Read '12.34' as 12 miles 34 chains, or '12.0440' as 12 miles 440 yards."""
    digits = 2 if unit == "mi.ch" else 4
    # through the rounded number, as a workbook keeps no zero at the end: 12.3 is 12 miles 30 chains
    value = number_of(cell, decimal)
    miles, part = f"{abs(value):.{digits}f}".split(".")
    if abs(abs(value) - float(f"{miles}.{part}")) > 1e-9:
        raise ValueError(f"must have {digits} digits after the point, as {COMPOUND_UNITS[unit]}")
    rest = _chains(float(part)) if unit == "mi.ch" else _yards(float(part))
    return math.copysign(int(miles) * M_PER_MILE + rest, value)


def _chains(chains: float) -> float:
    if chains >= 80:
        raise ValueError(f"must have fewer than 80 chains, and has {chains:g}")
    return chains * M_PER_CHAIN


def _yards(yards: float) -> float:
    if yards >= 1760:
        raise ValueError(f"must have fewer than 1760 yards, and has {yards:g}")
    return yards * M_PER_YARD
