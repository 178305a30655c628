"""What the page in sight computes: what it lays over the scenario, and the program that gives its number.

Share, the report and the copied command line read it here, so that none of them tells another run than the page shows.
"""

from collections.abc import Mapping
from typing import Any

from railjoule.core import RailjouleError
from railjoule.core.citation import bibtex
from railjoule.core.scenario import to_document
from railjoule.core.scenario.disturbance import Disturbance
from railjoule.core.strategy import STRATEGIES
from railjoule.dashboard.provenance import about_text
from railjoule.dashboard.state.program import SOLVE, PageRun, simulation
from railjoule.dashboard.state.recipes import Recipe, as_command
from railjoule.dashboard.state.workbench import Workbench

ACTUAL_RUN = simulation("actual_run", "actual_run")
FOLLOWING = simulation("simulate_following", "following")


def page_run(state: Workbench) -> PageRun:
    """Return what the page in sight computes."""
    computed: PageRun = state.pages[state.page].page_run()
    return computed


def page_recipe(state: Workbench) -> Recipe:
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


def about_numbers(state: Workbench) -> str:
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


def actual_run(state: Workbench, changes: Mapping[str, Any]) -> PageRun:
    """Return the run of a day; where nothing is otherwise than planned, that is the plan.

    The commands would follow that plan all the same, and under target braking curves if the scenario has them.
    """
    if not _is_as_planned(state, changes):
        return PageRun(ACTUAL_RUN, {**followed(state), **changes})
    nothing_else: Mapping[str, Any] = {"disturbance": {}} if state.scenario.edited.disturbance != Disturbance() else {}
    return PageRun(SOLVE, {"strategy": changes["strategy"], **followed(state), **nothing_else})


def _is_as_planned(state: Workbench, changes: Mapping[str, Any]) -> bool:
    """Return whether nothing of a day differs from the plan: a later departure shifts the run and nothing else."""
    day, measured = state.scenario.edited.disturbance, state.scenario.edited.simulation
    load = changes.get("disturbance.actual_load_factor", day.actual_load_factor)
    return (
        not state.day.events
        and load in {None, state.scenario.load_percent / 100}
        and changes.get("disturbance.coordinate_error_m", day.coordinate_error_m) == 0
        and changes.get("simulation.speed_error", measured.speed_error) == 0
        and not any(changes.get("simulation.sensor_errors_m", measured.sensor_errors_m) or ())
        and day.resistance_factor == day.line_voltage_factor == 1
        and day.rail_condition in {None, state.scenario.edited.line.rail_condition}
    )


def followed(state: Workbench) -> Mapping[str, Any]:
    """Return what keeps a command from simulating the control loop that a file may ask for."""
    in_loop = state.scenario.edited.simulation.kind == "field_oriented"
    return {"simulation.kind": "following"} if in_loop else {}
