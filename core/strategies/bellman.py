"""Bellman's dynamic programming: the cheapest run by backward induction over the speeds of a mesh.

Source: Liashenko, Yatsko 2025, (2) and (5)-(9). For the parts that are exact only here, see
`railjoule.core.dynamic_programming`.
"""

from dataclasses import dataclass

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.dynamic_programming.labels import no_labels
from railjoule.core.dynamic_programming.recursion import sweep_back
from railjoule.core.dynamic_programming.search import Level
from railjoule.core.energy import energy_decimals
from railjoule.core.physics.cell import NEARLY_AT_REST_MS, mean_speed
from railjoule.core.physics.mesh_data import electric_limit_n, tractive_limit_n
from railjoule.core.physics.stretches import shortest_stretch_s
from railjoule.core.strategies.switching import DecidedRun, recursion, with_min_on_off
from railjoule.core.strategy import Strategy, register
from railjoule.core.task import Task
from railjoule.core.trajectory import Trajectory, make_trajectory
from railjoule.core.units import J_PER_KWH, MS_PER_KMH


@dataclass(frozen=True, eq=False)
class ControlLaw:
    """The control at any speed and any place, and the cost to go from there; n cells, k speeds.

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
    found, free = recursion(task)
    notes: tuple[str, ...] = ()
    if found.unrefined_ms is not None:
        notes = (
            "The search ended before its speeds were as fine as usual: no run was found within "
            f"{found.unrefined_ms / MS_PER_KMH:.2g} km/h of the one before.",
        )
    kept = with_min_on_off(task, free)
    if kept is not free:
        notes = (*notes, _spacing_note(task, free, kept))
    kept = kept or free
    trajectory = make_trajectory(
        task.scenario,
        task.mesh,
        "bellman",
        kept.speed2,
        price_of_time_w=kept.price_of_time_w,
        iterations=kept.iterations,
        notes=notes,
    )
    return trajectory, _control_law(task, found.first, found.price_w)


def _spacing_note(task: Task, free: DecidedRun, run: DecidedRun | None) -> str:
    """Return a sentence about a run that is switched too often."""
    shortest, energy = shortest_stretch_s(task.mesh.data, free.speed2), free.energy_j + task.dwell_energy_j
    said = f"the minimum on/off time of {task.least_switching_s:g} s"
    if run is None:
        return f"Its drive is switched after {shortest:.1f} s: no run was found in which it stays on or off for {said}."
    needed = energy / J_PER_KWH
    return (
        f"Only the recursion is switched after {shortest:.1f} s and needs {needed:.{energy_decimals(needed)}f} kWh; "
        f"here the drive stays on or off for {said}, to the nearest cell."
    )


def _control_law(task: Task, level: Level, price_w: float) -> ControlLaw:
    """Return the law of a grid at a price of time: `best` numbers the steps, so that their exits give the efforts."""
    mesh, data, entering_speed2 = task.mesh, task.mesh.data, level.grid[:-1]
    labels = no_labels(mesh.cell_count)
    cost, steps, _ = sweep_back(level.steps, level.grid, price_w, labels, keeps_cost=True)
    best = steps[:, :, 0]
    leaving_speed2 = np.where(best >= 0, level.steps.leaving_speed2[best], np.nan)
    # nothing moves from rest to rest, where a limit of power has no end
    speed = np.maximum(mean_speed(np.sqrt(entering_speed2), np.sqrt(leaving_speed2)), NEARLY_AT_REST_MS)
    force = mesh.force_between_n(entering_speed2.T, leaving_speed2.T).T
    # braking is electric and friction together, of which the law does not tell the one from the other
    traction = tractive_limit_n(data, speed)
    braking = electric_limit_n(data, speed) + data.friction_effort_n
    largest = np.where(force > 0, traction, braking)
    control = np.divide(force, largest, out=np.full_like(force, np.nan), where=largest > 0)
    return ControlLaw(
        position_m=mesh.position_m,
        speed_ms=frozen_array(np.sqrt(level.grid)),
        cost_to_go_j=frozen_array(cost[:, :, 0]),
        control=frozen_array(control),
        price_of_time_w=price_w,
    )


register(
    Strategy(
        name="bellman",
        run=bellman,
        order=20,
        label="Bellman",
        colour=("#5B1A8B", "#A86BC8"),
        dash=(2, 2),
        help=(
            "Dynamic programming: a search over a grid of positions and speeds, with a price on time. Slower than "
            "the optimal solver and independent of it, so it serves as a check."
        ),
        applies_to="every scenario",
        source="liashenko-2025",
        labels=("Bellman's map",),
        seconds_per_cell=4e-4,
    )
)
