"""The running time reserve distributed linearly: all speeds of the fastest run are lowered in one ratio.

With v the speed of the fastest run, the train runs at k v wherever its efforts allow it. Each part of the line with a
reserve of its own has its own k, so that it takes its shortest time and its reserve. The train runs as fast as it can
below k v on climbs that it takes with full effort.

Source: the linear margin of OSRD, https://osrd.fr/en/docs/explanation/running_time_calculation/allowances/
"""

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.errors import StrategyRefusedError
from railjoule.core.motion import max_speeds
from railjoule.core.motion.passes import MOVED
from railjoule.core.reserve import times_between
from railjoule.core.strategies.plain_line import require_line_without
from railjoule.core.strategy import Strategy, register
from railjoule.core.task import Task
from railjoule.core.trajectory import Trajectory, make_trajectory

TIME_S, MAX_STEPS = 1e-7, 200
"""The run takes its time to so many seconds, after at most so many corrections of the ratios."""


def linear_reserve(task: Task) -> Trajectory:
    """Return the fastest run with its speeds lowered in one ratio until it takes the time of the timetable."""
    require_line_without(task, "passing_points")
    if any(task.end_speeds_ms):
        raise StrategyRefusedError("needs a run that begins and ends at rest.")
    task.require_timetable()
    borders, due = _parts(task)
    speed = task.fastest_speed_ms
    # where a part borders on another the lower ratio holds
    inside = (task.position_m >= borders[:-1, None] - 1e-6) & (task.position_m <= borders[1:, None] + 1e-6)
    ratio = times_between(task, task.fastest_speed2, borders) / due
    for _ in range(MAX_STEPS):
        lowered = np.where(inside, ratio[:, None], np.inf).min(axis=0) * speed
        limited = task.mesh.data._replace(limit_speed2=lowered**2)
        speed2, obstacle, _ = max_speeds(limited)
        if obstacle != MOVED:
            place = task.position_m[obstacle]
            raise StrategyRefusedError(f"finds no run: with its speeds lowered the train cannot pass {place:.0f} m.")
        taken = times_between(task, speed2, borders)
        if np.abs(taken - due).sum() <= TIME_S:
            return make_trajectory(task.scenario, task.mesh, "linear_reserve", speed2)
        ratio = np.minimum(ratio * taken / due, 1.0)
    raise StrategyRefusedError("finds no ratios with which each part of the line takes its time; use longer parts.")


def _parts(task: Task) -> tuple[FloatArray, FloatArray]:
    """Return the borders of the parts of the line [m] and their running times [s]."""
    scenario = task.scenario
    if scenario.timetable.has_reserve:
        reserved = scenario.reserved_time
        due = reserved.shortest_s + reserved.reserve_s
        # a task may have another time, as one over a trade-off; the ratio of the parts stays
        return reserved.borders_m, due * (task.running_time_s / due.sum())
    return task.position_m[[0, -1]], np.array([task.running_time_s])


register(
    Strategy(
        name="linear_reserve",
        run=linear_reserve,
        order=65,
        label="Linear reserve",
        colour=("#6B5B00", "#D7C46A"),
        dash=(10, 2, 2, 2),
        help=(
            "The fastest run with all its speeds lowered in one ratio, so that it takes the time of the timetable. "
            "It shows how much a better distribution of the reserve saves."
        ),
        applies_to="no passing points, at rest at both ends",
    )
)
