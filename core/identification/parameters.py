"""The parameters that a fit can free: where they stand in a scenario, and what they make of its vehicle."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from types import MappingProxyType

import numpy as np
import scipy

from railjoule.core.arrays import FloatArray
from railjoule.core.errors import RecordingError
from railjoule.core.physics.resistance import resistance_coefficients
from railjoule.core.scenario import Resistance, Vehicle
from railjoule.core.scenario.drive import ConstantEfficiency
from railjoule.core.units import MS_PER_KMH, STANDARD_GRAVITY_MS2

RESISTANCE = ("resistance.constant_n", "resistance.linear_n_per_kmh", "resistance.quadratic_n_per_kmh2")
MASS_FACTOR, MASS = "rotating_mass_factor", "total_mass_kg"
EFFICIENCY, AUXILIARY = "drive.traction_efficiency", "auxiliary_power_kw"
MOTION = (*RESISTANCE, MASS_FACTOR, MASS)
"""Parameters on which the speed depends; the other two change the power."""
NAMES = (*MOTION, EFFICIENCY, AUXILIARY)
DEFAULT = (*RESISTANCE, MASS_FACTOR, EFFICIENCY, AUXILIARY)
"""Freed by default; a train's load is mostly known better than a run determines it."""
UNITS: Mapping[str, str] = MappingProxyType(
    dict(zip(NAMES, ("N", "N per km/h", "N per (km/h)^2", "", "kg", "", "kW"), strict=True))
)
# specific resistances lie between 0.8 and 3 N/kN: a train of which nothing is known begins with one
MIN_SPECIFIC_N_PER_KN = 1.0
"""Size of a resistance that the scenario has as zero."""
MIN_EFFICIENCY = 0.01
"""A drive below takes a hundred times what it gives."""
MIN_AUXILIARY_KW = 20.0
"""Size of auxiliaries that the scenario has as zero."""


@dataclass(frozen=True, eq=False)
class Model:
    """All parameters of a vehicle, and which of them are free.

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle that the fit begins with.
    free : tuple of str
        Names of the free parameters, of `NAMES`.
    top_speed_ms : float
        Highest measured speed [m/s]: there the terms of the resistance are compared.
    """

    vehicle: Vehicle
    free: tuple[str, ...]
    top_speed_ms: float

    @cached_property
    def first(self) -> dict[str, float]:
        """The values of all parameters in the vehicle, by name."""
        vehicle = self.vehicle
        constant, linear, quadratic = resistance_coefficients(vehicle)
        terms = (constant, linear * MS_PER_KMH, quadratic * MS_PER_KMH**2)
        efficiency = getattr(vehicle.drive, "traction_efficiency", 1.0)
        factor = vehicle.total_inertia_kg / vehicle.total_mass_kg - 1
        rest = (factor, vehicle.total_mass_kg, efficiency, vehicle.auxiliary_power_kw)
        return dict(zip(NAMES, (*terms, *rest), strict=True))

    @cached_property
    def sizes(self) -> dict[str, float]:
        """Large changes of each parameter: an interval as wide leaves it undetermined."""
        first = self.first
        weight_kn = self.vehicle.total_mass_kg * STANDARD_GRAVITY_MS2 / 1e3
        top_kmh = max(self.top_speed_ms / MS_PER_KMH, 1.0)
        whole = max(
            sum(first[name] * top_kmh**power for power, name in enumerate(RESISTANCE)),
            MIN_SPECIFIC_N_PER_KN * weight_kn,
        )
        # each term by what it adds at the highest speed, as the scenario may have it as zero
        resistance = {name: whole / top_kmh**power for power, name in enumerate(RESISTANCE)}
        auxiliary = max(first[AUXILIARY], MIN_AUXILIARY_KW)
        return {**resistance, MASS_FACTOR: 0.2, MASS: 0.3 * first[MASS], EFFICIENCY: 0.2, AUXILIARY: auxiliary}

    def values(self, scaled: FloatArray) -> dict[str, float]:
        """Return all parameters for scaled changes of the free ones; shape (free,)."""
        first, sizes = self.first, self.sizes
        changed = {name: first[name] + sizes[name] * float(z) for name, z in zip(self.free, scaled, strict=True)}
        return {**first, **changed}

    def fitted(self, values: Mapping[str, float]) -> Vehicle:
        """Return the vehicle with fitted values: its resistance in absolute terms, at the load of the runs."""
        vehicle, free = self.vehicle, set(self.free)
        changes: dict[str, object] = {}
        mass = values[MASS]
        if MASS in free:
            # what the runs weighed; how it splits into train and passengers they do not tell
            changes["tare_kg"] = mass - vehicle.load_mass_kg
        if free & {MASS, MASS_FACTOR}:
            changes |= {"rotating_mass_factor": values[MASS_FACTOR], "inertial_mass_kg": None}
        if free & set(RESISTANCE):
            absolute = {name.partition(".")[2]: values[name] for name in RESISTANCE}
            curve = vehicle.resistance.curve_constant_m_n_per_kn
            changes["resistance"] = Resistance(**absolute, curve_constant_m_n_per_kn=curve)
        if EFFICIENCY in free and isinstance(vehicle.drive, ConstantEfficiency):
            changes["drive"] = vehicle.drive.model_copy(update={"traction_efficiency": values[EFFICIENCY]})
        if AUXILIARY in free:
            changes["auxiliary_power_kw"] = values[AUXILIARY]
        return vehicle.model_copy(update=changes)


def free_parameters(asked: Sequence[str] | None, vehicle: Vehicle, has_power: bool) -> tuple[str, ...]:
    """Return the names of the parameters to free, in the order of `NAMES`.

    Parameters
    ----------
    asked : sequence of str or None
        The choice of the user; None for all of `DEFAULT` that the vehicle has and the runs can determine.
    vehicle : Vehicle
        The vehicle.
    has_power : bool
        Whether the runs tell of the power at the line.

    Raises
    ------
    RecordingError
        If a name is unknown, or the vehicle or the runs know nothing of it.
    """
    efficient = isinstance(vehicle.drive, ConstantEfficiency)
    if vehicle.resistance.starting_ends_at_kmh is not None:
        raise RecordingError("vehicle.resistance.starting_n_per_kn and starting_n: a fit has no starting resistance.")
    if asked is None:
        known = [name for name in DEFAULT if has_power or name in MOTION]
        return tuple(name for name in known if efficient or name != EFFICIENCY)
    for name in asked:
        if name not in NAMES:
            raise RecordingError(f"--free {name}: must be among {', '.join(NAMES)}.")
        if name not in MOTION and not has_power:
            raise RecordingError(f"--free {name}: the runs have no column of power or energy, which it needs.")
        if name == EFFICIENCY and not efficient:
            model = getattr(vehicle.drive, "model", "")
            raise RecordingError(f"--free {name}: a drive of model {model!r} has no efficiency of its own.")
    return tuple(name for name in NAMES if name in asked)


def physical_range(model: Model) -> tuple[FloatArray, FloatArray]:
    """Return the least and the largest values that the free parameters of a train can have; each of shape (free,)."""
    # no train is pushed by its resistance, and no drive gives more than it takes
    high = np.array([1.0 if name == EFFICIENCY else np.inf for name in model.free])
    return np.array([MIN_EFFICIENCY if name == EFFICIENCY else 0.0 for name in model.free]), high


EXACT = 1e-6
"""Ends of intervals are found to within this share of their deviation."""


@dataclass(frozen=True, eq=False)
class Range:
    """Bounds of n parameters, and an estimate of them without bounds.

    A fit without bounds gives an estimate e with a covariance S. Its loss near e is the distance

        Q(x) = (x - e)' S^-1 (x - e)

    so the most likely parameters in the range have the minimum of Q there, and the interval of a parameter contains all
    of its values for which some parameters in the range have Q no more than the square of the quantile above that
    minimum (profile likelihood). If the estimate and its interval lie in the range, that is e with the usual interval.

    Parameters
    ----------
    estimate : array of shape (n,)
        The estimate.
    covariance : array of shape (n, n)
        Its covariance.
    low, high : array of shape (n,)
        Bounds.
    """

    estimate: FloatArray
    covariance: FloatArray
    low: FloatArray
    high: FloatArray

    @property
    def deviation(self) -> FloatArray:
        """Standard deviations of the estimate; shape (n,)."""
        return np.asarray(np.sqrt(np.diag(self.covariance)))

    def nearest(self) -> tuple[FloatArray, float]:
        """Return the most likely parameters in the range, and their Q; bounds may be equal."""
        free = self.low < self.high
        nearest = np.clip(self.estimate, self.low, self.high)
        if np.array_equal(nearest, self.estimate):
            return nearest, 0.0
        root = np.linalg.inv(np.linalg.cholesky(self.covariance))
        target = root @ self.estimate - root[:, ~free] @ nearest[~free]
        found = scipy.optimize.lsq_linear(root[:, free], target, (self.low[free], self.high[free]), method="bvls")
        nearest[free] = found.x
        return nearest, float(np.sum((root @ (nearest - self.estimate)) ** 2))

    def interval(self, index: int, quantile: float) -> tuple[float, float]:
        """Return the ends of the interval of a parameter.

        Parameters
        ----------
        index : int
            Which of the parameters.
        quantile : float
            Of the distribution of an estimate over its deviation, such as 1.96 for 95 %.
        """
        best, least = self.nearest()
        allowed = least + quantile**2
        low, high = (self._end(index, sign, float(best[index]), allowed) for sign in (-1, 1))
        return low, high

    def _end(self, index: int, sign: int, best: float, allowed: float) -> float:
        step = self.covariance[:, index] / self.deviation[index] * np.sqrt(allowed)
        farthest = self.estimate + sign * step
        if np.all((farthest >= self.low) & (farthest <= self.high)):
            return float(farthest[index])
        bound = float((self.low, self.high)[sign > 0][index])
        end = sign * min(sign * float(farthest[index]), sign * bound)

        def excess(value: float) -> float:
            low, high = self.low.copy(), self.high.copy()
            low[index] = high[index] = value
            return replace(self, low=low, high=high).nearest()[1] - allowed

        if excess(end) <= 0 or end == best:
            return end
        return float(scipy.optimize.brentq(excess, best, end, xtol=EXACT * self.deviation[index]))
