"""Vehicles, lines and scenarios that come with railjoule, read from its assets."""

import tomllib
from functools import lru_cache
from importlib.resources import files
from importlib.resources.abc import Traversable
from typing import Any, Literal

from railjoule.core.errors import ScenarioError
from railjoule.core.scenario._sentences import show, suggestion

PresetKind = Literal["vehicles", "lines", "scenarios"]


def preset_names(kind: PresetKind) -> tuple[str, ...]:
    """Return the names of all shipped presets of a kind, sorted."""
    return tuple(
        sorted(entry.name.removesuffix(".toml") for entry in _folder(kind).iterdir() if entry.name.endswith(".toml"))
    )


# The text is kept, and not the dictionary: a page asks at every change, and callers change what they get. 64 is more
# than there are files.
@lru_cache(maxsize=64)
def preset_text(kind: PresetKind, name: str) -> str:
    """Return a shipped file with its comments, which name the sources.

    Raises
    ------
    ScenarioError
        If there is no such preset; it names those that are alike.
    """
    known = preset_names(kind)
    if name not in known:
        hint = suggestion(name, known)
        end = "" if hint.endswith("?") else "."
        raise ScenarioError(f"there is no preset {show(name)} among the {kind}, {hint}{end}")
    return (_folder(kind) / f"{name}.toml").read_text(encoding="utf-8")


def preset_document(kind: PresetKind, name: str) -> dict[str, Any]:
    """Return a fresh copy of a shipped preset as a nested dictionary; errors as of `preset_text`."""
    return tomllib.loads(preset_text(kind, name))


def scenario_of_vehicle(name: str) -> str:
    """Return the name of the shipped scenario in which a shipped vehicle runs: a line and a timetable that fit it.

    Raises
    ------
    ScenarioError
        If there is no such vehicle.
    """
    preset_text("vehicles", name)
    scenarios = preset_names("scenarios")
    if name in scenarios:
        return name
    return next(one for one in scenarios if preset_document("scenarios", one)["vehicle"].get("preset") == name)


def _folder(kind: PresetKind) -> Traversable:
    # importlib.resources: the assets may lie in a wheel or in a checkout, and only this finds both
    return files("railjoule.assets") / kind
