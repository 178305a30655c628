"""Fitting a train to its measured runs: parameters with intervals, what the runs do not tell, and what follows.

Read `fit` first, then `noise`, which says why residuals of a simulated speed must not be taken as independent.
"""

from railjoule.core.identification.fit import Fit, Parameter, fit_runs
from railjoule.core.identification.gauges import GaugeError, GaugeErrors
from railjoule.core.identification.held_out import HeldOut, hold_out
from railjoule.core.identification.posterior import OptimumSpread, draw_parameters, monte_carlo_scenario, optimum_spread

__all__ = [
    "Fit",
    "GaugeError",
    "GaugeErrors",
    "HeldOut",
    "OptimumSpread",
    "Parameter",
    "draw_parameters",
    "fit_runs",
    "hold_out",
    "monte_carlo_scenario",
    "optimum_spread",
]
