"""The parameters of a train from its measured runs, by velocity fitting.

Minimised is the difference between the measured speed and the one that the train would have had under the measured
effort, from the start of each section on (Hansen, Nawaz, Olsson compared it with fitting accelerations, and found it
far less sensitive to the steps and the rate of a recorder). `noise` weighs it, `speed` simulates it. Where powers are
measured beside the efforts, efficiency and auxiliaries are fitted to them; where powers are all there is, the effort
follows from them.

The loss grows linearly beyond three standard deviations, so that a gust or a shunt does not decide. Intervals are
those of the sandwich estimator, which asks the residuals how large they are, with Student's quantile.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy

from railjoule.core.arrays import BoolArray, FloatArray
from railjoule.core.drive import make_drive
from railjoule.core.errors import RecordingError
from railjoule.core.fit.noise import Noise, Whitener, estimated_noise
from railjoule.core.fit.parameters import (
    AUXILIARY,
    EFFICIENCY,
    MASS,
    MASS_FACTOR,
    MOTION,
    RESISTANCE,
    UNITS,
    Model,
    free_parameters,
    scaled_floor,
)
from railjoule.core.fit.speed import simulated_speed
from railjoule.core.fit.steps import Steps, usable_steps
from railjoule.core.measured import MeasuredRun
from railjoule.core.scenario import Scenario
from railjoule.core.scenario.drive import ConstantEfficiency
from railjoule.core.units import MS_PER_KMH, W_PER_KW

CONFIDENCE = 0.95
UNDETERMINED = 0.25
"""An interval that reaches farther to both sides, over the parameter's size, says nothing of it."""
OUTLIER = 3.0
"""Standard deviations from which on a residual counts linearly."""
NOISE_ROUNDS = 2
"""How often the noise is found anew from the residuals: after two it stays."""
DIFFERENCE = 1e-4
"""Step of the differences that give the Jacobian, over the parameters' sizes: speeds bend little over it."""
# Efforts are told from currents, and sampled: even without noise a limit of power bends them between two samples by a
# thousandth. Calibrations of recorders promise no more than 1 %.
GAIN = 0.005
"""Standard deviation of a factor on all measured efforts."""
WEAK = 3.0
"""Standard deviation of a parameter around the scenario's before any run, over its size."""
LEAST_FREEDOM = 0.1
"""What at least is left of a residual that decides a fit alone."""
TINY = 1e-300
EFFORT_SHARE = 0.01
"""Errors of an effort as those of a power, scaled to the residuals as well."""
LEAST_POWER_FACTOR = 0.2
"""By which the deviations of powers are scaled at least."""
POWER_SHARE = 0.003
"""Errors of a power that its effort does not explain, over the largest power; scaled to the residuals afterwards."""


@dataclass(frozen=True)
class Parameter:
    """One fitted parameter.

    Parameters
    ----------
    name : str
        Its key in a vehicle.
    value, low, high : float
        The value, and the ends of its interval of 95 %.
    unit : str
        Its unit.
    """

    name: str
    value: float
    low: float
    high: float
    unit: str


@dataclass(frozen=True, eq=False)
class Fit:
    """What runs tell of a train.

    Parameters
    ----------
    scenario : Scenario
        What the fit began with.
    model : Model
        The vehicle and the free parameters.
    parameters : tuple of Parameter
        The free parameters.
    covariance : array of shape (free, free)
        Of their values.
    undetermined : tuple of str
        Names of those that the runs do not determine.
    confounded : tuple of tuple of str
        Which of them only a combination is known of.
    residual_ms : float
        Root mean square of simulated less measured speed [m/s].
    noise : Noise
        How large the errors of measurement are.
    step_count : int
        Samples that were used.
    mean_powers_kmh : tuple of float
        Means over distance of the speed to the powers 0, 1 and 2, in km/h: what weighs A, B and C.
    """

    scenario: Scenario
    model: Model
    parameters: tuple[Parameter, ...]
    covariance: FloatArray
    undetermined: tuple[str, ...]
    confounded: tuple[tuple[str, ...], ...]
    residual_ms: float
    noise: Noise
    step_count: int
    mean_powers_kmh: tuple[float, float, float]

    @property
    def values(self) -> dict[str, float]:
        """The values of all parameters, free or not, by name."""
        return {**self.model.first, **{parameter.name: parameter.value for parameter in self.parameters}}

    @property
    def correlation(self) -> FloatArray:
        """Correlation of the free parameters; shape (free, free)."""
        deviation = np.sqrt(np.diag(self.covariance))
        correlation: FloatArray = self.covariance / np.outer(deviation, deviation)
        return correlation

    @property
    def fitted_scenario(self) -> Scenario:
        """The scenario with the fitted vehicle."""
        return self.scenario.model_copy(update={"vehicle": self.model.fitted(self.values)})

    @property
    def sentences(self) -> tuple[str, ...]:
        """Which parameters cannot be told apart, or not at all, and what would help."""
        told = [f"{_listed(group)} cannot be told apart from these runs{_remedy(group)}." for group in self.confounded]
        alone = [name for name in self.undetermined if not any(name in group for group in self.confounded)]
        return (*told, *(f"These runs do not determine {name}{_remedy((name,))}." for name in alone))


def fit_runs(
    runs: Sequence[MeasuredRun],
    scenario: Scenario,
    free: Sequence[str] | None = None,
    coasting_only: bool = False,
) -> Fit:
    """Return what measured runs tell of a train.

    Parameters
    ----------
    runs : sequence of MeasuredRun
        Runs of one train.
    scenario : Scenario
        The vehicle to begin with; what is not free stays as it is.
    free : sequence of str, optional
        Names of the parameters to fit, of `railjoule.core.fit.parameters.NAMES`.
    coasting_only : bool
        Whether only samples without effort count.

    Raises
    ------
    RecordingError
        If the runs hold no known efforts or too few samples, or a parameter is unknown to vehicle or runs.
    """
    steps = usable_steps(runs, coasting_only)
    has_power = not coasting_only and bool(np.any(~np.isnan(steps.power_w)))
    names = free_parameters(free, scenario.vehicle, has_power)
    if steps.count <= len(names):
        raise RecordingError(f"{steps.count} samples cannot tell {len(names)} parameters.")
    if np.any(np.isnan(steps.effort_n)) and not isinstance(scenario.vehicle.drive, ConstantEfficiency):
        raise RecordingError(
            "Without a column of the effort, it follows from the power only with a constant efficiency."
        )
    model = Model(scenario.vehicle, names, float(np.max(steps.end_speed_ms)))
    problem = _Problem(model, steps, scenario.line.head_wind_kmh * MS_PER_KMH)
    scaled = np.zeros(len(names))
    noise = Noise()
    for _ in range(NOISE_ROUNDS + 1):
        problem.weigh(scaled, noise)
        scaled = _minimise(problem, scaled, np.full(len(names), -np.inf))
        noise = estimated_noise(steps, *problem.driven(scaled), problem.speed_residual(scaled))
        problem.scale_power(scaled)
    return _result(scenario, problem, scaled, noise)


def simulation_residual(runs: Sequence[MeasuredRun], fit: Fit, coasting_only: bool = False) -> FloatArray:
    """Return simulated less measured speeds [m/s] of runs by the parameters of a fit; shape (steps,).

    Raises
    ------
    RecordingError
        If the runs hold no known efforts or too few samples.
    """
    steps = usable_steps(runs, coasting_only)
    model = Model(fit.model.vehicle, fit.model.free, fit.model.top_speed_ms)
    values = fit.values
    scaled = np.array([(values[name] - model.first[name]) / model.sizes[name] for name in model.free])
    return _Problem(model, steps, fit.scenario.line.head_wind_kmh * MS_PER_KMH).speed_residual(scaled)


class _Problem:
    """Residuals of free parameters, each of variance 1 and independent of the others."""

    def __init__(self, model: Model, steps: Steps, wind_ms: float) -> None:
        self.model, self.steps, self.wind_ms = model, steps, wind_ms
        self.by_power = np.isnan(steps.effort_n)
        # a brake takes what the drive does not, and gives back what the recuperation factor says: neither is fitted
        self.metered = ~np.isnan(steps.read_power_w) & (np.nan_to_num(steps.read_effort_n, nan=-1.0) >= 0)
        if not {EFFICIENCY, AUXILIARY} & set(model.free):
            self.metered[:] = False
        self.power_factor = self.gain = 1.0
        self.drive = make_drive(model.vehicle.drive)
        self.whitener: Whitener | None = None

    def effort(self, values: Mapping[str, float]) -> FloatArray:
        """Return the mean efforts of the steps [N]: the measured ones, or those that a power leaves."""
        steps = self.steps
        left = np.maximum(steps.power_w - values[AUXILIARY] * W_PER_KW, 0.0)
        return np.where(self.by_power, values[EFFICIENCY] * left / steps.mean_speed_ms, self.gain * steps.effort_n)

    def driven(self, scaled: FloatArray) -> tuple[float, FloatArray]:
        """Return inertia [kg] and efforts at the ends of the steps [N]."""
        values = self.model.values(scaled)
        return _inertia(values), np.where(self.by_power, self.effort(values), self.steps.end_effort_n)

    def weigh(self, scaled: FloatArray, noise: Noise) -> None:
        """Take the covariance of errors at some values."""
        inertia, effort = self.driven(scaled)
        steps = self.steps
        if np.any(self.by_power):
            jump = np.abs(np.diff(effort, append=effort[-1]))
            steps = replace(steps, effort_jump_n=np.where(self.by_power, jump, steps.effort_jump_n))
        self.noise, self.whitener = noise, Whitener(steps, inertia, noise, effort)

    def speed_residual(self, scaled: FloatArray) -> FloatArray:
        """Return simulated less measured speed at the ends of the steps [m/s]."""
        values, steps = self.model.values(scaled), self.steps
        constant, linear, quadratic = (values[name] / MS_PER_KMH**power for power, name in enumerate(RESISTANCE))
        # the air meets the train at v + w: C (v + w)^2
        wind = self.wind_ms
        line = steps.line_force_n * (values[MASS] / self.model.first[MASS])
        simulated = simulated_speed(
            steps.step_s,
            steps.start_speed_ms,
            steps.begins,
            self.effort(values) - line,
            steps.tunnel_factor,
            constant + quadratic * wind**2,
            linear + 2 * quadratic * wind,
            quadratic,
            _inertia(values),
        )
        return simulated - steps.end_speed_ms

    def power_residual(self, scaled: FloatArray) -> FloatArray:
        """Return modelled less measured power over its deviation, where both are known."""
        if not np.any(self.metered):
            return np.zeros(0)
        values, steps, rows = self.model.values(scaled), self.steps, self.metered
        effort, speed, power = (
            self.gain * steps.read_effort_n[rows],
            steps.read_speed_ms[rows],
            steps.read_power_w[rows],
        )
        if EFFICIENCY in self.model.free:
            modelled = effort * speed / values[EFFICIENCY]
        else:
            modelled = self.drive.line_power_w(effort, speed)
        first = self.model.first[EFFICIENCY]
        variance = (
            (EFFORT_SHARE * effort * speed / first) ** 2
            + (effort / first) ** 2 * steps.speed_variance[rows]
            + steps.read_variance[rows]
            + (POWER_SHARE * np.max(np.abs(power))) ** 2
        )
        difference = modelled + values[AUXILIARY] * W_PER_KW - power
        residual: FloatArray = difference / (self.power_factor * np.sqrt(variance))
        return residual

    def scale_power(self, scaled: FloatArray) -> None:
        """Let the deviations of powers be as large as their residuals, as their median tells."""
        residual = self.power_residual(scaled)
        # a coasting train takes a power that hardly varies: it would make those of driving look exact
        driving = residual[self.steps.read_effort_n[self.metered] > 0]
        if len(driving):
            # of a normal distribution the median of the size is 0.6745 standard deviations
            factor = self.power_factor * float(np.median(np.abs(driving))) / 0.6745
            self.power_factor = max(factor, LEAST_POWER_FACTOR)

    def residual(self, scaled: FloatArray) -> FloatArray:
        """Return all residuals."""
        assert self.whitener is not None
        measured = np.append(self.whitener(self.speed_residual(scaled)), self.power_residual(scaled))
        # what no run tells stays near the scenario's; what they tell is ten and more times better known than that
        return np.append(measured, scaled / WEAK)

    def jacobian(self, scaled: FloatArray) -> FloatArray:
        """Return their derivatives by the scaled parameters, by central differences."""
        columns = []
        for index in range(len(scaled)):
            change = np.zeros(len(scaled))
            change[index] = DIFFERENCE
            columns.append((self.residual(scaled + change) - self.residual(scaled - change)) / (2 * DIFFERENCE))
        return np.column_stack(columns)

    def by_gain(self, scaled: FloatArray) -> FloatArray:
        """Return their derivatives by a factor on all measured efforts."""
        ends = []
        for sign in (1, -1):
            self.gain = 1 + sign * DIFFERENCE
            ends.append(self.residual(scaled))
        self.gain = 1.0
        slope: FloatArray = (ends[0] - ends[1]) / (2 * DIFFERENCE)
        return slope


def _inertia(values: Mapping[str, float]) -> float:
    return max((1 + values[MASS_FACTOR]) * values[MASS], 1.0)


def _minimise(problem: _Problem, first: FloatArray, low: FloatArray) -> FloatArray:
    found = scipy.optimize.least_squares(
        problem.residual,
        np.maximum(first, low + 1e-9),
        jac=problem.jacobian,
        bounds=(low, np.inf),
        loss="soft_l1",
        f_scale=OUTLIER,
        x_scale="jac" if np.all(np.isinf(low)) else 1.0,
        max_nfev=100,
    )
    best: FloatArray = found.x
    return best


def _result(scenario: Scenario, problem: _Problem, scaled: FloatArray, noise: Noise) -> Fit:
    model = problem.model
    problem.weigh(scaled, noise)
    covariance, directions = _covariance(problem.residual(scaled), problem.jacobian(scaled), problem.by_gain(scaled))
    sizes = np.array([model.sizes[name] for name in model.free])
    first = np.array([model.first[name] for name in model.free])
    quantile = float(scipy.stats.t.ppf(0.5 + 0.5 * CONFIDENCE, problem.steps.count - len(scaled)))
    reach = quantile * np.sqrt(np.diag(covariance))
    low, high = (first + sizes * (scaled + sign * reach) for sign in (-1, 1))
    floor = scaled_floor(model)
    best = scaled
    if np.any(scaled < floor):
        # no train is pushed by its resistance; the interval is that of the free fit, without what no train has
        best = _minimise(problem, np.maximum(scaled, floor), floor)
    values = np.maximum(first + sizes * best, 0.0)
    unknown = reach > UNDETERMINED
    residual = problem.speed_residual(best)
    return Fit(
        scenario=scenario,
        model=model,
        parameters=tuple(
            Parameter(name, float(value), max(float(below), 0.0), max(float(above), 0.0), UNITS[name])
            for name, value, below, above in zip(model.free, values, low, high, strict=True)
        ),
        covariance=covariance * np.outer(sizes, sizes),
        undetermined=tuple(name for name, is_unknown in zip(model.free, unknown, strict=True) if is_unknown),
        confounded=_confounded(model.free, unknown, directions, quantile),
        residual_ms=float(np.sqrt(np.mean(residual**2))),
        noise=noise,
        step_count=problem.steps.count,
        mean_powers_kmh=_mean_powers(problem.steps),
    )


def _mean_powers(steps: Steps) -> tuple[float, float, float]:
    speed_kmh = steps.mean_speed_ms / MS_PER_KMH
    distance = steps.mean_speed_ms * steps.step_s
    linear, quadratic = (float(np.average(speed_kmh**power, weights=distance)) for power in (1, 2))
    return 1.0, linear, quadratic


def _covariance(
    residual: FloatArray, jacobian: FloatArray, by_gain: FloatArray
) -> tuple[FloatArray, tuple[FloatArray, FloatArray]]:
    """Return the covariance of scaled parameters, and singular values and directions of the Jacobian."""
    # of 2 (sqrt(1 + u^2) - 1): the influence u / sqrt(1 + u^2), and its slope
    share = 1 + (residual / OUTLIER) ** 2
    influence, slope = residual / np.sqrt(share), share**-1.5
    _, singular, directions = np.linalg.svd(np.sqrt(slope)[:, None] * jacobian, full_matrices=False)
    bread = (directions.T / singular**2) @ directions
    # A residual that decides much of the fit is small because of that: over 1 less its leverage it has its own size
    # (MacKinnon and White's third variant). It takes the place of the factor for few samples.
    leverage = slope * np.sum((jacobian @ bread) * jacobian, axis=1)
    pulled = jacobian * (influence / np.maximum(1 - leverage, LEAST_FREEDOM))[:, None]
    filling = pulled.T @ pulled
    inward = (directions @ filling @ directions.T) / np.outer(singular**2, singular**2)
    # residuals that happen to be small, as those of a steady power, must not make an interval narrower than their
    # stated variances do, in any direction
    wider = np.sqrt(np.maximum(1 / (singular**2 * np.maximum(np.diag(inward), TINY)), 1.0))
    sandwich = directions.T @ (inward * np.outer(wider, wider)) @ directions
    # what the parameters become where all efforts are off alike, which no residual shows
    shift = GAIN * bread @ (jacobian.T @ (slope * by_gain))
    return sandwich + np.outer(shift, shift), (singular, directions)


def _confounded(
    names: Sequence[str], unknown: BoolArray, directions: tuple[FloatArray, FloatArray], quantile: float
) -> tuple[tuple[str, ...], ...]:
    """Return groups of parameters of which the runs know only a combination, the least known one first."""
    groups: list[tuple[str, ...]] = []
    singular, vectors = directions
    for value, vector in zip(singular[::-1], vectors[::-1], strict=True):
        reach = quantile * np.abs(vector) / value
        group = tuple(name for name, far, is_unknown in zip(names, reach, unknown, strict=True) if far > UNDETERMINED)
        if len(group) > 1 and not any(set(group) <= set(other) for other in groups):
            groups.append(group)
    return tuple(groups)


def _listed(names: Sequence[str]) -> str:
    return f"{', '.join(names[:-1])} and {names[-1]}"


def _remedy(names: Sequence[str]) -> str:
    """Return what other runs would tell them."""
    if set(names) <= set(RESISTANCE):
        return ": coasting from high to low speed would"
    if {MASS, MASS_FACTOR} & set(names) and set(names) <= set(MOTION):
        return ": measured efforts or coasting over known gradients would"
    if EFFICIENCY in names or AUXILIARY in names:
        return ": efforts measured beside the power would"
    return ""
