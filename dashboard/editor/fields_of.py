"""The fields of a scenario as its models declare them: label, unit, bounds, help, and how a text becomes a value.

The editor and the report both have them from here, so that a field has one name, and what it means, in both.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, Literal

from pydantic import BaseModel

from railjoule.core.scenario import Scenario
from railjoule.core.scenario.data_sheet import DataSheet
from railjoule.core.scenario.text_file import MAP_COLUMNS
from railjoule.core.strategy import STRATEGIES
from railjoule.dashboard.look.key_names import split_unit, words_of
from railjoule.dashboard.look.typed import clock, parse_number, parse_time
from railjoule.dashboard.look.words import MINUS, THIN_SPACE

Kind = Literal["number", "whole", "yes_no", "choice", "text", "numbers"]
Schema = Mapping[str, Any]

SMALL_UNIT = re.compile(r" \[[^\[\]]+\]")
"""The unit in a description: the label contains it already."""
POINT_COLUMNS: Mapping[str, tuple[str, ...]] = {
    "curve": ("speed_kmh", "effort_kn"),
    "permitted_deceleration": ("speed_kmh", "deceleration_ms2"),
    "points": MAP_COLUMNS,
}
"""Names for the columns of lists whose rows are plain lists of numbers."""
KINDS: Mapping[Any, Kind] = {"number": "number", "integer": "whole", "boolean": "yes_no", "string": "text"}
"""Our names of the kinds of values, by those of JSON schemas."""
BOUNDS = {
    "minimum": "least",
    "maximum": "most",
    "exclusiveMinimum": "above",
    "exclusiveMaximum": "below",
    "maxLength": "longest",
}
"""Our names of bounds, by those of JSON schemas."""
NULL: Mapping[str, str] = {"type": "null"}
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
        Dotted path in the file; in a table's row only the key.
    kind : str
        Kind of its values.
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
        """Name without unit."""
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
        """Meaning in a sentence without unit."""
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
        match self.kind:
            case "text":
                if self.longest is not None and len(text) > self.longest:
                    raise ValueError(f"At most {self.longest} characters.")
                return text
            case "choice":
                if text not in self.choices:
                    raise ValueError(f"One of {', '.join(self.choices)}.")
                return text
            case "yes_no":
                if text.lower() not in (*YES, *NO):
                    raise ValueError("Yes or no.")
                return text.lower() in YES
            case "numbers":
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
        Model of an entry.
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
        """Content in words."""
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
    return _parts(str(_table(table, model)["title"]), f"{table}." if table else "")


@cache
def tables_in(table: str, model: str = "") -> tuple[str, ...]:
    """Return the paths of the tables in a table, such as 'vehicle.traction' in 'vehicle'."""
    properties = _table(table, model)["properties"]
    return tuple(f"{table}.{name}" for name, one in properties.items() if "properties" in _resolved(one))


def model_names(table: str) -> tuple[str, ...]:
    """Return the kinds of a table of many kinds, such as those of the drive."""
    return tuple(_table(table)["discriminator"]["mapping"])


def describe(model: type[BaseModel]) -> tuple[Field | Table, ...]:
    """Return the fields and lists of one table of a scenario, such as `railjoule.core.scenario.Vehicle`."""
    return _parts(model.__name__, "")


@cache
def _schemas() -> Mapping[str, Schema]:
    """Return pydantic's JSON schemas of a scenario's models and of a data sheet, by their names."""
    schema, sheet = Scenario.model_json_schema(), DataSheet.model_json_schema()
    return {**schema["$defs"], schema["title"]: schema, sheet["title"]: sheet}


def _resolved(schema: Schema) -> Schema:
    """Return a schema with what it refers to, and with what it demands of a value that is not None."""
    for one in schema.get("anyOf", ()):
        schema = schema if one == NULL else {**schema, **one}
    return {**_schemas()[schema["$ref"].rpartition("/")[2]], **schema} if "$ref" in schema else schema


def _table(path: str, model: str = "") -> Schema:
    """Return the schema at a path; where it meets a table of many kinds, that of the kind `model`."""
    path = f"vehicle.{path}" if path.split(".", maxsplit=1)[0] == "drive" else path
    found = _schemas()["Scenario"]
    for name in path.split(".") if path else ():
        found = _resolved(found["properties"][name])
        if model and "discriminator" in found:
            found = _resolved({"$ref": found["discriminator"]["mapping"][model]})
    return found


@cache
def _parts(name: str, prefix: str) -> tuple[Field | Table, ...]:
    """Return the fields and lists of the model of a name; `prefix` comes before their names in their keys."""
    properties = _schemas()[name]["properties"]
    parts = (_part(prefix + key, schema) for key, schema in properties.items() if key not in TABLE_KEYS)
    return tuple(part for part in parts if part is not None)


def _part(key: str, schema: Schema) -> Field | Table | None:
    """Return the field or list of a schema; None for a table."""
    found = _resolved(schema)
    common: dict[str, Any] = {
        "key": key,
        "help": schema.get("description", ""),
        "optional": NULL in schema.get("anyOf", ()),
    }
    if found.get("type") == "array":
        return _list(found, common)
    choices = tuple(STRATEGIES) if key == "strategy" else tuple(found.get("enum", ()))
    kind: Kind | None = "choice" if choices else KINDS.get(found.get("type"))
    return Field(kind=kind, choices=choices, **common, **_bounds(found)) if kind else None


def _bounds(schema: Schema) -> dict[str, Any]:
    return {ours: schema[theirs] for theirs, ours in BOUNDS.items() if theirs in schema}


def _list(schema: Schema, common: Mapping[str, Any]) -> Field | Table:
    """Return a list of numbers as a field, one of models or of plain lists as a table."""
    fewest, most = schema.get("minItems", 0), schema.get("maxItems")
    entry = _resolved(schema["items"] if "items" in schema else schema["prefixItems"][0])
    if "properties" in entry:
        columns = tuple(part for part in _parts(entry["title"], "") if isinstance(part, Field))
    elif entry["type"] == "array":
        named = zip(POINT_COLUMNS[common["key"].rpartition(".")[2]], entry["prefixItems"], strict=True)
        columns = tuple(Field(name, "number", **_bounds(one)) for name, one in named)
    else:
        # nothing is a list of none where a list may not be left out
        optional = common["optional"] or fewest == 0
        return Field(kind="numbers", count=(fewest, most), **{**common, "optional": optional}, **_bounds(entry))
    # without a bound as many rows as core/budget.py lets any list have
    of_lists = "properties" not in entry
    return Table(columns=columns, of_lists=of_lists, fewest=fewest, most=most or 100_000, **common)
