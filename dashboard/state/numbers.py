"""Numbers as people type them."""

import math
import re
from typing import TYPE_CHECKING, Any, ClassVar

import param
from pydantic import BaseModel

from railjoule.dashboard.state.kept import Kept

# hours count only before two digits of minutes, so that 1:2:30 is no time
CLOCK = re.compile(r"(?:(?P<h>\d+):(?=\d\d:))?(?P<min>\d+):(?P<s>\d\d(?:\.\d+)?)")
# a digit is asked for ahead, as each part may be missing: without it, an empty text would be a time
WORDED = re.compile(
    r"(?=.*\d)(?:(?P<h>\d+(?:\.\d+)?)\s*h(?:ours?)?\s*)?(?:(?P<min>\d+(?:\.\d+)?)\s*(?:min(?:utes?)?|m)\s*)?"
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
        What was typed.
    bounds : tuple of float or None
        The least and the greatest time [s].
    name : str
        What the time is, where nothing else in sight tells.

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
    # rounded before it is taken apart, so that 119.96 s read 2:00
    whole, rest = divmod(round(seconds, 1), 1)
    minutes, second = divmod(int(whole), SIXTY)
    hours, minute = divmod(minutes, SIXTY)
    # less than half a tenth is what binary numbers leave of a whole second
    tenths = f"{rest:.1f}".removeprefix("0") if rest >= 0.05 else ""
    return f"{hours}:{minute:02d}:{second:02d}{tenths}" if hours else f"{minute}:{second:02d}{tenths}"


def core_bounds(part: type[BaseModel], key: str, scale: float = 1.0) -> dict[str, Any]:
    """Return the bounds of a key of the scenario's file, as a `TypedNumber` takes them.

    Parameters
    ----------
    part : type
        The part of the scenario that has the key.
    key : str
    scale : float
        A number of the page over that of the file, such as 100 for a percentage.
    """
    limits = {
        name: getattr(limit, name)
        for limit in part.model_fields[key].metadata
        for name in ("ge", "gt", "le", "lt")
        if hasattr(limit, name)
    }
    low, high = limits.get("ge", limits.get("gt")), limits.get("le", limits.get("lt"))
    return {
        "bounds": (None if low is None else scale * low, None if high is None else scale * high),
        "inclusive_bounds": ("gt" not in limits, "lt" not in limits),
    }


class TypedNumber(param.Number):
    """A parameter that has a field on a page: all that is said of it stands here, once.

    Parameters
    ----------
    label : str
        Beside the field: quantity and unit.
    unit : str
        In sentences; empty where the number has none.
    digits : int
        Decimals in the field, where nobody has typed more.
    **params
        As for any number. With a `step` the field has a slider, from one of the `softbounds` to the other; what is
        beyond them can be typed, as far as the `bounds` go.
    """

    # param's parameters keep values in slots alone
    __slots__ = ("digits", "unit")

    def __init__(self, label: str, unit: str = "", digits: int = 0, **params: Any) -> None:
        super().__init__(label=label, **params)
        self.unit, self.digits = unit, digits

    # without these, mypy would take the numbers of a model for TypedNumbers
    if TYPE_CHECKING:

        def __get__(self, instance: object, owner: type | None = None) -> Any: ...

        def __set__(self, instance: object, value: float | None) -> None: ...


class TypedInteger(TypedNumber, param.Integer):
    """A whole number that has a field on a page."""


def keyed(
    part: type[BaseModel],
    key: str,
    label: str,
    unit: str = "",
    digits: int = 0,
    scale: float = 1.0,
    **params: Any,
) -> Any:
    """Return a parameter for a key of the scenario's file, with the bounds, the default and the words of the core.

    Parameters
    ----------
    part : type
        The part of the scenario that has the key.
    key : str
    label, unit, digits
        As for `TypedNumber`; the unit follows a label without a comma.
    scale : float
        A number of the page over that of the file, such as 100 for a percentage.
    **params
        As for any number, in place of those of the core.
    """
    field = part.model_fields[key]
    default = field.default * scale if isinstance(field.default, float) else field.default
    whole = isinstance(default, int) and not isinstance(default, bool)
    kind = TypedInteger if whole else TypedNumber
    declared = {"default": default, "doc": field.description or "", **core_bounds(part, key, scale)}
    return kind(f"{label}, {unit}" if unit and "," not in label else label, unit, digits, **{**declared, **params})


class TypedParameters(Kept):
    """Parameters whose numbers can be typed."""

    may_be_empty: ClassVar[tuple[str, ...]] = ()
    """Those whose field may be left empty: they then have no value."""

    def parse_or_none(self, field: str, text: str) -> float | None:
        """Return the number that a text gives for a field, as `parse`; None for nothing where that is allowed."""
        return None if field in self.may_be_empty and not text.strip() else self.parse(field, text)

    def parse(self, field: str, text: str) -> float:
        """Return the number that a text gives for a field.

        Raises
        ------
        ValueError
            With a sentence that names the bound that it misses; of a time also the text and its forms.
        """
        bounds = self.bounds_of(field)
        # the names of fields end in their units: times alone may be typed as on a clock
        if field.endswith("_s"):
            name = self.param[field].label.split(",")[0]
            number = parse_time(text, bounds, name[:1].upper() + name[1:])
        else:
            number = parse_number(text, bounds)
        if end := self.open_end(field, number):
            raise ValueError(f"{end.capitalize()}.")
        if not isinstance(self.param[field], param.Integer):
            return number
        if number != int(number):
            raise ValueError("A whole number.")
        return int(number)
