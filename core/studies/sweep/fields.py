"""The fields of a scenario that a sweep varies: which they are, between which bounds, and how a value is put in.

`Scenario.with_` writes a document and reads it again, which checks everything and takes longer than the optimum itself.
A sweep lets it check the corners of the box that its ranges span. Each rule of a scenario bounds a number by constants
or by other numbers, on one side, so that what holds at all corners holds between them. Inside, values are put into
copies of the tables that they stand in, and all other tables are shared.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from types import UnionType
from typing import Annotated, Any, Union, get_args, get_origin

from pydantic import BaseModel

from railjoule.core.errors import ScenarioError
from railjoule.core.scenario import Scenario
from railjoule.core.scenario._sentences import shorten, show, suggestion
from railjoule.core.scenario.document import EXCLUSIVE_KEYS

MOST_FIELDS = 10
"""Fields of one sweep: each doubles the corners that are checked before it."""


@dataclass(frozen=True)
class Field:
    """A number of a scenario, and between which values it varies.

    Parameters
    ----------
    name : str
        Its path in the file, such as "vehicle.load_factor".
    path : tuple of str
        Where it stands in a `Scenario`.
    low, high : float
        The range, both ends included, in the field's own unit.
    whole : bool
        Whether it takes whole numbers alone.
    """

    name: str
    path: tuple[str, ...]
    low: float
    high: float
    whole: bool

    def value(self, number: float) -> float | int:
        """Return a number of a sample as the scenario takes it."""
        return round(number) if self.whole else number


def fields_of(scenario: Scenario, over: Mapping[str, tuple[float, float]]) -> tuple[Field, ...]:
    """Return the fields that a sweep varies, in the order given.

    Parameters
    ----------
    scenario : Scenario
    over : mapping of str to (float, float)
        Lowest and highest value by the field's path in the file.

    Raises
    ------
    ScenarioError
        If there are none or too many, a field is unknown or no number, two of them say the same thing, or a range is
        none or leads out of the field's bounds.
    """
    if not 1 <= len(over) <= MOST_FIELDS:
        raise ScenarioError(f"a sweep varies 1 to {MOST_FIELDS} fields, not {len(over)}.")
    fields = tuple(_field(scenario, name, ends) for name, ends in over.items())
    for field in fields:
        same = [other.name for other in fields if other.path[:-1] == field.path[:-1] and _exclude(field, other)]
        if same:
            raise ScenarioError(f"{field.name} and {same[0]} say the same thing: a sweep varies one of them.")
        for end in (field.low, field.high):
            # with the others as they are: what this refuses is wrong with this field
            scenario.replace(**{field.name: field.value(end)})
    return fields


def _exclude(one: Field, other: Field) -> bool:
    """Return whether two fields of one table are the same, or two ways to say one thing."""
    if one is other:
        return False
    return one.path == other.path or any({one.path[-1], other.path[-1]} <= group for group in EXCLUSIVE_KEYS)


def _field(scenario: Scenario, name: str, ends: tuple[float, float]) -> Field:
    low, high = ends
    for end in ends:
        if isinstance(end, bool) or not isinstance(end, int | float) or not math.isfinite(end):
            raise ScenarioError(f"{shorten(name)}: {show(end)} is no end of a range, which is a finite number.")
    if low > high:
        raise ScenarioError(f"{shorten(name)}: the range {low:g} to {high:g} begins above its end.")
    path, whole = _place(scenario, name)
    if whole and not (float(low).is_integer() and float(high).is_integer()):
        raise ScenarioError(f"{name}: the ends of the range {low:g} to {high:g} must be whole numbers.")
    return Field(name, path, float(low), float(high), whole)


def _place(scenario: Scenario, name: str) -> tuple[tuple[str, ...], bool]:
    """Return where a field stands in a scenario, and whether it takes whole numbers alone."""
    parts = name.split(".")
    # in a file the drive is a table of its own
    path = ("vehicle", *parts) if parts[0] == "drive" else tuple(parts)
    table: Any = scenario
    for key in path[:-1]:
        _require_key(table, key, name)
        table = getattr(table, key)
        if not isinstance(table, BaseModel):
            raise ScenarioError(f"{shorten(name)}: {shorten(key)} is no table with numbers in this scenario.")
    _require_key(table, path[-1], name)
    kinds = _kinds(type(table).model_fields[path[-1]].annotation)
    if not kinds & {float, int} or kinds - {float, int, type(None)}:
        raise ScenarioError(f"{shorten(name)} is no number: a sweep varies numbers alone.")
    return path, float not in kinds


def _require_key(table: BaseModel, key: str, name: str) -> None:
    known = set(type(table).model_fields)
    if key not in known:
        known |= {"drive"} if isinstance(table, Scenario) else set()
        raise ScenarioError(f"unknown key {shorten(name)}, {suggestion(key, known)}.".replace("?.", "?"))


def _kinds(annotation: Any) -> set[Any]:
    """Return the types of which a field takes a value."""
    if get_origin(annotation) is Annotated:
        return _kinds(get_args(annotation)[0])
    if get_origin(annotation) in (Union, UnionType):
        return set().union(*(_kinds(inner) for inner in get_args(annotation)))
    return {annotation}


def corners_hold(scenario: Scenario, fields: Sequence[Field]) -> bool:
    """Return whether a scenario is one at every corner of the box over which its fields vary."""
    for ends in product(*(sorted({field.low, field.high}) for field in fields)):
        changes = {field.name: field.value(end) for field, end in zip(fields, ends, strict=True)}
        try:
            scenario.replace(**changes)
        except ScenarioError:
            return False
    return True


class Patch:
    """Puts values of fields into a scenario without checking them, which the corners of their ranges were for.

    Parameters
    ----------
    scenario : Scenario
    fields : sequence of Field
    """

    def __init__(self, scenario: Scenario, fields: Sequence[Field]) -> None:
        self._scenario, self._fields = scenario, tuple(fields)
        self._tree: dict[str, Any] = {}
        for number, field in enumerate(fields):
            table = self._tree
            for key in field.path[:-1]:
                table = table.setdefault(key, {})
            table[field.path[-1]] = number
            part = scenario
            for key in field.path[:-1]:
                part = getattr(part, key)
            # the field replaces other keys, which would contradict it: their defaults, in tuples of one
            for other in _alternatives(field.path[-1]) & type(part).model_fields.keys():
                table[other] = (type(part).model_fields[other].default,)

    def __call__(self, values: Sequence[float]) -> Scenario:
        """Return the scenario with values, one a field in their order; untouched tables are the same objects."""
        own = [field.value(value) for field, value in zip(self._fields, values, strict=True)]
        patched: Scenario = _patched(self._scenario, self._tree, own)
        return patched


def _alternatives(key: str) -> set[str]:
    return set().union(*(group - {key} for group in EXCLUSIVE_KEYS if key in group))


def _patched(part: Any, tree: Mapping[str, Any], values: Sequence[float]) -> Any:
    update = {
        key: _patched(getattr(part, key), inner, values)
        if isinstance(inner, dict)
        else inner[0]
        if isinstance(inner, tuple)
        else values[inner]
        for key, inner in tree.items()
    }
    return part.model_copy(update=update)
