"""A line or a vehicle that was read, checked as those of a scenario are."""

from collections.abc import Mapping
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from railjoule.core.errors import ScenarioError
from railjoule.core.scenario import Line, Vehicle
from railjoule.core.scenario._sentences import sentence_of

Table = TypeVar("Table", bound=BaseModel)


class _LineTable(BaseModel):
    line: Line


class _VehicleTable(BaseModel):
    vehicle: Vehicle


def checked_line(line: Mapping[str, Any], source: str) -> Line:
    """Return the line of a scenario's table `line`.

    Raises
    ------
    ScenarioError
        If there can be no such line; the sentence begins with `source`.
    """
    return _checked(_LineTable, {"line": line}, source).line


def checked_vehicle(vehicle: Mapping[str, Any], source: str) -> Vehicle:
    """Return the vehicle of a scenario's table `vehicle`.

    Raises
    ------
    ScenarioError
        If there can be no such vehicle; the sentence begins with `source`.
    """
    return _checked(_VehicleTable, {"vehicle": vehicle}, source).vehicle


def _checked(model: type[Table], document: Mapping[str, Any], source: str) -> Table:
    try:
        return model.model_validate(document)
    except ValidationError as error:
        raise ScenarioError(sentence_of(error, model, source)) from None
