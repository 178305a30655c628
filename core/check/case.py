"""A run together with all that it is held against."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.check.drives import loss_model
from railjoule.core.check.loss_model import EXACT, LossModel
from railjoule.core.check.record import Record
from railjoule.core.check.train import Route, Train, route_of, train_of
from railjoule.core.scenario import Scenario

ROUNDED_SPEED = 1e-9
"""A solver tells speeds to this share: over a short cell that is much force."""
SMALL_LOSS_SHARE = 0.1
"""Losses below this share of the largest are told no better than those."""


@dataclass(frozen=True, eq=False)
class Case:
    """A run, its scenario, and what follows from both; arrays are of the k cells in which the train moves on.

    Parameters
    ----------
    scenario : Scenario
        What was asked for.
    record : Record
        The run.
    initial_speed_ms, final_speed_ms : float
        Speeds that the ends ask for [m/s].
    """

    scenario: Scenario
    record: Record
    initial_speed_ms: float
    final_speed_ms: float

    @cached_property
    def train(self) -> Train:
        """Masses and running resistance."""
        return train_of(self.scenario.vehicle)

    @cached_property
    def route(self) -> Route:
        """The line in running order."""
        return route_of(self.scenario)

    @cached_property
    def losses(self) -> LossModel:
        """The drive."""
        return loss_model(self.scenario.vehicle.drive)

    @cached_property
    def gradient_permille(self) -> FloatArray:
        """Mean gradient under the train."""
        return self.route.gradient_permille(*self._ends_m)

    @cached_property
    def gradient_n(self) -> FloatArray:
        """Force of the gradient against the train [N]."""
        return self.train.weight_kn * self.gradient_permille

    @cached_property
    def curve_n(self) -> FloatArray:
        """Curve resistance [N]."""
        curvature = self.route.curvature_per_m(*self._ends_m)
        return self.train.weight_kn * self.train.curve_constant_m_n_per_kn * curvature

    @cached_property
    def resistance_n(self) -> FloatArray:
        """Running resistance [N]."""
        train, record = self.train, self.record
        mean_speed2 = 0.5 * (record.entering_speed2 + record.leaving_speed2)
        quadratic = train.quadratic * self.route.tunnel_factor(*self._ends_m)
        resistance: FloatArray = train.constant_n + train.linear * record.mean_speed_ms + quadratic * mean_speed2
        return resistance

    @cached_property
    def acceleration_ms2(self) -> FloatArray:
        """Change of v^2 over twice the length [m/s2]."""
        change: FloatArray = self.record.leaving_speed2 - self.record.entering_speed2
        return 0.5 * change / self.record.length_m

    @cached_property
    def needed_n(self) -> FloatArray:
        """Force at the wheels that the motion needs [N]."""
        inertia: FloatArray = self.train.inertia_kg * self.acceleration_ms2
        return inertia + self.resistance_n + self.gradient_n + self.curve_n

    @cached_property
    def rounding_ms2(self) -> FloatArray:
        """What a change of the speeds in their last told digit makes of the acceleration [m/s2]."""
        greatest: FloatArray = np.maximum(self.record.entering_speed2, self.record.leaving_speed2)
        return ROUNDED_SPEED * greatest / self.record.length_m

    @cached_property
    def rounding_n(self) -> FloatArray:
        """The same as a force [N]."""
        return self.train.inertia_kg * self.rounding_ms2

    @cached_property
    def rounding_permille(self) -> FloatArray:
        """What the rounding of long ways makes of the mean gradient of a short cell [per mille]."""
        height = sum(section.length_m * abs(section.gradient_permille) for section in self.route.sections)
        return 10 * np.finfo(float).eps * height / self.record.length_m

    @cached_property
    def large_effort_n(self) -> float:
        """The largest effort of the run or, where it is less, a hundredth of the weight [N]: a scale for efforts."""
        effort = self.record.effort_n
        largest = float(np.max(np.abs(effort), initial=0.0)) if effort is not None else 0.0
        return max(largest, 10.0 * self.train.weight_kn)

    @cached_property
    def moved_j(self) -> float:
        """The work at the wheels or at the line with either sign, whichever is more [J]: a scale for energies."""
        record = self.record
        wheels = float(np.sum(np.abs(self.needed_n) * record.length_m))
        told = record.line_power_w
        line = 0.0 if told is None else float(np.sum(np.abs(told) * np.diff(record.time_s)))
        return max(wheels, line, 1.0)

    def electrical_power_w(self, effort_n: FloatArray) -> FloatArray:
        """Return the power at the terminals of the drive for electric efforts [W]; NaN where motors cannot do them.

        A drive without effort is off.
        """
        speed = self.record.mean_speed_ms
        losses = sum(self.losses.losses_w(effort_n, speed).values(), np.zeros(len(speed)))
        return np.where(effort_n == 0, 0.0, effort_n * speed + losses)

    def unsure_w(self, effort_n: FloatArray) -> FloatArray:
        """Return by how much a right power may differ, as the drive's losses are tabulated [W]."""
        if self.losses.accuracy == EXACT:
            return np.zeros(len(effort_n))
        losses = np.nan_to_num(sum(self.losses.losses_w(effort_n, self.record.mean_speed_ms).values()))
        unsure: FloatArray = self.losses.accuracy * (losses + SMALL_LOSS_SHARE * np.max(losses, initial=0.0))
        return unsure

    def line_power_w(self, effort_n: FloatArray) -> FloatArray:
        """Return the power that the line gives to the drive for electric efforts [W]; NaN as there."""
        power = self.electrical_power_w(effort_n)
        return np.where(power < 0, self.recuperation_factor * power, power)

    @property
    def recuperation_factor(self) -> float:
        """Share of the generated energy that the line takes back."""
        return self.scenario.vehicle.drive.recuperation_factor

    @property
    def _ends_m(self) -> tuple[FloatArray, FloatArray]:
        record = self.record
        return record.moving(record.position_m[:-1]), record.moving(record.position_m[1:])
