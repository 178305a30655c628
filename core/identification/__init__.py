"""Fitting a train to its measured runs: parameters with intervals, what the runs do not tell, and what follows.

Read `fit` first, then `noise`, which explains why residuals of a simulated speed must not be taken as independent.
"""

from railjoule.core.identification.fit import Fit, HeldOut, Parameter, fit_runs, hold_out, monte_carlo_scenario
from railjoule.core.identification.gauges import GaugeError, GaugeErrors

__all__ = [
    "Fit",
    "GaugeError",
    "GaugeErrors",
    "HeldOut",
    "Parameter",
    "fit_runs",
    "hold_out",
    "monte_carlo_scenario",
]
