"""The stopping place of a train with errors of measurement, with precision braking and without it.

Source: Liashenko, Yatsko 2025, Figure 2 and the sentence after (11): precision braking withstands errors of the speed
sensor and of the distances L_pb, L_c and L_st. An error of L_pb is one of the place of D1, an error of L_c one of D2
against D1, an error of L_st one of D3. Without precision braking the train has neither sensors nor the target curve:
it stops where it estimates to be at the stop.
"""

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.compilation import require_compiled
from railjoule.core.errors import InfeasibleLineError
from railjoule.core.scenario import Scenario
from railjoule.core.simulation.following import follow, plan_for
from railjoule.core.studies.labelled import label_rows
from railjoule.core.studies.montecarlo import SENSOR_ERRORS, UNITS, draw, drawn_scenario
from railjoule.core.studies.sweep.rows import RowByRow
from railjoule.core.studies.sweep.running import all_rows
from railjoule.core.trajectory import Trajectory

if TYPE_CHECKING:
    import xarray

MEASUREMENTS = ("coordinate_error_m", "speed_error", *SENSOR_ERRORS)
"""The errors of measurement: of the position at the start, of the speed, and of the places of D1, D2 and D3."""
COVERAGE = 0.95
"""Of the values of an error that is varied by itself, and of the half-width of the stopping place."""


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
        How far beyond the stop the train stands with precision braking and without [m]; NaN where it does not arrive.
    """

    quantity: str
    value: float
    with_m: float
    without_m: float


@dataclass(frozen=True)
class StopSpread:
    """How much the stopping place varies.

    Parameters
    ----------
    mean_m, deviation_m : float
        Mean and standard deviation of the stopping error [m].
    half_width_m : float
        Within this distance of the stop 95 % of the runs stand [m].
    largest_m : float
        The largest stopping error in size [m].
    """

    mean_m: float
    deviation_m: float
    half_width_m: float
    largest_m: float


@dataclass(frozen=True, eq=False)
class BrakingSensors:
    """Stopping errors with and without precision braking.

    Parameters
    ----------
    scenario : Scenario
        Sensors in `simulation`, distributions of their errors in `montecarlo`.
    effects : tuple of ErrorEffect
        Each error by itself, at both ends of the middle 95 % of its distribution.
    drawn : dict
        The errors by `MEASUREMENTS`, all drawn together: arrays of shape (runs,).
    with_m, without_m : array of shape (runs,)
        Stopping errors of these runs [m]; NaN where a train does not arrive.
    """

    scenario: Scenario
    effects: tuple[ErrorEffect, ...]
    drawn: Mapping[str, FloatArray]
    with_m: FloatArray
    without_m: FloatArray

    @property
    def spread_with(self) -> StopSpread:
        """The spread of the stopping place with precision braking."""
        return _spread(self.with_m)

    @property
    def spread_without(self) -> StopSpread:
        """The spread of the stopping place without precision braking."""
        return _spread(self.without_m)

    @property
    def reduction(self) -> float:
        """Standard deviation of the stopping error without precision braking over that with it."""
        deviation = self.spread_with.deviation_m
        return self.spread_without.deviation_m / deviation if deviation else np.inf

    def to_dataset(self) -> "xarray.Dataset":
        """Return the runs with labels and units."""
        columns = {name: (self.drawn[name], UNITS.get(name, "1")) for name in MEASUREMENTS}
        columns |= {
            "stop_error_m": (self.with_m, "m"),
            "stop_error_without_sensors_m": (self.without_m, "m"),
        }
        return label_rows(
            "run",
            columns,
            {"title": self.scenario.title, "seed": self.scenario.montecarlo.seed},
        )


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
        As `railjoule.core.solve` for the plan.
    """
    require_compiled()
    both = [_with_precision(scenario, is_on) for is_on in (True, False)]
    plans = [plan_for(one) for one in both]
    drawn = {name: values for name, values in draw(scenario).items() if name in MEASUREMENTS}
    single = [
        (name, float(value))
        for name in MEASUREMENTS
        for value in np.quantile(drawn[name], [0.5 - 0.5 * COVERAGE, 0.5 + 0.5 * COVERAGE])
    ]
    planned = _planned(scenario)
    # one row for each error by itself, then the runs in which all of them are drawn
    rows = [[value if name == one else planned[one] for one in MEASUREMENTS] for name, value in single]
    samples = np.vstack([rows, np.column_stack([drawn[name] for name in MEASUREMENTS])])
    work = RowByRow(_Stops(both, plans).run, len(both), ())
    errors = all_rows(work, samples, executor).values
    effects = [ErrorEffect(*one, *map(float, pair)) for one, pair in zip(single, errors[: len(single)], strict=True)]
    runs = errors[len(single) :]
    return BrakingSensors(scenario, tuple(effects), drawn, frozen_array(runs[:, 0]), frozen_array(runs[:, 1]))


class _Stops:
    """Follows the plans with and without precision braking under the same errors of measurement."""

    def __init__(self, scenarios: Sequence[Scenario], plans: Sequence[Trajectory]) -> None:
        self._scenarios, self._plans = scenarios, plans

    def run(self, errors: Sequence[float]) -> list[float]:
        """Return the stopping errors [m], with precision braking first; of several stops the largest one in size."""
        drawn = dict(zip(MEASUREMENTS, errors, strict=True))
        pairs = zip(self._plans, self._scenarios, strict=True)
        return [_stop_error(plan, drawn_scenario(scenario, drawn)) for plan, scenario in pairs]


def _stop_error(plan: Trajectory, scenario: Scenario) -> float:
    try:
        return max(follow(plan, scenario).stop_errors_m, key=abs)
    except InfeasibleLineError:
        return np.nan


def _with_precision(scenario: Scenario, is_on: bool) -> Scenario:
    options = scenario.simulation.model_copy(update={"target_braking": is_on})
    return scenario.model_copy(update={"simulation": options})


def _planned(scenario: Scenario) -> dict[str, float]:
    """Return the errors of measurement that the scenario itself has."""
    options = scenario.simulation
    sensors = dict(zip(SENSOR_ERRORS, options.sensor_errors_m, strict=True))
    return {
        "coordinate_error_m": scenario.disturbance.coordinate_error_m,
        "speed_error": options.speed_error,
        **sensors,
    }


def _spread(errors_m: FloatArray) -> StopSpread:
    """Return the spread of stopping errors [m]; NaN where no train arrives."""
    known = errors_m[np.isfinite(errors_m)]
    if not len(known):
        return StopSpread(np.nan, np.nan, np.nan, np.nan)
    size = np.abs(known)
    return StopSpread(float(known.mean()), float(known.std()), float(np.quantile(size, COVERAGE)), float(size.max()))
