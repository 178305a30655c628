"""The solver core of railjoule: scenarios, drives, motion, strategies, studies. It must not import user-interface code.

`import railjoule as rj` offers its public names.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

# Import SciPy as `import scipy` everywhere, so that its submodules load when they are first used: together they take as
# long as the rest of the core, and most runs need none of them.
from railjoule.core.api import frontier, simulate
from railjoule.core.check import Check, CheckResult, check_run, check_table
from railjoule.core.energy import Energy
from railjoule.core.errors import (
    CheckError,
    InfeasibleLineError,
    RailjouleError,
    ScenarioError,
    SolverError,
    StrategyRefusedError,
    TimetableError,
)
from railjoule.core.lower_bound import Bound
from railjoule.core.phases import Phase
from railjoule.core.scenario import (
    Braking,
    Line,
    Resistance,
    Scenario,
    Section,
    SpeedLimit,
    Station,
    Timetable,
    Traction,
    Vehicle,
    load_scenario,
    preset_names,
    save_scenario,
)
from railjoule.core.strategies import STRATEGIES, Comparison, Strategy, compare, register, solve
from railjoule.core.task import Task
from railjoule.core.trajectory import Trajectory

if TYPE_CHECKING:
    from railjoule.core.identification import fit_runs as fit
    from railjoule.core.measured import load_run
    from railjoule.core.studies.sweep import SweepTable, sweep

_LAZY = {
    "SweepTable": ("railjoule.core.studies.sweep", "SweepTable"),
    "fit": ("railjoule.core.identification", "fit_runs"),
    "load_run": ("railjoule.core.measured", "load_run"),
    "sweep": ("railjoule.core.studies.sweep", "sweep"),
}
"""Names that take a tenth of a second to import and that most programs do not need: module and name there."""

__all__ = [
    "STRATEGIES",
    "Bound",
    "Braking",
    "Check",
    "CheckError",
    "CheckResult",
    "Comparison",
    "Energy",
    "InfeasibleLineError",
    "Line",
    "Phase",
    "RailjouleError",
    "Resistance",
    "Scenario",
    "ScenarioError",
    "Section",
    "SolverError",
    "SpeedLimit",
    "Station",
    "Strategy",
    "StrategyRefusedError",
    "SweepTable",
    "Task",
    "Timetable",
    "TimetableError",
    "Traction",
    "Trajectory",
    "Vehicle",
    "check_run",
    "check_table",
    "compare",
    "fit",
    "frontier",
    "load_run",
    "load_scenario",
    "preset_names",
    "register",
    "save_scenario",
    "simulate",
    "solve",
    "sweep",
]


def __getattr__(name: str) -> Any:
    if name in _LAZY:
        module, own_name = _LAZY[name]
        return getattr(import_module(module), own_name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
