"""Parameters whose numbers people type."""

from typing import TYPE_CHECKING, Any, ClassVar

import param
from pydantic import BaseModel

from railjoule.dashboard.look.typed import parse_number, parse_time
from railjoule.dashboard.state.kept import Kept


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

    # param's parameters keep values only in slots
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
        bounds = self.field_bounds(field)
        # the names of fields end in their units: only times may be typed as on a clock
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
