"""Simple advice: the choice among its runs.

The page and the command line share these rules; nothing here loads the search itself.
"""

from collections.abc import Mapping
from typing import TYPE_CHECKING

from railjoule.core import Scenario, StrategyRefusedError, Trajectory
from railjoule.core.strategies import prepare_task
from railjoule.dashboard.look import comparisons, words

if TYPE_CHECKING:
    from railjoule.core.studies.simple_advice import SimpleAdvice, SimpleRun

LITTLE_ENERGY_SHARE, MAX_ENERGY_SHARE = 0.01, 0.1
"""Extra energy of simple advice over the optimum's: up to the first it costs little, above the second too much."""


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
    # one that was allowed more changes than it uses replaces the more expensive one with no more permitted
    return {run.changes: run for run in advice.runs}


def first_cheap_run(advice: "SimpleAdvice") -> "SimpleRun":
    """Return the run with the fewest changes that costs little; the last one where none does."""
    runs = [*by_changes(advice).values()]
    return next((run for run in runs if _is_cheap(advice, run)), runs[-1])


def choose_simple(advice: "SimpleAdvice") -> "tuple[SimpleRun | None, str]":
    """Return the run with the fewest instructions that costs little, and a sentence on it.

    Without one, it is the cheapest run with fewer instructions than the optimum, if that costs at most MAX_SHARE; None
    where the optimum is to be followed itself.
    """
    runs, optimum = [*by_changes(advice).values()], advice.optimum
    if optimum is None:
        return runs[-1], "No optimum is known to compare with."
    most = _instruction_count(optimum)
    fewer = [run for run in runs if _instruction_count(run.run) < most]
    if not fewer:
        return None, f"The optimum is already as simple as it gets: {most} instructions."
    cheap = [run for run in fewer if _is_cheap(advice, run)]
    best = min(cheap or fewer, key=lambda one: (bool(cheap) and _instruction_count(one.run), one.run.energy.net_j))
    count, more = _instruction_count(best.run), comparisons.above(best.run.energy_kwh, optimum.energy_kwh)
    if cheap:
        return best, f"{count} instructions instead of {most}: {more} energy."
    sentence = f"No advice with fewer than {most} instructions is within 1 % of the optimum: with {count} it is {more}."
    return (best if _is_cheap(advice, best, MAX_ENERGY_SHARE) else None), sentence


def _instruction_count(run: Trajectory) -> int:
    return len(words.instruction_groups(run.advice))


def _is_cheap(advice: "SimpleAdvice", run: "SimpleRun", share: float = LITTLE_ENERGY_SHARE) -> bool:
    return advice.optimum is not None and advice.price_kwh(run) <= share * abs(advice.optimum.energy_kwh)
