"""The effect of a vehicle's assumed values: the energy in the same time if each of them is wrong by a fifth."""

from collections.abc import Iterator, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass

import numpy as np

from railjoule.core.errors import ScenarioError
from railjoule.core.scenario import Scenario
from railjoule.core.strategies import prepare_task, run_strategy
from railjoule.core.studies.rows import RowByRow, rows_in_order
from railjoule.core.studies.table import StudyTable

CHANGE = 0.2
LOSSES = ("traction_efficiency", "braking_efficiency")
"""Values near 1 of which the distance to 1, the losses, is varied."""


@dataclass(frozen=True)
class Assumption:
    """Assumed values with one basis, which are varied together."""

    keys: tuple[str, ...]
    values: tuple[float, ...]
    basis: str

    @property
    def label(self) -> str:
        """The key of the value, or of several values the table with all of them."""
        return self.keys[0] if len(self.keys) == 1 else ", ".join((self.keys[0], *map(_name, self.keys[1:])))

    def changes(self, change: float) -> dict[str, float]:
        """Return the keys with values that are off by a share; of an efficiency, its losses are."""
        return {
            key: 1 - (1 - value) * (1 + change) if _name(key) in LOSSES else value * (1 + change)
            for key, value in zip(self.keys, self.values, strict=True)
        }


def assumptions(scenario: Scenario) -> tuple[Assumption, ...]:
    """Return the assumptions of a scenario's vehicle that are in force, by their basis."""
    groups: dict[tuple[str, str], list[tuple[str, float]]] = {}
    for one in scenario.vehicle.assumptions:
        # values of one basis belong together where they stand in one table
        groups.setdefault((one.basis, one.key.rpartition(".")[0]), []).append((one.key, one.value))
    return tuple(
        Assumption(tuple(key for key, _ in pairs), tuple(value for _, value in pairs), basis)
        for (basis, _), pairs in groups.items()
    )


def assumption_effects(scenario: Scenario, change: float = CHANGE, executor: Executor | None = None) -> StudyTable:
    """Return the energy if each assumption is off by a share, those with the largest effect first.

    NaN stands where the value is not possible, as a share above 1, or where the train cannot keep its time; `reasons`
    of the table lists the causes.

    Parameters
    ----------
    scenario : Scenario
        Its strategy drives in its time; its vehicle has assumed values.
    change : float
        Share by which the values are off, both ways, above 0 and below 1.
    executor : Executor, optional
        Computes the runs; by default this thread.

    Raises
    ------
    ScenarioError
        If the vehicle has no assumed values, or the share is out of bounds.
    RailjouleError
        As in `railjoule.core.solve` for the scenario itself.
    """
    *_, last = assumption_steps(scenario, change, executor)
    return last


def assumption_steps(
    scenario: Scenario, change: float = CHANGE, executor: Executor | None = None
) -> Iterator[StudyTable]:
    """Yield the table of `assumption_effects` after each run; arguments and errors as there."""
    found = assumptions(scenario)
    if not found:
        raise ScenarioError("vehicle.assumed has no value that is in force: nothing of the vehicle is assumed.")
    if not 0 < change < 1:
        raise ScenarioError(f"the change of the assumptions = {change:g} must be above 0 and below 1.")
    energy = run_strategy(prepare_task(scenario), scenario.strategy).energy_kwh

    def run(sample: Sequence[float]) -> tuple[float]:
        other = scenario.replace(found[int(sample[0])].changes(sample[1]))
        return (run_strategy(prepare_task(other), other.strategy).energy_kwh,)

    samples = np.array([(index, sign * change) for index in range(len(found)) for sign in (-1, 1)])
    for rows in rows_in_order(RowByRow(run, 1), samples, executor):
        values = np.full(len(samples), np.nan)
        values[: len(rows.values)] = rows.values[:, 0]
        yield _table(scenario, found, energy, values.reshape(-1, 2), rows.reasons, change)


def _table(
    scenario: Scenario,
    found: Sequence[Assumption],
    energy_kwh: float,
    values: "np.ndarray[tuple[int, int], np.dtype[np.float64]]",
    reasons: dict[int, str],
    change: float,
) -> StudyTable:
    difference = values / energy_kwh - 1
    known = np.where(np.isnan(difference), 0.0, np.abs(difference))
    order = np.argsort(-known.max(axis=1), kind="stable")
    texts = tuple(
        " ".join(reasons[row].removeprefix("scenario: ") for row in (2 * k, 2 * k + 1) if row in reasons) for k in order
    )
    columns = {
        "lower_value_kwh": values[order, 0],
        "higher_value_kwh": values[order, 1],
        "lower_value_difference": difference[order, 0],
        "higher_value_difference": difference[order, 1],
    }
    attributes = {
        "title": scenario.title,
        "strategy": scenario.strategy,
        "energy_kwh": energy_kwh,
        "change": change,
        "bases": tuple(found[k].basis for k in order),
        "reasons": texts,
    }
    done = int(np.count_nonzero(~np.isnan(values)) + len(reasons))
    return StudyTable(scenario, {"assumption": tuple(found[k].label for k in order)}, columns, attributes, done)


def _name(key: str) -> str:
    return key.rpartition(".")[2]
