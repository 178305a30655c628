"""Simple advice: which of its runs is told first, and what more orders would gain.

The page and the command line share these rules; nothing here loads the search itself.
"""

from collections.abc import Mapping
from typing import TYPE_CHECKING

from railjoule.core import Scenario, StrategyRefusedError, Trajectory
from railjoule.core.strategies import prepare_task

if TYPE_CHECKING:
    from railjoule.core.studies.simple_advice import SimpleAdvice, SimpleRun

# what simple orders may cost where nobody says how many there are to be
LITTLE_ENERGY_SHARE = 0.01


def compute_simple_advice(scenario: Scenario, max_changes: int | None = None) -> "SimpleAdvice":
    """Return the best runs with few changes of regime over a scenario; takes seconds on long lines.

    Parameters
    ----------
    scenario : Scenario
    max_changes : int, optional
        As for `railjoule.core.studies.simple_advice`.

    Raises
    ------
    RailjouleError
        If the timetable cannot be kept, or no such run is in time.
    """
    from railjoule.core.studies.simple_advice import MAX_CHANGES, simple_advice  # noqa: PLC0415

    return simple_advice(prepare_task(scenario), MAX_CHANGES if max_changes is None else max_changes)


def simple_run(scenario: Scenario, changes_allowed: int) -> Trajectory:
    """Return the run of simple advice with so many changes of regime allowed.

    Raises
    ------
    RailjouleError
        As `compute_simple_advice`, or if so many changes are of no use to the scenario.
    """
    runs = compute_simple_advice(scenario, changes_allowed).runs
    if runs[-1].changes_allowed != changes_allowed:
        raise StrategyRefusedError(f"finds no run that {changes_allowed} changes of regime make better.")
    return runs[-1].run


def by_changes(advice: "SimpleAdvice") -> "Mapping[int, SimpleRun]":
    """Return the runs by how often they change the regime, the fewest changes first."""
    # one that was allowed more changes than it uses replaces the dearer one that was allowed no more
    return {run.changes: run for run in advice.runs}


def first_told(advice: "SimpleAdvice") -> "SimpleRun":
    """Return the run with the fewest changes that costs little; the last one where none does."""
    runs = [*by_changes(advice).values()]
    return next((run for run in runs if _is_cheap(advice, run)), runs[-1])


def more_changes(advice: "SimpleAdvice") -> str:
    """Return in a sentence what more changes than those of the last run would gain."""
    from railjoule.core.studies.simple_advice import FREE_SHARE, MAX_CHANGES  # noqa: PLC0415

    last, optimum = advice.runs[-1], advice.optimum
    if optimum is not None and last.run.energy.net_j <= optimum.energy.net_j * (1 + FREE_SHARE):
        return f"More than {last.changes} changes would gain less than {100 * FREE_SHARE:g} %."
    if last.changes_allowed == MAX_CHANGES == last.changes:
        return f"More than {MAX_CHANGES} changes are not tried."
    return f"More than {last.changes} changes gain nothing."


def not_in_time(advice: "SimpleAdvice") -> str:
    """Return in a sentence with how many changes no run is in time; nothing where there is one with each number."""
    if not advice.refused:
        return ""
    numbers = [str(changes) for changes, _ in advice.refused]
    listed = " or ".join(filter(None, [", ".join(numbers[:-1]), numbers[-1]]))
    return f"With at most {listed} changes no run is in time."


def _is_cheap(advice: "SimpleAdvice", run: "SimpleRun") -> bool:
    return advice.optimum is not None and advice.price_kwh(run) <= LITTLE_ENERGY_SHARE * abs(advice.optimum.energy_kwh)
