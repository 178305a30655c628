"""Many scenarios at once, as labelled tables."""

from railjoule.core.studies.sensitivity import sensitivity
from railjoule.core.studies.tradeoff import Frontier, energy_time_frontier, enoc_frontier, frontier_times

__all__ = ["Frontier", "energy_time_frontier", "enoc_frontier", "frontier_times", "sensitivity"]
