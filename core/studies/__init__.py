"""Studies of many runs, as labelled tables."""

from railjoule.core.studies.assumptions import assumption_effects, assumption_steps
from railjoule.core.studies.braking_sensors import BrakingSensors, study_braking_sensors
from railjoule.core.studies.montecarlo import monte_carlo, monte_carlo_steps
from railjoule.core.studies.robust_plan import RobustPlan, find_robust_plan, robust_plan_steps
from railjoule.core.studies.sensitivity_table import sensitivity, sensitivity_steps
from railjoule.core.studies.storage import (
    Storage,
    StorageNeed,
    StorageRun,
    saving_over_size,
    storage_need,
    with_storage,
)
from railjoule.core.studies.table import StudyTable
from railjoule.core.studies.tradeoff import Frontier, energy_time_frontier, enoc_frontier, frontier_times

__all__ = [
    "BrakingSensors",
    "Frontier",
    "RobustPlan",
    "Storage",
    "StorageNeed",
    "StorageRun",
    "StudyTable",
    "assumption_effects",
    "assumption_steps",
    "energy_time_frontier",
    "enoc_frontier",
    "find_robust_plan",
    "frontier_times",
    "monte_carlo",
    "monte_carlo_steps",
    "robust_plan_steps",
    "saving_over_size",
    "sensitivity",
    "sensitivity_steps",
    "storage_need",
    "study_braking_sensors",
    "with_storage",
]
