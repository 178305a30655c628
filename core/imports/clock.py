"""Times in tables: on a clock of 12 or 24 hours, with or without a date, or since 1970; and the midnights in a run."""

import re
from collections.abc import Mapping
from contextlib import suppress
from datetime import UTC, datetime
from types import MappingProxyType

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.imports.cells import CellTable
from railjoule.core.imports.numbers import text_of_cell
from railjoule.core.imports.units import CLOCK

S_PER_DAY = 86_400.0
EPOCH = datetime(1970, 1, 1, tzinfo=UTC)
TIME_OF_DAY = r"(\d{1,2}):(\d{2})(?::(\d{2}(?:[.,]\d{1,9})?))?(?: ?([AaPp])\.?[Mm]\.?)?"
NOON_H = 12
EPOCH_UNITS: Mapping[str, tuple[float, float]] = MappingProxyType(
    {"ms": (1e11, 1e14), "us": (1e14, 1e17), "ns": (1e17, 1e20)}
)
"""Between which numbers a time since 1970 lies in such units, from 1973 to 5138; below the first it is one in s."""
DAY_FIRST = re.compile(rf"(\d{{1,2}})[./](\d{{1,2}})[./](\d{{4}})[ T]+({TIME_OF_DAY})")
DURATION = re.compile(rf"(\d{{1,4}}) days?,? ({TIME_OF_DAY})")
"""As pandas writes a difference of times."""


def unit_of_times(cells: CellTable, header: str) -> str:
    """Recognise the unit of a column of times by its cells: a time of day or since 1970; empty for others."""
    first = next((text for _, cell in cells.column(header) if (text := text_of_cell(cell))), "")
    if ":" in first:
        return CLOCK
    with suppress(ValueError):
        return next((unit for unit, (low, high) in EPOCH_UNITS.items() if low <= float(first) < high), "")
    return ""


def parse_clock(text: str) -> float:
    """Return a time of day, or a date with one, in s; raises ValueError where it is neither."""
    if match := re.fullmatch(TIME_OF_DAY, text):
        return _seconds(*match.groups())
    if match := DURATION.fullmatch(text):
        return S_PER_DAY * int(match[1]) + parse_clock(match[2])
    if match := DAY_FIRST.fullmatch(text):
        first, second, year, _, *clock = match.groups()
        # only differences count: which of the two is the day only matters at midnight
        day, month = (first, second) if int(second) <= 12 else (second, first)
        return parse_clock(f"{year}-{month:>02}-{day:>02}") + _seconds(*clock)
    with suppress(ValueError, OverflowError):
        moment = datetime.fromisoformat(text)
        # every zone has the same differences
        return (moment.replace(tzinfo=moment.tzinfo or UTC) - EPOCH).total_seconds()
    raise ValueError("must be a time, as 10:15:30, 10:15:30 PM or 2026-01-31T10:15:30")


def _seconds(hours: str, minutes: str, seconds: str | None, half: str | None) -> float:
    hour = int(hours)
    if half:
        if not 1 <= hour <= NOON_H:
            raise ValueError("must have an hour from 1 to 12 before AM or PM")
        # 12 AM is midnight, 12 PM is noon
        hour = hour % NOON_H + (NOON_H if half.lower() == "p" else 0)
    return 3600.0 * hour + 60.0 * int(minutes) + float((seconds or "0").replace(",", "."))


def past_midnight(time_s: FloatArray) -> FloatArray:
    """Add a day wherever the times of a run fall by half a day or more; a date makes times that never do [s]."""
    falls = np.diff(time_s, prepend=time_s[:1]) < -0.5 * S_PER_DAY
    return np.asarray(time_s + S_PER_DAY * np.cumsum(falls))
