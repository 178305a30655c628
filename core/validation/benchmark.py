"""Computing times of all strategies on the shipped scenarios, and of CasADi with IPOPT on the same problem.

All times are warm medians in one process: the first call, which compiles or loads kernels, does not count.
"""

import statistics
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial

from railjoule.core.bounds import minimise
from railjoule.core.errors import StrategyRefusedError
from railjoule.core.scenario import load_scenario, preset_names
from railjoule.core.strategies import STRATEGIES, Task, prepare_task, run_strategy
from railjoule.core.units import J_PER_KWH
from railjoule.core.validation.ipopt import IpoptProblem, is_installed, is_known

# longer is steadier; with some ten scenarios and ten solvers on each, a tenth of a second more takes ten seconds
BUDGET_S = 0.3
"""Time over which one call is repeated [s]."""
# odd, so that a median is one of the times; slow strategies are timed at least five times whatever the budget
FEWEST_CALLS, MAX_CALLS = 5, 201
ALONE, TEXTBOOK, TUNED = "interior point alone", "IPOPT, textbook", "IPOPT, tuned"
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
        yield from _time_strategies(name, task, budget_s)
        yield time_solver_alone(name, task, budget_s)
        # CasADi is no dependency: without it the table has no lines of IPOPT
        if is_installed() and is_known(task):
            yield from time_ipopt(name, task, budget_s)


def _time_strategies(name: str, task: Task, budget_s: float) -> Iterator[Timing]:
    for strategy in STRATEGIES:
        try:
            run = run_strategy(task, strategy)
        except StrategyRefusedError:
            continue
        median = warm_median_s(partial(run_strategy, task, strategy), budget_s)
        yield Timing(name, task.mesh.cell_count, strategy, run.energy_kwh, run.iterations, median)


def time_solver_alone(name: str, task: Task, budget_s: float = BUDGET_S) -> Timing:
    """Measure the interior-point method on given arrays, without lower bound and energy balance."""
    solution = minimise(task)
    median = warm_median_s(partial(minimise, task), budget_s)
    return Timing(name, task.mesh.cell_count, ALONE, solution.energy_j / J_PER_KWH, solution.iterations, median)


def time_ipopt(name: str, task: Task, budget_s: float = BUDGET_S) -> Iterator[Timing]:
    """Yield the times of IPOPT on the textbook and on railjoule's formulation, without building the problem."""
    for words, textbook in ((TEXTBOOK, True), (TUNED, False)):
        problem = IpoptProblem(task, textbook)
        run = problem.solve()
        median = warm_median_s(problem.solve, budget_s)
        yield Timing(name, task.mesh.cell_count, words, run.energy_j / J_PER_KWH, run.iterations, median)
