"""A train driven in steps of a millisecond along the speed of a plan, its efforts limited at each instant.

It shares no code of motion with the product. Resistance, the line under the train and the limits of effort are those of
`railjoule.core.check`, which the product's solvers do not use; where the product tabulates a limit of motors, the lower
of both holds. Only the electrical power of an effort at a speed is the product's.

In each step the train aims at the next node of the plan with a constant acceleration. It drives where the plan drives,
brakes where it brakes, and coasts where it coasts, as long as its speed is near that of the plan.
"""

from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numba
import numpy as np

from railjoule.core import Trajectory
from railjoule.core.arrays import FloatArray
from railjoule.core.check.drives import loss_model
from railjoule.core.check.train import Route, adhesion_limits_n, build_route, build_train, stated_limits_n
from railjoule.core.drive import make_drive
from railjoule.core.drive.line_power import line_power
from railjoule.core.motion import build_meshed_line
from railjoule.core.physics.braking import electric_efforts
from railjoule.core.scenario import Scenario
from railjoule.core.units import MS_PER_KMH, N_PER_KN, W_PER_KW

STEP_S = 1e-3
MAX_STEPS = 3_000_000
"""A run that needs more is driven in longer steps, of 2 ms after 50 minutes."""
LINE_STEP_M, SPEED_STEPS = 0.1, 5000
AHEAD_M = 0.2
"""A node that is nearer is left out, but at a stop: the aim would be at less than the way of a few steps."""
NO_EFFORT_SHARE, NEAR_SHARE = 1e-4, 0.1
"""Below this share of its largest effort a plan coasts; beyond this share of its square of speed the train steers."""
ENDED_SPEED2, ENDED_M = 1e-3, 0.01
"""A train this slow, this close to a stop, has arrived."""
BRAKING_RESERVE_SHARE = 5e-4
"""The train begins to brake so early that the brakes suffice without this share."""
PASSING_SHARE = 1e-3
"""A prescribed speed at a passing point is kept within this share."""
EXIT_M = 20.0
"""So near to an end that is passed at a given speed, the train steers towards it also where the plan coasts."""
COAST, DRIVE, BRAKE = 0, 1, -1


class Line(NamedTuple):
    """The line between two stops over k equal steps.

    Parameters
    ----------
    from_m, step_m : float
        Its start, and the length of a step [m].
    force_n, quadratic, powered : array of shape (k,)
        Force of gradients and curves [N], C [N s2/m2], and 1 where there is traction power, else 0.
    guarded_speed2 : array of shape (k + 1,)
        Squares of speed from which the brakes suffice for all limits and stops ahead [m2/s2].
    """

    from_m: float
    step_m: float
    force_n: FloatArray
    quadratic: FloatArray
    powered: FloatArray
    guarded_speed2: FloatArray


class Efforts(NamedTuple):
    """Largest efforts of the drive over equal steps of speed, and of the friction brakes [N]."""

    step_ms: float
    traction_n: FloatArray
    electric_n: FloatArray
    friction_n: float


class Mass(NamedTuple):
    """Inertia [kg], A [N] and B [N s/m] of the running resistance, and limits of dv/dt [m/s2]."""

    inertia_kg: float
    constant_n: float
    linear: float
    acceleration_ms2: float
    deceleration_ms2: float


class Plan(NamedTuple):
    """Nodes between two stops [m], squares of speed there [m2/s2], and action and effort [N] of each cell."""

    position_m: FloatArray
    speed2: FloatArray
    action: FloatArray
    effort_n: FloatArray


@dataclass(frozen=True)
class ContinuousRun:
    """Energy and time of such a run.

    Parameters
    ----------
    energy_j : float
        Net energy at the supply, auxiliaries included [J].
    travel_time_s : float
        Dwells included [s].
    excess_share : float
        By how much it exceeds a speed limit or misses a prescribed speed, as a share of that speed.
    """

    energy_j: float
    travel_time_s: float
    excess_share: float


def drive_plan(plan: Trajectory, step_s: float = STEP_S) -> ContinuousRun | None:
    """Return the run of a train that follows a plan; None if it stands before a stop."""
    scenario, route = plan.scenario, build_route(plan.scenario)
    efforts, mass = _efforts(plan), _mass(scenario)
    step_s = max(step_s, plan.travel_time_s / MAX_STEPS)
    energy_j, time_s, excess = 0.0, 0.0, 0.0
    # a stop is one node, or two with a dwell between them
    stops = np.flatnonzero(plan.speed_ms[1:-1] <= 0) + 1
    for first, last in pairwise([0, *stops, len(plan.speed_ms) - 1]):
        if plan.position_m[first] == plan.position_m[last]:
            time_s += plan.time_s[last] - plan.time_s[first]
            continue
        leg = _leg(plan, first, last)
        line = _line(plan, route, leg)
        guard(line, efforts, mass)
        most = int(1.3 * (plan.time_s[last] - plan.time_s[first]) / step_s) + 1000
        effort, speed, place, duration = (np.zeros(most) for _ in range(4))
        count = integrate(leg, line, efforts, mass, step_s, effort, speed, place, duration)
        if count < 0:
            return None
        done = slice(count)
        powered = line.powered[
            np.minimum(((place[done] - line.from_m) / line.step_m).astype(int), len(line.force_n) - 1)
        ]
        energy_j += _energy_j(scenario, efforts, powered, (effort[done], speed[done], duration[done]))
        time_s += float(duration[done].sum())
        excess = max(excess, _excess(plan, route, speed[done], place[done]))
    return ContinuousRun(energy_j + scenario.vehicle.auxiliary_power_kw * W_PER_KW * time_s, time_s, excess)


@numba.njit(error_model="numpy", nogil=True)  # type: ignore[untyped-decorator]
def guard(line: Line, efforts: Efforts, mass: Mass) -> None:
    """Lower the guarded speeds, backwards, to those from which a little less than all brakes suffices."""
    for i in range(line.force_n.shape[0] - 1, -1, -1):
        w, slowing, electric = line.guarded_speed2[i + 1], 0.0, np.inf
        # the brakes' least effort at either end of the step, and the resistance at the lower of both speeds
        for _ in range(2):
            x = (w + 2.0 * slowing * line.step_m) ** 0.5 / efforts.step_ms
            j = min(int(x), efforts.electric_n.shape[0] - 2)
            here = efforts.electric_n[j] + (x - j) * (efforts.electric_n[j + 1] - efforts.electric_n[j])
            electric = min(electric, here)
            braking = (1.0 - BRAKING_RESERVE_SHARE) * (line.powered[i] * electric + efforts.friction_n)
            resisting = mass.constant_n + mass.linear * w**0.5 + line.quadratic[i] * w + line.force_n[i]
            slowing = max(min((braking + resisting) / mass.inertia_kg, mass.deceleration_ms2), 0.0)
        line.guarded_speed2[i] = min(line.guarded_speed2[i], w + 2.0 * slowing * line.step_m)


@numba.njit(error_model="numpy", nogil=True)  # type: ignore[untyped-decorator]
def integrate(
    plan: Plan,
    line: Line,
    efforts: Efforts,
    mass: Mass,
    step_s: float,
    effort: FloatArray,
    speed: FloatArray,
    place: FloatArray,
    duration: FloatArray,
) -> int:
    """Fill the effort, mean speed, place and duration of each step; return their number, -1 if the train stands."""
    last = plan.position_m.shape[0] - 1
    end, end2 = plan.position_m[last], plan.speed2[last]
    s, v, a, cell, kept = plan.position_m[0], plan.speed2[0] ** 0.5, 0.0, 0, 0.0
    for k in range(effort.shape[0]):
        while cell < last - 1 and plan.position_m[cell + 1] <= s:
            cell += 1
        # the middle of the step, with the last acceleration: the error falls with the square of the step
        v_mid = max(v + 0.5 * a * step_s, 0.0)
        i = min(int((s - line.from_m + 0.5 * v * step_s) / line.step_m), line.force_n.shape[0] - 1)
        resisting = mass.constant_n + mass.linear * v_mid + line.quadratic[i] * v_mid * v_mid + line.force_n[i]
        x = v_mid / efforts.step_ms
        j = min(int(x), efforts.traction_n.shape[0] - 2)
        top = line.powered[i] * (efforts.traction_n[j] + (x - j) * (efforts.traction_n[j + 1] - efforts.traction_n[j]))
        low = line.powered[i] * (efforts.electric_n[j] + (x - j) * (efforts.electric_n[j + 1] - efforts.electric_n[j]))
        top = min(top, mass.inertia_kg * mass.acceleration_ms2 + resisting)
        low = max(-low - efforts.friction_n, min(resisting - mass.inertia_kg * mass.deceleration_ms2, 0.0))
        aim = cell + 1
        while aim < last and plan.position_m[aim] - s < AHEAD_M and plan.action[aim] == plan.action[cell]:
            aim += 1
        f = mass.inertia_kg * (plan.speed2[aim] - v * v) / (2.0 * max(plan.position_m[aim] - s, 1e-9)) + resisting
        share = (s - plan.position_m[cell]) / (plan.position_m[cell + 1] - plan.position_m[cell])
        planned2 = plan.speed2[cell] + share * (plan.speed2[cell + 1] - plan.speed2[cell])
        far = abs(v * v - planned2) > NEAR_SHARE * planned2 + 1e-6 or (end2 > 0.0 and end - s < EXIT_M)
        if plan.action[cell] == DRIVE:
            kept, f = plan.effort_n[cell], f if far else max(f, 0.0)
        elif plan.action[cell] == BRAKE:
            kept, f = 0.0, f if far else min(f, 0.0)
        else:
            # after power, the train keeps the effort until it has the speed with which the plan coasts
            kept = kept if v * v < planned2 else 0.0
            f = f if far else kept
        before = line.from_m + (i + 1) * line.step_m - s
        if before > 0.0:
            f = min(f, mass.inertia_kg * (line.guarded_speed2[i + 1] - v * v) / (2.0 * before) + resisting)
        f = max(min(f, max(top, 0.0)), low)
        a = (f - resisting) / mass.inertia_kg
        taken = step_s
        if v * taken + 0.5 * a * taken * taken >= end - s:
            # s = v t + a t^2 / 2, solved for the time without a difference of like numbers
            taken = 2.0 * (end - s) / (v + max(v * v + 2.0 * a * (end - s), 0.0) ** 0.5)
        elif v + a * taken <= 0.0:
            if end2 <= 0.0 and end - s <= ENDED_M and v * v <= ENDED_SPEED2:
                return k
            return -1
        effort[k], speed[k], place[k], duration[k] = f, v + 0.5 * a * taken, s, taken
        s, v = s + v * taken + 0.5 * a * taken * taken, v + a * taken
        if taken < step_s:
            return k + 1 if v * v <= end2 * (1 + 1e-3) + ENDED_SPEED2 and v * v >= end2 * (1 - 1e-6) else -1
    return -1


def _leg(plan: Trajectory, first: int, last: int) -> Plan:
    nodes, cells = slice(first, last + 1), slice(first, last)
    effort = plan.effort_n[cells]
    action = np.where(np.abs(effort) <= NO_EFFORT_SHARE * np.max(np.abs(plan.effort_n)), COAST, np.sign(effort))
    return Plan(plan.position_m[nodes].copy(), plan.speed_ms[nodes] ** 2, action.astype(float), effort.copy())


def _mass(scenario: Scenario) -> Mass:
    vehicle = scenario.vehicle
    train = build_train(vehicle, scenario.line.head_wind_kmh * MS_PER_KMH)
    rise, fall = vehicle.traction.max_acceleration_ms2 or np.inf, vehicle.braking.max_deceleration_ms2 or np.inf
    return Mass(train.inertia_kg, train.constant_n, train.linear, rise, fall)


def _line(plan: Trajectory, route: Route, leg: Plan) -> Line:
    """Return the means of the line over steps of a tenth of a metre, and its limits as the guarded speeds."""
    scenario, start, end = plan.scenario, float(leg.position_m[0]), float(leg.position_m[-1])
    borders = np.linspace(start, end, int(np.ceil((end - start) / LINE_STEP_M)) + 1)
    cells = borders[:-1], borders[1:]
    train = build_train(scenario.vehicle, scenario.line.head_wind_kmh * MS_PER_KMH)
    curves = train.curve_constant_m_n_per_kn * route.curvature_per_m(*cells)
    powered = np.ones(len(borders) - 1)
    for begins, ends in route.neutral:
        powered[(cells[1] > begins) & (cells[0] < ends)] = 0.0
    # the lowest limit in a step holds for all of it and for both of its ends
    inside = [route.speed_limit_ms(cells[0] + share * (borders[1] - start)) for share in (1e-6, 0.5, 1 - 1e-6)]
    limit = np.minimum(np.min(inside, axis=0), scenario.vehicle.traction.max_speed_kmh * MS_PER_KMH)
    limit = np.minimum(np.append(limit[0], limit), np.append(limit, limit[-1]))
    if plan.permitted_speed_ms is not None:
        limit = np.minimum(limit, np.sqrt(np.interp(borders, plan.position_m, plan.permitted_speed_ms**2)))
    limit[-1] = leg.speed2[-1] ** 0.5
    for position_m, passing_ms in route.passes:
        limit[np.abs(borders - position_m) < borders[1] - start] = passing_ms
    force = train.weight_kn * (route.gradient_permille(*cells) + curves)
    return Line(
        start, float(borders[1]) - start, force, train.quadratic * route.tunnel_factor(*cells), powered, limit**2
    )


def _efforts(plan: Trajectory) -> Efforts:
    """Return the largest efforts over speed: the lower of the check's limits and of the product's."""
    scenario, vehicle = plan.scenario, plan.scenario.vehicle
    speed = np.linspace(0, 1.001 * vehicle.traction.max_speed_kmh * MS_PER_KMH, SPEED_STEPS)
    model, data = loss_model(vehicle.drive), build_meshed_line(scenario, position_m=plan.nodes_m).data
    driven, braked = adhesion_limits_n(scenario, speed, scenario.line.rail_condition)
    efforts = []
    for limits, product, braking in ((vehicle.traction, data.traction, False), (vehicle.braking, data.braking, True)):
        stated = stated_limits_n(limits, speed).values()
        own = np.minimum.reduce([*stated, model.max_effort_n(speed, braking), driven])
        efforts.append(np.minimum(own, product.effort_n(np.maximum(speed, 1e-9))))
    return Efforts(float(speed[1]), *efforts, min(vehicle.braking.friction_effort_kn * N_PER_KN, float(np.min(braked))))


def _energy_j(
    scenario: Scenario, efforts: Efforts, powered: FloatArray, steps: tuple[FloatArray, FloatArray, FloatArray]
) -> float:
    """Return the energy that the drive takes from the supply less what it returns, by effort, speed, duration [J]."""
    drive, (effort, speed, duration) = make_drive(scenario.vehicle.drive), steps
    speed = np.maximum(speed, 1e-9)
    total, pulls, brakes = 0.0, effort > 0, effort < 0
    power = drive.electrical_power_w(effort[pulls], speed[pulls])
    total += float(power @ duration[pulls])
    braking, v = -effort[brakes], speed[brakes]
    strongest = powered[brakes] * np.interp(v, efforts.step_ms * np.arange(SPEED_STEPS), efforts.electric_n)
    electric = electric_efforts(drive.kind, drive.parameters, braking, v, strongest, efforts.friction_n)
    power = np.where(electric > 0, drive.electrical_power_w(-electric, v), 0.0)
    return total + float(line_power(power, drive.recuperation_factor) @ duration[brakes])


def _excess(plan: Trajectory, route: Route, speed: FloatArray, place: FloatArray) -> float:
    """Return by how much the run exceeds its limits, as a share of the limit."""
    limit = np.minimum(route.speed_limit_ms(place), plan.scenario.vehicle.traction.max_speed_kmh * MS_PER_KMH)
    excess = float(np.max(speed / limit)) - 1
    if plan.permitted_speed_ms is not None:
        # a braking curve is kept within a step of the line
        nearby = [np.interp(place - step, plan.position_m, plan.permitted_speed_ms**2) for step in (0.0, LINE_STEP_M)]
        allowed = np.sqrt(np.max(nearby, axis=0))
        excess = max(excess, float(np.max((speed - allowed) / np.maximum(allowed, 1.0))))
    for position_m, passing_ms in route.passes:
        if place[0] < position_m < place[-1]:
            missed = abs(float(np.interp(position_m, place, speed)) / passing_ms - 1)
            # the speeds are those of the middles of steps
            excess = max(excess, missed if missed > PASSING_SHARE else 0.0)
    return max(excess, 0.0)
