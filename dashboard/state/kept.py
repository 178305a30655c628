"""Persisted fields of a model, and the one check of every value that comes from outside."""

import difflib
import math
from collections.abc import Callable, Iterable, Mapping
from typing import Any, ClassVar, Self

import param

from railjoule.core.scenario._base import without_misleading
from railjoule.dashboard.limits import LONGEST_TEXT, MOST_ITEMS

# beyond 2**53 the numbers of a browser, which are floats, skip whole numbers
LARGEST_INTEGER = 2**53
"""Bound of whole numbers without bounds of their own."""
# characters of a stranger's value in a sentence, and choices that a sentence lists
LONGEST_SHOWN, MAX_LISTED = 40, 8


class Kept(param.Parameterized):
    """Parameters of which some are kept: in the address, over a reload, by undo and redo.

    Every parameter that is set by hand is named in `kept` or in `passing`; a page that names its fields in `kept`
    needs nothing else.
    """

    kept: ClassVar[tuple[str, ...]] = ()
    passing: ClassVar[tuple[str, ...]] = ()
    """Fields that a user sets, but that are temporary or follow from the others."""
    address_prefix: str | None = None
    """Prefix of its fields in the page's address; None if it is no part of a page."""

    originals = param.Dict(default={}, doc="Values of the shipped scenario, by field.")

    def keep(self) -> dict[str, Any]:
        """Return the kept values by field: numbers, texts, lists and mappings only."""
        return {field: plain(getattr(self, field)) for field in self.kept}

    def lay(self, values: Mapping[str, Any]) -> None:
        """Take over checked values by field, all in one change.

        Raises
        ------
        RailjouleError
            If the values are impossible together.
        """
        # only what differs is set: models in lists would be made again, and their fields on the page with them
        now = self.keep()
        new = {field: value for field, value in values.items() if field not in now or now[field] != value}
        self.param.update(**{field: self._made(field, value) for field, value in new.items()})

    def field_bounds(self, field: str) -> tuple[float | None, float | None]:
        """Return the least and the largest number that a field takes; `open_end` is whether it takes these."""
        return getattr(self.param[field], "bounds", None) or (None, None)

    def closed_ends(self, field: str) -> tuple[bool, bool]:
        """Return whether a field takes its least and its largest number themselves."""
        return getattr(self.param[field], "inclusive_bounds", None) or (True, True)

    def open_end(self, field: str, number: float) -> str:
        """Return, as 'above 0', which end of a field a number is where the field takes all but that; else nothing."""
        (low, high), closed = self.field_bounds(field), self.closed_ends(field)
        if number == low and not closed[0]:
            return f"above {low:g}"
        return f"below {high:g}" if number == high and not closed[1] else ""

    def checked(self, field: str, value: Any) -> Any:
        """Return a value that may stand in a field, as it is kept.

        Raises
        ------
        ValueError
            With the end of a sentence that begins with field and value, and names what is missed.
        """
        parameter = self.param[field]
        if value is None:
            if parameter.allow_None:
                return None
            raise ValueError("must have a value")
        if isinstance(parameter, param.Number):
            number = _number(value, self.field_bounds(field), isinstance(parameter, param.Integer))
            if end := self.open_end(field, number):
                raise ValueError(f"must be {end}")
            return number
        # before Selector, of which it is a kind
        if isinstance(parameter, param.ListSelector):
            return [_choice(one, parameter.objects) for one in _list(value)]
        if isinstance(parameter, param.Selector):
            return _choice(value, parameter.objects)
        if isinstance(parameter, param.List):
            return [_item(one, parameter.item_type) for one in _list(value)]
        kinds = {param.Boolean: (bool, "true or false"), param.Dict: (dict, "a table"), param.String: (str, "a text")}
        for kind, (wanted, words) in kinds.items():
            if isinstance(parameter, kind):
                if not isinstance(value, wanted):
                    raise ValueError(f"must be {words}")
                if isinstance(value, str) and len(value) > LONGEST_TEXT:
                    raise ValueError(f"must have at most {LONGEST_TEXT:,} characters")
                return value
        raise ValueError("cannot be kept")

    def _made(self, field: str, value: Any) -> Any:
        """Return the value that the field holds for one that was kept."""
        kind: Any = self.param[field].item_type if isinstance(self.param[field], param.List) else None
        return [kind.revived(item) for item in value] if is_kept(kind) else value

    @classmethod
    def revived(cls, values: Mapping[str, Any]) -> Self:
        """Return a model that holds kept values."""
        return cls(**values)


def is_kept(kind: Any) -> bool:
    """Return whether a type is that of models which can be kept."""
    return isinstance(kind, type) and issubclass(kind, Kept)


def plain(value: Any) -> Any:
    """Return a value as it is kept: of models their fields."""
    if isinstance(value, Kept):
        return value.keep()
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    return value


def short(value: Any) -> str:
    """Return a short text of any value."""
    if isinstance(value, int) and abs(value) > LARGEST_INTEGER:
        return "a very large number"  # Python may refuse to write it down
    if value is None:
        return "none"
    if isinstance(value, (list, tuple)):
        return "a list"
    if not isinstance(value, (bool, int, float, str)):
        return "a table"
    text = f"{value:g}" if isinstance(value, float) else without_misleading(str(value))
    return text if len(text) <= LONGEST_SHOWN else text[: LONGEST_SHOWN - 3] + "..."


def _number(value: Any, bounds: tuple[float | None, float | None], whole: bool) -> float:
    # to Python, True is a number
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise ValueError("must be a number")
    # only of floats: a whole number beyond the largest float would raise OverflowError
    if isinstance(value, float) and not math.isfinite(value):
        raise ValueError("must be a finite number")
    if whole and value != int(value):
        raise ValueError("must be a whole number")
    low, high = bounds
    if low is not None and value < low:
        raise ValueError(f"must be at least {low:g}")
    if high is not None and value > high:
        raise ValueError(f"must be at most {high:g}")
    if abs(value) > LARGEST_INTEGER:
        raise ValueError(f"must be at most {LARGEST_INTEGER:g}")
    return int(value) if whole else value


def _choice(value: Any, objects: Any) -> Any:
    # by type too, as True equals 1 in Python
    found = [one for one in objects if type(one) is type(value) and one == value]
    if not found:
        raise ValueError(_choices_words(value, list(map(str, objects))))
    return found[0]


def _choices_words(value: Any, names: list[str]) -> str:
    """Return the end of a sentence about an unknown choice: it lists a few choices, and of many the most similar."""
    if len(names) <= MAX_LISTED:
        return f"must be one of {', '.join(names)}"
    # cut first, as a text of a link may have megabytes, which are compared letter by letter
    close = difflib.get_close_matches(str(value)[:LONGEST_SHOWN], names, n=1)
    return f"is not one of the {len(names)} known{f'; did you mean {close[0]}?' if close else ''}"


def _list(value: Any) -> list[Any]:
    if not isinstance(value, list):
        raise ValueError("must be a list")
    if len(value) > MOST_ITEMS:
        raise ValueError(f"must have at most {MOST_ITEMS} entries")
    return value


def _item(value: Any, kind: Any) -> Any:
    """Return a checked entry of a list: a table of fields where the entries are models."""
    if not is_kept(kind):
        if isinstance(value, bool) or not isinstance(value, kind or (int, float, str)):
            raise ValueError("has an entry of a wrong kind")
        return _number(value, (None, None), False) if isinstance(value, (int, float)) else value
    if not isinstance(value, dict):
        raise ValueError("must be a list of tables")
    template = kind()
    for field in value:
        if field not in kind.kept:
            raise ValueError(f"has an entry with the unknown key {short(field)}")
    checked = {}
    for field in (field for field in kind.kept if field in value):
        one = value[field]
        try:
            checked[field] = template.checked(field, one)
        except ValueError as refusal:
            raise ValueError(f"has {field} = {short(one)}, which {refusal}") from None
        # the bounds of numbers may depend on choices, which stand before them
        if isinstance(template.param[field], param.Selector):
            setattr(template, field, checked[field])
    return checked


def result(kind: type | tuple[type, ...], doc: str) -> Any:
    """Return a parameter that holds a result once there is one."""
    return param.ClassSelector(class_=kind, default=None, allow_None=True, doc=doc)


class Items:
    """Listens to the models that a list holds, to each of them once.

    Parameters
    ----------
    act : callable
        Called with each change.
    """

    def __init__(self, act: Callable[..., object]) -> None:
        self._act = act
        self._known: list[param.Parameterized] = []

    def follow(self, items: Iterable[param.Parameterized], names: Callable[[Any], Iterable[str]]) -> None:
        """Listen to those that are new, and only to the named parameters of each."""
        # who has gone is not unwatched: a watcher is stored with its model, and goes with it
        self._known, before = list(items), self._known
        for item in self._known:
            if not any(item is known for known in before):
                item.param.watch(self._act, list(names(item)))
