"""The solver core of railjoule: scenarios, drives, motion, strategies, studies. It knows no screen."""

from typing import TYPE_CHECKING, Any

# Whoever needs scipy writes `import scipy` and `scipy.optimize.brentq`: its parts then load when they are first used.
# Together they take as long as the rest of the core, and most runs need none of them.
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
from railjoule.core.phases import Phase
from railjoule.core.scenario import Scenario, load_scenario, save_scenario
from railjoule.core.strategies import compare, solve
from railjoule.core.trajectory import Bound, Trajectory

if TYPE_CHECKING:
    from railjoule.core.studies.sweep import SweepTable, sweep

__all__ = [
    "Bound",
    "Check",
    "CheckError",
    "CheckResult",
    "Energy",
    "InfeasibleLineError",
    "Phase",
    "RailjouleError",
    "Scenario",
    "ScenarioError",
    "SolverError",
    "StrategyRefusedError",
    "SweepTable",
    "TimetableError",
    "Trajectory",
    "check_run",
    "check_table",
    "compare",
    "load_scenario",
    "save_scenario",
    "solve",
    "sweep",
]


def __getattr__(name: str) -> Any:
    # studies take a tenth of a second to import, which most of what asks for the core need not wait for
    if name in {"SweepTable", "sweep"}:
        from railjoule.core.studies import sweep as swept  # noqa: PLC0415

        return getattr(swept, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
