"""Scenarios as TOML files and as nested dictionaries of their shape, with presets filled in and taken out again."""

from collections.abc import Iterable, Mapping
from copy import deepcopy
from pathlib import Path
from typing import Any, Literal, TypeVar

import tomli_w
from pydantic import BaseModel

from railjoule.core.errors import ScenarioError
from railjoule.core.scenario._base import PresetPart
from railjoule.core.scenario._sentences import shorten, show, validated
from railjoule.core.scenario.line import Line, Section
from railjoule.core.scenario.presets import preset_document, preset_names, preset_text
from railjoule.core.scenario.scenario import RESERVE_KEYS, TIME_KEYS, Scenario
from railjoule.core.scenario.text_file import (
    MAX_FILE_BYTES,
    MAX_KEY_PARTS,
    NESTED_TOO_DEEPLY,
    Folder,
    read_map,
    read_rows,
    read_text,
    read_toml,
)
from railjoule.core.written import write_text

Document = dict[str, Any]
AnyPart = TypeVar("AnyPart", bound=PresetPart)

# A document is often laid over a preset that gives the same quantity by the other key. Without this, setting one would
# leave both in force, which the model refuses.
EXCLUSIVE_KEYS = (
    {"rotating_mass_factor", "inertial_mass_kg"},
    {"load_factor", "load_t"},
    {"actual_load_factor", "actual_load_t"},
    {"max_load_t", "capacity_passengers"},
    set(TIME_KEYS),
    *({key, "deduct_train_length"} for key in TIME_KEYS if key != "average_speed_kmh"),
    *({key, "reserve_parts"} for key in TIME_KEYS if key not in RESERVE_KEYS),
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
        The name of the document in errors, such as its file's.
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
    return validated(Scenario, filled, source)


def part_from_preset(model: type[AnyPart], name: str, changes: Mapping[str, Any]) -> AnyPart:
    """Return a shipped vehicle or line with some keys changed.

    Raises
    ------
    ScenarioError
        If there is no such preset, or a key or its value is wrong.
    """
    _require_consistent(changes, model.__name__)
    document = merged(preset_document(model.preset_kind, name), {"preset": name, **changes})
    return validated(model, document, f"{model.__name__}.from_preset({name!r})")


def _require_consistent(keys: Iterable[str], source: str) -> None:
    """Raise ScenarioError if two keys of one table exclude each other."""
    for group in EXCLUSIVE_KEYS:
        given = sorted(group & set(keys))
        if len(given) > 1:
            raise ScenarioError(f"{source}: {' and '.join(given)} exclude each other; give one of them.")


def to_document(scenario: Scenario) -> Document:
    """Return the shortest document that gives `scenario` back: only what differs from presets and defaults."""
    document, vehicle, line = _dump(scenario), scenario.vehicle, scenario.line
    short = _over_preset(vehicle)
    if short is not None and (drive := short.pop("drive", {})):
        # of a drive of another kind all keys are needed
        document["drive"] = vehicle.drive.model_dump(mode="json", exclude_none=True) if drive.get("model") else drive
    document["vehicle"] = _dump(vehicle.model_copy(update={"preset": None})) if short is None else short
    short = _over_preset(line)
    document["line"] = whole_line(line) if short is None else short
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
        if path.count(".") >= MAX_KEY_PARTS:
            raise ScenarioError(f"{shorten(path)}: a key has at most {MAX_KEY_PARTS} parts with dots between them.")
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
    # Keys of another kind of drive would be unknown ones; the recuperation factor is what the supply takes back,
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
    vehicle = document["vehicle"] = _filled("vehicles", vehicle)
    drive = document.pop("drive", None)
    if isinstance(drive, dict):
        vehicle["drive"] = _merged_drive(vehicle.get("drive", {}), drive)
    elif drive is not None:
        raise ScenarioError(f"drive = {show(drive)} must be a table.")
    drive = vehicle.get("drive")
    if not isinstance(drive, dict) or drive.get("model") != "efficiency_map" or "file" not in drive:
        return
    name = _file_name("drive.file", drive.pop("file"))
    if "points" in drive:
        raise ScenarioError("drive needs only one of file and points.")
    # the name of the file goes no further: a scenario is one value that can be saved, sent and compared
    drive["points"] = read_map(name, folder)


def _fill_line(document: Document, folder: Folder | None) -> None:
    line = document.get("line")
    if not isinstance(line, dict):
        return
    if (name := line.pop("file", None)) is not None:
        # two of them would contradict each other, and no rule decides which one counts
        if "sections" in line or "preset" in line:
            raise ScenarioError("line needs only one of preset, file and sections.")
        line["sections"] = read_rows("line.file", _file_name("line.file", name), folder, Section.model_fields)
    document["line"] = _filled("lines", line)


def _file_name(key: str, name: Any) -> str:
    if not isinstance(name, str):
        raise ScenarioError(f"{key} = {show(name)} must be the name of a CSV file.")
    return name


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


def _over_preset(part: PresetPart) -> Document | None:
    """Compute the changes of its preset that give a part; None if it has none."""
    if part.preset is None:
        return None
    full = part.model_dump(mode="json", exclude_none=True)
    base = part.model_validate(preset_document(part.preset_kind, part.preset)).model_dump(
        mode="json", exclude_none=True
    )
    short = _difference(full, base)
    # a default that another key of its group replaces needs no line of its own
    for key in [key for group in EXCLUSIVE_KEYS if len(group & short.keys()) > 1 for key in group & short.keys()]:
        if short[key] == type(part).model_fields[key].default:
            del short[key]
    # compared as parts: a key that replaces another one's default is not among the base's keys
    return short if part.model_validate(merged(base, short)) == part else None


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


def load_scenario(path: str | Path, changes: Mapping[str, Any] | None = None) -> Scenario:
    """Read a scenario file, or by its name a shipped scenario.

    Parameters
    ----------
    path : str or Path
        A TOML file, or the name of a shipped scenario such as `liashenko-ii`.
    changes : mapping, optional
        Keys to set before it is checked, named by dotted path.

    Raises
    ------
    ScenarioError
        If the file cannot be read or anything in it is wrong.
    """
    path = Path(path)
    # a user's own file of the same name wins, or a file on disk could not be read
    shipped = str(path) in preset_names("scenarios") and not path.exists()
    # a shipped scenario names no files, so it needs no folder; one on disk may name others beside it
    text = preset_text("scenarios", str(path)) if shipped else read_text(path)
    return parse_scenario(text, path.name, None if shipped else path.parent, changes)


def as_scenario(scenario: Scenario | str | Path) -> Scenario:
    """Return a scenario, also one that is given by its name or file.

    Raises
    ------
    ScenarioError
        If it is neither, or as in `load_scenario`.
    """
    if isinstance(scenario, Scenario):
        return scenario
    if isinstance(scenario, str | Path):
        return load_scenario(scenario)
    raise ScenarioError(
        f"scenario has the type {type(scenario).__name__}; it must be a Scenario, the name of a shipped one, or a "
        "file's path."
    )


def parse_scenario(
    text: str,
    source: str = "scenario",
    folder: Folder | None = None,
    changes: Mapping[str, Any] | None = None,
) -> Scenario:
    """Return the scenario that a TOML text describes.

    Parameters
    ----------
    text : str
        The TOML.
    source : str
        Its name in errors.
    folder : Path or callable, optional
        Folder of the files that it names; without it such keys are refused.
    changes : mapping, optional
        Keys to set before it is checked, named by dotted path.

    Raises
    ------
    ScenarioError
        If the text is no TOML, larger than 10 MB, or anything in it is wrong.
    """
    # also for texts that never were a file, as those pasted into the page
    if len(text) > MAX_FILE_BYTES:
        raise ScenarioError(f"{source}: more than the {MAX_FILE_BYTES / 1e6:g} MB permitted.")
    document = read_toml(text, source)
    try:
        # the changes come before the checks: keys that only fit together can be changed together
        return scenario_from_document(change_document(document, changes or {}), source, folder)
    except RecursionError:
        raise ScenarioError(f"{source}: {NESTED_TOO_DEEPLY}") from None


def format_scenario(scenario: Scenario) -> str:
    """Return the TOML text that gives exactly `scenario` when it is read again."""
    return tomli_w.dumps(to_document(scenario))


def save_scenario(scenario: Scenario, path: str | Path) -> None:
    """Write `scenario` to a TOML file that gives exactly it when it is read again."""
    write_text(path, format_scenario(scenario))
