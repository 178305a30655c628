"""What a referee of the optimum knows: a scenario's numbers and equations, with no kernel, solver or account of ours.

Masses, resistance, line and the formulas of the drives are those of `railjoule.core.check`, which is written apart from
all that computes a run, and which import-linter keeps apart. The mesh alone is taken from the run that is judged, as
energies of different meshes would compare nothing.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from railjoule.core import load_scenario
from railjoule.core.arrays import FloatArray
from railjoule.core.check.drives import loss_model
from railjoule.core.check.loss_model import LossModel
from railjoule.core.check.train import Route, Train, route_of, train_of
from railjoule.core.scenario import Scenario
from railjoule.core.strategies import Task, prepare_task
from railjoule.core.units import MS_PER_KMH, N_PER_KN, W_PER_KW
from tests.any_scenarios import any_document, any_time
from tests.check_many import review_module, timed_task
from tests.every_drive import DRIVES

IDLING = {
    "induction": "induction with a standstill brake",
    "loss_polynomial": "loss polynomial",
    "efficiency_map": "efficiency map",
    "synchronous": "synchronous",
}
"""The drives that take power as soon as they are on, and what `tests.every_drive` calls each."""
TRAMS = ("tram-950m", "tram-950m-recuperating")
METROS = ("kharkiv-like-40kmh", "kharkiv-like-20kmh", "metro-with-limit")
# the tram of 22 t has four induction motors, the car of 60 t in `tests.every_drive` four of the others; a train of
# another mass gets as many a tonne, and a start that is usual for it
TONNES_A_MOTOR = {"induction": 5.5, "loss_polynomial": 15.0, "efficiency_map": 15.0, "synchronous": 15.0}
STARTING_MS2, CORNER_SHARE = 1.1, 0.45
# a residue of rounding in a force that stands for none
OFF_SHARE = 1e-7
# The product rounds the corners of limits that vary with speed by so much, as the check allows, see its `efforts`
CORNERS, EDGE = 2e-3, 1e-8


@dataclass(frozen=True, eq=False)
class Problem:
    """The least-energy problem of a scenario over given nodes; arrays of n cells and n + 1 nodes.

    Parameters
    ----------
    scenario : Scenario
    position_m : array of shape (n + 1,)
        Nodes [m], without those that a dwell repeats.
    """

    scenario: Scenario
    position_m: FloatArray

    @cached_property
    def route(self) -> Route:
        return route_of(self.scenario)

    @cached_property
    def train(self) -> Train:
        return train_of(self.scenario.vehicle)

    @cached_property
    def model(self) -> LossModel:
        return loss_model(self.scenario.vehicle.drive)

    @cached_property
    def length_m(self) -> FloatArray:
        return np.diff(self.position_m)

    @cached_property
    def constant_n(self) -> FloatArray:
        """What resists at any speed: A, gradients and curves [N]; shape (n,)."""
        ends, train = (self.position_m[:-1], self.position_m[1:]), self.train
        curves = train.curve_constant_m_n_per_kn * self.route.curvature_per_m(*ends)
        return train.constant_n + train.weight_kn * (self.route.gradient_permille(*ends) + curves)

    @cached_property
    def quadratic(self) -> FloatArray:
        """C with the factor of tunnels [N s2/m2]; shape (n,)."""
        return self.train.quadratic * self.route.tunnel_factor(self.position_m[:-1], self.position_m[1:])

    @cached_property
    def stands(self) -> FloatArray:
        """Whether the train stands at a node: at the ends and at stops; shape (n + 1,)."""
        places = np.array([self.position_m[0], *(stop.position_m for stop in self.route.stops), self.position_m[-1]])
        return np.abs(self.position_m[:, None] - places).min(axis=1) < 1e-5

    @cached_property
    def limit_ms(self) -> FloatArray:
        """Limit of speed at the nodes, the lower one of two cells [m/s]; 0 where the train stands; shape (n + 1,)."""
        vehicle = self.scenario.vehicle.traction.max_speed_kmh * MS_PER_KMH
        cells = np.minimum(self.route.speed_limit_ms(0.5 * (self.position_m[:-1] + self.position_m[1:])), vehicle)
        nodes = np.minimum(np.append(cells, np.inf), np.append(np.inf, cells))
        return np.where(self.stands, 0.0, nodes)

    @property
    def dwell_s(self) -> float:
        return sum(stop.dwell_s for stop in self.route.stops)

    @property
    def running_time_s(self) -> float:
        """Time allowed without dwells [s]."""
        return self.scenario.travel_time_s - self.dwell_s

    @property
    def auxiliary_w(self) -> float:
        return self.scenario.vehicle.auxiliary_power_kw * W_PER_KW

    @property
    def factor(self) -> float:
        """Share of the generated energy that the supply takes back."""
        return self.scenario.vehicle.drive.recuperation_factor

    @property
    def friction_n(self) -> float:
        return self.scenario.vehicle.braking.friction_effort_kn * N_PER_KN

    @property
    def rates_ms2(self) -> tuple[float, float]:
        """Largest acceleration and deceleration [m/s2], infinite where the vehicle sets none."""
        vehicle = self.scenario.vehicle
        return (
            vehicle.traction.max_acceleration_ms2 or np.inf,
            vehicle.braking.max_deceleration_ms2 or np.inf,
        )

    def limit_n(self, speed_ms: FloatArray, braking: bool) -> FloatArray:
        """Return the largest electric effort of vehicle and motors at speeds of shape (k,) [N]."""
        limits = self.scenario.vehicle.braking if braking else self.scenario.vehicle.traction
        effort = self.model.largest_effort_n(speed_ms, braking)
        if limits.max_effort_kn is not None:
            effort = np.minimum(effort, limits.max_effort_kn * N_PER_KN)
        if limits.max_power_kw is not None:
            effort = np.minimum(effort, limits.max_power_kw * W_PER_KW / np.maximum(speed_ms, 1e-9))
        curve = getattr(limits, "curve", None)
        if curve is not None:
            kmh, kn = np.array(curve).T
            last = kmh[-1] * MS_PER_KMH
            # beyond its last point a curve keeps the power of that one, as the file format states
            beyond = np.minimum(1.0, last / np.maximum(speed_ms, last))
            effort = np.minimum(effort, np.interp(speed_ms, kmh * MS_PER_KMH, kn * N_PER_KN) * beyond)
        return effort

    def force_n(self, cell: Any, entering_ms: FloatArray, leaving_ms: FloatArray) -> FloatArray:
        """Return the force at the wheels over cells, from their speeds [N]."""
        entering2, leaving2 = entering_ms**2, leaving_ms**2
        force: FloatArray = (
            self.train.inertia_kg * 0.5 * (leaving2 - entering2) / self.length_m[cell]
            + self.constant_n[cell]
            + self.train.linear * 0.5 * (entering_ms + leaving_ms)
            + self.quadratic[cell] * 0.5 * (entering2 + leaving2)
        )
        return force

    def power_w(self, effort_n: FloatArray, speed_ms: FloatArray) -> FloatArray:
        """Return what a drive that is on takes for efforts, braking negative, of shape (k,) [W]."""
        size, braking = np.abs(effort_n), effort_n < 0
        motors = np.where(
            braking, self.model.largest_effort_n(speed_ms, True), self.model.largest_effort_n(speed_ms, False)
        )
        # formulas have no flux for what is beyond a motor's limit by rounding, of theirs or of a run's: its losses are
        # those at the limit, and what is really beyond has none
        kept = np.where(size <= motors * (1 + CORNERS), np.minimum(size, motors * (1 - EDGE)), size)
        losses = sum(self.model.losses_w(np.copysign(kept, effort_n), speed_ms).values(), np.zeros(len(speed_ms)))
        return effort_n * speed_ms + losses

    def line_power_w(self, effort_n: FloatArray, speed_ms: FloatArray) -> FloatArray:
        """Return what the supply gives a drive for efforts, electric braking negative, of shape (k,) [W]."""
        power = np.where(effort_n == 0, 0.0, self.power_w(effort_n, speed_ms))
        return np.where(power < 0, self.factor * power, power)


def shipped_problems(names: tuple[str, ...], drives: tuple[str, ...]) -> Iterator[tuple[str, str, Task]]:
    """Yield shipped scenarios with each drive: name, drive, task."""
    for name in names:
        scenario = load_scenario(name)
        for drive in drives:
            yield name, drive, prepare_task(with_drive(scenario, drive))


def random_problems(drives: tuple[str, ...], seeds: range) -> Iterator[tuple[str, str, Task]]:
    """Yield ordinary random scenarios of each drive that can be driven: name, drive, task."""
    generator = review_module("gen")
    for drive in drives:
        for seed in seeds:
            if generator is None:
                document, share = any_document(seed), any_time(seed)
                if document["vehicle"]["drive"]["model"] != drive:
                    continue
            else:
                document, share = generator.scenario(seed, ordinary=drive)
            yield f"seed {seed}", drive, timed_task(document, share)


def with_drive(scenario: Scenario, drive: str) -> Scenario:
    """Return a scenario with one of the drives that idle; unchanged where it is the scenario's own kind."""
    vehicle = scenario.vehicle
    if vehicle.drive.model == drive:
        return scenario
    motors = max(round(vehicle.total_mass_kg / 1e3 / TONNES_A_MOTOR[drive]), 1)
    parameters = {**DRIVES[IDLING[drive]], "motors": motors, "recuperation_factor": vehicle.drive.recuperation_factor}
    changes: dict[str, Any] = {"vehicle.drive": parameters}
    effort_kn = STARTING_MS2 * vehicle.total_mass_kg / N_PER_KN
    if vehicle.traction.max_effort_kn is None:
        changes["vehicle.traction.max_effort_kn"] = effort_kn
    if vehicle.braking.max_effort_kn is None:
        changes["vehicle.braking.max_effort_kn"] = effort_kn
    if vehicle.traction.max_power_kw is None:
        top = vehicle.traction.max_speed_kmh * MS_PER_KMH
        changes["vehicle.traction.max_power_kw"] = effort_kn * CORNER_SHARE * top
    return scenario.with_(**changes)
