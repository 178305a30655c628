"""The fields of a scenario as its models declare them: label, unit, bounds, help, and how a text becomes a value.

The editor and the report both have them from here, so that a field has one name, and what it means, in both.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from types import NoneType
from typing import Any, Literal, NamedTuple, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from railjoule.core.scenario import Scenario
from railjoule.core.scenario.text_file import MAP_COLUMNS
from railjoule.core.strategy import STRATEGIES
from railjoule.dashboard.look.key_names import split_unit, words_of
from railjoule.dashboard.look.words import MINUS, THIN_SPACE
from railjoule.dashboard.state.numbers import clock, parse_number, parse_time

Kind = Literal["number", "whole", "yes_no", "choice", "text", "numbers"]

SMALL_UNIT = re.compile(r" \[[^\[\]]+\]")
"""The unit in a description: the label says it already."""
POINT_COLUMNS: Mapping[str, tuple[str, ...]] = {
    "curve": ("speed_kmh", "effort_kn"),
    "permitted_deceleration": ("speed_kmh", "deceleration_ms2"),
    "points": MAP_COLUMNS,
}
"""Names for the columns of lists whose rows are plain lists of numbers."""
KINDS: Mapping[Any, Kind] = {float: "number", int: "whole", bool: "yes_no", str: "text"}
BOUNDS = {"ge": "least", "le": "most", "gt": "above", "lt": "below", "max_length": "longest"}
"""Pydantic's names of bounds, and ours."""
# the first of both is what a field shows
YES = ("yes", "true", "1")
NO = ("no", "false", "0")
# not commas, which may stand before decimals
SEPARATORS = re.compile(r"[;\s]+")
LONG_S = 3600.0
"""A time that may be so long is read as on a clock, too."""
TABLE_KEYS = ("preset", "model")
"""Keys of tables that are chosen, not typed."""


@dataclass(frozen=True)
class Field:
    """One key of a scenario's file.

    Parameters
    ----------
    key : str
        Dotted path in the file; in a table's row the key alone.
    kind : str
        What its values are.
    help : str
        Its meaning.
    optional : bool
        Whether it may be left out.
    least, most : float or None
        Bounds of its numbers.
    above, below : float or None
        Bounds that its numbers do not reach.
    choices : tuple of str
        Of a choice.
    count : tuple of int and int or None
        How many numbers a list of them may have.
    longest : int or None
        Characters that a text may have.
    """

    key: str
    kind: Kind
    help: str = ""
    optional: bool = False
    least: float | None = None
    most: float | None = None
    above: float | None = None
    below: float | None = None
    choices: tuple[str, ...] = ()
    count: tuple[int, int | None] | None = None
    longest: int | None = None

    @property
    def name(self) -> str:
        """The last part of the key."""
        return self.key.rpartition(".")[2]

    @property
    def unit(self) -> str:
        """The unit of its numbers, empty where they have none."""
        return split_unit(self.name)[1] if self.kind in {"number", "whole", "numbers"} else ""

    @property
    def label(self) -> str:
        """Quantity and unit in words."""
        return f"{self.quantity}, {self.unit}" if self.unit else self.quantity

    @property
    def quantity(self) -> str:
        """What it is called, without its unit."""
        return words_of(split_unit(self.name)[0] if self.unit else self.name)

    @property
    def bounds_words(self) -> str:
        """The bounds of its numbers or texts, as a clause; empty where it has none."""
        parts = [
            word.format(f"{value:,.10g}".replace(",", THIN_SPACE).replace("-", MINUS))
            for word, value in (
                ("at least {}", self.least),
                ("above {}", self.above),
                ("at most {}", self.most),
                ("below {}", self.below),
                ("at most {} characters", self.longest),
            )
            if value is not None
        ]
        text = " and ".join(parts)
        if self._may_be_long and self.most is not None:
            text += f" ({clock(self.most)})"
        if self.kind == "whole":
            text = f"a whole number, {text}" if text else "a whole number"
        return text

    @property
    def meaning(self) -> str:
        """What it means, in a sentence without its unit."""
        return SMALL_UNIT.sub("", self.help)

    @property
    def help_words(self) -> str:
        """Meaning and bounds in sentences."""
        bounds = self.bounds_words
        several = " Numbers separated by spaces." if self.kind == "numbers" else ""
        empty = " Can be left empty." if self.optional else ""
        forms = " Also as 2:30 or 2 min 30 s." if self._may_be_long else ""
        return f"{self.meaning}{several}{f' {bounds[:1].upper()}{bounds[1:]}.' if bounds else ''}{forms}{empty}".strip()

    @property
    def _may_be_long(self) -> bool:
        return self.unit == "s" and (self.most is None or self.most >= LONG_S)

    def parse(self, text: str) -> Any:
        """Return the value that a text gives; None for nothing where that is allowed.

        Raises
        ------
        ValueError
            With a sentence that names the bound that it misses.
        """
        text = text.strip()
        if not text and self.optional:
            return None
        if self.kind == "text":
            if self.longest is not None and len(text) > self.longest:
                raise ValueError(f"At most {self.longest} characters.")
            return text
        if self.kind == "choice":
            if text not in self.choices:
                raise ValueError(f"One of {', '.join(self.choices)}.")
            return text
        if self.kind == "yes_no":
            if text.lower() not in (*YES, *NO):
                raise ValueError("Yes or no.")
            return text.lower() in YES
        if self.kind == "numbers":
            return self._parse_numbers(text)
        return self._parse_number(text)

    def _parse_number(self, text: str) -> float:
        bounds = self.least, self.most
        if self.unit == "s":
            # the cell of a table is named by its row and column
            number = parse_time(text, bounds, self.quantity if "." in self.key else "")
        else:
            number = parse_number(text, bounds)
        if self.above is not None and number <= self.above:
            raise ValueError(f"Above {self.above:g}.")
        if self.below is not None and number >= self.below:
            raise ValueError(f"Below {self.below:g}.")
        if self.kind != "whole":
            return number
        if number != int(number):
            raise ValueError("A whole number.")
        return int(number)

    def _parse_numbers(self, text: str) -> list[float]:
        numbers = [self._parse_number(part) for part in SEPARATORS.split(text) if part]
        fewest, most = self.count or (0, None)
        if len(numbers) < fewest or (most is not None and len(numbers) > most):
            how_many = f"{fewest}" if fewest == most else f"{fewest} to {most}"
            raise ValueError(f"{how_many} numbers.")
        return numbers

    def show(self, value: Any) -> str:
        """Return the text that gives a value again."""
        if value is None:
            return ""
        if self.kind == "yes_no":
            return YES[0] if value else NO[0]
        if self.kind == "numbers":
            return " ".join(plain(number) for number in value)
        return plain(value) if isinstance(value, int | float) else str(value)


@dataclass(frozen=True)
class Table:
    """A list of a scenario's file whose entries have columns.

    Parameters
    ----------
    key : str
        Dotted path in the file.
    columns : tuple of Field
        What an entry has.
    of_lists : bool
        Whether an entry is a plain list of numbers.
    help : str
        Its meaning.
    optional : bool
        Whether it may be left out, rather than be empty.
    fewest, most : int
        How many entries it may have.
    """

    key: str
    columns: tuple[Field, ...]
    of_lists: bool
    help: str
    optional: bool
    fewest: int
    most: int

    @property
    def label(self) -> str:
        """What it holds, in words."""
        return words_of(self.key)


def plain(number: float) -> str:
    """Return a number as it stands in a file, without more digits than it needs."""
    # a float holds 15 digits at least: what arithmetic has left in the last ones is not shown
    return f"{number:.12g}"


def parts_of(table: str, model: str = "") -> Sequence[Field | Table]:
    """Return the fields and lists of a table of the scenario, without the tables in it.

    Parameters
    ----------
    table : str
        Its dotted path, such as 'vehicle.traction', empty for the scenario itself.
    model : str
        The kind of the drive, where the path leads there.
    """
    return describe(_model_at(table, model), f"{table}." if table else "")


@cache
def tables_in(table: str, model: str = "") -> tuple[str, ...]:
    """Return the paths of the tables in a table, such as 'vehicle.traction' in 'vehicle'."""
    fields = _model_at(table, model).model_fields
    return tuple(f"{table}.{name}" for name, info in fields.items() if _is_model(_declared(info).plain))


def models_of(table: str) -> tuple[str, ...]:
    """Return the kinds of a table of many kinds, such as those of the drive."""
    return tuple(_kinds(_at(table, "")))


@cache
def describe(model: type[BaseModel], prefix: str = "") -> tuple[Field | Table, ...]:
    """Return the fields and lists that a model declares, without the models in it.

    Parameters
    ----------
    model : type
        One table of a scenario, such as `railjoule.core.scenario.Vehicle`.
    prefix : str
        What comes before the names of its fields in their keys.
    """
    parts = (_part(prefix + name, info) for name, info in model.model_fields.items() if name not in TABLE_KEYS)
    return tuple(part for part in parts if part is not None)


class _Declared(NamedTuple):
    """What an annotation says: the type without None, whether it may be None, and its bounds by pydantic's names."""

    plain: Any
    optional: bool
    limits: Mapping[str, Any]

    @property
    def bounds(self) -> dict[str, Any]:
        """Bounds of numbers and the length of a text, as `Field` has them."""
        return {ours: self.limits.get(theirs) for theirs, ours in BOUNDS.items()}


def _declared(info: FieldInfo) -> _Declared:
    kind, limits = info.annotation, _limits(info)
    if NoneType not in get_args(kind):
        return _Declared(kind, False, limits)
    # bounds may stand within the union with None or beside it; those beside it are said of this field alone
    inner = FieldInfo.from_annotation(next(each for each in get_args(kind) if each is not NoneType))
    return _Declared(inner.annotation, True, _limits(inner) | limits)


def _limits(info: FieldInfo) -> dict[str, Any]:
    names = (*BOUNDS, "min_length")
    return {name: getattr(each, name) for each in info.metadata for name in names if hasattr(each, name)}


def _is_model(kind: Any) -> bool:
    return isinstance(kind, type) and issubclass(kind, BaseModel)


def _kinds(union: Any) -> dict[str, type[BaseModel]]:
    """Return the models of a table of many kinds by what its key `model` says."""
    return {get_args(member.model_fields["model"].annotation)[0]: member for member in get_args(union)}


def _at(table: str, model: str) -> Any:
    """Return the type at a path; where it meets a table of many kinds, that of the kind `model`."""
    path = "vehicle.drive" + table.removeprefix("drive") if table.split(".", maxsplit=1)[0] == "drive" else table
    kind: Any = Scenario
    for name in path.split(".") if path else ():
        kind = _declared(kind.model_fields[name]).plain
        if model and not _is_model(kind):
            kind = _kinds(kind)[model]
    return kind


def _model_at(table: str, model: str) -> type[BaseModel]:
    found: type[BaseModel] = _at(table, model)
    return found


def _part(key: str, info: FieldInfo) -> Field | Table | None:
    """Return what a field declares; None for a table or what cannot be edited as text."""
    declared = _declared(info)
    about = info.description or ""
    if key == "strategy":
        return Field(kind="choice", key=key, help=about, choices=tuple(STRATEGIES))
    if get_origin(declared.plain) is tuple:
        return _list(key, declared, about)
    return _field(key, declared, about)


def _field(key: str, declared: _Declared, about: str = "") -> Field | None:
    common: dict[str, Any] = {"key": key, "help": about, "optional": declared.optional}
    if get_origin(declared.plain) is Literal:
        return Field(kind="choice", choices=get_args(declared.plain), **common)
    kind = KINDS.get(declared.plain)
    return None if kind is None else Field(kind=kind, **common, **declared.bounds)


def _list(key: str, declared: _Declared, about: str) -> Field | Table | None:
    """Return a list of numbers as a field, one of models or of plain lists as a table."""
    entries = [_declared(FieldInfo.from_annotation(each)) for each in get_args(declared.plain) if each is not Ellipsis]
    first, same = entries[0], Ellipsis in get_args(declared.plain)
    fewest, most = declared.limits.get("min_length", 0), declared.limits.get("max_length")
    if same and (_is_model(first.plain) or get_origin(first.plain) is tuple):
        return Table(
            key=key,
            columns=_columns(key, first.plain),
            of_lists=not _is_model(first.plain),
            help=about,
            optional=declared.optional,
            fewest=fewest,
            # as many rows as core/budget.py lets any list have
            most=100_000 if most is None else most,
        )
    count = (fewest, most) if same else (len(entries), len(entries))
    # nothing is a list of none where a list may not be left out
    optional = declared.optional or count[0] == 0
    return Field(key=key, kind="numbers", help=about, optional=optional, count=count, **first.bounds)


def _columns(key: str, entry: Any) -> tuple[Field, ...]:
    """Return the columns of a list's entries: the fields of a model, or the numbers of a plain list."""
    if _is_model(entry):
        return tuple(part for part in describe(entry) if isinstance(part, Field))
    named = zip(POINT_COLUMNS[key.rpartition(".")[2]], get_args(entry), strict=True)
    return tuple(field for name, each in named if (field := _field(name, _declared(FieldInfo.from_annotation(each)))))
