"""What a fit leaves open means for what follows: distributions for Monte Carlo, and the spread of the optimum."""

from dataclasses import dataclass

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.errors import RailjouleError, RecordingError
from railjoule.core.identification.fit import Fit
from railjoule.core.identification.parameters import RESISTANCE
from railjoule.core.scenario import Scenario
from railjoule.core.scenario.distribution import LogNormal
from railjoule.core.strategies import solve

MOST_DRAWS = 10_000
# a distribution of no width would be a fixed value, which is another kind
LEAST_DEVIATION = 1e-4
"""Of the logarithm of the resistance factor."""


@dataclass(frozen=True, eq=False)
class OptimumSpread:
    """The optimum of a scenario over what a fit leaves open.

    Parameters
    ----------
    energy_kwh : array of shape (draws,)
        Energy of the optimum for each draw of the parameters [kWh]; NaN where there is none.
    """

    energy_kwh: FloatArray

    @property
    def mean_kwh(self) -> float:
        """Mean energy [kWh]."""
        return float(np.nanmean(self.energy_kwh))

    @property
    def interval_kwh(self) -> tuple[float, float]:
        """Ends of the interval that holds 95 % of the draws [kWh]."""
        low, high = np.nanquantile(self.energy_kwh, [0.025, 0.975])
        return float(low), float(high)


def draw_parameters(fit: Fit, draws: int, seed: int = 1) -> list[dict[str, float]]:
    """Return draws of all parameters: the free ones from the normal distribution of the fit.

    A draw outside the range that a train can have becomes the nearest one within, by the distance of the fit.

    Raises
    ------
    RecordingError
        If the runs do not determine some of them at all: no distribution follows from that.
    """
    if not 1 <= draws <= MOST_DRAWS:
        raise RecordingError(f"draws = {draws} must lie within 1 to {MOST_DRAWS}.")
    if not np.all(np.isfinite(fit.covariance)) or any(_is_open(fit, name) for name in fit.undetermined):
        raise RecordingError(" ".join(fit.sentences))
    estimate, names = fit.estimate, [parameter.name for parameter in fit.parameters]
    random = np.random.default_rng(seed)
    drawn = random.multivariate_normal(estimate.estimate, fit.covariance, size=draws, method="eigh")
    rows = [estimate.nearest(row)[0].tolist() for row in drawn]
    return [{**fit.model.first, **dict(zip(names, row, strict=True))} for row in rows]


def _is_open(fit: Fit, name: str) -> bool:
    """Return whether nothing at all is known of a parameter, not even together with others or by its gauge."""
    is_known = name in fit.undetermined_by_gauges or any(name in group for group in fit.confounded)
    return not is_known and name not in RESISTANCE


def optimum_spread(fit: Fit, scenario: Scenario, draws: int = 100, seed: int = 1) -> OptimumSpread:
    """Return the optimum of a scenario for vehicles drawn from a fit.

    Raises
    ------
    RecordingError
        As `draw_parameters`.
    """
    energies = np.full(draws, np.nan)
    for index, values in enumerate(draw_parameters(fit, draws, seed)):
        vehicle = fit.model.fitted(values)
        try:
            energies[index] = solve(scenario.model_copy(update={"vehicle": vehicle}), "optimal").energy_kwh
        except RailjouleError:
            # a train too heavy for the time is one of the things that the runs leave open
            continue
    return OptimumSpread(frozen_array(energies))


def monte_carlo_scenario(fit: Fit, scenario: Scenario) -> Scenario:
    """Return a scenario with the fitted vehicle whose Monte Carlo study draws the resistance that the fit leaves open.

    Its `resistance_factor` is log-normal around 1, with the deviation of the work against the fitted resistance at the
    speeds of the runs; A, B and C themselves are hardly known one by one where their sum is known well.
    """
    deviation = resistance_deviation(fit)
    options = scenario.montecarlo.model_copy(
        update={
            "resistance_factor": LogNormal(
                distribution="log_normal", median=1.0, log_standard_deviation=max(deviation, LEAST_DEVIATION)
            )
        }
    )
    return scenario.model_copy(update={"vehicle": fit.model.fitted(fit.values), "montecarlo": options})


def resistance_deviation(fit: Fit) -> float:
    """Return the standard deviation of the fitted resistance at the speeds of the runs, as a share of it."""
    values, names = fit.values, [parameter.name for parameter in fit.parameters]
    speeds = fit.mean_powers_kmh
    whole = sum(values[name] * power for name, power in zip(RESISTANCE, speeds, strict=True))
    slope = np.array([speeds[RESISTANCE.index(name)] if name in RESISTANCE else 0.0 for name in names])
    return float(np.sqrt(max(slope @ fit.covariance @ slope, 0.0)) / max(whole, 1e-9))
