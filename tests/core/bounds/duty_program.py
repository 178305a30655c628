"""The relaxed problem of drives with idle losses, written separately from the solver, for CasADi and IPOPT.

Masses, resistance, line and the formulas of the drives are those of `railjoule.core.check`, which shares no code with
the solvers.

Where a drive may be switched at will within a cell, it drives for a share d of the cell's time, brakes for a share b
and is off for the rest. The effort over the cell is F = d f with f the effort while on, so that a power p(f, v) becomes
d p(F / d, v), which is convex in F and d where p is in f. A standstill brake stands in for the machines for another
share s of the time, with an effort of its own and no power, and d + b + s <= 1. The limits of a vehicle and of its
motors hold for each of the three while it lasts. CasADi builds that in symbols, IPOPT solves it. The formulas are those
of the publications, with T the torque, w = x v the speed of a motor, x its turns over distance, n motors:

    loss polynomial   p0 + k1 w + k2 w^2 + c1 M + c2 M^2 in each motor that is on, its gear's loss g |F v|
    induction         Rawicki (1)-(43), frame of the rotor flux: K = d kappa = d |T| / kT is linear in F and d, the
                      ratio of the currents q is a variable, and the power K times a function of q and w. Rated flux,
                      K <= d Imu^2 q, and voltage, K D(q, w) <= d Um^2 q, limit it; a second ratio, free otherwise,
                      shows that the effort is within the current: K (q + 1 / q) <= d I^2

Ours of induction machines lies below where rated flux and voltage both bind: it rounds the corner between the two
limits of the ratio, to the cheap side. With voltage to spare the two agree to a few ten-millionths.

The mesh alone is taken from ours. IPOPT ends in a local optimum: where power is not convex in effort and speed
together, both values are those of one. The first bound, that of `certify`, has to lie below IPOPT's value wherever this
is the minimum.
"""

import importlib
import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.check.drives import loss_model
from railjoule.core.check.loss_model import LossModel
from railjoule.core.check.train import Route, Train, build_route, build_train
from railjoule.core.scenario import Scenario
from railjoule.core.scenario.drive import Induction, LossPolynomial
from railjoule.core.units import H_PER_MH, MS_PER_KMH, N_PER_KN, W_PER_KW

OPTIONS = {
    "print_time": False,
    "expand": True,
    "ipopt.print_level": 0,
    "ipopt.sb": "yes",
    "ipopt.tol": 1e-8,
    "ipopt.max_iter": 1500,
    # by default bounds are relaxed by 1e-8, which buys an energy lower than there is
    "ipopt.bound_relax_factor": 0.0,
}
# A share of the square of effort over duty: without it, off would divide zero by zero. Duties above a thousandth are
# cheapened by a ten-thousandth of their copper losses at most
LEAST_DUTY = 1e-7
SLOWEST2 = 0.01
"""Floor of the squares of speed between stops, that of ours [m2/s2]."""
STILL = 1e-3
"""Rounds the kink of the hysteresis loss where a generator's field stands [rad/s]."""
ROOM = 1.2


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
        return build_route(self.scenario)

    @cached_property
    def train(self) -> Train:
        return build_train(self.scenario.vehicle)

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
        return np.where(self.stands, 0.0, np.minimum(np.append(cells, np.inf), np.append(np.inf, cells)))

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
        effort = self.model.max_effort_n(speed_ms, braking)
        if limits.max_effort_kn is not None:
            effort = np.minimum(effort, limits.max_effort_kn * N_PER_KN)
        if limits.max_power_kw is not None:
            effort = np.minimum(effort, limits.max_power_kw * W_PER_KW / np.maximum(speed_ms, 1e-9))
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


@dataclass(frozen=True, eq=False)
class Relaxed:
    """What IPOPT ends with: energy with auxiliaries and dwells [J], squares of speed, its own word for the end."""

    energy_j: float
    speed2: FloatArray
    status: str
    converged: bool


class DutyProgram:
    """The relaxed problem of a loss polynomial or of induction machines."""

    def __init__(self, problem: Problem) -> None:
        self.ca: Any = importlib.import_module("casadi")
        self.problem, self.cells = problem, len(problem.length_m)
        # efforts are shares of the largest tractive effort that vehicle and motors have at any speed
        speeds = np.linspace(0.05, 1.0, 50) * problem.limit_ms.max()
        largest = [float(problem.limit_n(speeds, braking).max()) for braking in (False, True)]
        self.scale = largest[0]
        vehicle = problem.scenario.vehicle
        stated = [limits.max_effort_kn for limits in (vehicle.traction, vehicle.braking)]
        self.constant = [
            # where motors alone limit the effort, this only bounds a variable: more than they have at any speed
            ROOM * largest[i] / self.scale if stated[i] is None else stated[i] * N_PER_KN / self.scale
            for i in range(2)
        ]
        self.free = ~problem.stands
        self._names: list[Any] = []
        self._low: list[FloatArray] = []
        self._high: list[FloatArray] = []
        self._first: list[FloatArray] = []
        self._rows: list[Any] = []
        self._row_low: list[float] = []
        self._row_high: list[float] = []

    def solve(self, start_ms: FloatArray) -> Relaxed:
        """Return the optimum from squares of speed at the nodes."""
        objective = self._formulate(start_ms)
        ca = self.ca
        counts = [row.numel() for row in self._rows]
        solver = ca.nlpsol(
            "duty", "ipopt", {"x": ca.vertcat(*self._names), "f": objective, "g": ca.vertcat(*self._rows)}, OPTIONS
        )
        solution = solver(
            x0=np.concatenate(self._first),
            lbx=np.concatenate(self._low),
            ubx=np.concatenate(self._high),
            lbg=np.repeat(self._row_low, counts),
            ubg=np.repeat(self._row_high, counts),
        )
        stats = solver.stats()
        speed2 = np.zeros(self.cells + 1)
        speed2[self.free] = np.array(solution["x"]).ravel()[: self.free.sum()]
        energy = float(solution["f"]) * self.scale + self.problem.auxiliary_w * self.problem.dwell_s
        return Relaxed(energy, speed2, str(stats["return_status"]), bool(stats["success"]))

    def _variable(self, low: Any, high: Any, first: Any, count: int | None = None) -> Any:
        count = self.cells if count is None else count
        symbol = self.ca.SX.sym(f"x{len(self._names)}", count)
        self._names.append(symbol)
        low, high = np.broadcast_to(low, count).astype(float), np.broadcast_to(high, count).astype(float)
        self._low.append(low)
        self._high.append(high)
        self._first.append(np.clip(np.broadcast_to(first, count), low, high).astype(float))
        return symbol

    def _keep(self, expression: Any, low: float = 0.0, high: float = math.inf) -> None:
        self._rows.append(expression)
        self._row_low.append(low)
        self._row_high.append(high)

    def _formulate(self, start_ms: FloatArray) -> Any:
        """Gather variables and constraints and return the energy without dwells, over the scale of efforts."""
        problem, h = self.problem, self.problem.length_m
        limit2 = problem.limit_ms**2
        floor = np.minimum(SLOWEST2, 0.25 * start_ms**2)
        free_w = self._variable(floor[self.free], limit2[self.free], start_ms[self.free] ** 2, int(self.free.sum()))
        w, place = [], 0
        for node in range(self.cells + 1):
            w.append(free_w[place] if self.free[node] else 0.0)
            place += int(self.free[node])
        w = self.ca.vertcat(*w)
        root = self.ca.vertcat(*[self.ca.sqrt(w[i]) if self.free[i] else 0.0 for i in range(self.cells + 1)])
        v = 0.5 * (root[:-1] + root[1:])
        entering, leaving = w[:-1], w[1:]
        rate = 0.5 * (leaving - entering) / h
        force = (
            problem.train.inertia_kg * rate
            + problem.constant_n
            + problem.train.linear * v
            + problem.quadratic * 0.5 * (entering + leaving)
        ) / self.scale
        first = problem.force_n(np.arange(self.cells), start_ms[:-1], start_ms[1:]) / self.scale
        driving, braking = self._efforts(first)
        friction = self._variable(0.0, problem.friction_n / self.scale, 1e-3) if problem.friction_n > 0 else 0.0
        standing = self._standing()
        self._keep(driving["effort"] - braking["effort"] - standing["effort"] - friction - force, 0.0, 0.0)
        self._keep(driving["duty"] + braking["duty"] + standing["duty"], -math.inf, 1.0)
        faster, slower = problem.rates_ms2
        if math.isfinite(faster) or math.isfinite(slower):
            self._keep(rate, -slower, faster)
        self._vehicle_limits(driving, v, False)
        self._vehicle_limits(braking, v, True)
        if self._has_standstill_brake:
            # it does what the machines could, each while it brakes: together they would allow these more than they have
            self._vehicle_limits(standing, v, True)
            self._within_current(standing, v, -1.0)
        taken, given = self._powers(driving, braking, v)
        # what braking draws counts in full, what it gives back by the recuperation factor
        drawn = self._variable(0.0, math.inf, 1e-2)
        self._keep(drawn - given)
        line = taken + problem.factor * given + (1 - problem.factor) * drawn
        time = self.ca.sum1(h / v)
        self._keep(time, -math.inf, problem.running_time_s)
        return self.ca.sum1(h * line / v) + problem.auxiliary_w / self.scale * time

    def _efforts(self, first: FloatArray) -> tuple[dict[str, Any], dict[str, Any]]:
        """Return the variables of driving and of braking, started at efforts over the scale."""
        up, down = np.maximum(first, 0.0), np.maximum(-first, 0.0)
        driving = {
            "effort": self._variable(0.0, self.constant[0], up + 1e-2),
            "duty": self._variable(0.0, 1.0, 0.1 + 0.8 * up / max(up.max(), 1e-9)),
        }
        braking = {
            "effort": self._variable(0.0, self.constant[1], down + 1e-2),
            "duty": self._variable(0.0, 1.0, 0.05 + 0.8 * down / max(down.max(), 1e-9)),
        }
        return driving, braking

    @property
    def _has_standstill_brake(self) -> bool:
        return getattr(self.problem.scenario.vehicle.drive, "standstill_brake", False)

    def _standing(self) -> dict[str, Any]:
        """Return the variables of the standstill brake, nothing where there is none."""
        if not self._has_standstill_brake:
            return {"effort": 0.0, "duty": 0.0}
        return {"effort": self._variable(0.0, self.constant[1], 1e-3), "duty": self._variable(0.0, 1.0, 1e-2)}

    def _vehicle_limits(self, part: dict[str, Any], v: Any, braking: bool) -> None:
        vehicle = self.problem.scenario.vehicle
        limits = vehicle.braking if braking else vehicle.traction
        effort, duty = part["effort"], part["duty"]
        if limits.max_effort_kn is not None:
            self._keep(self.constant[braking] * duty - effort)
        if limits.max_power_kw is not None:
            self._keep(limits.max_power_kw * W_PER_KW / self.scale * duty - effort * v)

    def _powers(self, driving: dict[str, Any], braking: dict[str, Any], v: Any) -> tuple[Any, Any]:
        """Return what driving and what braking takes, over the scale of efforts."""
        drive = self.problem.scenario.vehicle.drive
        if isinstance(drive, LossPolynomial):
            return self._by_polynomial(drive, driving, v, 1.0), self._by_polynomial(drive, braking, v, -1.0)
        if not isinstance(drive, Induction):
            raise ValueError("no closed form of this drive stands here")
        self._within_current(driving, v, 1.0)
        self._within_current(braking, v, -1.0)
        return self._by_machines(drive, driving, v, 1.0), self._by_machines(drive, braking, v, -1.0)

    def _by_polynomial(self, drive: LossPolynomial, part: dict[str, Any], v: Any, sign: float) -> Any:
        turns, share = drive.gear_ratio / (0.5 * drive.wheel_diameter_m), 1 + sign * drive.gear_loss_share
        effort, duty, speed = part["effort"], part["duty"], turns * v
        torque = share / (drive.motors * turns) * self.scale
        idle = drive.no_load_loss_w + drive.speed_loss_w_per_rads * speed + drive.speed_loss_w_per_rads2 * speed**2
        copper = drive.torque_loss_w_per_nm2 * torque**2 * effort**2 / (duty + LEAST_DUTY)
        losses = idle * duty + drive.torque_loss_w_per_nm * torque * effort + copper
        return sign * share * effort * v + drive.motors / self.scale * losses

    def _by_machines(self, drive: Induction, part: dict[str, Any], v: Any, sign: float) -> Any:
        machine, ratio = _Machine(drive), self._variable(1e-3, 1e3, 1.0)
        strength, rotor = self._strength(drive, machine, part, sign), machine.pole_pairs * machine.turns * v
        self._within_flux_and_voltage(machine, part["duty"], strength, ratio, rotor, sign)
        field = rotor + sign * machine.slip_rate * ratio
        iron = (machine.hysteresis * self.ca.sqrt(field**2 + STILL**2) + machine.eddy * field**2) / ratio
        copper = 1.5 * machine.stator_ohm * (ratio + 1 / ratio)
        slip = machine.torque_constant * machine.slip_rate * ratio / machine.pole_pairs
        shaft = sign * machine.torque_constant * rotor / machine.pole_pairs
        return drive.motors / self.scale * strength * (shaft + copper + slip + iron)

    def _within_current(self, part: dict[str, Any], v: Any, sign: float) -> None:
        drive = self.problem.scenario.vehicle.drive
        current_a = drive.starting_current_a if sign > 0 else drive.braking_current_a
        machine, ratio = _Machine(drive), self._variable(1e-3, 1e3, 2.0)
        strength, rotor = self._strength(drive, machine, part, sign), machine.pole_pairs * machine.turns * v
        self._within_flux_and_voltage(machine, part["duty"], strength, ratio, rotor, sign)
        self._keep(part["duty"] - strength * (ratio + 1 / ratio) / current_a**2)

    def _strength(self, drive: Induction, machine: "_Machine", part: dict[str, Any], sign: float) -> Any:
        """Return the duty times the product of both currents [A2], kept above 0."""
        gear = 1 / drive.gear_efficiency if sign > 0 else drive.gear_efficiency
        torque = part["effort"] * (self.scale * gear / (drive.motors * machine.turns))
        strength = (torque + sign * part["duty"] * drive.mechanical_loss_torque_nm) / machine.torque_constant
        self._keep(strength / machine.flux2)
        return strength

    def _within_flux_and_voltage(
        self, machine: "_Machine", duty: Any, strength: Any, ratio: Any, rotor: Any, sign: float
    ) -> None:
        field = rotor + sign * machine.slip_rate * ratio
        along = machine.stator_ohm - sign * field * machine.leakage_h * ratio
        across = sign * machine.stator_ohm * ratio + field * machine.stator_h
        self._keep(duty * ratio - strength / machine.flux2)
        self._keep(duty - strength * (along**2 + across**2) / (ratio * machine.voltage2))


class _Machine:
    """One induction machine, in the frame of its rotor flux; symbols as in Rawicki's paper."""

    def __init__(self, drive: Induction) -> None:
        rotor, mutual = drive.rotor_inductance_mh * H_PER_MH, drive.mutual_inductance_mh * H_PER_MH
        rated = 2 * math.pi * drive.rated_frequency_hz
        self.turns = drive.gear_ratio / (0.5 * drive.wheel_diameter_m)
        self.pole_pairs = drive.pole_pairs
        self.stator_ohm = drive.stator_resistance_ohm
        self.stator_h = drive.stator_inductance_mh * H_PER_MH
        self.leakage_h = self.stator_h - mutual**2 / rotor
        self.slip_rate = drive.rotor_resistance_ohm / rotor
        self.torque_constant = 1.5 * drive.pole_pairs * mutual**2 / rotor
        self.flux2 = drive.rated_magnetising_current_a**2
        self.voltage2 = drive.max_phase_voltage_v**2
        self.hysteresis = drive.hysteresis_loss_w / rated / self.flux2
        self.eddy = drive.eddy_loss_w / rated**2 / self.flux2


def even_run(problem: Problem, fastest_ms: FloatArray) -> FloatArray:
    """Return the fastest run cut off at the speed that takes most of the time allowed [m/s]; shape (n + 1,)."""
    low, high = 0.0, float(fastest_ms.max())
    for _ in range(60):
        middle = 0.5 * (low + high)
        speed = np.minimum(fastest_ms, middle)
        time = float(np.sum(2 * problem.length_m / (speed[1:] + speed[:-1])))
        low, high = (middle, high) if time > 0.99 * problem.running_time_s else (low, middle)
    return np.minimum(fastest_ms, high)
