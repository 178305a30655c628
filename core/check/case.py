"""A run, its scenario, and the quantities that its rules compare."""

from functools import cached_property

import numpy as np

from railjoule.core.arrays import BoolArray, FloatArray
from railjoule.core.check.drives import loss_model
from railjoule.core.check.loss_model import Losses
from railjoule.core.check.record import Record
from railjoule.core.check.train import adhesion_limits_n, build_route, build_train, stated_limits_n
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


class Case:
    """A run, its scenario, and quantities of both; arrays are of the k cells in which the train moves on.

    Parameters
    ----------
    scenario : Scenario
        Of the run.
    record : Record
        The run, with n cells.
    initial_speed_ms, final_speed_ms : float
        Required speeds at the ends [m/s].

    Attributes
    ----------
    train, route, model : Train, Route, LossModel
        Masses and running resistance, the line in running order, and the drive.
    top_speed_ms, auxiliary_power_w, friction_limit_n : float
        Of the vehicle; the largest effort of its friction brakes [N].
    moves : array of bool of shape (n,)
        Whether the train moves on in each cell.
    start_m, end_m, middle_m, length_m, duration_s : array
        Places, lengths [m] and times [s] of the cells.
    entering_speed2, leaving_speed2, mean_speed_ms : array
        Squares of speed at both ends of the cells [m2/s2], and means of the speeds there, their lengths over times.
    gradient_permille, gradient_n, curve_n, resistance_n : array
        Mean gradient under the train, and forces of gradient, curve and running resistance against it [N].
    acceleration_ms2, required_effort_n : array
        Change of v^2 over twice the length [m/s2], and force at the wheels that the motion needs [N].
    rounding_ms2, rounding_n : array
        Change of acceleration [m/s2] and force [N] by a change of the speeds in their last digit.
    rounding_share, rounding_permille : array
        Last digit of the length of the line over the length of each cell, and change of its gradient by that.
    effort_scale_n, energy_scale_j : float
        The largest effort or, where it is less, a hundredth of the weight; the work at the wheels or at the line with
        either sign, whichever is more.
    neutral : array of bool
        Cells that lie in a neutral section at least in part.
    adhesion_n : array of shape (2, k)
        Largest forces that the driven and the braked axles transmit to the rails [N].
    recuperation_factor, effort_factor : array
        Share of the generated energy that the supply takes back, and of the largest tractive effort that is left.
    place_effort_n, place_power_w, place_current_a : array
        Limits of tractive effort [N], of power at the wheels [W] and of the current of the supply [A] at the place.
    """

    def __init__(self, scenario: Scenario, record: Record, initial_speed_ms: float, final_speed_ms: float) -> None:
        self.scenario, self.record = scenario, record
        self.initial_speed_ms, self.final_speed_ms = initial_speed_ms, final_speed_ms
        self.train = build_train(scenario.vehicle, scenario.line.head_wind_kmh * MS_PER_KMH)
        self.route, self.model = build_route(scenario), loss_model(scenario.vehicle.drive)
        self.top_speed_ms = scenario.vehicle.traction.max_speed_kmh * MS_PER_KMH
        self.auxiliary_power_w = scenario.vehicle.auxiliary_power_kw * W_PER_KW
        self.friction_limit_n = scenario.vehicle.braking.friction_effort_kn * N_PER_KN
        self.moves: BoolArray = np.diff(record.position_m) > 0
        self.start_m, self.end_m = (self.moving(places) for places in (record.position_m[:-1], record.position_m[1:]))
        self.middle_m, self.length_m = 0.5 * (self.start_m + self.end_m), self.end_m - self.start_m
        self.duration_s = self.moving(np.diff(record.time_s))
        entering, leaving = self.moving(record.speed_ms[:-1]), self.moving(record.speed_ms[1:])
        self.entering_speed2, self.leaving_speed2 = entering**2, leaving**2
        self.mean_speed_ms = 0.5 * (entering + leaving)
        self._set_forces()
        self._set_scales()
        self.neutral = np.zeros(len(self.start_m), dtype=bool)
        for begins, ends in self.route.neutral:
            self.neutral |= np.minimum(self.end_m, ends) - np.maximum(self.start_m, begins) > SAME_PLACE_M
        self._set_limits_of_places()

    def _set_limits_of_places(self) -> None:
        scenario, count, route = self.scenario, len(self.start_m), self.route
        self.recuperation_factor = np.full(count, scenario.vehicle.drive.recuperation_factor)
        self.effort_factor = np.ones(count)
        self.place_effort_n, self.place_power_w, self.place_current_a = (np.full(count, np.inf) for _ in range(3))
        for begins, ends, limit in route.restricted:
            # a cell that a border cuts must keep the limits of both sides
            cells = np.minimum(self.end_m, ends) - np.maximum(self.start_m, begins) > SAME_PLACE_M
            for values, most in (
                (self.recuperation_factor, limit.recuperation_factor),
                (self.effort_factor, limit.effort_factor),
                (self.place_effort_n, None if limit.max_effort_kn is None else limit.max_effort_kn * N_PER_KN),
                (self.place_power_w, None if limit.max_power_kw is None else limit.max_power_kw * W_PER_KW),
                (self.place_current_a, limit.max_current_a),
            ):
                if most is not None:
                    values[cells] = np.minimum(values[cells], most)
        self.adhesion_n = np.array(adhesion_limits_n(scenario, self.mean_speed_ms, scenario.line.rail_condition))
        conditions = {condition for _, _, condition in route.rails}
        # of two conditions the worse holds, and "wet" is the last one
        for condition in sorted(conditions):
            of_rails = np.array(adhesion_limits_n(scenario, self.mean_speed_ms, condition))
            for begins, ends, found in route.rails:
                if found == condition:
                    cells = (self.middle_m > begins) & (self.middle_m < ends)
                    self.adhesion_n[:, cells] = of_rails[:, cells]

    def _set_forces(self) -> None:
        train, cells = self.train, (self.start_m, self.end_m)
        self.gradient_permille = self.route.gradient_permille(*cells)
        self.gradient_n = train.weight_kn * self.gradient_permille
        # 1 / radius is averaged and not the radius, which is infinite, written 0, on straight track
        self.curve_n = train.weight_kn * train.curve_constant_m_n_per_kn * self.route.curvature_per_m(*cells)
        # The mean of v^2 over the distance, as v^2 is linear there, and beside it length over time for v: the
        # conventions of the file format. The square of the mean speed would be less, most of all in cells from rest.
        mean_speed2 = 0.5 * (self.entering_speed2 + self.leaving_speed2)
        quadratic = train.quadratic * self.route.tunnel_factor(*cells)
        self.resistance_n = train.constant_n + train.linear * self.mean_speed_ms + quadratic * mean_speed2
        self.resistance_n += train.mean_starting_n(self.entering_speed2, self.leaving_speed2)
        self.acceleration_ms2 = 0.5 * (self.leaving_speed2 - self.entering_speed2) / self.length_m
        # Newton's second law for the cell, from the speeds only; the efforts of the run are compared with it
        inertia_n = train.inertia_kg * self.acceleration_ms2
        self.required_effort_n = inertia_n + self.resistance_n + self.gradient_n + self.curve_n

    def _set_scales(self) -> None:
        record, route = self.record, self.route
        self.rounding_ms2 = ROUNDED_SPEED * np.maximum(self.entering_speed2, self.leaving_speed2) / self.length_m
        self.rounding_n = self.train.inertia_kg * self.rounding_ms2
        self.rounding_share = np.finfo(float).eps * route.length_m / self.length_m
        steepest = max(abs(section.gradient_permille) for section in route.sections)
        # over a train's length it is a difference of integrals of integrals
        spread = max(route.length_m / (route.train_m or 1.0), 1.0) if route.points_m is None else 1.0
        # 10 last digits: the two ends and the borders of the sections between them are rounded each on its own
        self.rounding_permille = 10 * steepest * spread * self.rounding_share
        largest = 0.0 if record.effort_n is None else float(np.max(np.abs(record.effort_n), initial=0.0))
        # weight in kN times 10 is a hundredth of the weight in N: a coasting run has no effort to be a share of
        self.effort_scale_n = max(largest, 10.0 * self.train.weight_kn)
        # The net energy can be zero with much energy moved either way, so it is no scale for an error.
        wheels = float(np.sum(np.abs(self.required_effort_n) * self.length_m))
        reported = 0.0 if record.supply_power_w is None else np.abs(record.supply_power_w) @ np.diff(record.time_s)
        self.energy_scale_j = max(wheels, float(reported), 1.0)

    def moving(self, values: FloatArray) -> FloatArray:
        """Return the values of the cells in which the train moves on; shape (k,)."""
        return values[self.moves]

    @cached_property
    def drive_power_w(self) -> FloatArray:
        """Supply power of the drive in the run, auxiliaries excluded [W]."""
        assert self.record.supply_power_w is not None
        return self.moving(self.record.supply_power_w) - self.auxiliary_power_w

    @cached_property
    def electric_n(self) -> FloatArray:
        """Effort of the drive, braking negative [N]; that of all brakes where the run does not separate them."""
        record = self.record
        assert record.effort_n is not None
        if record.electric_braking_n is None or record.tractive_effort_n is None:
            return self.moving(record.effort_n)
        return self.moving(record.tractive_effort_n - record.electric_braking_n)

    @cached_property
    def off(self) -> BoolArray:
        """Cells in which the drive is off: without effort, or with a negligible one that takes no power in the run."""
        # An effort of exactly 0 is off. A tiny one is either: an induction machine that holds its flux takes idle
        # power for it. The power of the run decides, so that neither reading is an error.
        most_n = (self.scenario.vehicle.traction.max_effort_kn or 0.0) * N_PER_KN
        rounding = np.abs(self.electric_n) <= max(OFF_SHARE * self.effort_scale_n, OFF_SHARE_OF_MOST * most_n)
        return np.asarray((self.electric_n == 0) | (rounding & (self.drive_power_w == 0)))

    @cached_property
    def losses_w(self) -> Losses:
        """Losses of the drive by its formulas, by kind [W]; NaN where its motors cannot give the effort."""
        losses = self.model.losses_w(self.electric_n, self.mean_speed_ms)
        return {kind: np.where(self.off, 0.0, watts) for kind, watts in losses.items()}

    @cached_property
    def terminal_power_w(self) -> FloatArray:
        """Power of the drive by its formulas, negative where it generates [W]; NaN as in `losses_w`."""
        return sum(self.losses_w.values(), np.where(self.off, 0.0, self.electric_n * self.mean_speed_ms))

    @cached_property
    def loss_uncertainty_w(self) -> FloatArray:
        """Possible difference of a right power, as the drive's losses are tabulated [W]."""
        # NaN, where the motors cannot do it, is no uncertainty: the limits of effort judge it
        losses = np.nan_to_num(sum(self.losses_w.values(), np.zeros(len(self.electric_n))))
        return np.asarray(self.model.accuracy * (losses + SMALL_LOSS_SHARE * np.max(losses, initial=0.0)))

    @cached_property
    def rounded_effort_work_j(self) -> float:
        """Work of efforts that are rounding while the drive is off [J], which is a loss of no reported kind."""
        return float(np.abs(self.electric_n)[self.off] @ self.length_m[self.off])

    @cached_property
    def electric_limit_n(self) -> FloatArray:
        """Largest effort of the electric brake, within the limits of vehicle, motors and supply [N]."""
        stated = stated_limits_n(self.scenario.vehicle.braking, self.mean_speed_ms).values()
        motors = self.model.max_effort_n(self.mean_speed_ms, True)
        return np.where(self.neutral, 0.0, np.minimum.reduce([*stated, self.adhesion_n[0], motors]))

    def supply_power_of_terminal_w(self, terminal_power_w: FloatArray, cells: BoolArray | None = None) -> FloatArray:
        """Return the supply power for a power of the drive [W] in all or some cells: a share of it is recuperated."""
        factor = self.recuperation_factor if cells is None else self.recuperation_factor[cells]
        return np.where(terminal_power_w < 0, factor * terminal_power_w, terminal_power_w)

    def supply_power_of_effort_w(self, effort_n: FloatArray, speed_ms: FloatArray, cells: BoolArray) -> FloatArray:
        """Return the supply power of the drive for electric efforts at speeds in cells [W]; off without effort."""
        power = sum(self.model.losses_w(effort_n, speed_ms).values(), effort_n * speed_ms)
        return self.supply_power_of_terminal_w(np.where(effort_n == 0, 0.0, power), cells)
