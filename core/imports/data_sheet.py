"""A vehicle of the values of a data sheet, as the result of an import."""

from collections.abc import Mapping
from typing import Any

from railjoule.core.errors import ScenarioError
from railjoule.core.imports.findings import Notes
from railjoule.core.imports.source_file import SourceFile, read_json
from railjoule.core.imports.vehicle import ImportedVehicle, imported_vehicle
from railjoule.core.scenario._sentences import validated
from railjoule.core.scenario.data_sheet import DataSheet

KEY = "data_sheet"
"""The only key of a file of a data sheet."""


def read_data_sheet(values: Mapping[str, Any], source: str) -> ImportedVehicle:
    """Make a vehicle of the values of a data sheet.

    Parameters
    ----------
    values : mapping
        Fields of `DataSheet`.
    source : str
        Name of the sheet in findings and errors.

    Raises
    ------
    ScenarioError
        If a value is missing, unknown, of a wrong type or out of bounds, or has no effect.
    """
    sheet, notes = validated(DataSheet, dict(values), source), Notes(source)
    document = sheet.to_document()
    bases: dict[tuple[str, str], list[str]] = {}
    for one in document["assumed"]:
        table = one["key"].rpartition(".")[0]
        bases.setdefault((one["basis"], table), []).append(f"{one['key']} = {one['value']:g}")
    for (basis, _), keys in bases.items():
        notes.add("assumption", f"{', '.join(keys)}: {basis}.")
    return imported_vehicle(document, notes)


def read_data_sheet_file(source: SourceFile) -> ImportedVehicle:
    """Make a vehicle of a JSON file with the key `data_sheet`; errors as of `read_data_sheet`."""
    values = read_json(source).get(KEY)
    if not isinstance(values, dict):
        raise ScenarioError(f"{source.name}: {KEY} must be a table.")
    return read_data_sheet(values, source.name)
