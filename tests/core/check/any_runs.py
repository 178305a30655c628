"""The runs of every strategy over the scenarios of `tests.any_scenarios`; `tests.check_many` drives more of them."""

from collections.abc import Iterable, Iterator

from railjoule.core import Check, RailjouleError, Trajectory
from railjoule.core.bounds import bounded
from railjoule.core.strategies import STRATEGIES, run_strategy
from tests.any_scenarios import any_task

SEEDS = 120
CLEAR = 2
"""A rule that is broken by less than this many times what is allowed may be kept on another machine."""


def any_runs(seed: int) -> Iterator[Trajectory]:
    """Yield the runs over the scenario of a seed, each with a bound that covers it, as `compare` gives them."""
    task, bound = any_task(seed), None
    for name in STRATEGIES:
        if task is None:
            return
        try:
            run = run_strategy(task, name)
        except RailjouleError:
            continue
        bound = run.bound if name == "optimal" else bound
        yield bounded(task, run, bound)


def clear_faults(checks: Iterable[Check]) -> list[Check]:
    """Return the checks of a run that it clearly fails."""
    return [check for check in checks if check.largest > CLEAR * check.allowed]
