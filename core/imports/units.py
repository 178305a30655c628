"""Units in the headings and cells of tables: the words that name them, and what a heading leaves unclear."""

import re
import unicodedata
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

IntervalKind = Literal["gradients", "heights", "limits", "curves", "tunnels", "neutral"]
TableKind = IntervalKind | Literal["stations"]
Quantity = TableKind | Literal["positions"]
CLOCK = "clock"
"""Unit of times of day, hh:mm:ss with or without a date."""
KNOTS = "kn"
"""A unit of speed that is recognised, and refused."""
LENGTHS = {
    "m": ("m", "metre", "metres", "meter", "meters", "\u043c", "\u7c73"),
    "km": ("km", "\u043a\u043c", "\u516c\u91cc", "\u5343\u7c73"),
    "ft": ("ft", "foot", "feet"),
    "yd": ("yd", "yds", "yard", "yards"),
    "ch": ("ch", "chain", "chains"),
    "mi": ("mi", "mile", "miles"),
}
SPELLINGS: Mapping[Quantity, Mapping[str, tuple[str, ...]]] = {
    "positions": {
        **LENGTHS,
        "mi.ch": ("mi.ch", "mi ch", "miles.chains", "miles chains", "miles and chains", "mile.chain", "m.ch"),
        "mi.yd": ("mi.yd", "mi yd", "miles.yards", "miles yards", "miles and yards", "mile.yard", "m.yd"),
    },
    "gradients": {
        "permille": ("\u2030", "permille", "permil", "per mille", "per mil", "promille", "pro mille", "mm/m", "m/km",
                     "o/oo", "0/00", "per thousand", "per 1000", "1/1000",
                     "\u043f\u0440\u043e\u043c\u0438\u043b\u043b\u0435", "\u043f\u0440\u043e\u043c\u0456\u043b\u0435"),
        "percent": ("%", "percent", "per cent", "pct", "prozent", "pour cent", "percentage",
                    "\u043f\u0440\u043e\u0446\u0435\u043d\u0442"),
        "fraction": ("m/m", "ft/ft", "m per m", "fraction", "-", "dimensionless", "rise/run"),
        "ratio": ("1 in", "1 in n", "1 in x", "1in", "1:", "1:n", "1:x", "1/n", "1/x", "one in", "one in n",
                  "one in x"),
        "deg": ("deg", "degree", "degrees", "\u00b0"),
        "rad": ("rad", "radian", "radians"),
        "per10000": ("per 10000", "per 10 000", "\u2031", "1/10000", "per ten thousand"),
        "ft/mi": ("ft/mi", "ft/mile", "ft mi", "ft per mi", "ft per mile", "feet per mile", "feet/mile"),
    },
    "limits": {
        "km/h": ("km/h", "kmh", "kph", "kmph", "km h", "km/hr", "kilometers per hour", "kilometres per hour",
                 "\u043a\u043c/\u0447",
                 "\u043a\u043c/\u0433\u043e\u0434", "\u516c\u91cc/\u5c0f\u65f6", "\u5343\u7c73/\u5c0f\u65f6"),
        "m/s": ("m/s", "ms", "mps", "m s", "meters per second", "metres per second", "\u043c/\u0441", "\u7c73/\u79d2"),
        "mph": ("mph", "mi/h", "mi h", "miles per hour", "miles/hour"),
        KNOTS: ("kn", "kt", "kts", "knot", "knots"),
    },
    "curves": {
        **LENGTHS,
        "deg": ("deg", "degree", "degrees", "\u00b0", "chord", "chord definition"),
        "deg_arc": ("deg arc", "degrees arc", "arc", "arc definition"),
        "1/m": ("1/m", "m-1", "m^-1", "per m", "per metre", "per meter", "rad/m"),
        "1/km": ("1/km", "km-1", "km^-1", "per km", "rad/km"),
        "1/ft": ("1/ft", "ft-1", "ft^-1", "per ft", "per foot"),
    },
    "heights": {unit: LENGTHS[unit] for unit in ("m", "ft")},
    "stations": {
        "s": ("s", "sec", "secs", "second", "seconds", "sek", "\u0441", "\u79d2"),
        "min": ("min", "mins", "minute", "minutes", "\u043c\u0438\u043d", "\u0445\u0432", "\u5206"),
        "h": ("h", "hour", "hours"),
        CLOCK: ("hh:mm", "hh:mm:ss", "h:mm", "h:mm:ss", "am/pm", "clock", "utc", "local time"),
    },
    "tunnels": {"factor": ("factor",), "m2": ("m2", "m^2")},
    "neutral": {},
}  # fmt: skip
"""Words for each unit, by what is measured."""
IMPLIED: Mapping[Quantity, Mapping[str, tuple[str, ...]]] = {
    "positions": {
        "pk": ("pk", "pkd", "pkf"),
        "km": ("kilometer", "kilometre", "kilometers", "kilometres"),
        "mi": ("milepost", "mileposts"),
    },
    "curves": {"deg": ("degree of curve", "degrees of curve", "degree of curvature")},
    "tunnels": {"m2": ("area", "cross section", "querschnitt")},
}
"""Names of what is measured that say its unit where nothing else does."""
CURVATURES = ("curvature", "krummung", "courbure")
"""Such a quantity is no radius, and so not in metres."""
NO_UNIT = ("of", "the", "in", "at", "en", "de", "du", "la", "le", "max", "maximum", "permitted", "allowed", "value",
           "values", "profile", "mean", "average", "point", "place", "station", "distance", "mileage",
           "limite", "maximale", "courbe")  # fmt: skip
"""Words of headings that say nothing of a unit."""
LONGEST_PHRASE = 4
BRACKETS = re.compile(r"\(([^()]*)\)|\[([^][]*)\]|\{([^{}]*)\}")
SIGNS = re.compile("([%\u2030\u2031\u00b0])")
NUMBER_AND_UNIT = re.compile(r"([-+]?[\d.,\s'\u2019\u00a0\u2009\u202f]*\d[.,]?)\s*(\D.*)")


@dataclass(frozen=True)
class Heading:
    """The unit that the heading of a column names, if any, and in words why it is in doubt, if it is."""

    unit: str | None = None
    doubt: str = ""


@dataclass(frozen=True)
class ColumnUnit:
    """The unit of a column.

    Parameters
    ----------
    unit : str
        In which a cell counts that names none.
    stated : str or None
        As the heading or the user names it.
    is_assumed : bool
        Whether it is used for cells without a known unit.
    """

    unit: str
    stated: str | None
    is_assumed: bool


NOTHING = ColumnUnit("", None, False)
"""Of a column that is not there, or whose cells have units of their own."""


def unit_words(unit: str) -> str:
    """Format a unit for a sentence."""
    words = {"permille": "per mille", "percent": "per cent", "ratio": "1 in n", "deg_arc": "degrees by the arc"}
    return words.get(unit, unit)


def plain(text: str) -> str:
    """Return a text in small letters without accents."""
    letters = (letter for letter in unicodedata.normalize("NFKD", text) if not unicodedata.combining(letter))
    return "".join(letters).casefold().replace("\u2212", "-")


def _phrases(table: Mapping[Quantity, Mapping[str, tuple[str, ...]]]) -> dict[str, dict[str, str]]:
    return {
        quantity: {plain(word): unit for unit, words in units.items() for word in words}
        for quantity, units in table.items()
    }


_STATED, _IMPLIED = _phrases(SPELLINGS), _phrases(IMPLIED)
_ANY_UNIT = {phrase for phrases in _STATED.values() for phrase in phrases} - {"-", "factor"}
_NAMES = {phrase for phrases in _IMPLIED.values() for phrase in phrases}
# of other quantities, so that a heading which names one is no heading without a unit
_ANY_UNIT |= {"mm", "cm", "hm", "nmi", "mrad", "gon", "fps", "ft/s"}


def tokens(heading: str) -> list[str]:
    """Return the words of a heading without what stands in brackets."""
    text = SIGNS.sub(r" \1 ", plain(BRACKETS.sub(" ", heading)))
    words = (word.strip(".:'\"") if len(word) > 1 and word != "1:" else word for word in re.split(r"[\s_,;]+", text))
    # a hyphen joins words, but for that of a power
    return [part for word in words for part in ([word] if re.search(r"\d", word) else word.split("-")) if part]


def name_tokens(heading: str) -> list[str]:
    """Return the words of a heading without units; a heading that is nothing but a unit keeps it."""
    words = tokens(heading)
    kept = [
        word for phrase, _ in _split(words, _ANY_UNIT | _NAMES) if phrase not in _ANY_UNIT for word in phrase.split()
    ]
    return kept or words


def read_heading(heading: str, quantity: Quantity, names: Collection[str] | None) -> Heading:
    """Return the unit that a heading names.

    Parameters
    ----------
    heading : str
        The name of a column.
    quantity : str
        The quantity of the column.
    names : collection of str or None
        Words by which the column was found: what stands behind them must be understood. None where the user named
        the column, whose words may then mean anything.
    """
    stated, implied = _STATED[quantity], _IMPLIED.get(quantity, {})
    known = {**implied, **stated}
    units, unknown, has_name = [], [], False
    for bracket in (next(filter(None, found), "") for found in BRACKETS.findall(heading)):
        content = " ".join(plain(bracket).replace("_", " ").split()).removeprefix("in ")
        if content in known or content.strip(".") in known:
            units.append(known.get(content) or known[content.strip(".")])
        elif content and not all(word in NO_UNIT or word in (names or ()) for word in content.split()):
            unknown.append(bracket.strip())
    by_name = []
    for phrase, found in _split(tokens(heading), {*known, *_ANY_UNIT}):
        if phrase in stated and phrase != "-":
            units.append(stated[phrase])
        elif phrase in implied:
            by_name.append(implied[phrase])
        elif found or (has_name and phrase not in NO_UNIT and names is not None and phrase not in names):
            unknown.append(phrase)
        has_name = has_name or (names is not None and phrase in names)
    if re.search(r"[][(){}]", BRACKETS.sub("", heading)):
        unknown.append("a bracket that is not closed")
    return _judged(heading, quantity, list(dict.fromkeys(units or by_name)), unknown)


def _judged(heading: str, quantity: Quantity, units: Sequence[str], unknown: Sequence[str]) -> Heading:
    if {"deg", "deg_arc"} == set(units):  # degrees, by the arc
        units = ["deg_arc"]
    unit = units[0] if len(units) == 1 else None
    if unknown:
        return Heading(unit, f"{heading!r} contains {', '.join(map(repr, unknown))}, which is not understood")
    if len(units) > 1:
        return Heading(None, f"{heading!r} names {len(units)} units, {' and '.join(map(unit_words, units))}")
    words = name_tokens(heading)
    is_curvature = quantity == "curves" and any(word in CURVATURES for word in words) and "radius" not in words
    if is_curvature and unit not in {"deg", "deg_arc", "1/m", "1/km", "1/ft"}:
        return Heading(unit, f"{heading!r} is no radius, and does not name the unit of its curvatures")
    return Heading(unit)


def _split(words: Sequence[str], phrases: Collection[str]) -> Iterator[tuple[str, bool]]:
    """Yield the phrases of some words, the longest first, and other words one by one; each is marked as one."""
    index = 0
    while index < len(words):
        for count in range(min(LONGEST_PHRASE, len(words) - index), 0, -1):
            phrase = " ".join(words[index : index + count])
            if phrase in phrases:
                yield phrase, True
                break
        else:
            count = 1
            yield words[index], False
        index += count


def stated_unit(word: str, quantity: Quantity) -> str | None:
    """Look up the unit of a quantity by any of its spellings."""
    return _STATED[quantity].get(plain(word).strip(" ()[]."))


def without_unit(text: str, quantity: Quantity) -> tuple[str, str | None]:
    """Split the text of a cell into its number and its unit, if it has a known one."""
    found = NUMBER_AND_UNIT.fullmatch(text)
    unit = stated_unit(found[2], quantity) if found and found[2] != "-" else None
    return (text, None) if found is None or unit is None else (found[1].strip(), unit)
