"""Computing times of all strategies on the shipped scenarios, and of CasADi with IPOPT on the same problem.

All times are warm medians in one process: the first call, which compiles or loads kernels, does not count.
"""

import statistics
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any

from railjoule.core.bounds import minimise
from railjoule.core.errors import StrategyRefusedError
from railjoule.core.scenario import load_scenario, preset_names
from railjoule.core.strategies import STRATEGIES, Task, prepare_task, run_strategy
from railjoule.core.trajectory import Trajectory
from railjoule.core.units import J_PER_KWH
from railjoule.core.validation.ipopt import IpoptProblem, is_installed, is_known

# longer is steadier; with some ten scenarios and ten solvers on each, a tenth of a second more takes ten seconds
BUDGET_S = 0.3
"""Time over which one call is repeated [s]."""
# odd, so that a median is one of the times; slow strategies are timed at least five times whatever the budget
FEWEST_CALLS, MAX_CALLS = 5, 201
INTERIOR_POINT, TEXTBOOK, TUNED = "only interior point", "IPOPT, textbook", "IPOPT, tuned"
"""Names of the solvers that are no strategies."""


@dataclass(frozen=True)
class Timing:
    """Computing time of one solver on one scenario.

    Parameters
    ----------
    scenario : str
        Name of the shipped scenario.
    cell_count : int
        Cells of its mesh.
    solver : str
        A strategy with its bound and energy balance, the interior-point method without them, or CasADi with IPOPT.
    energy_kwh : float
        Net energy that it finds [kWh].
    iterations : int
        0 where there are none.
    median_s : float
        Warm median [s].
    """

    scenario: str
    cell_count: int
    solver: str
    energy_kwh: float
    iterations: int
    median_s: float


def warm_median_s(call: Callable[[], object], budget_s: float = BUDGET_S) -> float:
    """Return the median time of a call [s], repeated for about `budget_s` after one that does not count."""
    call()
    # compiling, loading and filling caches happen once in a session: in the call that does not count
    times: list[float] = []
    until = time.perf_counter() + budget_s
    while len(times) < FEWEST_CALLS or (len(times) < MAX_CALLS and time.perf_counter() < until):
        started = time.perf_counter()
        call()
        times.append(time.perf_counter() - started)
    return statistics.median(times)


def benchmark(budget_s: float = BUDGET_S) -> Iterator[Timing]:
    """Yield the times of all solvers on all shipped scenarios, one by one.

    Parameters
    ----------
    budget_s : float
        Time over which each solver is repeated on each scenario [s].
    """
    for name in preset_names("scenarios"):
        task = prepare_task(load_scenario(name))
        for solver, call in _solvers(task):
            try:
                found = call()
            except StrategyRefusedError:
                continue
            energy_kwh = found.energy_kwh if isinstance(found, Trajectory) else found.energy_j / J_PER_KWH
            median = warm_median_s(call, budget_s)
            yield Timing(name, task.mesh.cell_count, solver, energy_kwh, found.iterations, median)


def _solvers(task: Task) -> Iterator[tuple[str, Callable[[], Any]]]:
    """Yield name and call of each solver of a task; IPOPT without building its problem."""
    for strategy in STRATEGIES:
        yield strategy, partial(run_strategy, task, strategy)
    yield INTERIOR_POINT, partial(minimise, task)
    # CasADi is no dependency: without it the table has no lines of IPOPT
    if is_installed() and is_known(task):
        yield TEXTBOOK, IpoptProblem(task, textbook=True).solve
        yield TUNED, IpoptProblem(task).solve
