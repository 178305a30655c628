"""The parameters of a train from its measured runs, by velocity fitting.

Minimised is the difference between the measured speed and the one that the train would have had under the measured
effort, from the start of each section on (Hansen, Nawaz, Olsson compared it with fitting accelerations, and found it
far less sensitive to the steps and the rate of a recorder). `noise` weighs it, `problem` simulates it. If powers are
measured beside the efforts, efficiency and auxiliaries are fitted to them; where powers are all there is, the effort
follows from them. Calibration errors of the gauges are fitted beside the parameters (`gauges`).

The loss grows linearly beyond three standard deviations, so that a gust or a shunt does not decide. The covariance is
that of the sandwich estimator, which takes the size of the errors from the residuals. Values and intervals follow from
this one fit (`physical_range`), with Student's quantile.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import compress

import numpy as np
import scipy

from railjoule.core.arrays import BoolArray, FloatArray
from railjoule.core.errors import RecordingError
from railjoule.core.identification.gauges import GaugeError, GaugeErrors
from railjoule.core.identification.noise import estimated_noise, expected_residual_ms, scale_freedom
from railjoule.core.identification.parameters import RESISTANCE, UNITS, Model, Range, free_parameters, physical_range
from railjoule.core.identification.problem import Problem
from railjoule.core.identification.sentences import assumed_errors, contradiction, open_parameters
from railjoule.core.identification.steps import usable_steps
from railjoule.core.measured import MeasuredRun, measured_run
from railjoule.core.scenario import Scenario
from railjoule.core.scenario.disturbance import LogNormal
from railjoule.core.scenario.drive import ConstantEfficiency
from railjoule.core.units import MS_PER_KMH

CONFIDENCE = 0.95
UNDETERMINED = 0.25
"""An interval that reaches farther to both sides, over the parameter's size, leaves it undetermined."""
OUTLIER = 3.0
"""Standard deviations from which on a residual counts linearly."""
NOISE_ROUNDS = 2
"""How often the noise is estimated again from the residuals: after two it stays."""
MIN_FREEDOM = 0.1
"""Minimum rest of a residual that decides a fit by itself."""
TINY = 1e-300
DEFAULT_GAUGES = GaugeErrors()


@dataclass(frozen=True)
class Parameter:
    """A fitted parameter by its key in a vehicle, with the ends of its interval of 95 %."""

    name: str
    value: float
    low: float
    high: float
    unit: str


@dataclass(frozen=True, eq=False)
class Fit:
    """A train as fitted to its runs.

    Parameters
    ----------
    scenario : Scenario
        The scenario before the fit.
    model : Model
        The vehicle and the free parameters.
    parameters : tuple of Parameter
        The free parameters.
    covariance : array of shape (free, free)
        Covariance of the free parameters.
    stated : GaugeErrors
        Assumed standard deviations of the calibration errors.
    gauge_errors : tuple of GaugeError
        Those that count in these runs, with the most likely errors.
    undetermined : tuple of str
        Names of those that the runs do not determine.
    confounded : tuple of tuple of str
        Which of them only a combination is known of.
    residual_ms : float
        Root mean square of simulated less measured speed [m/s].
    contradiction : str
        How the runs contradict the model, in a sentence; empty where they do not.
    assumed : str
        The assumed standard deviations of the gauges' calibration errors, in a sentence.
    sentences : tuple of str
        How the runs contradict the model, and which parameters they leave open and would be determined how.
    step_count : int
        Samples that were used.
    mean_powers_kmh : tuple of float
        Means over distance of the speed to the powers 0, 1 and 2, in km/h: what weighs A, B and C.
    """

    scenario: Scenario
    model: Model
    parameters: tuple[Parameter, ...]
    covariance: FloatArray
    stated: GaugeErrors
    gauge_errors: tuple[GaugeError, ...]
    undetermined: tuple[str, ...]
    confounded: tuple[tuple[str, ...], ...]
    residual_ms: float
    contradiction: str
    assumed: str
    sentences: tuple[str, ...]
    step_count: int
    mean_powers_kmh: tuple[float, ...]

    @property
    def values(self) -> dict[str, float]:
        """The values of all parameters, free or not, by name."""
        return {**self.model.first, **{parameter.name: parameter.value for parameter in self.parameters}}

    @property
    def correlation(self) -> FloatArray:
        """Correlation of the free parameters; shape (free, free)."""
        deviation = np.sqrt(np.diag(self.covariance))
        return np.asarray(self.covariance / np.outer(deviation, deviation))

    @property
    def fitted_scenario(self) -> Scenario:
        """The scenario with the fitted vehicle."""
        return self.scenario.model_copy(update={"vehicle": self.model.fitted(self.values)})


def fit_runs(
    runs: Sequence[MeasuredRun],
    scenario: Scenario,
    free: Sequence[str] | None = None,
    coasting_only: bool = False,
    stated: GaugeErrors = DEFAULT_GAUGES,
) -> Fit:
    """Fit a train to its measured runs.

    Parameters
    ----------
    runs : sequence of MeasuredRun
        Runs of one train.
    scenario : Scenario
        The vehicle to begin with; what is not free stays as it is.
    free : sequence of str, optional
        Names of the parameters to fit, of `railjoule.core.identification.parameters.NAMES`.
    coasting_only : bool
        Whether only samples without effort count.
    stated : GaugeErrors
        Standard deviations of the calibration errors of the gauges.

    Raises
    ------
    RecordingError
        If the runs hold no known efforts or too few samples, or a parameter is unknown to vehicle or runs.
    """
    steps = usable_steps(runs, scenario, coasting_only)
    has_power = not coasting_only and bool(np.any(~np.isnan(steps.power_w)))
    names = free_parameters(free, scenario.vehicle, has_power)
    if steps.count <= len(names):
        raise RecordingError(f"{steps.count} samples cannot tell {len(names)} parameters.")
    if np.any(np.isnan(steps.effort_n)) and not isinstance(scenario.vehicle.drive, ConstantEfficiency):
        raise RecordingError(
            "Without a column of the effort, it follows from the power only with a constant efficiency."
        )
    model = Model(scenario.vehicle, names, float(np.max(steps.end_speed_ms)))
    problem = Problem(model, steps, scenario.line.head_wind_kmh * MS_PER_KMH, stated)
    unknowns = np.zeros(problem.count)
    for _ in range(NOISE_ROUNDS + 1):
        unknowns = np.asarray(
            scipy.optimize.least_squares(
                problem.residual,
                unknowns,
                jac=problem.jacobian,
                loss="soft_l1",
                f_scale=OUTLIER,
                x_scale="jac",
                max_nfev=100,
            ).x
        )
        noise = estimated_noise(steps, problem.driven(unknowns), problem.speed_residual(unknowns))
        problem.scale_power(unknowns)
        problem.weigh(unknowns, noise)
        problem.inflate(unknowns)
    return _result(scenario, problem, unknowns)


def simulation_residual(runs: Sequence[MeasuredRun], fit: Fit, coasting_only: bool = False) -> FloatArray:
    """Return simulated less measured speeds [m/s] of runs by the parameters of a fit; shape (steps,).

    Raises
    ------
    RecordingError
        If the runs hold no known efforts or too few samples.
    """
    steps = usable_steps(runs, fit.scenario, coasting_only)
    model = Model(fit.model.vehicle, fit.model.free, fit.model.top_speed_ms)
    values = fit.values
    problem = Problem(model, steps, fit.scenario.line.head_wind_kmh * MS_PER_KMH, fit.stated)
    known = {gauge.name: gauge.value for gauge in fit.gauge_errors}
    scaled = [(values[name] - model.first[name]) / model.sizes[name] for name in model.free]
    errors = [known.get(gauge.name, 0.0) / gauge.deviation for gauge in problem.gauges]
    return problem.speed_residual(np.array([*scaled, *errors]))


def _result(scenario: Scenario, problem: Problem, unknowns: FloatArray) -> Fit:
    model, count = problem.model, problem.free_count
    covariance = _covariance(problem, unknowns)
    sizes = np.array([model.sizes[name] for name in model.free])
    first = np.array([model.first[name] for name in model.free])
    low, high = physical_range(model)
    unbounded = np.full(len(problem.gauges), np.inf)
    bounds = np.append((low - first) / sizes, -unbounded), np.append((high - first) / sizes, unbounded)
    best = Range(unknowns, covariance, *bounds).nearest()[0]
    # the range of the parameters only has the same nearest point, as the gauge errors have no bounds
    train = covariance[:count, :count]
    estimate = Range(first + sizes * unknowns[:count], train * np.outer(sizes, sizes), low, high)
    quantile = float(scipy.stats.t.ppf(0.5 + 0.5 * CONFIDENCE, scale_freedom(problem.steps.step_s)))
    unknown = quantile * np.sqrt(np.diag(train)) > UNDETERMINED
    shared, gauges = covariance[:count, count:], covariance[count:, count:]
    # of the parameters, if the gauge errors were known
    by_runs = train - shared @ np.linalg.solve(gauges, shared.T)
    unknown_by_runs = unknown & (quantile * np.sqrt(np.diag(by_runs)) > UNDETERMINED)
    undetermined = tuple(compress(model.free, unknown))
    confounded = _confounded(model.free, unknown_by_runs, by_runs, quantile)
    errors, steps = problem.errors(best), problem.steps
    gauge_errors = tuple(replace(gauge, value=errors[gauge.name]) for gauge in problem.gauges)
    residual_ms = float(np.sqrt(np.mean(problem.speed_residual(best) ** 2)))
    expected_ms = expected_residual_ms(steps, problem.driven(best))
    contradicted = contradiction(model.free, estimate, gauge_errors, residual_ms, expected_ms)
    open_by_gauges = tuple(compress(model.free, unknown & ~unknown_by_runs))
    speed_kmh, distance = steps.mean_speed_ms / MS_PER_KMH, steps.mean_speed_ms * steps.step_s
    powers = [float(np.average(speed_kmh**power, weights=distance)) for power in range(3)]
    return Fit(
        scenario=scenario,
        model=model,
        parameters=tuple(
            Parameter(name, float(value), *estimate.interval(index, quantile), UNITS[name])
            for index, (name, value) in enumerate(zip(model.free, estimate.nearest()[0], strict=True))
        ),
        covariance=estimate.covariance,
        stated=problem.stated,
        gauge_errors=gauge_errors,
        undetermined=undetermined,
        confounded=confounded,
        residual_ms=residual_ms,
        contradiction=contradicted,
        assumed=assumed_errors(gauge_errors),
        sentences=(*filter(None, [contradicted]), *open_parameters(undetermined, open_by_gauges, confounded)),
        step_count=steps.count,
        mean_powers_kmh=tuple(powers),
    )


def _covariance(problem: Problem, unknowns: FloatArray) -> FloatArray:
    """Return the covariance of the unknowns."""
    residual, jacobian = problem.residual(unknowns), problem.jacobian(unknowns)
    # of 2 (sqrt(1 + u^2) - 1): the influence u / sqrt(1 + u^2), and its slope
    share = 1 + (residual / OUTLIER) ** 2
    influence, slope = residual / np.sqrt(share), share**-1.5
    _, singular, directions = np.linalg.svd(np.sqrt(slope)[:, None] * jacobian, full_matrices=False)
    bread = (directions.T / singular**2) @ directions
    # A residual that decides much of the fit is small because of that: over 1 less its leverage it has its own size
    # (MacKinnon and White's third variant). It takes the place of the factor for few samples.
    leverage = slope * np.sum((jacobian @ bread) * jacobian, axis=1)
    size = influence / np.maximum(1 - leverage, MIN_FREEDOM)
    # of priors the deviations are stated, and no residual is a sample of them
    size[len(size) - len(unknowns) :] = 1.0
    pulled = jacobian * size[:, None]
    filling = pulled.T @ pulled
    inward = (directions @ filling @ directions.T) / np.outer(singular**2, singular**2)
    # residuals that happen to be small, as those of a steady power, must not make an interval narrower than their
    # stated variances do, in any direction
    wider = np.sqrt(np.maximum(1 / (singular**2 * np.maximum(np.diag(inward), TINY)), 1.0))
    return np.asarray(directions.T @ (inward * np.outer(wider, wider)) @ directions)


def _confounded(
    names: Sequence[str], unknown: BoolArray, covariance: FloatArray, quantile: float
) -> tuple[tuple[str, ...], ...]:
    """Return groups of parameters of which the runs know only a combination, the least known one first."""
    groups: list[tuple[str, ...]] = []
    variances, vectors = np.linalg.eigh(covariance)
    for variance, vector in zip(variances[::-1], vectors.T[::-1], strict=True):
        reach = quantile * np.abs(vector) * np.sqrt(variance)
        group = tuple(name for name, far, is_unknown in zip(names, reach, unknown, strict=True) if far > UNDETERMINED)
        if len(group) > 1 and not any(set(group) <= set(other) for other in groups):
            groups.append(group)
    return tuple(groups)


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
