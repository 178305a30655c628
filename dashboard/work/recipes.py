"""The runs of recipes: of what was pinned before the page was opened."""

from dataclasses import dataclass
from typing import Protocol

from railjoule.core import Scenario, StrategyRefusedError, Trajectory
from railjoule.core.motion import build_meshed_line
from railjoule.core.simulation.manual import drive_manually, read_commands
from railjoule.dashboard.work.runs import RunsRequest, compute_runs
from railjoule.dashboard.work.simple_advice import simple_run


class Recipe(Protocol):
    """How a run comes about."""

    @property
    def strategy(self) -> str:
        """Who drives, unless it is simple advice."""

    @property
    def simple(self) -> int:
        """Of simple advice, how often the regime may change between two stops; else 0."""

    @property
    def driven(self) -> str:
        """Of a run driven by hand, its commands; else empty."""

    def scenario(self) -> Scenario:
        """Return the scenario of the run."""


@dataclass(frozen=True, eq=False)
class RecipeRun:
    """A recipe and its run."""

    recipe: Recipe
    trajectory: Trajectory


def compute_recipes(recipes: tuple[Recipe, ...]) -> tuple[RecipeRun, ...]:
    """Return the runs of recipes, each with the bound of its scenario's optimum.

    Raises
    ------
    RailjouleError
        If one of them cannot be run.
    """
    return tuple(RecipeRun(recipe, _run(recipe)) for recipe in recipes)


def _run(recipe: Recipe) -> Trajectory:
    scenario, strategy = recipe.scenario(), recipe.strategy
    if recipe.simple:
        return simple_run(scenario, recipe.simple)
    if recipe.driven:
        mesh = build_meshed_line(scenario)
        return drive_manually(scenario, mesh, read_commands(recipe.driven, mesh.cell_count))
    runs = compute_runs(RunsRequest(scenario, (strategy,)))
    if strategy not in runs.runs:
        raise StrategyRefusedError(f"{strategy} {runs.refused[strategy]}")
    return runs.runs[strategy]
