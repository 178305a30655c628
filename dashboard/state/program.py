"""The program of a page: its changes of the scenario, and the Python that gives its number."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any


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
