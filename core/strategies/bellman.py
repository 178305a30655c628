"""Bellman's dynamic programming: the cheapest run by backward induction over the speeds of a mesh.

Source: Liashenko, Yatsko 2025, (2) and (5)-(9). What is exact here and is not there: see
`railjoule.core.dynamic_programming`.
"""

from dataclasses import dataclass

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.dynamic_programming.backward import sweep_back
from railjoule.core.dynamic_programming.search import Level, search
from railjoule.core.physics.cell import NEARLY_AT_REST_MS, mean_speed
from railjoule.core.task import Task
from railjoule.core.trajectory import Trajectory, make_trajectory
from railjoule.core.units import MS_PER_KMH


@dataclass(frozen=True, eq=False)
class ControlLaw:
    """What to do at any speed and any place, and what is still to pay from there; n cells, k speeds.

    Parameters
    ----------
    position_m : array of shape (n + 1,)
        Nodes [m].
    speed_ms : array of shape (n + 1, k)
        Speeds at each node [m/s], up to the greatest possible one.
    cost_to_go_j : array of shape (n + 1, k)
        Energy and price of time from there to the end [J]; infinite where the end cannot be reached.
    control : array of shape (n, k)
        Effort over the largest one at that speed, braking negative; NaN where the end cannot be reached.
    price_of_time_w : float
        Price of a second, auxiliaries included [J/s].
    """

    position_m: FloatArray
    speed_ms: FloatArray
    cost_to_go_j: FloatArray
    control: FloatArray
    price_of_time_w: float


def bellman(task: Task) -> Trajectory:
    """Return the cheapest run that backward induction finds; it takes every scenario within its budget of cells.

    Raises
    ------
    TimetableError
        If the timetable cannot be kept.
    StrategyRefusedError
        If the mesh has more cells than the current budget.
    SolverError
        If the grid holds no run.
    """
    return bellman_with_law(task)[0]


def bellman_with_law(task: Task) -> tuple[Trajectory, ControlLaw]:
    """Return the run and the control law of the grid that spans all speeds; errors as `bellman`."""
    task.require_timetable()
    task.require_budget("bellman")
    data = task.course.data
    found = search(data, task.greatest_speed2, task.running_time_s)
    notes: tuple[str, ...] = ()
    if found.unrefined_ms is not None:
        notes = (
            "The search ended before its speeds were as fine as usual: no run was found within "
            f"{found.unrefined_ms / MS_PER_KMH:.2g} km/h of the one before.",
        )
    trajectory = make_trajectory(
        task.scenario,
        task.course,
        "bellman",
        found.speed2,
        # the search prices a second with the auxiliaries that run in it; what is shown is what driving alone saves
        price_of_time_w=max(found.price_w - data.auxiliary_power_w, 0.0),
        iterations=found.sweeps,
        notes=notes,
    )
    return trajectory, _control_law(task, found.first, found.price_w)


def _control_law(task: Task, level: Level, price_w: float) -> ControlLaw:
    """Return the law of a grid at a price of time: `best` numbers the steps, so that their exits give the efforts."""
    course, data, entering_speed2 = task.course, task.course.data, level.grid[:-1]
    cost, best, _ = sweep_back(level.steps, level.grid, price_w)
    leaving_speed2 = np.where(best >= 0, level.steps.leaving_speed2[best], np.nan)
    # nothing moves from rest to rest, where a limit of power has no end
    speed = np.maximum(mean_speed(np.sqrt(entering_speed2), np.sqrt(leaving_speed2)), NEARLY_AT_REST_MS)
    force = course.force_between_n(entering_speed2.T, leaving_speed2.T).T
    # braking is electric and friction together, of which the law does not tell the one from the other
    traction = data.traction.effort_n(speed)
    braking = data.braking.effort_n(speed) + data.friction_effort_n
    largest = np.where(force > 0, traction, braking)
    control = np.divide(force, largest, out=np.full_like(force, np.nan), where=largest > 0)
    return ControlLaw(
        position_m=course.position_m,
        speed_ms=frozen_array(np.sqrt(level.grid)),
        cost_to_go_j=frozen_array(cost),
        control=frozen_array(control),
        price_of_time_w=price_w,
    )
