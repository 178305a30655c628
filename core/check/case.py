"""A run, its scenario, and the quantities that its rules compare."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from railjoule.core.arrays import BoolArray, FloatArray
from railjoule.core.check.drives import loss_model
from railjoule.core.check.limits import adhesion_limits_n, stated_limits_n
from railjoule.core.check.loss_model import Losses, LossModel
from railjoule.core.check.record import Record
from railjoule.core.check.train import Route, Train, build_route, build_train
from railjoule.core.scenario import Scenario
from railjoule.core.units import MS_PER_KMH, N_PER_KN, W_PER_KW

# The acceleration divides a difference of squares by the length of a cell: a relative error d of the speed becomes d
# v^2 / h. At 1e-9, 30 m/s and a cell of 1 mm that is 1e-3 m/s2, which no limit of a scenario can tell from noise.
ROUNDED_SPEED = 1e-9
"""Rounding of a solver's speeds: over a short cell that is much force."""
# Without this a residue of the solver would be charged idle losses of a whole train. The run itself must agree: only a
# cell for which it takes no power counts as off, see `off`.
OFF_SHARE = 1e-6
"""Efforts below this share of the largest one may be rounding, and then the drive is off."""
# a weak brake behind strong motors: what is rounding of the one's effort is not much of the other's
OFF_SHARE_OF_MOST = 1e-7
"""The same of the largest tractive effort that the vehicle has."""
# places have an accuracy below a micrometre
SAME_PLACE_M = 1e-5
"""A node this close to a border lies on it."""
# a table's error is one of its scale, so towards no loss a share of the loss itself would be stricter than any table
SMALL_LOSS_SHARE = 0.1
"""Losses below this share of the largest are known no better than those."""


@dataclass(frozen=True, eq=False)
class Case:
    """A run, its scenario, and quantities of both; arrays are of the k cells in which the train moves on.

    Parameters
    ----------
    scenario : Scenario
        Of the run.
    record : Record
        The run.
    initial_speed_ms, final_speed_ms : float
        Required speeds at the ends [m/s].
    """

    scenario: Scenario
    record: Record
    initial_speed_ms: float
    final_speed_ms: float

    @cached_property
    def train(self) -> Train:
        """Masses and running resistance."""
        return build_train(self.scenario.vehicle, self.scenario.line.head_wind_kmh * MS_PER_KMH)

    @cached_property
    def route(self) -> Route:
        """The line in running order."""
        return build_route(self.scenario)

    @cached_property
    def model(self) -> LossModel:
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
        # 1 / radius is averaged and not the radius, which is infinite, written 0, on straight track
        curvature = self.route.curvature_per_m(*self._ends_m)
        return self.train.weight_kn * self.train.curve_constant_m_n_per_kn * curvature

    @cached_property
    def resistance_n(self) -> FloatArray:
        """Running resistance [N]."""
        train, record = self.train, self.record
        # The mean of v^2 over the distance, as v^2 is linear there, and beside it length over time for v: the
        # conventions of the file format. The square of the mean speed would be less, most of all in cells from rest.
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
    def required_effort_n(self) -> FloatArray:
        """Force at the wheels that the motion needs [N]."""
        # Newton's second law for the cell, from the speeds only; the efforts of the run are compared with it
        inertia: FloatArray = self.train.inertia_kg * self.acceleration_ms2
        return inertia + self.resistance_n + self.gradient_n + self.curve_n

    @cached_property
    def rounding_ms2(self) -> FloatArray:
        """Change of the acceleration by a change of the speeds in their last digit [m/s2]."""
        greatest: FloatArray = np.maximum(self.record.entering_speed2, self.record.leaving_speed2)
        return ROUNDED_SPEED * greatest / self.record.length_m

    @cached_property
    def rounding_n(self) -> FloatArray:
        """Force of that change [N]."""
        return self.train.inertia_kg * self.rounding_ms2

    @cached_property
    def rounding_permille(self) -> FloatArray:
        """Change of the mean gradient of a short cell by the rounding of places [per mille]."""
        route = self.route
        steepest = max(abs(section.gradient_permille) for section in route.sections)
        # over a train's length it is a difference of integrals of integrals
        spread = max(route.length_m / (route.train_m or 1.0), 1.0) if route.spreads_evenly else 1.0
        # 10 last digits: the two ends and the borders of the sections between them are rounded each on its own
        return 10 * steepest * spread * self.rounding_share

    @cached_property
    def rounding_share(self) -> FloatArray:
        """Last digit of the length of the line over the length of each cell."""
        share: FloatArray = np.finfo(float).eps * self.route.length_m / self.record.length_m
        return share

    @cached_property
    def effort_scale_n(self) -> float:
        """The largest effort of the run or, where it is less, a hundredth of the weight [N]: a scale for efforts."""
        effort = self.record.effort_n
        largest = float(np.max(np.abs(effort), initial=0.0)) if effort is not None else 0.0
        # weight in kN times 10 is a hundredth of the weight in N: a coasting run has no effort to be a share of
        return max(largest, 10.0 * self.train.weight_kn)

    @cached_property
    def energy_scale_j(self) -> float:
        """The work at the wheels or at the line with either sign, whichever is more [J]: a scale for energies."""
        record = self.record
        # The net energy can be zero with much energy moved either way, so it is no scale for an error.
        wheels = float(np.sum(np.abs(self.required_effort_n) * record.length_m))
        reported = record.supply_power_w
        line = 0.0 if reported is None else float(np.sum(np.abs(reported) * np.diff(record.time_s)))
        return max(wheels, line, 1.0)

    @cached_property
    def drive_power_w(self) -> FloatArray:
        """Supply power of the drive in the run, auxiliaries excluded [W]."""
        assert self.record.supply_power_w is not None
        return self.record.moving(self.record.supply_power_w) - self.auxiliary_power_w

    @cached_property
    def electric_n(self) -> FloatArray:
        """Effort of the drive, braking negative [N]; that of all brakes where the run does not separate them."""
        record = self.record
        assert record.effort_n is not None
        if record.electric_braking_n is None or record.tractive_effort_n is None:
            return record.moving(record.effort_n)
        return record.moving(record.tractive_effort_n - record.electric_braking_n)

    @cached_property
    def off(self) -> BoolArray:
        """Cells in which the drive is off: without effort, or with a negligible one that takes no power in the run."""
        # An effort of exactly 0 is off. A tiny one is either: an induction machine that holds its flux takes idle
        # power for it. The power of the run decides, so that neither reading is an error.
        most_n = (self.scenario.vehicle.traction.max_effort_kn or 0.0) * N_PER_KN
        rounding = np.abs(self.electric_n) <= max(OFF_SHARE * self.effort_scale_n, OFF_SHARE_OF_MOST * most_n)
        off: BoolArray = (self.electric_n == 0) | (rounding & (self.drive_power_w == 0))
        return off

    @cached_property
    def losses_w(self) -> Losses:
        """Losses of the drive by its formulas, by kind [W]; NaN where its motors cannot give the effort."""
        losses = self.model.losses_w(self.electric_n, self.record.mean_speed_ms)
        return {kind: np.where(self.off, 0.0, watts) for kind, watts in losses.items()}

    @cached_property
    def rounded_effort_work_j(self) -> float:
        """Work of efforts that are rounding while the drive is off [J], which is a loss of no reported kind."""
        return float(np.sum(np.where(self.off, np.abs(self.electric_n) * self.record.length_m, 0.0)))

    @cached_property
    def terminal_power_w(self) -> FloatArray:
        """Power of the drive by its formulas, negative where it generates [W]; NaN as in `losses_w`."""
        work = self.electric_n * self.record.mean_speed_ms
        power: FloatArray = np.where(self.off, 0.0, work) + sum(self.losses_w.values(), np.zeros(len(work)))
        return power

    @cached_property
    def loss_uncertainty_w(self) -> FloatArray:
        """Possible difference of a right power, as the drive's losses are tabulated [W]."""
        # NaN, where the motors cannot do it, is no uncertainty: the limits of effort judge it
        losses = np.nan_to_num(sum(self.losses_w.values(), np.zeros(len(self.electric_n))))
        unsure: FloatArray = self.model.accuracy * (losses + SMALL_LOSS_SHARE * np.max(losses, initial=0.0))
        return unsure

    @cached_property
    def neutral(self) -> BoolArray:
        """Cells that lie in a neutral section at least in part."""
        start, end = self._ends_m
        neutral = np.zeros(len(start), dtype=bool)
        for begins, ends in self.route.neutral:
            neutral |= np.minimum(end, ends) - np.maximum(start, begins) > SAME_PLACE_M
        return neutral

    @cached_property
    def electric_limit_n(self) -> FloatArray:
        """Largest effort of the electric brake, within the limits of vehicle, motors and supply [N]."""
        speed = self.record.mean_speed_ms
        stated = stated_limits_n(self.scenario.vehicle.braking, speed).values()
        limit = np.minimum.reduce([*stated, self.adhesion_n[0], self.model.max_effort_n(speed, True)])
        return np.where(self.neutral, 0.0, limit)

    @cached_property
    def adhesion_n(self) -> tuple[FloatArray, FloatArray]:
        """Largest forces that the driven and the braked axles transmit to the rails [N]."""
        return adhesion_limits_n(self.scenario, self.record.mean_speed_ms)

    def supply_power_of_terminal_w(self, terminal_power_w: FloatArray) -> FloatArray:
        """Return the supply power for a power of the drive [W]: a share of generated power is recuperated."""
        return np.where(terminal_power_w < 0, self.recuperation_factor * terminal_power_w, terminal_power_w)

    def supply_power_of_effort_w(self, effort_n: FloatArray, speed_ms: FloatArray) -> FloatArray:
        """Return the supply power of the drive for electric efforts at speeds [W]; off without effort."""
        losses = sum(self.model.losses_w(effort_n, speed_ms).values(), np.zeros(len(speed_ms)))
        return self.supply_power_of_terminal_w(np.where(effort_n == 0, 0.0, effort_n * speed_ms + losses))

    @property
    def top_speed_ms(self) -> float:
        """Largest speed of the vehicle [m/s]."""
        return self.scenario.vehicle.traction.max_speed_kmh * MS_PER_KMH

    @property
    def auxiliary_power_w(self) -> float:
        """Power of the auxiliaries [W]."""
        return self.scenario.vehicle.auxiliary_power_kw * W_PER_KW

    @property
    def recuperation_factor(self) -> float:
        """Share of the generated energy that is recuperated."""
        return self.scenario.vehicle.drive.recuperation_factor

    @property
    def _ends_m(self) -> tuple[FloatArray, FloatArray]:
        record = self.record
        return record.moving(record.position_m[:-1]), record.moving(record.position_m[1:])
