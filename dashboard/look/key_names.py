"""The names of a scenario's keys on the pages: a sentence about a file names keys, one on a page names fields."""

import re
from functools import cache
from typing import Any, get_args

from pydantic import BaseModel

from railjoule.core.scenario import Scenario

NAMES = {
    "capacity_passengers": "passenger capacity",
    "model": "kind",
    "coordinate_error": "position error",  # the papers' word in the file's key, the pages' in all that is read
    "no_load_loss": "no-load loss",
    "limits_hold_for": "speed limits hold for",
    "gradient_at": "gradient acts on",
    "max_load": "freight capacity",
    "starting": "starting resistance",
    "starting_ends_at": "starting resistance ends at",
    "stop_deceleration": "braking rate",
}
"""Names of fields whose keys do not read well."""
UNITS = {
    "_m_n_per_kn": "N m/kN",
    "_n_per_kn_per_kmh2": "N/kN/(km/h)\u00b2",
    "_n_per_kn_per_kmh": "N/kN/(km/h)",
    "_n_per_kn": "N/kN",
    "_n_per_kmh2": "N/(km/h)\u00b2",
    "_n_per_kmh": "N/(km/h)",
    "_n": "N",
    "_w_per_rads3": "W/(rad/s)\u00b3",
    "_w_per_rads2": "W/(rad/s)\u00b2",
    "_w_per_rads": "W/(rad/s)",
    "_w_per_nm2": "W/(N m)\u00b2",
    "_w_per_nm": "W/(N m)",
    "_per_amp_nm": "N m/A",
    "_min_per_100km": "min/100 km",
    "_permille": "\u2030",
    "_percent": "%",
    "_rads": "rad/s",
    "_kmh": "km/h",
    "_ms2": "m/s\u00b2",
    "_ms3": "m/s\u00b3",
    "_ohm": "ohm",
    "_kwh": "kWh",
    "_kg": "kg",
    "_kn": "kN",
    "_kw": "kW",
    "_hz": "Hz",
    "_mh": "mH",
    "_mm": "mm",
    "_nm": "N m",
    "_vs": "V s",
    "_km": "km",
    "_m2": "m\u00b2",
    "_m": "m",
    "_t": "t",
    "_s": "s",
    "_w": "W",
    "_a": "A",
    "_v": "V",
    "_j": "J",
}
"""Ends of keys with the units that they name; the longest stand before those that they end with."""
KEY = re.compile(r"(?<![\w.\-/])([a-z]+(?:\.[a-z_0-9]+)+)(\[\d+\])?(?: = (-?[\d.,e+]*\d))?")
"""A dotted key with its place in a list and its number, where there are any."""
IN_BRACKETS = re.compile(r" \(([a-z]+(?:\.[a-z_0-9]+)+)\)")
"""A key that follows its words."""


def words_of(key: str) -> str:
    """Return the name of the last part of a key, without unit."""
    name = key.rpartition(".")[2]
    words = NAMES.get(name, name.replace("_", " "))
    return words[:1].upper() + words[1:]


def split_unit(name: str) -> tuple[str, str]:
    """Return a key's words and the unit that it ends with; no unit where it names none."""
    for end, unit in UNITS.items():
        if name.endswith(end):
            return name.removesuffix(end), unit
    return name, ""


def without_keys(sentence: str) -> str:
    """Return a sentence with the name of the field in the place of each key of a scenario's file.

    Parameters
    ----------
    sentence : str
        Such as 'disturbance.coordinate_error_m = 500 must be less than ...', which becomes 'Position error = 500 m
        must be less than ...'.
    """
    plain = IN_BRACKETS.sub(lambda found: "" if _is_key(found[1]) else found[0], sentence)
    return KEY.sub(_named, plain)


def _named(found: re.Match[str]) -> str:
    key, place, number = found.groups()
    if not _is_key(key):
        return found[0]
    name, unit = split_unit(key.rpartition(".")[2])
    words = words_of(name)
    if found.start():
        words = words[0].lower() + words[1:]
    value = "" if number is None else f" = {number}{f' {unit}' if unit else ''}"
    return f"{words}{place or ''}{value}"


def _is_key(text: str) -> bool:
    """Return whether a dotted text is a key: files have names such as line.csv."""
    table, *_, name = text.split(".")
    return (table == "drive" or table in Scenario.model_fields) and name in _names()


@cache
def _names() -> frozenset[str]:
    """Return the names of all keys in all tables."""
    names: set[str] = set()
    pending: list[Any] = [Scenario]
    seen = set[Any]()
    while pending:
        kind = pending.pop()
        if kind in seen:
            continue
        seen.add(kind)
        if isinstance(kind, type) and issubclass(kind, BaseModel):
            names.update(kind.model_fields)
            pending += [info.annotation for info in kind.model_fields.values()]
        else:
            pending += get_args(kind)
    return frozenset(names)
