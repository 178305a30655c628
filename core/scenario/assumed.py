"""Assumed values of a vehicle, each with its formula and source, until other values replace them."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, get_args

from pydantic import BaseModel, Field

from railjoule.core.scenario._base import Name, Number, Part

if TYPE_CHECKING:
    from railjoule.core.scenario.vehicle import Vehicle


class Assumed(Part):
    """An assumed value: it counts as assumed as long as the vehicle has it."""

    key: Name = Field(max_length=100, description="Key of the scenario, such as vehicle.rotating_mass_factor.")
    value: Number = Field(description="Assumed value.")
    basis: Name = Field(max_length=300, description="Formula and source; values with the same one belong together.")


def value_at(vehicle: "Vehicle", key: str) -> Any:
    """Return the value of a vehicle at a key of the scenario; None where it has no such value."""
    found: Any = vehicle
    for name in key.removeprefix("vehicle.").split("."):
        found = getattr(found, name, None)
    return found


def require_known_keys(vehicle: "Vehicle") -> None:
    """Raise ValueError for an assumed value of a key that no vehicle has, or that is given twice."""
    known = set(_number_keys(type(vehicle), "vehicle."))
    seen = set()
    for index, one in enumerate(vehicle.assumed):
        if one.key not in known:
            raise ValueError(f"assumed[{index}].key = {one.key!r} must be the key of a number of [vehicle] or [drive]")
        if one.key in seen:
            raise ValueError(f"assumed[{index}].key = {one.key!r} is given twice")
        seen.add(one.key)


def _number_keys(model: type[BaseModel], path: str) -> Iterator[str]:
    """Yield the keys of all numbers of a table and the tables in it; the drive has a table of its own in files."""
    for name, field in model.model_fields.items():
        pending, models = [field.annotation], []
        while pending:
            kind = pending.pop()
            if isinstance(kind, type) and issubclass(kind, BaseModel):
                models.append(kind)
            elif kind is float:
                yield path + name
            elif not str(kind).startswith("tuple"):
                pending += get_args(kind)
        for inner in models:
            yield from _number_keys(inner, f"{'' if name == 'drive' else path}{name}.")
