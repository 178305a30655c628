"""The residuals of a fit: speeds and powers of a train with calibration errors of the gauges, whitened."""

import math
from collections.abc import Mapping
from dataclasses import asdict, replace

import numpy as np

from railjoule.core.arrays import BoolArray, FloatArray
from railjoule.core.compiled import njit
from railjoule.core.drive import make_drive
from railjoule.core.identification.gauges import (
    EFFORT_GAIN,
    EFFORT_OFFSET,
    GAUGE_ERRORS,
    POWER_GAIN,
    POWER_OFFSET,
    SPEED_GAIN,
    GaugeError,
    GaugeErrors,
)
from railjoule.core.identification.noise import Driven, Noise, Whitener, noise_inflation
from railjoule.core.identification.parameters import AUXILIARY, EFFICIENCY, MASS, MASS_FACTOR, RESISTANCE, Model
from railjoule.core.identification.steps import Steps
from railjoule.core.physics.cell import mean_speed
from railjoule.core.physics.resistance import running_resistance
from railjoule.core.units import MS_PER_KMH, W_PER_KW

DIFFERENCE = 1e-4
"""Step of the differences that give the Jacobian, over the parameters' sizes: speeds bend little over it."""
WEAK = 3.0
"""Standard deviation of a parameter around the scenario's before any run, over its size."""
EFFORT_SHARE = 0.01
"""Errors of an effort as those of a power, scaled to the residuals as well."""
POWER_SHARE = 0.003
"""Errors of a power that its effort does not explain, over the largest power; scaled to the residuals afterwards."""
MIN_DRIVING_FACTOR, MIN_COASTING_FACTOR = 0.2, 0.02
"""By which these two deviations are scaled at least."""
FEWEST_COASTING = 10
"""Fewer samples without effort do not give the errors of their power."""
MEDIAN_SQUARE = 0.6745**2
"""Median of the square of a normal variable of variance 1."""
# a step changes the resistance by less than a thousandth of itself: three or four rounds leave rounding
MAX_ROUNDS = 30
EXACT_MS = 1e-12
"""Between two rounds the speed may still change by this."""
FASTEST_MS = 1e3
"""Parameters on trial may push a train; its speed ends here."""


class Problem:
    """Residuals, each of variance 1 and independent of the others, of free parameters and gauge errors.

    The unknowns are the scaled changes of the free parameters (`Model.sizes`), then the gauge errors over their
    standard deviations.

    Parameters
    ----------
    model : Model
        The vehicle and its free parameters.
    steps : Steps
        The measured steps.
    wind_ms : float
        Head wind [m/s].
    stated : GaugeErrors
        Standard deviations of the gauge errors.
    """

    def __init__(self, model: Model, steps: Steps, wind_ms: float, stated: GaugeErrors) -> None:
        self.model, self.steps, self.wind_ms = model, steps, wind_ms
        self.by_power = np.isnan(steps.effort_n)
        # a brake takes the rest of the effort, and the recuperation factor decides how much it gives back: not fitted
        self.metered = ~np.isnan(steps.read_power_w) & (np.nan_to_num(steps.read_effort_n, nan=-1.0) >= 0)
        if not {EFFICIENCY, AUXILIARY} & set(model.free):
            self.metered[:] = False
        self.driving_factor = self.coasting_factor = 1.0
        self.speed_inflation, self.power_inflation = np.ones(steps.count), 1.0
        self.drive = make_drive(model.vehicle.drive)
        self.stated, self.gauges = stated, self._gauges(stated)
        self.weigh(np.zeros(self.count), Noise())

    def _gauges(self, stated: GaugeErrors) -> tuple[GaugeError, ...]:
        """Return the gauge errors that change a residual."""
        steps = self.steps
        effort, power = float(steps.max_effort_n.max()), float(steps.max_power_w.max())
        if not np.any(steps.pulled_share):
            effort = 0.0
        if not np.any(self.by_power | self.metered):
            power = 0.0
        full_scale = dict(zip(GAUGE_ERRORS, (float(effort > 0), effort, float(power > 0), power, 1.0), strict=True))
        if np.all(steps.is_between_stations):
            full_scale[SPEED_GAIN] = 0.0
        deviation = {name: percent / 100 * full_scale[name] for name, percent in asdict(stated).items()}
        return tuple(GaugeError(name, deviation[name]) for name in GAUGE_ERRORS if deviation[name] > 0)

    @property
    def free_count(self) -> int:
        """Number of free parameters, which come first among the unknowns."""
        return len(self.model.free)

    @property
    def count(self) -> int:
        """Number of unknowns."""
        return self.free_count + len(self.gauges)

    def values(self, unknowns: FloatArray) -> dict[str, float]:
        """Return all parameters of the train."""
        return self.model.values(unknowns[: self.free_count])

    def errors(self, unknowns: FloatArray) -> dict[str, float]:
        """Return all gauge errors by name: logarithms of factors, N and W."""
        found = dict.fromkeys(GAUGE_ERRORS, 0.0)
        for gauge, z in zip(self.gauges, unknowns[self.free_count :], strict=True):
            found[gauge.name] = gauge.deviation * float(z)
        return found

    def effort(self, values: Mapping[str, float], errors: Mapping[str, float]) -> FloatArray:
        """Return the mean efforts of the steps [N]: the measured ones, or those that a power leaves."""
        steps = self.steps
        power = (steps.power_w - errors[POWER_OFFSET]) / math.exp(errors[POWER_GAIN])
        left = np.maximum(power - values[AUXILIARY] * W_PER_KW, 0.0)
        by_power = values[EFFICIENCY] * left / steps.mean_speed_ms
        measured = (steps.effort_n - errors[EFFORT_OFFSET] * steps.pulled_share) / math.exp(errors[EFFORT_GAIN])
        return np.where(self.by_power, by_power, measured)

    def driven(self, unknowns: FloatArray) -> Driven:
        """Return inertia and efforts of the train."""
        values, errors, steps = self.values(unknowns), self.errors(unknowns), self.steps
        _, linear, quadratic = self._resistance(values)
        inertia = _inertia(values)
        steeper = linear + 2 * quadratic * steps.tunnel_factor * steps.mean_speed_ms
        return Driven(
            inertia,
            np.where(self.by_power, self.effort(values, errors), steps.end_effort_n),
            np.exp(-steeper * steps.step_s / inertia),
        )

    def _resistance(self, values: Mapping[str, float]) -> tuple[float, float, float]:
        """Return A [N], B [N s/m] and C [N s2/m2] of the train in the wind."""
        constant, linear, quadratic = (values[name] / MS_PER_KMH**power for power, name in enumerate(RESISTANCE))
        # the air meets the train at v + w: C (v + w)^2
        wind = self.wind_ms
        return constant + quadratic * wind**2, linear + 2 * quadratic * wind, quadratic

    def weigh(self, unknowns: FloatArray, noise: Noise) -> None:
        """Take the covariance of errors at some unknowns."""
        train, steps = self.driven(unknowns), self.steps
        if np.any(self.by_power):
            effort = train.end_effort_n
            jump = np.abs(np.diff(effort, append=effort[-1]))
            steps = replace(steps, effort_jump_n=np.where(self.by_power, jump, steps.effort_jump_n))
        self.whitener = Whitener(steps, train, noise)

    def speed_residual(self, unknowns: FloatArray) -> FloatArray:
        """Return simulated less measured speed at the ends of the steps [m/s]."""
        values, errors, steps = self.values(unknowns), self.errors(unknowns), self.steps
        line = steps.line_force_n * (values[MASS] / self.model.first[MASS])
        gain = np.where(steps.is_between_stations, 1.0, math.exp(errors[SPEED_GAIN]))
        simulated = simulated_speed(
            steps.step_s,
            steps.start_speed_ms / gain,
            steps.begins,
            self.effort(values, errors) - line,
            steps.tunnel_factor,
            *self._resistance(values),
            _inertia(values),
        )
        return gain * simulated - steps.end_speed_ms

    def power_difference(self, unknowns: FloatArray) -> FloatArray:
        """Return modelled less measured power [W], where both are known."""
        values, errors, steps, rows = self.values(unknowns), self.errors(unknowns), self.steps, self.metered
        read = steps.read_effort_n[rows]
        effort = (read - errors[EFFORT_OFFSET] * (read > 0)) / math.exp(errors[EFFORT_GAIN])
        gain = np.where(steps.is_between_stations[rows], 1.0, math.exp(errors[SPEED_GAIN]))
        speed = steps.read_speed_ms[rows] / gain
        if EFFICIENCY in self.model.free:
            modelled = effort * speed / values[EFFICIENCY]
        else:
            modelled = self.drive.supply_power_w(effort, speed)
        taken = (modelled + values[AUXILIARY] * W_PER_KW) * math.exp(errors[POWER_GAIN]) + errors[POWER_OFFSET]
        return np.asarray(taken - steps.read_power_w[rows])

    def _power_variances(self) -> tuple[FloatArray, FloatArray]:
        """Return the variances of powers by the effort's errors, and by their own, not scaled [W2]."""
        steps, rows = self.steps, self.metered
        effort, speed = steps.read_effort_n[rows], steps.read_speed_ms[rows]
        per_effort = effort / self.model.first[EFFICIENCY]
        by_effort = (EFFORT_SHARE * per_effort * speed) ** 2 + per_effort**2 * steps.speed_variance[rows]
        own = (POWER_SHARE * steps.max_power_w.max()) ** 2 + steps.read_variance[rows]
        return by_effort, own

    def power_residual(self, unknowns: FloatArray) -> FloatArray:
        """Return modelled less measured power over its deviation, where both are known."""
        if not np.any(self.metered):
            return np.zeros(0)
        by_effort, own = self._power_variances()
        variance = self.driving_factor**2 * by_effort + self.coasting_factor**2 * own
        return np.asarray(self.power_difference(unknowns) / np.sqrt(variance))

    def scale_power(self, unknowns: FloatArray) -> None:
        """Let the deviations of powers be as large as their residuals, by their median."""
        if not np.any(self.metered):
            return
        square = self.power_difference(unknowns) ** 2 / MEDIAN_SQUARE
        by_effort, own = self._power_variances()
        coasts = by_effort == 0
        if coasts.sum() >= FEWEST_COASTING:
            factor = float(np.median(np.sqrt(square[coasts] / own[coasts])))
            self.coasting_factor = max(factor, MIN_COASTING_FACTOR)
        if not np.all(coasts):
            left = (square - self.coasting_factor**2 * own)[~coasts] / by_effort[~coasts]
            self.driving_factor = max(float(np.median(left)), MIN_DRIVING_FACTOR**2) ** 0.5

    def inflate(self, unknowns: FloatArray) -> None:
        """Let the deviations of speeds and powers be as large as their correlation over time makes them."""
        self.speed_inflation, self.power_inflation = np.ones(self.steps.count), 1.0
        residual, jacobian = self.residual(unknowns), self.jacobian(unknowns)
        bread = np.asarray(np.linalg.inv(jacobian.T @ jacobian), dtype=float)
        speeds, powers = self.steps.count, int(self.metered.sum())
        step_s = self.steps.step_s
        power = slice(speeds, speeds + powers)
        pulls = self.steps.pulled_share > 0
        for rows in (np.flatnonzero(pulls), np.flatnonzero(~pulls)):
            self.speed_inflation[rows] = noise_inflation(residual[rows], jacobian[rows], bread, step_s[rows])
        self.power_inflation = noise_inflation(residual[power], jacobian[power], bread, step_s[self.metered])

    def residual(self, unknowns: FloatArray) -> FloatArray:
        """Return all residuals."""
        speed = self.whitener(self.speed_residual(unknowns)) / self.speed_inflation
        power = self.power_residual(unknowns) / self.power_inflation
        # parameters that no run determines stay near the scenario's; others are ten and more times better known
        prior = np.append(unknowns[: self.free_count] / WEAK, unknowns[self.free_count :])
        return np.concatenate([speed, power, prior])

    def jacobian(self, unknowns: FloatArray) -> FloatArray:
        """Return their derivatives by the unknowns, by central differences."""
        columns = []
        for index in range(len(unknowns)):
            change = np.zeros(len(unknowns))
            change[index] = DIFFERENCE
            columns.append((self.residual(unknowns + change) - self.residual(unknowns - change)) / (2 * DIFFERENCE))
        return np.column_stack(columns)


def _inertia(values: Mapping[str, float]) -> float:
    return max((1 + values[MASS_FACTOR]) * values[MASS], 1.0)


@njit(cache=True, error_model="numpy", nogil=True)
def simulated_speed(
    step_s: FloatArray,
    start_speed_ms: FloatArray,
    begins: BoolArray,
    force_n: FloatArray,
    tunnel_factor: FloatArray,
    constant_n: float,
    linear: float,
    quadratic: float,
    inertia_kg: float,
) -> FloatArray:
    """Return the speed of a train under the measured effort at the end of each step [m/s]; shape (n,).

    Between two samples force and mass give dv = (F - R(v) - line) dt / m, with the running resistance at the means that
    a cell of the mesh takes. A section begins at its first measured speed; later ones are never looked at again.

    Parameters
    ----------
    step_s : array of shape (n,)
        Time between two samples [s].
    start_speed_ms : array of shape (n,)
        Measured speed at the start of each step, of which only those count where a section begins [m/s].
    begins : array of bool of shape (n,)
        Whether a section begins with the step.
    force_n : array of shape (n,)
        Effort less the forces of gradients and curves [N].
    tunnel_factor : array of shape (n,)
        Factor on the quadratic resistance.
    constant_n, linear, quadratic : float
        A [N], B [N s/m] and C [N s2/m2].
    inertia_kg : float
        Mass that resists acceleration [kg].
    """
    speed = np.empty(step_s.shape[0])
    before = 0.0
    for i in range(step_s.shape[0]):
        if begins[i]:
            before = start_speed_ms[i]
        after = before
        for _ in range(MAX_ROUNDS):
            v = mean_speed(before, after)
            speed2 = 0.5 * (before * before + after * after)
            resistance = running_resistance(constant_n, linear, quadratic * tunnel_factor[i], v, speed2)
            # a resistance never pushes back: parameters on trial may be wild, and speeds stay squares' roots
            reached = min(max(before + (force_n[i] - resistance) * step_s[i] / inertia_kg, 0.0), FASTEST_MS)
            change = reached - after
            after = reached
            if abs(change) <= EXACT_MS:
                break
        speed[i] = after
        before = after
    return speed
