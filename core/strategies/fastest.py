"""The fastest run under all limits: it decides whether a timetable can be kept."""

from railjoule.core.task import Task
from railjoule.core.trajectory import Trajectory, make_trajectory


def fastest(task: Task) -> Trajectory:
    """Return the run with the shortest possible time; it takes every scenario."""
    return make_trajectory(task.scenario, task.course, "fastest", task.greatest_speed2)
