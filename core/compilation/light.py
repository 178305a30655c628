"""Which runs Python computes within a second or two, before the solver is compiled."""

from railjoule.core.scenario import Scenario
from railjoule.core.scenario.drive import ConstantEfficiency, CopperLoss
from railjoule.core.strategy import STRATEGIES

NO_IDLE_LOSSES = (ConstantEfficiency, CopperLoss)
LIGHT_CELLS = 1500
"""An interpreted optimum takes 1.1 ms a cell with its bound, whichever strategy is measured against it."""


def estimated_cells(scenario: Scenario) -> float:
    """Return about how many cells the mesh of a scenario has, without making it."""
    # no cell goes across a border: each section ends with a shorter one
    return scenario.line.length_m / scenario.solver.mesh_m + len(scenario.line.sections)


def needs_compiler(scenario: Scenario, *strategies: str) -> bool:
    """Return whether any of some strategies would take more than about two seconds without compiled code.

    Drives with idle losses decide where they are on, which takes a few hundred times the work of an optimum.
    """
    return (
        not isinstance(scenario.vehicle.drive, NO_IDLE_LOSSES)
        or estimated_cells(scenario) > LIGHT_CELLS
        or not all(STRATEGIES[name].is_light for name in strategies)
    )
