"""The stopping position of a train with errors of measurement, with precision braking and without it.

Source: Liashenko, Yatsko 2025, Figure 2 and the sentence after (11): precision braking withstands errors of the speed
sensor and of the distances L_pb, L_c and L_st. An error of L_pb is one of the place of D1, an error of L_c one of D2
against D1, an error of L_st one of D3. Without precision braking the train has neither sensors nor the target curve:
it stops where it estimates to be at the stop.
"""

from collections.abc import Sequence
from concurrent.futures import Executor
from dataclasses import dataclass

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.compilation import require_compiled
from railjoule.core.errors import InfeasibleLineError
from railjoule.core.scenario import Scenario
from railjoule.core.simulation.following import follow, plan_for
from railjoule.core.studies.montecarlo import SENSOR_ERRORS, draw, drawn_scenario, planned_values
from railjoule.core.studies.rows import RowByRow, all_rows
from railjoule.core.studies.table import StudyTable
from railjoule.core.trajectory import Trajectory

MEASUREMENTS = ("coordinate_error_m", "speed_error", *SENSOR_ERRORS)
"""The errors of measurement: of the position at the start, of the speed, and of the places of D1, D2 and D3."""
COVERAGE = 0.95
"""Share of the values of an error that is varied by itself, and of the stopping positions within the half width."""


@dataclass(frozen=True)
class ErrorEffect:
    """The stopping errors that one error of measurement causes by itself.

    Parameters
    ----------
    quantity : str
        One of `MEASUREMENTS`.
    value : float
        The error: [m], or the measured speed over the true one, minus 1.
    with_m, without_m : float
        Stopping position beyond the stop with precision braking and without [m]; NaN where the train does not arrive.
    """

    quantity: str
    value: float
    with_m: float
    without_m: float


@dataclass(frozen=True)
class StopSpread:
    """The spread of the stopping position.

    Parameters
    ----------
    deviation_m : float
        Standard deviation of the stopping error [m].
    half_width_m : float
        Distance from the stop that contains 95 % of the runs [m].
    """

    deviation_m: float
    half_width_m: float


@dataclass(frozen=True, eq=False)
class BrakingSensors:
    """Stopping errors with and without precision braking.

    Parameters
    ----------
    table : StudyTable
        A row for each run in which all `MEASUREMENTS` are drawn: the errors of measurement, and the stopping errors
        `stop_error_m` and `stop_error_without_sensors_m` [m]; NaN where a train does not arrive.
    effects : tuple of ErrorEffect
        Each error by itself, at both ends of the middle 95 % of its distribution.
    """

    table: StudyTable
    effects: tuple[ErrorEffect, ...]

    @property
    def spread_with(self) -> StopSpread:
        """The spread of the stopping position with precision braking."""
        return _spread(self.table["stop_error_m"])

    @property
    def spread_without(self) -> StopSpread:
        """The spread of the stopping position without precision braking."""
        return _spread(self.table["stop_error_without_sensors_m"])


def study_braking_sensors(scenario: Scenario, executor: Executor | None = None) -> BrakingSensors:
    """Return the stopping errors that errors of measurement cause, with precision braking and without it.

    Parameters
    ----------
    scenario : Scenario
        The run, its sensors in `simulation`, and in `montecarlo` the distributions of `MEASUREMENTS`, the number of
        runs and the seed. Load, resistance and voltage are those of its `disturbance`; none of them is drawn.
    executor : Executor, optional
        Executor of the runs; by default this thread.

    Raises
    ------
    ScenarioError
        If a distribution has nothing within the bounds of its quantity.
    RailjouleError
        As in `railjoule.core.solve` for the plan.
    """
    require_compiled()
    options = scenario.simulation
    with_and_without = [
        scenario.model_copy(update={"simulation": options.model_copy(update={"target_braking": is_on})})
        for is_on in (True, False)
    ]
    plans = [plan_for(one) for one in with_and_without]
    drawn = {name: values for name, values in draw(scenario).items() if name in MEASUREMENTS}
    single = [
        (name, float(value))
        for name in MEASUREMENTS
        for value in np.quantile(drawn[name], [0.5 - 0.5 * COVERAGE, 0.5 + 0.5 * COVERAGE])
    ]
    planned = planned_values(scenario)
    # one row for each error by itself, then the runs in which all of them are drawn
    rows = [[value if name == one else planned[one] for one in MEASUREMENTS] for name, value in single]
    samples = np.vstack([rows, np.column_stack([drawn[name] for name in MEASUREMENTS])])

    def stop_error(plan: Trajectory, actual: Scenario) -> float:
        # of several stops the largest error in size
        try:
            return max(follow(plan, actual).stop_errors_m, key=abs)
        except InfeasibleLineError:
            return np.nan

    def run(errors: Sequence[float]) -> list[float]:
        actual = [drawn_scenario(one, dict(zip(MEASUREMENTS, errors, strict=True))) for one in with_and_without]
        return [stop_error(*pair) for pair in zip(plans, actual, strict=True)]

    values = all_rows(RowByRow(run, len(plans), ()), samples, executor).values
    effects = [ErrorEffect(*one, *map(float, pair)) for one, pair in zip(single, values[: len(single)], strict=True)]
    with_m, without_m = values[len(single) :].T
    table = StudyTable(
        scenario,
        {"run": range(len(with_m))},
        {**drawn, "stop_error_m": with_m, "stop_error_without_sensors_m": without_m},
        {"title": scenario.title, "seed": scenario.montecarlo.seed},
        len(with_m),
    )
    return BrakingSensors(table, tuple(effects))


def _spread(errors_m: FloatArray) -> StopSpread:
    """Return the spread of stopping errors [m]; NaN where no train arrives."""
    known = errors_m[np.isfinite(errors_m)]
    if not len(known):
        return StopSpread(np.nan, np.nan)
    return StopSpread(float(known.std()), float(np.quantile(np.abs(known), COVERAGE)))
