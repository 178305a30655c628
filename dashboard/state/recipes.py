"""The recipe of a run: scenario, changes, strategy and program; as a scenario file, in Python and as a command line.

All three texts give the same numbers as the page.
"""

import json
import re
import shlex
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from railjoule.core import Scenario
from railjoule.core.scenario import format_scenario
from railjoule.dashboard.state.draft import shipped
from railjoule.dashboard.state.program import SOLVE, Program

FILE = "scenario.toml"
LONGEST_LINE = 100
BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")


@dataclass(frozen=True)
class Recipe:
    """How a run comes about: of a pin, of a link, of a report, of a copied program or command.

    Parameters
    ----------
    preset : str or None
        The shipped scenario that it starts from; None where it starts from another one.
    opened : Scenario or None
        The scenario that it starts from where it is not a shipped one.
    changes : mapping
        Keys of the file with their changed values.
    strategy : str
        The strategy of the run, unless it is simple advice.
    simple : int
        Of simple advice, how often the regime may change between two stops; 0 for a run of the strategy.
    recording : str
        Of a measured run the key under which the page holds it, as its file is in no link; empty for all others.
    driven : str
        Of a run driven by hand its commands, such as p0c300b2200; empty for all others.
    program : Program
        The Python and the command that give the number of the page.
    untold : str
        A sentence on the part that no scenario file can hold; empty if one holds all.
    """

    preset: str | None
    opened: Scenario | None
    changes: Mapping[str, Any]
    strategy: str = "optimal"
    simple: int = 0
    recording: str = ""
    driven: str = ""
    program: Program = SOLVE
    untold: str = ""

    @property
    def base(self) -> Scenario:
        """The scenario before its changes."""
        return shipped(self.preset or "") if self.opened is None else self.opened

    @property
    def scenario(self) -> Scenario:
        """The scenario with its changes.

        Raises
        ------
        ScenarioError
            If they are impossible together.
        """
        return self.base.replace(**self.changes) if self.changes else self.base


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
