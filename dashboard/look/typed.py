"""Numbers and times as people type them, in a field of a page or after an option of a command."""

import math
import re

# hours count only before two digits of minutes, so that 1:2:30 is no time
CLOCK = re.compile(r"(?:(?P<h>\d+):(?=\d\d:))?(?P<min>\d+):(?P<s>\d\d(?:\.\d+)?)")
# a digit is asked for ahead, as each part may be missing: without it, an empty text would be a time
WORDED = re.compile(
    r"(?=.*\d)(?:(?P<h>\d+(?:\.\d+)?)\s*(?:h|hours?)\s*)?(?:(?P<min>\d+(?:\.\d+)?)\s*(?:min(?:utes?)?|m)\s*)?"
    r"(?:(?P<s>\d+(?:\.\d+)?)\s*(?:s|sec|seconds?)?)?"
)
"""Times as on a clock, and with the names of their units; what ends a worded one without a name is seconds."""
SIXTY = 60
# of what was typed, in the sentence that refuses it: a whole table may have been pasted into a field
LONGEST_SHOWN = 30


def parse_number(text: str, bounds: tuple[float | None, float | None]) -> float:
    """Return the number that a text gives.

    Raises
    ------
    ValueError
        With a sentence that names the bound that it misses.
    """
    try:
        value = float(_plain(text))
    except ValueError:
        raise ValueError("Not a number.") from None
    if not math.isfinite(value):
        raise ValueError("Not a number.")
    low, high = bounds
    if low is not None and value < low:
        raise ValueError(f"At least {low:g}.")
    if high is not None and value > high:
        raise ValueError(f"At most {high:g}.")
    return value


def parse_time(text: str, bounds: tuple[float | None, float | None], name: str = "") -> float:
    """Return the time that a text gives [s]: seconds, or as 2:30, 1:02:03 or 2 min 30 s.

    Parameters
    ----------
    text : str
        The typed text.
    bounds : tuple of float or None
        The least and the greatest time [s].
    name : str
        Name of the time for the message, if nothing else shows it.

    Raises
    ------
    ValueError
        With a sentence that names the text and the forms that it may have, or the bound that it misses.
    """
    no_time = _no_time(text, name)
    plain = _plain(text).strip().lower()
    found = CLOCK.fullmatch(plain) or WORDED.fullmatch(plain)
    if found is None:
        try:
            return parse_number(plain, bounds)
        except ValueError as error:
            raise no_time if str(error) == "Not a number." else error from None
    hours, minutes, seconds = (float(found[part] or 0) for part in ("h", "min", "s"))
    on_clock = ":" in plain
    if on_clock and (seconds >= SIXTY or (found["h"] is not None and minutes >= SIXTY)):
        raise no_time
    # by way of its text, as the bounds are checked there
    return parse_number(repr(hours * SIXTY**2 + minutes * SIXTY + seconds), bounds)


def _no_time(text: str, name: str) -> ValueError:
    shown = text if len(text) <= LONGEST_SHOWN else text[: LONGEST_SHOWN - 3] + "..."
    about = f"{name}: " if name else ""
    return ValueError(f"{about}{shown!r} is not a time: write seconds, min:s or h:min:s, such as 150, 2:30 or 1:02:03.")


def _plain(text: str) -> str:
    # numbers are copied from the page, which writes thin spaces and true minus signs; many write a decimal comma
    return text.replace("\u202f", "").replace("\u2212", "-").replace(",", ".")


def clock(seconds: float) -> str:
    """Return a time [s] as on a clock: 2:30, or 1:02:03 from an hour on."""
    # rounded before it is split, so that 119.96 s read 2:00
    whole, rest = divmod(round(seconds, 1), 1)
    minutes, second = divmod(int(whole), SIXTY)
    hours, minute = divmod(minutes, SIXTY)
    # less than half a tenth is what binary numbers leave of a whole second
    tenths = f"{rest:.1f}".removeprefix("0") if rest >= 0.05 else ""
    return f"{hours}:{minute:02d}:{second:02d}{tenths}" if hours else f"{minute}:{second:02d}{tenths}"
