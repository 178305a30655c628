"""Types of the values of options: one for each kind of number, time, pair and file, for all commands.

A type returns the value of a word, or raises ValueError with a text such as "must be a number", which the parser puts
behind option and word. The core is imported only when it is needed, so that `--help` is fast.
"""

import datetime
from collections.abc import Callable, Iterable
from contextlib import suppress
from pathlib import Path
from typing import Any, TypeVar

from railjoule.dashboard.look.typed import parse_number, parse_time
from railjoule.dashboard.server.options import PREFIX, origin_parts

Value = TypeVar("Value")
LONGEST_TIME_S = 86_400.0
"""The longest time of a scenario, as the core bounds it, and of a proof."""
OTHER_NAMES = {"brake_pressure": "brake"}
"""Quantities of a recorder by the names that they had."""
ANY = (None, None)
VEHICLE = "vehicle.preset="
"""Names a shipped vehicle; without FILE its own scenario is solved."""


class UsageError(Exception):
    """Arguments that make no command, in one sentence."""


def printable(text: str) -> str:
    """Return a text of one line without control characters, which a terminal would obey."""
    return "".join(character if character.isprintable() else " " for character in text)


def shortened(text: object) -> str:
    """Return a text of at most 80 characters."""
    full = str(text)
    return full if len(full) <= 80 else full[:77] + "..."


def must_be(requirement: str, read: Callable[[str], Value]) -> Callable[[str], Value]:
    """Return a type that reads words by `read`, and raises the same requirement for every other word."""

    def value(text: str) -> Value:
        try:
            return read(text)
        except ValueError:
            raise ValueError(f"must be {requirement}") from None

    return value


def _parts(text: str) -> tuple[str, str]:
    key, _, value = (part.strip() for part in text.partition("="))
    if not (key and value):
        raise ValueError
    return key, value


def _share(text: str) -> float:
    plain = text.removesuffix("%")
    return parse_number(plain, ANY) / (1 if plain == text else 100)


def _sheet_value(text: str) -> tuple[str, Any]:
    key, word = _parts(text)
    return key, toml_value(word)


def _range(text: str) -> tuple[str, tuple[float, float]]:
    field, ends = _parts(text)
    low, _, high = ends.partition(":")
    return field, (number(low), number(high))


number = must_be("a number", lambda text: parse_number(text, ANY))
"""A number, with a decimal point or a decimal comma."""
share = must_be("a share, as 0.9 or 90 %", _share)
seconds = must_be(
    f"a time from 0 to {LONGEST_TIME_S:g} s, as 150 or 2:30", lambda text: parse_time(text, (0.0, LONGEST_TIME_S))
)
sheet_value = must_be("KEY=VALUE, such as mass_t=120", _sheet_value)
field_range = must_be("FIELD=LOW:HIGH, such as vehicle.load_factor=0:1", _range)


def whole(least: int, most: int | None = None) -> Callable[[str], int]:
    """Return the type of whole numbers within bounds."""
    bounds = f"of at least {least}" if most is None else f"from {least} to {most}"

    def read(text: str) -> int:
        value = int(text)
        if value < least or (most is not None and value > most):
            raise ValueError
        return value

    return must_be(f"a whole number {bounds}", read)


def pair(example: str, value: Callable[[str], Any] = str) -> Callable[[str], tuple[str, Any]]:
    """Return the type of words such as 'speed=km/h'."""
    split = must_be(f"QUANTITY=VALUE, such as {example}", _parts)

    def read(text: str) -> tuple[str, Any]:
        key, word = split(text)
        return OTHER_NAMES.get(key, key), value(word)

    return read


def of_table(text: str) -> tuple[Any, str, str]:
    """Return the kind of a table of a line, a key and a value, of a word such as gradients.from=PKD."""
    from railjoule.core.imports import TABLE_KINDS  # noqa: PLC0415

    path, equals, value = text.partition("=")
    kind, dot, key = path.partition(".")
    if kind not in TABLE_KINDS or not (equals and dot and key):
        raise ValueError(f"must be TABLE.KEY=VALUE, where TABLE is {', '.join(TABLE_KINDS)}")
    return kind, key, value


def chainage(text: str) -> float:
    """Return a chainage [m], as '12345', '12+345', '12.345km' or '7mi 40ch'."""
    from railjoule.core.imports.numbers import parse_position  # noqa: PLC0415

    return parse_position(text, "m", ".")


def file(*suffixes: str) -> Callable[[str], Path]:
    """Return the type of files whose names end in one of these suffixes."""
    *most, last = suffixes
    endings = f"{', '.join(most)} or {last}" if most else last

    def read(text: str) -> Path:
        if Path(text).suffix.lower() not in suffixes:
            raise ValueError(f"must end in {endings}")
        if text.lower().endswith(".parquet"):
            from railjoule.core.parquet import NEEDED, has_parquet  # noqa: PLC0415

            if not has_parquet():
                raise ValueError(NEEDED.rstrip("."))
        return Path(text)

    return read


def origin(text: str) -> str:
    """Return a name under which browsers reach a server."""
    origin_parts(text)
    return text


def prefix(text: str) -> str:
    """Return the path below which a server answers; empty for all of it."""
    path = text.rstrip("/")
    if path and not PREFIX.fullmatch(path):
        raise ValueError("must be a path such as /tools/railjoule")
    return path


def changes(words: Iterable[str]) -> dict[str, Any]:
    """Return the changes of a scenario that words KEY=VALUE ask for.

    Raises
    ------
    UsageError
        If a word has no key or no equals sign.
    """
    changed = {}
    for word in words:
        key, equals, value = word.partition("=")
        if not key.strip() or not equals:
            raise UsageError(f"--set {shortened(word)}: must be KEY=VALUE, such as vehicle.load_factor=0.3.")
        changed[key.strip()] = toml_value(value, key.strip().endswith("_s"))
    return changed


def toml_value(text: str, is_time: bool = False) -> Any:
    """Return the value that a text gives: TOML, else a number or a time as people type it, else the text itself."""
    from railjoule.core.errors import ScenarioError  # noqa: PLC0415
    from railjoule.core.scenario.text_file import read_toml  # noqa: PLC0415

    document = {}
    with suppress(ScenarioError):
        document = read_toml(f"value = {text}", "--set")
    # a text with line breaks could name more keys
    value = document["value"] if list(document) == ["value"] else text
    # 0,3 and 2:30 are no TOML, and 02:30:00 is a time of day in it
    if value is text or isinstance(value, datetime.time):
        with suppress(ValueError):
            if is_time or "," in text:
                return parse_time(text, ANY) if is_time else number(text)
    return value
