"""The strategies: each takes a task and returns a trajectory, by a solver of its own.

`solve` below is the entry: it makes a scenario a task, runs a strategy, and gives the run a bound and the best known
run to be measured against. Read it first, then a short strategy, `fastest`, then `optimal`. A strategy decides what it
refuses and makes the trajectory; the methods stand in folders of their own:

- `optimal`: interior point, `core/bounds` and `core/interior_point`; where a drive takes power without effort,
  `switching` decides where it is on, and dynamic programming steps in where no optimum is found
- `bellman`: dynamic programming, `core/dynamic_programming`
- `eoc`, `enoc`: Ftorek's two, on the line that `plain_line` makes of a task
- `phases`: start, cruise, coast, brake, `core/phase_planning`
- `speed_limits`: set speeds of sections, `core/limit_search`
"""

import time
from collections.abc import Callable
from dataclasses import replace

from railjoule.core.best_known import with_best_known
from railjoule.core.bounds import bounded, check_seconds, run_to_prove, tightened
from railjoule.core.check import check_run
from railjoule.core.compilation import needs_compiler, require_compiled
from railjoule.core.errors import (
    CheckError,
    DriveRangeError,
    InfeasibleLineError,
    RailjouleError,
    StrategyRefusedError,
)
from railjoule.core.scenario import STRATEGY_NAMES, Scenario, StrategyName
from railjoule.core.strategies import bellman, enoc, eoc, fastest, optimal, phases, speed_limits
from railjoule.core.strategies.arrival_windows import missed_windows
from railjoule.core.strategies.optimal import known_optimum
from railjoule.core.task import Task, prepare_task
from railjoule.core.trajectory import Trajectory

STRATEGIES: dict[StrategyName, Callable[[Task], Trajectory]] = {
    "optimal": optimal.optimal,
    "bellman": bellman.bellman,
    "eoc": eoc.eoc,
    "enoc": enoc.enoc,
    "phases": phases.phases,
    "speed_limits": speed_limits.speed_limits,
    "fastest": fastest.fastest,
}
"""The strategies of this version, in the order in which they are shown."""


def solve(
    scenario: Scenario,
    strategy: StrategyName | None = None,
    *,
    initial_speed_ms: float | None = None,
    final_speed_ms: float | None = None,
    check: bool = False,
    prove_seconds: float | None = None,
) -> Trajectory:
    """Return the run of a strategy over a scenario, with a bound that covers it and the best known run.

    Parameters
    ----------
    scenario : Scenario
        The train, the line, the timetable and the options.
    strategy : str, optional
        Overrides the scenario's own.
    initial_speed_ms, final_speed_ms : float, optional
        Speeds at the ends of the run [m/s]; those of the timetable where absent.
    check : bool
        Whether the run is held against its scenario by formulas that share no code with the strategies; it then
        carries the result as `check`.
    prove_seconds : float, optional
        How long to tighten the bound where the first one is loose, as it often is of a drive that takes power without
        effort [s]; 0 keeps the first bound, which drives with a table of losses do not have. By default it is tightened
        with a fixed number of steps, half a second or less, and up to two where it is open by more than 0.3 %.

    Raises
    ------
    CheckError
        If the check finds that the run breaks a rule.
    ScenarioError
        If a limit of effort is missing, the mesh too fine, or `prove_seconds` out of its bounds.
    InfeasibleLineError
        If no run passes the line at all.
    TimetableError
        If the timetable cannot be kept.
    StrategyRefusedError
        If the strategy cannot honour the scenario.
    """
    check_seconds(prove_seconds)
    name = strategy or scenario.strategy
    task = prepare_task(scenario, initial_speed_ms, final_speed_ms)
    trajectory = run_strategy(task, name)
    # an optimum is its own reference; without slack there is nothing to save, and no optimum is looked for
    if trajectory.reference is not None:
        trajectory = _tightened(task, trajectory, prove_seconds)
    elif task.has_slack:
        best = known_optimum(task)
        best = None if best is None else _tightened(task, best, prove_seconds)
        trajectory = bounded(task, trajectory, best.bound if best is not None else None)
        *_, trajectory = with_best_known([trajectory] if best is None else [best, trajectory])
    if not check:
        return trajectory
    result = check_run(scenario, trajectory, initial_speed_ms=initial_speed_ms, final_speed_ms=final_speed_ms)
    trajectory = replace(trajectory, check=result)
    if not result.ok:
        raise CheckError(trajectory)
    return trajectory


def run_strategy(task: Task, strategy: StrategyName) -> Trajectory:
    """Return the run of a strategy over a task, with the time that it took.

    Raises
    ------
    ScenarioError
        If an option of the strategy is out of its bounds.
    TimetableError
        If the timetable cannot be kept.
    StrategyRefusedError
        If the strategy is not part of this version or cannot honour the scenario. What it asks too much of the drive or
        of the line is a fault of its run alone: the task was prepared without.
    SolverError
        If it ended without a run.
    """
    if strategy not in STRATEGIES:
        known = ", ".join(STRATEGIES)
        if strategy in STRATEGY_NAMES:
            raise StrategyRefusedError(f"is not part of this version; choose one of {known}.")
        raise StrategyRefusedError(f"is not a strategy; choose one of {known}.")
    if needs_compiler(task.scenario, strategy):
        require_compiled()
    started = time.perf_counter()
    try:
        trajectory = STRATEGIES[strategy](task)
    except (DriveRangeError, InfeasibleLineError) as error:
        raise StrategyRefusedError(f"finds no run that can be driven: {error}") from error
    seconds = time.perf_counter() - started
    times = filter(None, (task.scenario.time_note, *missed_windows(task, trajectory)))
    return replace(trajectory, solve_time_s=seconds, notes=(*trajectory.notes, *times))


def compare(
    scenario: Scenario, *, prove_seconds: float | None = None
) -> tuple[list[Trajectory], dict[StrategyName, str]]:
    """Return the runs of all strategies that take a scenario, and why the others refuse it or fail.

    `prove_seconds` as for `solve`.

    Raises
    ------
    TimetableError, InfeasibleLineError, ScenarioError
        As `solve`.
    """
    check_seconds(prove_seconds)
    task = prepare_task(scenario)
    # a timetable that none can keep is one fault of the scenario, not a refusal of each strategy
    task.require_timetable()
    runs: list[Trajectory] = []
    refused: dict[StrategyName, str] = {}
    for name in STRATEGIES:
        try:
            runs.append(run_strategy(task, name))
        except RailjouleError as refusal:
            refused[name] = str(refusal)
    return with_bounds(task, runs, prove_seconds), refused


def with_bounds(task: Task, runs: list[Trajectory], prove_seconds: float | None = None) -> list[Trajectory]:
    """Return the runs of several strategies over a task with a bound that covers each, and the best known run.

    `prove_seconds` as for `solve`.
    """
    # one proof serves all runs over the task's mesh; `bounded` makes another only for those over nodes of their own
    first = known = next((run.bound for run in runs if run.bound is not None), None)
    if first is not None and (start := run_to_prove(first, runs)) is not None:
        known = tightened(task, first, start, seconds=prove_seconds)
    runs = [replace(run, bound=known) if run.bound is first else run for run in runs]
    return with_best_known([bounded(task, run, known) for run in runs])


def _tightened(task: Task, best: Trajectory, seconds: float | None) -> Trajectory:
    """Return an optimum with the greater bound that it is worth to look for where one run is asked for."""
    return best if best.bound is None else best.with_bound(tightened(task, best.bound, best, seconds=seconds))


__all__ = ["STRATEGIES", "Task", "compare", "prepare_task", "run_strategy", "solve", "with_bounds"]
