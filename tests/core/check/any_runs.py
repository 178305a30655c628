"""The runs of every strategy over the scenarios of `tests.any_scenarios`.

`python -m tests.core.check.any_runs` prints which rules they break, by strategy and regulator, and for which seeds.
"""

from collections import defaultdict
from collections.abc import Iterable, Iterator

from railjoule.core import Check, RailjouleError, Trajectory, check_run
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


def main() -> None:
    """Print the seeds of all clear faults."""
    found = defaultdict(list)
    for seed in range(SEEDS):
        for run in any_runs(seed):
            regulator = run.scenario.search.regulator if run.strategy == "speed_limits" else ""
            for check in clear_faults(check_run(run.scenario, run).checks):
                found[run.strategy, check.name, regulator].append(seed)
    for (strategy, rule, regulator), seeds in sorted(found.items()):
        print(f"{strategy} {regulator}, {rule}: {seeds}")


if __name__ == "__main__":
    main()
