"""The run in four phases, as tram drivers know it: start, cruise, coast, brake.

The start is at full effort or with a current that is given or free, braking is full electric braking, and between them
the train holds its speed, then coasts. Stops and changes of the speed limit divide the line into parts whose times
are chosen together. Source: Rawicki, (44)-(55). The searches are in `railjoule.core.phase_planning`: of tables over
speed on a plain line, which has one limit, gradient and curve, and cell by cell on all others.
"""

from dataclasses import replace
from itertools import pairwise

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.errors import StrategyRefusedError, TimetableError
from railjoule.core.motion import MeshedLine, build_meshed_line, running_time
from railjoule.core.phase_planning.line_planner import LinePlan, plan_line
from railjoule.core.phase_planning.plan import PhasePlan, lay_out
from railjoule.core.phase_planning.planner import ON_TIME, PhasePlanner
from railjoule.core.phase_planning.tables import phase_model
from railjoule.core.physics.adhesion import adhesive_weight
from railjoule.core.strategies.plain_line import (
    check_accelerations,
    check_speeds,
    plain_limits_ms,
    require_line_without,
)
from railjoule.core.strategy import Strategy, register
from railjoule.core.task import Task
from railjoule.core.trajectory import Trajectory, make_trajectory
from railjoule.core.units import MS_PER_KMH, N_PER_KN

# Forces and limits that differ by less are the same; a force as a share of half the inertia, which is a difference of
# acceleration of 5e-10 m/s2
UNEVEN = 1e-9
SAME_KMH = 0.05
"""Speeds that differ by less are one speed in a sentence."""
SLOWEST_BRAKE_KMH = 0.05
"""Below this speed one decimal would round the start of braking to 0."""
MAX_SENTENCES = 8
"""A run of more stretches is not described stretch by stretch."""


def phases(task: Task) -> Trajectory:
    """Compute the best start / cruise / coast / brake run.

    Raises
    ------
    TimetableError
        If the timetable cannot be kept.
    StrategyRefusedError
        If the line has passing points or neutral sections, the phases cannot be driven, or not in this time.
    """
    task.require_timetable()
    require_line_without(task, "passing_points", "neutral_sections", "traction_limits", "rail_conditions")
    if task.mesh.data.starting_n > 0:
        raise StrategyRefusedError("needs a train without vehicle.resistance.starting_n_per_kn and starting_n.")
    try:
        return _plain_run(task) if _is_plain(task) else _line_run(task)
    except TimetableError as late:
        # the timetable can be kept: only these phases need longer
        least = TimetableError(task.travel_time_s, late.shortest_time_s + task.dwell_s)
        raise StrategyRefusedError(
            f"needs at least {least.min_tenth_s:.1f} s with these phases; the fastest run needs "
            f"{task.shortest_travel_time_s:.1f} s."
        ) from late


def _is_plain(task: Task) -> bool:
    """Return whether one table over speed holds for each phase, wherever it is driven."""
    mesh, limits = task.mesh, plain_limits_ms(task.mesh)
    force, tunnels = mesh.data.line_force_n, mesh.tunnel_factor
    uneven = np.ptp(force) > UNEVEN * mesh.data.half_inertia_kg or np.any(np.abs(tunnels - 1) > UNEVEN)
    if uneven or np.ptp(limits) > UNEVEN * np.max(limits):
        return False
    # the planner of a plain line divides the time of parts that end at rest
    if task.scenario.line.inner_stations and task.end_speeds_ms[1] > 0:
        return False
    # downhill a coasting train may gain speed: then no table over falling speed holds
    speeds = np.linspace(0.0, float(limits[0]), 10)
    return bool(np.min(_planner(task).model.resistance_n(speeds)) > 0)


def _plain_run(task: Task) -> Trajectory:
    """Compute the run over a plain line."""
    planner = _planner(task)
    first, last = task.mesh.position_m[[0, -1]].tolist()
    stops = [station.position_m for station in task.scenario.line.in_running_order().inner_stations]
    distances, (initial, final) = np.diff([first, *stops, last]).tolist(), task.end_speeds_ms
    if len(distances) == 1:
        return _plain_trajectory(task, planner, (planner.plan(distances[0], task.running_time_s, initial, final),))
    return _plain_trajectory(task, planner, planner.plan_parts(distances, task.running_time_s, initial))


def _line_run(task: Task) -> Trajectory:
    """Compute the run over a line with several limits or gradients."""
    task.require_budget("phases")
    plan = plan_line(task.scenario, task.mesh, task.running_time_s)
    _require_exit_speed(task, float(plan.speed2[-1]))
    check_accelerations(task.mesh, plan.speed2)
    check_speeds(task.mesh, plan.speed2)
    price = plan.price_of_time_w
    return make_trajectory(
        task.scenario,
        task.mesh,
        "phases",
        plan.speed2,
        price_of_time_w=None if price is None else price - task.mesh.data.auxiliary_power_w,
        notes=_stretch_sentences(task.mesh, plan),
    )


def _require_exit_speed(task: Task, exit_speed2: float) -> None:
    """Refuse a run that ends slower than its timetable asks for, as no phase accelerates the train before the end."""
    asked_kmh, found_kmh = task.end_speeds_ms[1] / MS_PER_KMH, exit_speed2**0.5 / MS_PER_KMH
    if found_kmh < asked_kmh - SAME_KMH:
        raise StrategyRefusedError(
            f"leaves the line at {found_kmh:.1f} km/h with these phases, where timetable.exit_speed_kmh asks for "
            f"{asked_kmh:.1f} km/h."
        )


def _planner(task: Task) -> PhasePlanner:
    """Return the planner of a task's train on a plain line.

    Raises
    ------
    StrategyRefusedError
        If a starting current is given that the drive does not have.
    """
    scenario, mesh = task.scenario, task.mesh
    vehicle, driven_n = scenario.vehicle, adhesive_weight(scenario, scenario.line.rail_condition).driven_n
    if np.isfinite(driven_n):
        # the friction brakes have what adhesion leaves them
        friction_kn = mesh.data.friction_effort_n / N_PER_KN
        braking = vehicle.braking.model_copy(update={"friction_effort_kn": friction_kn})
        vehicle = vehicle.model_copy(update={"braking": braking})
    force_n, top_ms = float(mesh.data.line_force_n[0]), float(plain_limits_ms(mesh)[0])
    model = phase_model(vehicle, force_n, top_ms, scenario.line.head_wind_kmh * MS_PER_KMH, driven_n)
    return PhasePlanner(model, scenario.phases)


def _plain_trajectory(task: Task, planner: PhasePlanner, plans: tuple[PhasePlan, ...]) -> Trajectory:
    """Return the trajectory of plans for the parts of a task's line, in order."""
    nodes, speeds = [task.mesh.position_m[:1]], [np.array([plans[0].initial_speed_ms])]
    for place, speed in _laid_out(task, planner, plans):
        nodes.append(nodes[-1][-1] + place[1:])
        speeds.append(speed[1:])
    position = np.concatenate(nodes)
    # the sum of parts may miss the end by its rounding, and a meshed line ends where the line does
    position[-1] = task.mesh.position_m[-1]
    mesh = build_meshed_line(task.scenario, plans[0].initial_speed_ms, plans[-1].final_speed_ms, position)
    # the marginal energy per second is equal in all parts, as their time is divided by it
    price, speed2 = planner.price_of_time_w(plans[0]), np.concatenate(speeds) ** 2
    # no brake helps where the line slows a coasting train down more than is allowed
    check_accelerations(mesh, speed2)
    # starts and coasting are planned without a braking curve; brakes are no stronger than it
    check_speeds(mesh, speed2)
    return make_trajectory(
        task.scenario,
        mesh,
        "phases",
        speed2,
        price_of_time_w=None if price is None else price - mesh.data.auxiliary_power_w,
        notes=tuple(_sentence(plan) for plan in plans),
    )


def _laid_out(task: Task, planner: PhasePlanner, plans: tuple[PhasePlan, ...]) -> list[tuple[FloatArray, FloatArray]]:
    """Return the nodes and speeds of plans, in time together.

    A fastest run has no time to keep, and misses that of its tables: the part with most time makes up for its delay.
    """
    runs = [lay_out(planner.model, plan) for plan in plans]
    late_s = sum(running_time(np.diff(place), speed**2) for place, speed in runs) - task.running_time_s
    free = [k for k, plan in enumerate(plans) if not plan.fastest]
    if late_s > ON_TIME * task.running_time_s and free:
        k = max(free, key=lambda k: plans[k].running_time_s)
        runs[k] = lay_out(planner.model, replace(plans[k], running_time_s=plans[k].running_time_s - late_s))
    return runs


def _sentence(plan: PhasePlan) -> str:
    """Describe a plan with its numbers."""
    first = {"start": "It starts", "coast": "It coasts", "brake": "It brakes"}[plan.first]
    if plan.first == "start" and plan.starting_current_a is not None:
        first += f" with {plan.starting_current_a:.0f} A"
    words = f"{first} to {plan.cruise_speed_ms / MS_PER_KMH:.1f} km/h"
    if plan.cycles > 1:
        words += f", {plan.cycles} times in all, coasting to {plan.restart_speed_ms / MS_PER_KMH:.1f} km/h in between"
    if plan.cruise_m > 0:
        words += f", cruises for {plan.cruise_m:.0f} m"
    brake_kmh = plan.brake_speed_ms / MS_PER_KMH
    if brake_kmh < SLOWEST_BRAKE_KMH:
        return f"{words} and coasts almost to rest: it brakes from {brake_kmh:.2g} km/h."
    return f"{words} and brakes from {brake_kmh:.1f} km/h."


def _stretch_sentences(mesh: MeshedLine, plan: LinePlan) -> tuple[str, ...]:
    """Describe the cycles of a plan, one sentence per stretch; or all in one where they are many."""
    borders, speed_kmh = plan.border_m, np.sqrt(plan.speed2) / MS_PER_KMH
    count = len(borders) - 1
    if count > MAX_SENTENCES:
        return (f"It drives {count} stretches between stops and changes of the limit in one cycle of phases each.",)
    nodes = np.searchsorted(mesh.position_m, borders)
    sentences = []
    for k, (first, last) in enumerate(pairwise(nodes.tolist())):
        entry, peak, end = (float(speed_kmh[first]), float(np.max(speed_kmh[first : last + 1])), float(speed_kmh[last]))
        coasts_to = max(min(float(plan.speeds_ms[1, k]) / MS_PER_KMH, peak), end)
        words = f"From {borders[k]:.0f} to {borders[k + 1]:.0f} m it "
        words += f"runs at {peak:.1f} km/h" if peak - entry < SAME_KMH else f"starts to {peak:.1f} km/h"
        goal = "a stand" if end < SAME_KMH else f"{end:.1f} km/h"
        steps = [f"coasts to {coasts_to:.1f} km/h"] if peak - coasts_to >= SAME_KMH else []
        steps += [f"brakes to {goal}"] if coasts_to - end >= SAME_KMH else []
        sentences.append(" and ".join([words, *steps]) + ".")
    return tuple(sentences)


register(
    Strategy(
        name="phases",
        run=phases,
        order=50,
        label="Four phases",
        colour=("#00845C", "#36D39A"),
        dash=(4, 3),
        help=(
            "The best run of four phases between two stops: full power, hold a speed, coast, brake. It is what a "
            "driver can remember."
        ),
        applies_to=(
            "every scenario without neutral sections and passing points; more than one cycle (`phases.cycles`) "
            "only on one gradient, curve and limit from end to end"
        ),
        source="rawicki-2013",
        labels=("Phases", "Phase"),
        seconds_per_cell=3e-4,
    )
)
