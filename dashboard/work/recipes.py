"""The runs of recipes: of what was pinned before the page was opened."""

from dataclasses import dataclass
from typing import Protocol

from railjoule.core import Scenario, StrategyRefusedError, Trajectory
from railjoule.core.scenario import StrategyName
from railjoule.dashboard.work.runs import RunsRequest, compute_runs


class Recipe(Protocol):
    """How a run comes about."""

    @property
    def strategy(self) -> StrategyName:
        """Who drives."""

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
    return tuple(RecipeRun(recipe, _run(recipe.scenario(), recipe.strategy)) for recipe in recipes)


def _run(scenario: Scenario, strategy: StrategyName) -> Trajectory:
    runs = compute_runs(RunsRequest(scenario, (strategy,)))
    if strategy not in runs.runs:
        raise StrategyRefusedError(f"{strategy} {runs.refused[strategy]}")
    return runs.runs[strategy]
