"""Motion of a train over a line: mesh, running resistance, forces of the line, limits, fastest passes."""

from railjoule.core.motion.meshed_line import MeshedLine, build_meshed_line
from railjoule.core.motion.passes import max_speeds, running_time

__all__ = ["MeshedLine", "build_meshed_line", "max_speeds", "running_time"]
