"""What the page in sight computes, as a scenario file, as a Python program and as a command line.

All three give the same numbers as the page.
"""

import json
import re
import shlex
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from railjoule.core import RailjouleError, Scenario
from railjoule.core.citation import bibtex
from railjoule.core.scenario import format_scenario, to_document
from railjoule.core.strategy import STRATEGIES
from railjoule.dashboard.provenance import about_text
from railjoule.dashboard.state.program import Program
from railjoule.dashboard.state.programs import page_run
from railjoule.dashboard.state.workbench import Workbench

FILE = "scenario.toml"
LONGEST_LINE = 100
BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")


@dataclass(frozen=True)
class Recipe:
    """A scenario with changes, by the keys of the file, and the program that gives the page's number.

    `untold` says what of it a scenario file cannot; empty where one says all.
    """

    preset: str
    opened: Scenario | None
    base: Scenario
    changes: Mapping[str, Any]
    program: Program
    untold: str = ""

    @property
    def scenario(self) -> Scenario:
        """The scenario with its changes.

        Raises
        ------
        ScenarioError
            If they are impossible together.
        """
        return self.base.replace(**self.changes)


def recipe_of(state: Workbench) -> Recipe:
    """Return what the page in sight computes."""
    scenario, computed = state.scenario, page_run(state)
    changes = _effective({**scenario.changes, **computed.changes}, to_document(scenario.base))
    # named only where it differs, as all keys: without changes the command is the name of the scenario alone
    if changes.get("strategy") == scenario.base.strategy:
        del changes["strategy"]
    return Recipe(scenario.preset, scenario.opened, scenario.base, changes, computed.program, computed.untold)


def _effective(changes: Mapping[str, Any], document: Mapping[str, Any]) -> dict[str, Any]:
    """Return changes without those that take a key away which the document does not have."""

    def has(path: str) -> bool:
        table: Any = document
        for key in path.split("."):
            if not isinstance(table, Mapping) or key not in table:
                return False
            table = table[key]
        return True

    return {path: value for path, value in changes.items() if value is not None or has(path)}


def as_toml(recipe: Recipe) -> str:
    """Return the scenario file."""
    return format_scenario(recipe.scenario)


def as_python(recipe: Recipe) -> str:
    """Return a program that prints the energy [kWh]."""
    program = recipe.program
    names: dict[str, list[str]] = {}
    lines = []
    if program.of_scenario:
        if recipe.opened is None:
            names["railjoule.core"] = ["load_scenario"]
            lines = [f'scenario = load_scenario("{recipe.preset}")']
        else:
            names["railjoule.core.scenario"] = ["parse_scenario"]
            lines = [f"scenario = parse_scenario({_triple(format_scenario(recipe.opened))})"]
        if recipe.changes:
            changes = "".join(f"    {key!r}: {value!r},\n" for key, value in recipe.changes.items())
            lines.append(f"scenario = scenario.replace(**{{\n{changes}}})")
    for name, module in program.imports.items():
        names.setdefault(module, []).append(name)
    imports = [f"from {module} import {', '.join(imported)}" for module, imported in sorted(names.items())]
    return "\n".join([*imports, "", *lines, program.body])


def as_command(recipe: Recipe) -> str:
    """Return the command line; what only a file can say is written into one first."""
    command = recipe.program.command
    if not command:
        # a name of a stranger's scenario must not end the comment: what follows it would be a command
        return f"# No command line gives this: {' '.join(recipe.untold.split())}\n# The Python program does.\n"
    if not recipe.program.of_scenario:
        return f"railjoule {command}\n"
    # TOML has no null, so that --set cannot take a key away: a file leaves it out
    removes = any(value is None for value in recipe.changes.values())
    if recipe.opened is not None or removes:
        text = as_toml(recipe)
        # in quotes, the shell leaves all signs of the text as they are
        return f"cat > {FILE} <<'END_OF_FILE'\n{text}END_OF_FILE\nrailjoule {command} {FILE}\n"
    words = [shlex.quote(f"{key}={toml_value(value)}") for key, value in recipe.changes.items()]
    head = f"railjoule {command} {recipe.preset}"
    if not words:
        return f"{head}\n"
    line = f"{head} --set {' '.join(words)}"
    return f"{line}\n" if len(line) <= LONGEST_LINE else f"{head} --set \\\n  " + " \\\n  ".join(words) + "\n"


def about_numbers(state: Workbench) -> str:
    """Return the text of a file that goes with the numbers of the page in sight."""
    try:
        command = as_command(recipe_of(state))
    except RailjouleError as error:
        command = f"# {error}"
    source = STRATEGIES[state.chosen].source
    return about_text(command, bibtex([source] if source else []))


def toml_value(value: Any) -> str:
    """Return a plain value as TOML in one line."""
    if isinstance(value, Mapping):
        pairs = (f"{_key(key)} = {toml_value(one)}" for key, one in value.items() if one is not None)
        return "{" + ", ".join(pairs) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(toml_value(one) for one in value) + "]"
    if isinstance(value, (bool, str)):
        # the one sign that JSON takes as it is and TOML does not
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    return repr(value)


def _key(key: str) -> str:
    return key if BARE_KEY.fullmatch(key) else toml_value(key)


def _triple(text: str) -> str:
    """Return a text as a Python literal of several lines."""
    # backslashes first: those that escape quotes must not be doubled
    escaped = text.replace("\\", "\\\\").replace('"""', '\\"\\"\\"')
    # a line break right after the quotes would be part of the text, unless a backslash stands before it
    return f'"""\\\n{escaped}"""'
