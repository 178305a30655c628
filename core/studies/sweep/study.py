"""What a sweep is, whole and checked before its first run, and the fingerprint that its results are told by."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, cast

from railjoule.core.budget import Budget, current_budget
from railjoule.core.errors import ScenarioError
from railjoule.core.scenario import Scenario, format_scenario, parse_scenario
from railjoule.core.scenario._sentences import show
from railjoule.core.strategy import STRATEGIES
from railjoule.core.studies.sweep.columns import DEFAULT_COLUMNS, require_columns
from railjoule.core.studies.sweep.engine import Plan
from railjoule.core.studies.sweep.fields import Field, corners_hold, fields_of
from railjoule.core.studies.sweep.sampling import Method, Sampler, level_count
from railjoule.core.studies.sweep.version import solver_version

SCENARIO_FILE = "scenario.toml"


@dataclass(frozen=True, eq=False)
class Study:
    """A sweep to be made: which numbers of a scenario vary, how they are drawn, and what is told of each run.

    Parameters
    ----------
    scenario : Scenario
        Where all other numbers stand.
    fields : tuple of Field
        What varies, and between which values.
    sample : int
        How many rows.
    method : str
        How they are drawn.
    seed : int
    strategy : str
        Who makes the runs.
    columns : tuple of str
        What is told of each run.
    budget : Budget
        What each run may take.
    """

    scenario: Scenario
    fields: tuple[Field, ...]
    sample: int
    method: Method
    seed: int
    strategy: str
    columns: tuple[str, ...]
    budget: Budget

    @property
    def width(self) -> int:
        """How many numbers a row has."""
        return len(self.fields) + len(self.columns)

    @cached_property
    def identity(self) -> dict[str, Any]:
        """What decides each number of the table, as plain values; the last is the version of all that computes them."""
        return {
            "scenario": format_scenario(self.scenario),
            "over": {field.name: [field.low, field.high] for field in self.fields},
            "sample": self.sample,
            "method": self.method,
            "seed": self.seed,
            "strategy": self.strategy,
            "columns": list(self.columns),
            "solver": solver_version(),
        }

    @cached_property
    def fingerprint(self) -> str:
        """32 hexadecimal digits that change with anything that decides a number of the table."""
        # the order of the fields counts: each has a coordinate of the sample
        return hashlib.sha256(json.dumps(self.identity).encode()).hexdigest()[:32]

    @cached_property
    def plan(self) -> Plan:
        """What its rows have in common, for who solves them."""
        key = f"{self.fingerprint} {self.budget.name}"
        patched = corners_hold(self.scenario, self.fields)
        return Plan(
            key, solver_version(), self.scenario, self.fields, self.strategy, self.columns, patched, self.budget
        )

    def level_count(self, field: Field) -> int | None:
        """Return how many values a field takes; None if any of its range."""
        return level_count(field, self.sample, len(self.fields), self.method)

    def sampler(self) -> Sampler:
        """Return what draws its rows from the first one on."""
        return Sampler(self.fields, self.sample, self.method, self.seed)


def study_of(
    scenario: Scenario,
    over: Mapping[str, tuple[float, float]],
    sample: int,
    method: str = "sobol",
    *,
    seed: int = 0,
    strategy: str | None = None,
    columns: Sequence[str] = DEFAULT_COLUMNS,
) -> Study:
    """Return a sweep to be made; parameters as `sweep`.

    Raises
    ------
    ScenarioError
        If a field is unknown or no number, its range leads out of its bounds, or there is no such method, strategy or
        column.
    """
    name = strategy or scenario.strategy
    if name not in STRATEGIES:
        raise ScenarioError(f"strategy = {show(name)} must be one of {', '.join(STRATEGIES)}.")
    require_columns(columns)
    fields = fields_of(scenario, over)
    # a sampler that can be made is what shows that method, seed and number of rows are right
    Sampler(fields, sample, method, seed)
    return Study(scenario, fields, sample, cast("Method", method), seed, name, tuple(columns), current_budget())


def study_from(identity: Mapping[str, Any]) -> Study:
    """Return the sweep that an `identity` tells of; errors as `study_of`, if what is kept is none of today's."""
    scenario = parse_scenario(identity["scenario"], SCENARIO_FILE)
    over = {name: (low, high) for name, (low, high) in identity["over"].items()}
    return study_of(
        scenario,
        over,
        identity["sample"],
        identity["method"],
        seed=identity["seed"],
        strategy=identity["strategy"],
        columns=identity["columns"],
    )
