"""How well a fit predicts a run that it has not seen: each run is held out once."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from railjoule.core.identification.fit import DEFAULT_GAUGES, Fit, fit_runs, simulation_residual
from railjoule.core.identification.gauges import GaugeErrors
from railjoule.core.measured import MeasuredRun, measured_run
from railjoule.core.scenario import Scenario

FEWEST_RUNS = 2
"""One to fit, one to hold out."""


@dataclass(frozen=True)
class HeldOut:
    """A run predicted by a fit to the others.

    Parameters
    ----------
    name : str
        Its file.
    residual_ms : float
        Root mean square of simulated less measured speed [m/s].
    modelled_kwh : float
        Energy by the fitted vehicle at the measured speeds [kWh].
    measured_kwh : float or None
        Energy by its meter or its power [kWh].
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
    """Return how fits to all runs but one predict that one; nothing where there is a single run.

    Parameters
    ----------
    runs, scenario, free, coasting_only, stated
        As `railjoule.core.identification.fit_runs`.

    Raises
    ------
    RecordingError
        As `fit_runs`.
    """
    if len(runs) < FEWEST_RUNS:
        return ()
    held = []
    for run in runs:
        others = [other for other in runs if other is not run]
        held.append(_predicted(run, fit_runs(others, scenario, free, coasting_only, stated), coasting_only))
    return tuple(held)


def _predicted(run: MeasuredRun, fit: Fit, coasting_only: bool) -> HeldOut:
    # by its speeds alone: the efforts that were measured are not looked at
    modelled = measured_run(run.recording, fit.fitted_scenario, run.placement.start_m).modelled
    residual = simulation_residual([run], fit, coasting_only)
    return HeldOut(run.recording.name, float(np.sqrt(np.mean(residual**2))), modelled.energy_kwh, run.measured_kwh)
