"""The phases of a run: the driver's actions and where they begin and end, so that a driver can follow the run."""

from railjoule.core.phases.find import find_phases
from railjoule.core.phases.phase import NAMES, Phase, PhaseName, RunData

__all__ = ["NAMES", "Phase", "PhaseName", "RunData", "find_phases"]
