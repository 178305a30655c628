"""What a page computes, as a program: what it lays over the scenario, and the Python that gives its number."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class Program:
    """What turns a scenario into the number of a page.

    Parameters
    ----------
    imports : mapping of str to str
        What it needs, by the name of what is imported; the module is the value.
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
    """What a page computes.

    Parameters
    ----------
    program : Program
    changes : mapping
        What it lays over the scenario, by the keys of the file.
    untold : str
        A sentence on what of it no scenario file can say; empty where one says all.
    """

    program: Program
    changes: Mapping[str, Any] = field(default_factory=dict)
    untold: str = ""


def simulation(name: str, module: str) -> Program:
    """Return the program of a simulation of the core."""
    body = "ride = simulate(scenario)\nprint(ride.actual.energy_kwh)\n"
    return Program({f"{name} as simulate": f"railjoule.core.simulation.{module}"}, body, "simulate")


SOLVE = Program({"solve": "railjoule.core"}, "run = solve(scenario)\nprint(run.energy_kwh)\n", "solve")
