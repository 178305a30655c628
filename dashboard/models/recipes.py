"""What the page in sight computes, as a scenario file, as a Python program and as a command line.

All three give the same numbers as the page.
"""

import json
import re
import shlex
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from railjoule.core import Scenario
from railjoule.core.scenario import format_scenario
from railjoule.dashboard.models.actual import actual_changes, event_changes
from railjoule.dashboard.models.workbench import Workbench

FILE = "scenario.toml"
LONGEST_LINE = 100
BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")
ACTUAL = "Drive, actual run"
SIMULATIONS = {
    ACTUAL: "from railjoule.core.simulate.actual_run import actual_run as simulate",
    "Robustness": "from railjoule.core.simulate.following import simulate_following as simulate",
    "Disturbances": "from railjoule.core.simulate.actual_run import actual_run as simulate",
}
"""Pages on which a train meets another day than planned, and what drives it."""


@dataclass(frozen=True)
class Recipe:
    """A scenario with changes, by the keys of the file, and the command that runs it."""

    preset: str
    opened: Scenario | None
    base: Scenario
    changes: Mapping[str, Any]
    page: str

    @property
    def command(self) -> str:
        """The command of `railjoule`."""
        return "simulate" if self.page in SIMULATIONS else "solve"

    @property
    def scenario(self) -> Scenario:
        """The scenario with its changes.

        Raises
        ------
        ScenarioError
            If they are impossible together.
        """
        return self.base.with_(**self.changes)


def recipe_of(state: Workbench) -> Recipe:
    """Return what the page in sight computes."""
    scenario = state.scenario
    changes = {**scenario.changes, **_strategy(state)}
    page = ACTUAL if state.page == "Drive" and state.actual.on else state.page
    if state.page == "Robustness":
        changes |= state.robustness.changes
    elif state.page == "Disturbances":
        changes |= event_changes(state)
    elif page == ACTUAL:
        changes |= actual_changes(state)
    elif state.page == "Speed limits":
        changes |= state.speed_limits.changes
    return Recipe(scenario.preset, scenario.opened, scenario.base, changes, page)


def _strategy(state: Workbench) -> dict[str, str]:
    chosen = state.chosen_now
    return {} if chosen == state.scenario.base.strategy else {"strategy": chosen}


def as_toml(recipe: Recipe) -> str:
    """Return the scenario file."""
    return format_scenario(recipe.scenario)


def as_python(recipe: Recipe) -> str:
    """Return a program that prints the energy [kWh]."""
    scenario, names, imports = f'load_scenario("{recipe.preset}")', ["load_scenario"], []
    if recipe.opened is not None:
        scenario = f"parse_scenario({_triple(format_scenario(recipe.opened))})"
        names, imports = [], ["from railjoule.core.scenario import parse_scenario"]
    lines = [f"scenario = {scenario}"]
    if recipe.changes:
        changes = "".join(f"    {key!r}: {value!r},\n" for key, value in recipe.changes.items())
        lines.append(f"scenario = scenario.with_(**{{\n{changes}}})")
    if recipe.command == "simulate":
        imports.append(SIMULATIONS[recipe.page])
        lines.append("ride = simulate(scenario)\nprint(ride.actual.energy_kwh)")
    else:
        names.append("solve")
        lines.append("run = solve(scenario)\nprint(run.energy_kwh)")
    first = [f"from railjoule.core import {', '.join(names)}"] if names else []
    return "\n".join([*first, *imports, "", *lines, ""])


def as_command(recipe: Recipe) -> str:
    """Return the command line; what only a file can say is written into one first."""
    removes = any(value is None for value in recipe.changes.values())
    if recipe.opened is not None or removes:
        text = as_toml(recipe)
        return f"cat > {FILE} <<'END_OF_FILE'\n{text}END_OF_FILE\nrailjoule {recipe.command} {FILE}\n"
    words = [shlex.quote(f"{key}={toml_value(value)}") for key, value in recipe.changes.items()]
    head = f"railjoule {recipe.command} {recipe.preset}"
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
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    return repr(value)


def _key(key: str) -> str:
    return key if BARE_KEY.fullmatch(key) else toml_value(key)


def _triple(text: str) -> str:
    """Return a text as a Python literal of several lines."""
    escaped = text.replace("\\", "\\\\").replace('"""', '\\"\\"\\"')
    return f'"""\\\n{escaped}"""'
