"""Strategies of users: any function from a task to the speeds of a run."""

from collections.abc import Callable

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.errors import StrategyRefusedError
from railjoule.core.task import Task
from railjoule.core.trajectory import Trajectory, make_trajectory

OwnStrategy = Callable[[Task], "FloatArray | Trajectory"]
"""Takes a task and returns the speeds at its nodes [m/s], shape (n + 1,), or a whole trajectory."""
SAME_SPEED_MS = 1e-3
"""A speed that differs from a prescribed one by less counts as the same."""


def run_of_speeds(strategy: OwnStrategy) -> Callable[[Task], Trajectory]:
    """Return a strategy that makes a trajectory of the speeds that a user's function returns."""
    name = getattr(strategy, "__name__", type(strategy).__name__)

    def run(task: Task) -> Trajectory:
        found = strategy(task)
        if isinstance(found, Trajectory):
            return found
        return make_trajectory(task.scenario, task.mesh, name, _squares_of_speed(name, found, task))

    return run


def _squares_of_speed(name: str, found: object, task: Task) -> FloatArray:
    """Return squares of speed [m2/s2] that describe a run from end to end, or refuse."""
    try:
        speed_ms = np.asarray(found, dtype=float)
    except (TypeError, ValueError):
        raise StrategyRefusedError(
            f"{name} returned the type {type(found).__name__}; it must return speeds [m/s] as an array."
        ) from None
    count = len(task.position_m)
    if speed_ms.shape != (count,):
        raise StrategyRefusedError(
            f"{name} returned an array of shape {speed_ms.shape}; it must return {count} speeds [m/s], one for each "
            "node in task.position_m."
        )
    if not np.all(np.isfinite(speed_ms)) or np.any(speed_ms < 0):
        node = int(np.flatnonzero(~np.isfinite(speed_ms) | (speed_ms < 0))[0])
        raise StrategyRefusedError(
            f"{name} returned {speed_ms[node]:g} m/s at {task.position_m[node]:g} m; speeds must be finite and at "
            "least 0."
        )
    prescribed2 = task.mesh.data.fixed_speed2
    fixed = prescribed2 >= 0
    prescribed = np.sqrt(np.where(fixed, prescribed2, 0.0))
    wrong = np.where(fixed, np.abs(speed_ms - prescribed) > SAME_SPEED_MS, speed_ms == 0)
    if np.any(wrong):
        node = int(np.flatnonzero(wrong)[0])
        needed = f"it must be {prescribed[node]:g} m/s there" if fixed[node] else "no stop is planned there"
        raise StrategyRefusedError(f"{name} returned {speed_ms[node]:g} m/s at {task.position_m[node]:g} m; {needed}.")
    squares: FloatArray = np.where(fixed, prescribed2, speed_ms**2)
    return squares
