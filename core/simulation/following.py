"""A train that follows a planned speed with the load that it really carries, at its own estimate of its position.

Source: Liashenko, Yatsko 2025, (10)-(11) and Figure 2. The plan is a speed over distance. The controller's law is
Delta(s + h) = Delta(s) exp(-h / L): Delta is the square of the measured speed less that of the plan at the estimated
position, L the response length. On the plan it stays there, beside it it comes back without overshoot, and requests
the effort that this needs as long as the real train has it. Within the launch, until the plan's first acceleration
ends, it follows the faster of the plan at the estimated position and the plan at the distance covered, as a train
that estimates to stand before its station would otherwise never start.

The position is measured with errors, and sensors correct it before the stop: D1 sets it; from D1 to D2 the measured
distance is compared with the known one, which calibrates speed and distance from there on; D3 sets it again.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.best_known import ON_TIME_S
from railjoule.core.errors import InfeasibleLineError, ScenarioError, SolverError, TimetableError
from railjoule.core.motion import MeshedLine, build_meshed_line
from railjoule.core.motion.driving import STANDING_SPEED2, brake_fully, drive
from railjoule.core.motion.mesh import line_borders, with_nodes_at
from railjoule.core.physics.mesh_data import at_place, data_between
from railjoule.core.scenario import Scenario
from railjoule.core.scenario.options import SimulationOptions
from railjoule.core.simulation.actual_vehicle import actual_vehicle, actually_loaded, notes_on
from railjoule.core.simulation.leg import DrivenPlan, make_leg
from railjoule.core.strategies import Task, run_strategy
from railjoule.core.strategies.line_parts import cut_part
from railjoule.core.strategies.optimal import unwindowed_optimum
from railjoule.core.task import task_over
from railjoule.core.trajectory import Trajectory, make_trajectory
from railjoule.core.units import N_PER_KN

Position = TypeVar("Position", float, FloatArray)
# Cells beyond a stop that the brakes did not reach, and how many: 10 km, more than any brake that works needs. A
# shorter cell only refines where it stands, which is found within the last one anyway.
OVERRUN_CELL_M, LONGEST_OVERRUN_CELLS = 5.0, 2000


@dataclass(frozen=True)
class Stretch:
    """A part of a meshed line between two sensors: the estimate is `estimated_m` + `scale` (position - `from_m`).

    Parameters
    ----------
    from_m : float
        Its begin [m].
    estimated_m : float
        Estimated position there [m].
    scale : float
        Measured speed over the true one.
    sensor : str
        Which sensor it begins at: D1, D2, D3; empty at a start.
    """

    from_m: float
    estimated_m: float
    scale: float
    sensor: str = ""

    def estimated(self, position_m: Position) -> Position:
        """Return the estimated position [m] at a true one [m]."""
        return self.estimated_m + self.scale * (position_m - self.from_m)

    def true(self, estimated_m: Position) -> Position:
        """Return the true position [m] of an estimated one [m]."""
        return self.from_m + (estimated_m - self.estimated_m) / self.scale


@dataclass(frozen=True, eq=False)
class Following(DrivenPlan):
    """A plan and the run of a train that followed it.

    Parameters
    ----------
    stop_errors_m : tuple of float
        Overshoot at each stop, negative where the train stops short [m].
    stretches : tuple of list of Stretch
        Estimated positions between one stop and the next.
    departure_delay_s : float
        How much later than planned it left [s].
    arrival_delays_s : tuple of float
        How much later than planned it arrived at each stop, the end included [s].
    """

    stop_errors_m: tuple[float, ...]
    stretches: tuple[list[Stretch], ...]
    departure_delay_s: float
    arrival_delays_s: tuple[float, ...]

    @property
    def delay_s(self) -> float:
        """How much later than planned it arrived [s]."""
        return self.departure_delay_s + self.actual.travel_time_s - self.planned.travel_time_s

    @property
    def notes(self) -> tuple[str, ...]:
        """A sentence on the target curves that the plan keeps to, and needs more energy for than one without them."""
        options = self.actual.scenario.simulation
        if not options.target_braking:
            return ()
        return (
            f"The plan brakes along target curves of {options.target_deceleration_ms2:g} m/s2; "
            "simulation.target_braking = false plans without them.",
        )


def simulate_following(scenario: Scenario) -> Following:
    """Plan a scenario, and follow the plan under its disturbance.

    Raises
    ------
    RailjouleError
        As `railjoule.core.solve` for the plan; InfeasibleLineError if the real train comes to a stand before a stop.
    """
    return follow(plan_for(scenario), scenario)


def plan_for(scenario: Scenario) -> Trajectory:
    """Return the plan of a scenario, under the target braking curves unless they are off."""
    return run_strategy(plannable_task(scenario), scenario.strategy)


def plan_knowing_load(scenario: Scenario, load_factor: float | None = None) -> Trajectory | None:
    """Return the plan with a load, by default the actual one, or None if there is none."""
    vehicle = scenario.vehicle
    loaded = actually_loaded(vehicle, scenario.disturbance) if load_factor is None else vehicle.with_load(load_factor)
    known = scenario.with_fixed_time().model_copy(update={"vehicle": loaded})
    try:
        return plan_for(known)
    except (InfeasibleLineError, TimetableError, SolverError):
        return None


def plannable_task(scenario: Scenario) -> Task:
    """Return the task of a scenario with the target braking curves (11) before its stops as speed limits."""
    mesh, options = build_meshed_line(scenario), scenario.simulation
    if not options.target_braking:
        return task_over(scenario, mesh)
    largest = mesh.data.limit_speed2
    # the target curve begins at D1, where the train learns its position; without that sensor it holds all along
    zone = options.reset_sensor_m or mesh.length_m
    for stop in stop_positions_m(scenario):
        before = stop - mesh.position_m
        inside = (before >= 0) & (before <= zone)
        # the end of the line may be passed in motion, a station not
        end_ms = scenario.timetable.end_speeds_ms[1] if stop >= mesh.position_m[-1] else 0.0
        curve = 2 * options.target_deceleration_ms2 * before + end_ms**2
        largest = np.where(inside, np.minimum(largest, curve), largest)
    task = task_over(scenario, replace(mesh, data=mesh.data._replace(limit_speed2=largest)))
    return replace(task, can_be_remeshed=False)


def stop_positions_m(scenario: Scenario) -> list[float]:
    """Return the stops of a run, its end included [m]."""
    line = scenario.line.in_running_order()
    return [*(station.position_m for station in line.inner_stations), line.length_m]


Replan = Callable[[float, float], Trajectory]
"""Returns the plan from the stop at a place [m] to the end, for the time that is left there [s]."""


def replanned_rests(scenario: Scenario) -> Replan:
    """Return the optimum of the rest of a scenario's line, or where the time is too short, its fastest run."""
    task = plannable_task(scenario)

    def replan(position_m: float, left_s: float) -> Trajectory:
        node, last = int(np.argmin(np.abs(task.position_m - position_m))), task.mesh.cell_count
        dwells_s = float(task.mesh.dwell_s[node + 1 : last].sum())
        part = cut_part(task, node, last, left_s - dwells_s)
        if part.has_slack:
            return unwindowed_optimum(part)
        return make_trajectory(scenario, part.mesh, "fastest", part.fastest_speed2)

    return replan


def follow(
    planned: Trajectory, scenario: Scenario, dwell_delays_s: Sequence[float] = (), replan: Replan | None = None
) -> Following:
    """Return the run of a train that follows a plan under the disturbance of a scenario.

    Parameters
    ----------
    planned : Trajectory
        The plan over the scenario's line.
    scenario : Scenario
        With its disturbance: the load really carried, the position error, the sensors.
    dwell_delays_s : sequence of float, optional
        By how much the dwell at each station differs from the planned one [s]; then the train leaves no station before
        its planned departure.
    replan : callable, optional
        Plans the rest at each late departure; by default the speeds stay those of the plan.

    Raises
    ------
    ScenarioError
        If the position error or a sensor lies beyond the distance from one stop to the next.
    InfeasibleLineError
        If the train comes to a stand before a stop.
    """
    _require_errors_within_a_section(scenario)
    real = actual_vehicle(scenario)
    entry2 = planned.speed_ms[:1] ** 2
    nodes, speeds, stop_nodes, errors, estimates = [np.zeros(1)], [entry2], [], [], []
    start, planned_start = 0.0, 0.0
    stops_m, plan, target = stop_positions_m(scenario), make_leg(planned), planned
    # a plan may wait for a window of arrival, at the start as well: more than the dwells of the stations
    stands = [plan.dwell_s[np.argmin(np.abs(plan.position_m - place))] for place in (0.0, *stops_m[:-1])]
    due_s = [planned.arrival_s(place) for place in stops_m]
    late_s, delays = scenario.disturbance.departure_delay_s, []
    time_s = late_s + stands[0]
    for number, stop in enumerate(stops_m):
        if replan is not None and late_s > ON_TIME_S:
            target = replan(planned_start, due_s[-1] - time_s)
        stretched = stretches(start, stop, scenario.disturbance.coordinate_error_m, scenario.simulation)
        leg, speed2 = _drive_leg(target, real, stretched, (start, planned_start, stop))
        nodes.append(leg[1:])
        speeds.append(speed2[1:])
        errors.append(float(leg[-1] - stop))
        estimates.append(stretched)
        stop_nodes.append(sum(map(len, nodes)) - 1)
        start, planned_start = float(leg[-1]), stop
        speed = np.sqrt(speed2)
        time_s += float(np.sum(2 * np.diff(leg) / (speed[1:] + speed[:-1])))
        delays.append(time_s - due_s[number])
        if number < len(dwell_delays_s):
            departure_s = due_s[number] + stands[number + 1]
            stands[number + 1] = max(departure_s, time_s + stands[number + 1] + dwell_delays_s[number]) - time_s
            late_s = time_s + stands[number + 1] - departure_s
        if number + 1 < len(stands):
            time_s += stands[number + 1]
    mesh = build_meshed_line(real, position_m=np.concatenate(nodes))
    dwell = np.zeros(mesh.cell_count + 1)
    dwell[[0, *stop_nodes[:-1]]] = stands
    mesh = replace(mesh, dwell_s=dwell)
    actual = make_trajectory(real, mesh, planned.strategy, np.concatenate(speeds), notes=notes_on(scenario))
    delay_s = scenario.disturbance.departure_delay_s
    return Following(planned, actual, tuple(errors), tuple(estimates), delay_s, tuple(delays))


def _require_errors_within_a_section(scenario: Scenario) -> None:
    """Raise ScenarioError where a position error or a sensor lies beyond the distance between two stops."""
    shortest, options = min(np.diff([0.0, *stop_positions_m(scenario)])), scenario.simulation
    lengths = {"disturbance.coordinate_error_m": scenario.disturbance.coordinate_error_m}
    if options.target_braking:
        lengths["simulation.reset_sensor_m"] = options.reset_sensor_m or 0.0
        lengths["simulation.stop_sensor_m"] = options.stop_sensor_m or 0.0
    for key, length in lengths.items():
        if abs(length) >= shortest:
            raise ScenarioError(
                f"{key} = {length:g} must be less than the shortest distance between two stops, {shortest:g} m."
            )


def _drive_leg(
    planned: Trajectory, real: Scenario, stretched: list[Stretch], places: tuple[float, float, float]
) -> tuple[FloatArray, FloatArray]:
    """Return nodes [m] and squares of speed from one stop to the next."""
    start, planned_start, stop = places
    inside = (planned.position_m >= planned_start - 1e-6) & (planned.position_m <= stop + 1e-6)
    plan_m, plan2 = planned.position_m[inside], planned.speed_ms[inside] ** 2
    nodes = _leg_mesh(plan_m, real, stretched, start, stopping_position(stretched, stop))
    estimated, scale = estimated_positions(stretched, nodes)
    # it is the measured speed that is held to the plan
    target2 = np.interp(estimated, plan_m, plan2) / scale**2
    launch = _launch_end(planned, plan_m, plan2)
    covered = np.minimum(nodes - start + planned_start, plan_m[launch])
    target2 = np.where(estimated < plan_m[launch], np.maximum(target2, np.interp(covered, plan_m, plan2)), target2)
    # a leg begins and ends at rest but where the plan itself enters or leaves the line in motion
    target2[[0, -1]] = plan2[[0, -1]]
    mesh = build_meshed_line(real, position_m=nodes)
    speed2, stand = drive(mesh.data, target2, float(plan2[0]), response_m=real.simulation.response_length_m)
    if stand >= 0:
        raise InfeasibleLineError(_stand_reason(mesh, stand))
    arrives = speed2[-1] <= STANDING_SPEED2 or plan2[-1] > STANDING_SPEED2
    return (nodes, speed2) if arrives else _overrun(nodes, speed2, real)


def _stand_reason(mesh: MeshedLine, node: int) -> str:
    """Return why a train comes to a stand at a node."""
    cell = node - 1
    needed = mesh.gradient_force_n[cell] + mesh.curve_force_n[cell] + mesh.data.resistance_constant_n
    needed += mesh.data.starting_n
    effort = at_place(mesh.data, mesh.data.place[cell]).traction.constant_n * mesh.data.supply_share[cell]
    return (
        f"At {mesh.position_m[node]:.0f} m, on a gradient of {mesh.gradient_permille[cell]:.4g} per mille, the "
        f"train with its actual load comes to a stand: to start there takes {needed / N_PER_KN:.1f} kN, and it pulls "
        f"with {effort / N_PER_KN:.1f} kN at most. Use a lower actual load or resistance_factor under disturbance."
    )


def _leg_mesh(plan_m: FloatArray, real: Scenario, stretched: list[Stretch], start: float, end: float) -> FloatArray:
    """Return nodes [m]: where the train passes the plan's nodes, where the line changes, where the sensors stand."""
    passed = []
    for stretch, until in zip(stretched, [*(after.from_m for after in stretched[1:]), end], strict=True):
        positions = stretch.true(plan_m)
        passed.append(positions[(positions > stretch.from_m) & (positions < until)])
    own = np.unique(np.concatenate([[start], *passed, [end]]))
    own = own[(own >= start) & (own <= end)]
    fixed = [
        *line_borders(real.line.in_running_order(), real.limits_last_m),
        *(stretch.from_m for stretch in stretched[1:]),
    ]
    # a start that is estimated beyond the station leaves the plan's first nodes out
    fixed += list(np.arange(start, end, real.solver.mesh_m))
    return with_nodes_at(own, [position for position in fixed if start + 1e-3 < position < end - 1e-3])


def _launch_end(planned: Trajectory, plan_m: FloatArray, plan2: FloatArray) -> int:
    """Return the node of a leg at which the plan's first acceleration under power ends."""
    first = int(np.searchsorted(planned.position_m, plan_m[0] - 1e-6))
    effort = planned.tractive_effort_n[first : first + len(plan_m) - 1]
    ended = np.flatnonzero((effort <= 0) | (np.diff(plan2) <= 0))
    # a dwell before the leg is a cell without length
    ended = ended[plan_m[ended] > plan_m[0]]
    return int(ended[0]) if len(ended) else len(plan_m) - 1


def _overrun(nodes: FloatArray, speed2: FloatArray, real: Scenario) -> tuple[FloatArray, FloatArray]:
    """Return a leg and full braking beyond a stop that the brakes did not reach."""
    stop = nodes[-1]
    beyond = stop + OVERRUN_CELL_M * np.arange(1, LONGEST_OVERRUN_CELLS)
    # the first cell is the last one of the leg, so that gradients and limits go on from there
    data = build_meshed_line(real, position_m=np.concatenate([nodes[-2:], beyond])).data
    braked2, distance = brake_fully(data_between(data, 1, len(beyond)), float(speed2[-1]))
    if math.isnan(distance):
        raise InfeasibleLineError(f"Beyond {stop:.0f} m the brakes of the train with its actual load cannot stop it.")
    passed = beyond[beyond < stop + distance]
    ends = np.append(passed, stop + distance)
    return np.append(nodes, ends), np.concatenate([speed2, braked2[1 : len(passed) + 1], [0.0]])


def stretches(start_m: float, stop_m: float, coordinate_error_m: float, options: SimulationOptions) -> list[Stretch]:
    """Return the stretches of the meshed line from one stop to the next, in order.

    Parameters
    ----------
    start_m, stop_m : float
        Start of the train, and its stop [m].
    coordinate_error_m : float
        How much further on the train estimates to be at its start [m].
    options : SimulationOptions
        Sensors and errors of measurement.
    """
    measured = 1.0 + options.speed_error
    # sensors belong to the target braking: without it the train drives to its stop on its own estimate
    mesh = [Stretch(start_m, start_m + coordinate_error_m, measured)]
    if not options.target_braking:
        return mesh
    errors, reset, calibration = options.sensor_errors_m, options.reset_sensor_m, options.calibration_length_m
    scale = measured
    if reset is not None and stop_m - reset + errors[0] > start_m:
        first = stop_m - reset + errors[0]
        mesh.append(Stretch(first, stop_m - reset, scale, "D1"))
        # D2 calibrates only a train that comes to it after D1: errors of the sensors may reverse their order
        second = stop_m - reset + (calibration or 0.0) + errors[1]
        if calibration is not None and second > first:
            # what the distance between the sensors should measure, over what it measured
            scale *= calibration / (measured * (second - first))
            mesh.append(Stretch(second, mesh[-1].estimated(second), scale, "D2"))
    if options.stop_sensor_m is not None and stop_m - options.stop_sensor_m + errors[2] > mesh[-1].from_m:
        mesh.append(Stretch(stop_m - options.stop_sensor_m + errors[2], stop_m - options.stop_sensor_m, scale, "D3"))
    return mesh


def stopping_position(mesh: list[Stretch], stop_m: float) -> float:
    """Return the position of a train whose estimate is the stop [m]: after the last sensor that it passes."""
    for stretch, after in zip(mesh, [*mesh[1:], None], strict=True):
        position = stretch.true(stop_m)
        if after is None or position <= after.from_m:
            return position
    raise AssertionError("the last stretch has no end")


def estimated_positions(mesh: list[Stretch], position_m: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the estimated positions [m] and the scales of the measured speed at true positions [m]; as many."""
    starts = np.array([stretch.from_m for stretch in mesh])
    index = np.clip(np.searchsorted(starts, position_m, side="right") - 1, 0, len(mesh) - 1)
    offset = np.array([stretch.estimated_m for stretch in mesh])[index]
    scale = np.array([stretch.scale for stretch in mesh])[index]
    return offset + scale * (position_m - starts[index]), scale
