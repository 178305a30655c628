"""The fastest run under all limits: it decides whether a timetable can be kept."""

from railjoule.core.strategy import Strategy, register
from railjoule.core.task import Task
from railjoule.core.trajectory import Trajectory, make_trajectory


def fastest(task: Task) -> Trajectory:
    """Return the run with the shortest possible time; it takes every scenario."""
    return make_trajectory(task.scenario, task.mesh, "fastest", task.fastest_speed2)


register(
    Strategy(
        name="fastest",
        run=fastest,
        order=70,
        label="Fastest",
        colour=("#1D242D", "#EBF2FF"),
        dash=(1, 3),
        help=(
            "The shortest possible run: full power, then the limits, then full braking. It shows how much time "
            "there is to save energy with."
        ),
        applies_to="every scenario",
        is_light=True,
    )
)
