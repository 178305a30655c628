"""Predictions of a fit: a run that it has not seen, and the resistance that it leaves open."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from railjoule.core.identification.fit import DEFAULT_GAUGES, Fit, fit_runs, simulation_residual
from railjoule.core.identification.gauges import GaugeErrors
from railjoule.core.identification.parameters import RESISTANCE
from railjoule.core.measured import MeasuredRun, measured_run
from railjoule.core.scenario import Scenario
from railjoule.core.scenario.disturbance import LogNormal

# a distribution of no width would be a fixed value, which is another kind
MIN_DEVIATION = 1e-4
"""Of the logarithm of the resistance factor."""


def monte_carlo_scenario(fit: Fit, scenario: Scenario) -> Scenario:
    """Return a scenario with the fitted vehicle whose Monte Carlo study draws the resistance that the fit leaves open.

    Its `resistance_factor` is log-normal around 1, with the deviation of the work against the fitted resistance at the
    speeds of the runs; A, B and C themselves are hardly known one by one where their sum is known well.
    """
    deviation = resistance_deviation(fit)
    options = scenario.montecarlo.model_copy(
        update={
            "resistance_factor": LogNormal(
                distribution="log_normal", median=1.0, log_standard_deviation=max(deviation, MIN_DEVIATION)
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


@dataclass(frozen=True)
class HeldOut:
    """A run predicted by a fit to the others.

    `residual_ms` is the root mean square of simulated less measured speed, `modelled_kwh` the energy by the fitted
    vehicle at the measured speeds, `measured_kwh` the energy by its meter or its power.
    """

    name: str
    residual_ms: float
    modelled_kwh: float
    measured_kwh: float | None

    @property
    def energy_error(self) -> float | None:
        """Modelled over measured energy, less 1; None where nothing or no energy was measured."""
        if self.measured_kwh is None or self.measured_kwh <= 0:
            return None
        return self.modelled_kwh / self.measured_kwh - 1


def hold_out(
    runs: Sequence[MeasuredRun],
    scenario: Scenario,
    free: Sequence[str] | None = None,
    coasting_only: bool = False,
    stated: GaugeErrors = DEFAULT_GAUGES,
) -> tuple[HeldOut, ...]:
    """Predict each run by a fit to the others; nothing for a single run.

    Parameters
    ----------
    runs, scenario, free, coasting_only, stated
        As `railjoule.core.identification.fit_runs`.

    Raises
    ------
    RecordingError
        As `fit_runs`.
    """
    if len(runs) == 1:
        return ()
    held = []
    for run in runs:
        fit = fit_runs([other for other in runs if other is not run], scenario, free, coasting_only, stated)
        # by its speeds only: the measured efforts are not used
        modelled = measured_run(run.recording, fit.fitted_scenario, run.placement.start_m).modelled
        residual = float(np.sqrt(np.mean(simulation_residual([run], fit, coasting_only) ** 2)))
        held.append(HeldOut(run.recording.name, residual, modelled.energy_kwh, run.measured_kwh))
    return tuple(held)
