"""The recipe of a run: scenario, changes, strategy and program; as a scenario file, in Python and as a command line.

All three texts give the same numbers as the page in sight. Share, the report and the copied command read them here.
"""

import json
import re
import shlex
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from railjoule.core import RailjouleError, Scenario
from railjoule.core.citation import bibtex
from railjoule.core.scenario import format_scenario, to_document
from railjoule.core.scenario.disturbance import Disturbance
from railjoule.core.strategy import STRATEGIES
from railjoule.dashboard.provenance import about_text
from railjoule.dashboard.state.draft import shipped

if TYPE_CHECKING:
    from railjoule.dashboard.workbench import Workbench

FILE = "scenario.toml"
LONGEST_LINE = 100
BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")


@dataclass(frozen=True)
class Program:
    """The Python that turns a scenario into the number of a page.

    Parameters
    ----------
    imports : mapping of str to str
        Its modules, by the name that is imported from each.
    body : str
        Python, which finds the scenario as `scenario` and prints an energy [kWh].
    command : str
        The command of `railjoule` that does the same with a scenario; empty where none does.
    of_scenario : bool
        Whether it runs the page's scenario at all.
    """

    imports: Mapping[str, str]
    body: str
    command: str
    of_scenario: bool = True


@dataclass(frozen=True)
class PageRun:
    """The run of a page.

    Parameters
    ----------
    program : Program
    changes : mapping
        Changes of the scenario, by the keys of the file.
    untold : str
        A sentence on the part that no scenario file can hold; empty if one holds all.
    """

    program: Program
    changes: Mapping[str, Any] = field(default_factory=dict)
    untold: str = ""


def simulation(name: str, module: str) -> Program:
    """Return the program of a simulation of the core."""
    body = "ride = simulate(scenario)\nprint(ride.actual.energy_kwh)\n"
    return Program({f"{name} as simulate": f"railjoule.core.simulation.{module}"}, body, "simulate")


SOLVE = Program({"solve": "railjoule.core"}, "run = solve(scenario)\nprint(run.energy_kwh)\n", "solve")


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
    moved : str
        Of an optimum with a moved instruction the phase and its place in metres, such as 5@1000; empty for all others.
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
    moved: str = ""
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


ACTUAL_RUN = simulation("actual_run", "actual_run")
FOLLOWING = simulation("simulate_following", "following")


def page_run(state: "Workbench") -> PageRun:
    """Return the program of the page in sight."""
    computed: PageRun = state.pages[state.page].page_run()
    return computed


def page_recipe(state: "Workbench") -> Recipe:
    """Return the recipe of the page in sight."""
    scenario, computed = state.scenario, page_run(state)
    document = to_document(scenario.base)
    changes = {
        path: value
        for path, value in {**scenario.changes, **computed.changes}.items()
        # without those that take a key away which the document does not have
        if value is not None or _has(document, path)
    }
    # named only where it differs, as all keys: without changes the command only names the scenario
    if changes.get("strategy") == scenario.base.strategy:
        del changes["strategy"]
    return Recipe(scenario.preset, scenario.opened, changes, program=computed.program, untold=computed.untold)


def about_numbers(state: "Workbench") -> str:
    """Return the text of a file that goes with the numbers of the page in sight."""
    try:
        command = as_command(page_recipe(state))
    except RailjouleError as error:
        command = f"# {error}"
    source = STRATEGIES[state.chosen].source
    return about_text(command, bibtex([source] if source else []))


def _has(document: Mapping[str, Any], path: str) -> bool:
    """Return whether a document has a key at a dotted path."""
    table: Any = document
    for key in path.split("."):
        if not isinstance(table, Mapping) or key not in table:
            return False
        table = table[key]
    return True


def actual_run(state: "Workbench", changes: Mapping[str, Any]) -> PageRun:
    """Return the run of a day; where nothing is otherwise than planned, that is the plan.

    The commands would follow that plan all the same, and under target braking curves if the scenario has them.
    """
    if not _is_as_planned(state, changes):
        return PageRun(ACTUAL_RUN, {**followed(state), **changes})
    nothing_else: Mapping[str, Any] = {"disturbance": {}} if state.scenario.edited.disturbance != Disturbance() else {}
    return PageRun(SOLVE, {"strategy": changes["strategy"], **followed(state), **nothing_else})


def _is_as_planned(state: "Workbench", changes: Mapping[str, Any]) -> bool:
    """Return whether nothing of a day differs from the plan: a later departure shifts the run and nothing else."""
    day, measured = state.scenario.edited.disturbance, state.scenario.edited.simulation
    load = changes.get("disturbance.actual_load_factor", day.actual_load_factor)
    return (
        not state.day.events
        and load in {None, state.scenario.planned_load_percent / 100}
        and changes.get("disturbance.coordinate_error_m", day.coordinate_error_m) == 0
        and changes.get("simulation.speed_error", measured.speed_error) == 0
        and not any(changes.get("simulation.sensor_errors_m", measured.sensor_errors_m) or ())
        and day.resistance_factor == day.line_voltage_factor == 1
        and (day.rail_condition is None or state.scenario.edited.line.all_rail_conditions == {day.rail_condition})
    )


def followed(state: "Workbench") -> Mapping[str, Any]:
    """Return the option that keeps a command from simulating the control loop that a file may request."""
    in_loop = state.scenario.edited.simulation.kind == "field_oriented"
    return {"simulation.kind": "following"} if in_loop else {}
