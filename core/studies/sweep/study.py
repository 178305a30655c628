"""A study of very many runs: a sweep that is checked before its first run, and the fingerprint of its results."""

import hashlib
import json
import platform
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from importlib.metadata import version
from pathlib import Path
from typing import Any, cast

from railjoule.core.arrays import FloatArray
from railjoule.core.budget import Budget, current_budget
from railjoule.core.errors import ScenarioError
from railjoule.core.kernel_cache import source_hash
from railjoule.core.scenario import Scenario, format_scenario, parse_scenario
from railjoule.core.scenario._sentences import shorten, show, suggestion
from railjoule.core.strategy import STRATEGIES
from railjoule.core.studies.sweep.fields import (
    Field,
    Method,
    draw_rows,
    levels_per_field,
    parse_fields,
    require_sample,
)
from railjoule.core.units import J_PER_KWH

SCENARIO_FILE = "scenario.toml"
CORE = Path(__file__).parents[2]
LIBRARIES = ("numba", "numpy", "scipy")
"""Libraries whose releases may change the last digits of a run, or a row of a sample."""
Column = Callable[[Any], float | None]
"""Returns a result of a run, a `Trajectory` or `MeshOptimum`; None where it is unknown."""


def _loss(kind: str) -> Column:
    # zero for drives without this kind of loss
    return lambda run: run.energy.losses_j.get(kind, 0.0) / J_PER_KWH


def _part(name: str) -> Column:
    return lambda run: getattr(run.energy, name) / J_PER_KWH


DEFAULT_COLUMNS = ("energy_kwh", "lower_bound_kwh", "travel_time_s", "price_of_time_w")
COLUMNS: dict[str, Column] = {
    "energy_kwh": lambda run: run.energy_kwh,
    "lower_bound_kwh": lambda run: run.lower_bound_kwh,
    "travel_time_s": lambda run: run.travel_time_s,
    "price_of_time_w": lambda run: run.price_of_time_w,
    "max_speed_kmh": lambda run: run.max_speed_kmh,
    "traction_energy_kwh": _part("traction_j"),
    "recuperated_kwh": _part("recuperated_j"),
    "auxiliary_kwh": _part("auxiliary_j"),
    "running_resistance_kwh": _part("running_resistance_j"),
    "curve_resistance_kwh": _part("curve_resistance_j"),
    "kinetic_kwh": _part("kinetic_j"),
    "potential_kwh": _part("potential_j"),
    "losses_kwh": lambda run: sum(run.energy.losses_j.values()) / J_PER_KWH,
    "brake_resistors_kwh": _loss("brake_resistors"),
    "friction_brakes_kwh": _loss("friction_brakes"),
}
"""All columns by name; `losses_kwh` is the sum of the losses of drive, resistors and friction brakes."""


@cache
def solver_version() -> str:
    """Return everything that the last digits of a run depend on: sources, libraries, kind of processor."""
    libraries = " ".join(f"{name} {version(name)}" for name in LIBRARIES)
    # not the exact model of the processor: the nodes of a cluster differ in it, and their results hardly ever
    return f"core {source_hash(CORE)} {libraries} {platform.machine()}"


@dataclass(frozen=True, eq=False)
class Study:
    """A sweep: the numbers of a scenario that vary, how they are drawn, and the results of each run.

    Parameters
    ----------
    scenario : Scenario
        All other numbers.
    fields : tuple of Field
        The fields that vary, with their ranges.
    sample : int
        Number of rows.
    method : str
        How rows are drawn.
    seed : int
    strategy : str
    columns : tuple of str
        Results of each run.
    budget : Budget
        Budget of each run.
    solver : str
        Version of the solver, which must be the one of the workers.
    """

    scenario: Scenario
    fields: tuple[Field, ...]
    sample: int
    method: Method
    seed: int
    strategy: str
    columns: tuple[str, ...]
    budget: Budget
    solver: str

    @property
    def width(self) -> int:
        """Numbers in a row."""
        return len(self.fields) + len(self.columns)

    @cached_property
    def identity(self) -> dict[str, Any]:
        """Everything that decides a number of the table, as plain values; the last one is the version of the solver."""
        return {
            "scenario": format_scenario(self.scenario),
            "over": {field.name: [field.low, field.high] for field in self.fields},
            "sample": self.sample,
            "method": self.method,
            "seed": self.seed,
            "strategy": self.strategy,
            "columns": list(self.columns),
            "solver": self.solver,
        }

    @cached_property
    def fingerprint(self) -> str:
        """32 hexadecimal digits that change with anything that decides a number of the table."""
        # the order of the fields counts: each has a coordinate of the sample
        return hashlib.sha256(json.dumps(self.identity).encode()).hexdigest()[:32]

    def level_count(self, field: Field) -> int | None:
        """Return the number of values of a field; None for a whole range."""
        if self.method == "grid":
            return levels_per_field(self.sample, len(self.fields))
        return int(field.high - field.low) + 1 if field.whole else None

    def draw(self, first: int, count: int) -> FloatArray:
        """Return the samples of consecutive rows; shape (count, fields)."""
        return draw_rows(self.fields, self.sample, self.method, self.seed, first, count)


def make_study(
    scenario: Scenario,
    over: Mapping[str, tuple[float, float]],
    sample: int,
    method: str = "sobol",
    *,
    seed: int = 0,
    strategy: str | None = None,
    columns: Sequence[str] = DEFAULT_COLUMNS,
) -> Study:
    """Return a checked study; parameters as in `sweep`.

    Raises
    ------
    ScenarioError
        If a field is unknown or not a number, its range exceeds its bounds, or method, strategy or column do not exist.
    """
    name = strategy or scenario.strategy
    if name not in STRATEGIES:
        raise ScenarioError(f"strategy = {show(name)} must be one of {', '.join(STRATEGIES)}.")
    for column in columns:
        if column not in COLUMNS:
            words = suggestion(column, COLUMNS)
            raise ScenarioError(f"there is no column {shorten(column)}: {words}.".replace("?.", "?"))
        if list(columns).count(column) > 1:
            raise ScenarioError(f"the column {column} is named twice.")
    study = Study(
        scenario,
        parse_fields(scenario, over),
        sample,
        cast("Method", method),
        seed,
        name,
        tuple(columns),
        current_budget(),
        solver_version(),
    )
    require_sample(study.fields, sample, method, seed)
    return study


def study_from(identity: Mapping[str, Any]) -> Study:
    """Return the study of an `identity`; errors as in `make_study`, if it does not fit this version."""
    return make_study(
        parse_scenario(identity["scenario"], SCENARIO_FILE),
        {name: (low, high) for name, (low, high) in identity["over"].items()},
        **{key: identity[key] for key in ("sample", "method", "seed", "strategy", "columns")},
    )
