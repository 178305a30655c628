"""Scenarios as TOML files."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import tomli_w

from railjoule.core.errors import ScenarioError
from railjoule.core.scenario.csv_table import Folder
from railjoule.core.scenario.document import change_document, document_of, scenario_from_document
from railjoule.core.scenario.presets import preset_names, preset_text
from railjoule.core.scenario.scenario import Scenario
from railjoule.core.scenario.text_file import LARGEST_FILE_BYTES, read_text
from railjoule.core.scenario.toml_text import NESTED_TOO_DEEPLY, read_toml
from railjoule.core.written import write_text


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
        What errors call it.
    folder : Path or callable, optional
        Where files that it names are looked for; without it such keys are refused.
    changes : mapping, optional
        Keys to set before it is checked, named by dotted path.

    Raises
    ------
    ScenarioError
        If the text is no TOML, larger than 10 MB, or anything in it is wrong.
    """
    # also for texts that never were a file, as those pasted into the page
    if len(text) > LARGEST_FILE_BYTES:
        raise ScenarioError(f"{source}: more than the {LARGEST_FILE_BYTES / 1e6:g} MB allowed.")
    document = read_toml(text, source)
    try:
        # the changes come before the checks: keys that only fit together can be changed together
        return scenario_from_document(change_document(document, changes or {}), source, folder)
    except RecursionError:
        raise ScenarioError(f"{source}: {NESTED_TOO_DEEPLY}") from None


def format_scenario(scenario: Scenario) -> str:
    """Return the TOML text that gives exactly `scenario` when it is read again."""
    return tomli_w.dumps(document_of(scenario))


def save_scenario(scenario: Scenario, path: str | Path) -> None:
    """Write `scenario` to a TOML file that gives exactly it when it is read again."""
    write_text(path, format_scenario(scenario))
