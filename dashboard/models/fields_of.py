"""The fields of a scenario as its models declare them: label, unit, bounds, help, and how a text becomes a value."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Any, Literal

from railjoule.core.scenario import Scenario
from railjoule.core.scenario.map_csv import COLUMNS as MAP_COLUMNS
from railjoule.dashboard.look.words import MINUS, THIN_SPACE
from railjoule.dashboard.models.numbers import clock, parse_number, parse_time

Kind = Literal["number", "whole", "yes_no", "choice", "text", "numbers"]
Schema = Mapping[str, Any]

NAMES = {"capacity_passengers": "passenger capacity"}
"""What a field is called whose key does not read well."""
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
    "_permille": "\u2030",
    "_rads": "rad/s",
    "_kmh": "km/h",
    "_ms2": "m/s\u00b2",
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
    "_m": "m",
    "_s": "s",
    "_w": "W",
    "_a": "A",
    "_v": "V",
    "_j": "J",
}
"""Ends of keys with the units that they name; the longest stand before those that they end with."""
SMALL_UNIT = re.compile(r" \[[^\[\]]+\]")
"""The unit in a description: the label says it already."""
POINT_COLUMNS: Mapping[str, tuple[str, ...]] = {
    "vehicle.traction.curve": ("speed_kmh", "effort_kn"),
    "drive.points": MAP_COLUMNS,
}
"""Names for the columns of tables whose rows are plain lists."""
YES = ("yes", "true", "1")
NO = ("no", "false", "0")
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
        words = split_unit(self.name)[0] if self.unit else self.name
        text = NAMES.get(words, words).replace("_", " ")
        text = text[:1].upper() + text[1:]
        return f"{text}, {self.unit}" if self.unit else text

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
    def help_words(self) -> str:
        """Meaning and bounds in sentences."""
        bounds = self.bounds_words
        meaning = SMALL_UNIT.sub("", self.help)
        several = " Numbers separated by spaces." if self.kind == "numbers" else ""
        empty = " Can be left empty." if self.optional else ""
        forms = " Also as 2:30 or 2 min 30 s." if self._may_be_long else ""
        return f"{meaning}{several}{f' {bounds[:1].upper()}{bounds[1:]}.' if bounds else ''}{forms}{empty}".strip()

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
            number = parse_time(text, bounds, self.label.split(",")[0] if "." in self.key else "")
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
        words = self.key.rpartition(".")[2].replace("_", " ")
        return words[:1].upper() + words[1:]


def plain(number: float) -> str:
    """Return a number as it stands in a file, without more digits than it needs."""
    return f"{number:.12g}"


def split_unit(name: str) -> tuple[str, str]:
    """Return a key's words and the unit that it ends with; no unit where it names none."""
    for end, unit in UNITS.items():
        if name.endswith(end):
            return name.removesuffix(end), unit
    return name, ""


def parts_of(table: str, model: str = "") -> list[Field | Table]:
    """Return the fields and lists of a table of the scenario, without the tables in it.

    Parameters
    ----------
    table : str
        Its dotted path, such as 'vehicle.traction', empty for the scenario itself.
    model : str
        The kind of the drive, where the path leads there.
    """
    schema = _schema_at(table, model)
    return [
        part
        for key, inner in schema["properties"].items()
        if key not in TABLE_KEYS and (part := _part(f"{table}.{key}".removeprefix("."), inner)) is not None
    ]


def tables_in(table: str, model: str = "") -> tuple[str, ...]:
    """Return the paths of the tables in a table, such as 'vehicle.traction' in 'vehicle'."""
    properties = _schema_at(table, model)["properties"]
    return tuple(f"{table}.{key}" for key, inner in properties.items() if "properties" in _resolved(inner)[0])


def models_of(table: str) -> tuple[str, ...]:
    """Return the kinds of a table of many kinds, such as those of the drive."""
    return tuple(_kinds(_schema_at(table, "")))


@cache
def _whole_schema() -> Schema:
    return Scenario.model_json_schema()


def _kinds(schema: Schema) -> Mapping[str, str]:
    kinds: Mapping[str, str] = schema["discriminator"]["mapping"]
    return kinds


def _schema_at(table: str, model: str) -> Schema:
    """Return the schema of a path; where it meets a table of many kinds, that of the kind `model`."""
    path = "vehicle.drive" + table.removeprefix("drive") if table.split(".", maxsplit=1)[0] == "drive" else table
    schema = _whole_schema()
    for key in path.split(".") if path else ():
        schema = _resolved(schema["properties"][key])[0]
        if model and "discriminator" in schema:
            schema = _resolved({"$ref": _kinds(schema)[model]})[0]
    return schema


def _resolved(schema: Schema) -> tuple[Schema, bool]:
    """Return a schema with its reference followed, and whether it may be left out."""
    optional = False
    if "anyOf" in schema:
        (inner,) = [choice for choice in schema["anyOf"] if choice.get("type") != "null"][:1]
        optional = any(choice.get("type") == "null" for choice in schema["anyOf"])
        schema = {**{key: value for key, value in schema.items() if key != "anyOf"}, **inner}
    if "$ref" in schema:
        schema = _whole_schema()["$defs"][schema["$ref"].rpartition("/")[2]]
    return schema, optional


def _part(key: str, declared: Schema) -> Field | Table | None:
    """Return what a schema declares; None for a table or what cannot be edited here."""
    schema, optional = _resolved(declared)
    if schema.get("type") != "array":
        return _field(key, declared)
    items, _ = _resolved(schema.get("items", {}))
    if "properties" in items or "prefixItems" in items:
        return _table(key, schema, items, optional)
    return _field(key, declared)


def _table(key: str, schema: Schema, items: Schema, optional: bool) -> Table:
    if "properties" in items:
        columns = tuple(field for name, inner in items["properties"].items() if (field := _field(name, inner)))
    else:
        names = POINT_COLUMNS.get(key) or tuple(f"column_{number}" for number in range(len(items["prefixItems"])))
        made = [_field(name, inner) for name, inner in zip(names, items["prefixItems"], strict=True)]
        columns = tuple(field for field in made if field is not None)
    return Table(
        key=key,
        columns=columns,
        of_lists="prefixItems" in items,
        help=str(schema.get("description", "")),
        optional=optional,
        fewest=int(schema.get("minItems", 0)),
        most=int(schema.get("maxItems", 100_000)),
    )


def _field(key: str, declared: Schema) -> Field | None:
    schema, optional = _resolved(declared)
    common: dict[str, Any] = {"key": key, "help": str(schema.get("description", "")), "optional": optional}
    if "enum" in schema:
        return Field(kind="choice", choices=tuple(schema["enum"]), **common)
    kinds: Mapping[str, Kind] = {"number": "number", "integer": "whole", "boolean": "yes_no", "string": "text"}
    kind = str(schema.get("type"))
    if kind == "array":
        return _numbers(schema, common)
    if kind not in kinds or "const" in schema:
        return None
    return Field(kind=kinds[kind], longest=schema.get("maxLength"), **common, **_bounds(schema))


def _numbers(schema: Schema, common: Mapping[str, Any]) -> Field | None:
    of_each: Sequence[Schema] = schema.get("prefixItems") or [schema.get("items", {})]
    if any(inner.get("type") != "number" for inner in of_each):
        return None
    count = int(schema.get("minItems", 0)), schema.get("maxItems")
    field = Field(kind="numbers", count=count, **common, **_bounds(of_each[0]))
    # nothing is a list of none where a list may not be left out
    return replace(field, optional=True) if count[0] == 0 else field


def _bounds(schema: Schema) -> dict[str, Any]:
    names = {"least": "minimum", "most": "maximum", "above": "exclusiveMinimum", "below": "exclusiveMaximum"}
    return {ours: schema.get(theirs) for ours, theirs in names.items()}
