"""Motion of a train over a line: mesh, running resistance, forces of the line, limits, fastest passes."""

from railjoule.core.motion.course import Course, build_course
from railjoule.core.motion.passes import greatest_speeds, running_time

__all__ = ["Course", "build_course", "greatest_speeds", "running_time"]
