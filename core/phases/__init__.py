"""A run in the words of a driver: what he does, from where to where, so that he can follow it."""

from railjoule.core.phases.find import find_phases
from railjoule.core.phases.phase import NAMES, Phase, PhaseName
from railjoule.core.phases.run_data import RunData

__all__ = ["NAMES", "Phase", "PhaseName", "RunData", "find_phases"]
