"""Plans ahead for an on-board computer, which has little time: the strategy and the mesh that suffice for it."""

from dataclasses import replace

from railjoule.core.drive import make_drive
from railjoule.core.errors import SolverError, StrategyRefusedError
from railjoule.core.scenario import Scenario
from railjoule.core.simulation.leg import Leg
from railjoule.core.simulation.replanning import Replanner
from railjoule.core.simulation.train_state import State

REPLAN_S = 0.05
"""A plan ahead is to take no longer [s]."""
# Measured with the shipped scenarios: interior points take 4 microseconds a cell, phases 0.5 ms, Bellman 1 ms
MOST_CELLS, SLOW_CELLS = 5000, {"phases": 60, "bellman": 32}
"""Cells of the mesh ahead, beside those that stops and borders add: in general, and of slow strategies."""


def plan_quickly(state: State, allowed_time_s: float) -> tuple[Leg, str, list[str]]:
    """Return the plan from a state to the end, the strategy that made it, and what it cannot keep.

    Parameters
    ----------
    state : State
    allowed_time_s : float
        Time of the whole run, the accepted delay included [s].

    Raises
    ------
    InfeasibleLineError
        If the line ahead cannot be driven.
    """
    strategies = dict.fromkeys((_quick_strategy(state.scenario), strategy_for_all_lines(state.scenario)))
    refusals: list[StrategyRefusedError | SolverError] = []
    for strategy in strategies:
        planner = Replanner(allowed_time_s)
        try:
            leg = planner.plan(replace(state, scenario=quick_scenario(state, strategy)))
        except (StrategyRefusedError, SolverError) as refusal:
            refusals.append(refusal)
        else:
            return leg, "fastest" if planner.is_fastest else strategy, planner.notes
    raise refusals[-1]


def quick_scenario(state: State, strategy: str) -> Scenario:
    """Return the scenario of a state with a strategy, over cells so long that its plan ahead takes REPLAN_S at most."""
    scenario = state.scenario
    most_cells = SLOW_CELLS.get(strategy, MOST_CELLS)
    mesh_m = max(scenario.solver.mesh_m, (scenario.line.length_m - state.position_m) / most_cells)
    solver = scenario.solver.model_copy(update={"mesh_m": mesh_m})
    return scenario.model_copy(update={"strategy": strategy, "solver": solver})


def _quick_strategy(scenario: Scenario) -> str:
    """Return the scenario's strategy where it is fast, else the one that stands in for it."""
    return scenario.strategy if scenario.strategy in {"phases", "fastest"} else strategy_for_all_lines(scenario)


def strategy_for_all_lines(scenario: Scenario) -> str:
    """Return the fast strategy that takes every line."""
    # the optimum of a drive with idle losses decides where it is on, which takes a tenth of a second and more
    return "bellman" if make_drive(scenario.vehicle.drive).jumps_at_no_effort else "optimal"
