"""Scenarios as nested dictionaries, the shape of a TOML file: presets filled in and taken out again."""

from collections.abc import Iterable, Mapping
from copy import deepcopy
from typing import Any, Literal, TypeVar

from pydantic import BaseModel, ValidationError

from railjoule.core.errors import ScenarioError
from railjoule.core.scenario._sentences import sentence_of, shorten, show
from railjoule.core.scenario.csv_table import Folder
from railjoule.core.scenario.line import Line
from railjoule.core.scenario.map_csv import read_map
from railjoule.core.scenario.presets import preset_document
from railjoule.core.scenario.scenario import Scenario
from railjoule.core.scenario.sections_csv import read_sections
from railjoule.core.scenario.toml_text import MOST_KEY_PARTS
from railjoule.core.scenario.vehicle import Vehicle

Document = dict[str, Any]
PresetPart = TypeVar("PresetPart", Vehicle, Line)

# A document is often laid over a preset that says the same thing by the other key. Without this, setting one would
# leave both in force, which the model refuses.
EXCLUSIVE_KEYS = (
    {"rotating_mass_factor", "inertial_mass_kg"},
    {"travel_time_s", "average_speed_kmh"},
    {"travel_time_s", "deduct_train_length"},
)
"""Keys of which only one has an effect: one replaces the other."""


def scenario_from_document(
    document: Mapping[str, Any],
    source: str = "scenario",
    folder: Folder | None = None,
) -> Scenario:
    """Return the scenario that a nested dictionary describes.

    Parameters
    ----------
    document : mapping
        Keys as in a scenario file.
    source : str
        What errors call the document, such as its file's name.
    folder : Path or callable, optional
        Where `line.file` is looked for; without it that key is refused.

    Raises
    ------
    ScenarioError
        If a key is unknown or missing, or a value of a wrong type or out of bounds.
    """
    # presets are filled in in place, and the document is the caller's
    filled = deepcopy(dict(document))
    try:
        _fill_vehicle(filled, folder)
        _fill_line(filled, folder)
    except ScenarioError as error:
        raise ScenarioError(f"{source}: {error}") from None
    try:
        return Scenario.model_validate(filled)
    except ValidationError as error:
        raise ScenarioError(sentence_of(error, Scenario, source)) from None


def part_from_preset(
    model: type[PresetPart], kind: Literal["vehicles", "lines"], name: str, changes: Mapping[str, Any]
) -> PresetPart:
    """Return a shipped vehicle or line with some keys changed.

    Raises
    ------
    ScenarioError
        If there is no such preset, or a key or its value is wrong.
    """
    _require_consistent(changes, model.__name__)
    document = merged(preset_document(kind, name), {"preset": name, **changes})
    try:
        return model.model_validate(document)
    except ValidationError as error:
        raise ScenarioError(sentence_of(error, model, f"{model.__name__}.from_preset({name!r})")) from None


def _require_consistent(keys: Iterable[str], source: str) -> None:
    """Raise ScenarioError if two keys of one table exclude each other."""
    for group in EXCLUSIVE_KEYS:
        given = sorted(group & set(keys))
        if len(given) > 1:
            raise ScenarioError(f"{source}: {' and '.join(given)} exclude each other; give one of them.")


def document_of(scenario: Scenario) -> Document:
    """Return the shortest document that gives `scenario` back: only what differs from presets and defaults."""
    document = _dump(scenario)
    vehicle, drive = _shorten_vehicle(scenario.vehicle)
    document["vehicle"] = vehicle
    if drive:
        document["drive"] = drive
    document["line"] = _shorten_line(scenario.line)
    return document


def whole_line(line: Line) -> Document:
    """Return a line without a preset, as the file of one has it."""
    return _dump(line.model_copy(update={"preset": None}))


def change_document(document: Document, changes: Mapping[str, Any]) -> Document:
    """Return a copy of `document` with the keys of `changes`, dotted paths, set; None takes a key away.

    Raises
    ------
    ScenarioError
        If a path has too many parts or leads through a value that is no table, or two keys exclude each other.
    """
    changed = deepcopy(document)
    tables: dict[str, set[str]] = {}
    for path, value in changes.items():
        parent, _, key = path.rpartition(".")
        # a key that is taken away or switched off contradicts nothing
        if value is not None and value is not False:
            tables.setdefault(parent, set()).add(key)
    for parent, keys in tables.items():
        _require_consistent(keys, parent or "scenario")
    for path, value in changes.items():
        # before any table is made: a path of a million parts would nest as many dictionaries
        if path.count(".") >= MOST_KEY_PARTS:
            raise ScenarioError(f"{shorten(path)}: a key has at most {MOST_KEY_PARTS} parts with dots between them.")
        *parents, key = (
            path.removeprefix("vehicle.").split(".") if path.startswith("vehicle.drive.") else path.split(".")
        )
        table = changed
        for parent in parents:
            table = table.setdefault(parent, {})
            if not isinstance(table, dict):
                raise ScenarioError(f"{shorten(path)}: {shorten(parent)} is not a table.")
        if value is None:
            table.pop(key, None)
            continue
        # None above takes the key away, so that a default or a preset holds again
        _drop_alternatives(table, key)
        table[key] = deepcopy(value)
    return changed


def merged(base: Mapping[str, Any], changes: Mapping[str, Any]) -> Document:
    """Return `base` with `changes` laid over it, table by table."""
    result = dict(deepcopy(base))
    for key, value in changes.items():
        if isinstance(value, Mapping) and isinstance(result.get(key), Mapping):
            result[key] = (_merged_drive if key == "drive" else merged)(result[key], value)
        else:
            _drop_alternatives(result, key)
            result[key] = deepcopy(value)
    return result


def _merged_drive(base: Mapping[str, Any], changes: Mapping[str, Any]) -> Document:
    """Lay a drive over another; of a drive of another kind only the recuperation factor stays."""
    # Keys of another kind of drive would be unknown ones; the recuperation factor says what the line takes back,
    # whatever the drive is.
    if "model" in changes and changes["model"] != base.get("model"):
        base = {key: value for key, value in base.items() if key == "recuperation_factor"}
    return merged(base, changes)


def _drop_alternatives(table: Document, key: str) -> None:
    for group in EXCLUSIVE_KEYS:
        if key in group:
            for other in group - {key}:
                table.pop(other, None)


def _fill_vehicle(document: Document, folder: Folder | None) -> None:
    vehicle = document.get("vehicle")
    if not isinstance(vehicle, dict):
        return
    # The order matters: first the preset, then the drive of the document over that of the preset, then the map's file,
    # as either of the two may name it.
    vehicle = _filled("vehicles", vehicle)
    drive = document.pop("drive", None)
    if isinstance(drive, dict):
        vehicle["drive"] = _merged_drive(vehicle.get("drive", {}), drive)
    elif drive is not None:
        raise ScenarioError(f"drive = {show(drive)} must be a table.")
    if isinstance(vehicle.get("drive"), dict):
        fill_map(vehicle["drive"], folder)
    document["vehicle"] = vehicle


def fill_map(drive: Document, folder: Folder | None) -> None:
    """Put the points of a map's file in its place."""
    if drive.get("model") != "efficiency_map" or "file" not in drive:
        return
    name = drive.pop("file")
    if not isinstance(name, str):
        raise ScenarioError(f"drive.file = {show(name)} must be the name of a CSV file.")
    if "points" in drive:
        raise ScenarioError("drive needs only one of file and points.")
    # from here on nothing knows the file: a scenario is one value that can be saved, sent and compared
    drive["points"] = read_map(name, folder)


def _fill_line(document: Document, folder: Folder | None) -> None:
    line = document.get("line")
    if isinstance(line, dict):
        fill_sections(line, folder)
        document["line"] = _filled("lines", line)


def fill_sections(line: Document, folder: Folder | None) -> None:
    """Put the sections of a line's file in its place."""
    name = line.pop("file", None)
    if name is not None and not isinstance(name, str):
        raise ScenarioError(f"line.file = {show(name)} must be the name of a CSV file.")
    if name is not None:
        # two of them would contradict each other, and no rule says which one counts
        if "sections" in line or "preset" in line:
            raise ScenarioError("line needs only one of preset, file and sections.")
        line["sections"] = read_sections(name, folder)


def _filled(kind: Literal["vehicles", "lines"], table: Document) -> Document:
    preset = table.get("preset")
    if preset is None:
        return table
    if not isinstance(preset, str):
        raise ScenarioError(f"preset = {show(preset)} must be the name of one of the {kind}.")
    return merged(preset_document(kind, preset), table)


def _dump(part: BaseModel) -> Document:
    """Dump what differs from the defaults, with lists for tuples."""
    return part.model_dump(mode="json", exclude_none=True, exclude_defaults=True)


def _shorten_vehicle(vehicle: Vehicle) -> tuple[Document, Document]:
    """Return the tables `vehicle` and `drive` of a document."""
    full = vehicle.model_dump(mode="json", exclude_none=True)
    short = None
    if vehicle.preset is not None:
        short = _over(full, Vehicle.model_validate(preset_document("vehicles", vehicle.preset)))
    if short is not None:
        drive = short.pop("drive", {})
        return short, full["drive"] if drive.get("model") else drive
    return _dump(vehicle.model_copy(update={"preset": None})), {}


def _shorten_line(line: Line) -> Document:
    short = None
    if line.preset is not None:
        full = line.model_dump(mode="json", exclude_none=True)
        short = _over(full, Line.model_validate(preset_document("lines", line.preset)))
    return whole_line(line) if short is None else short


def _over(full: Document, base: BaseModel) -> Document | None:
    """Return what is to be laid over a preset to give `full`; None where no such thing does."""
    table = base.model_dump(mode="json", exclude_none=True)
    short = _difference(full, table)
    return short if merged(table, short) == full else None


def _difference(full: Document, base: Document) -> Document:
    """Return the entries of `full` that `base` lacks or has otherwise."""
    result: Document = {}
    for key, value in full.items():
        if key not in base:
            result[key] = value
        elif value != base[key]:
            both_tables = isinstance(value, dict) and isinstance(base[key], dict)
            result[key] = _difference(value, base[key]) if both_tables else value
    return result
