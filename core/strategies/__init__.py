"""The strategies, and the entry points `solve` and `compare`.

`solve` turns a scenario into a task, runs a strategy, and gives the run a lower bound and the best known run. To read
the code, begin with `solve`, then a short strategy, `fastest`, then `optimal`. A strategy is a file in this folder that
calls `register`; it decides which scenarios it refuses and makes the trajectory. The methods have folders of their own:

- `optimal`: interior point, `core/interior_point` and `core/continuous_bound`; for drives with idle losses `switching`
  decides where the drive is on, and dynamic programming is used where no optimum is found
- `bellman`: dynamic programming, `core/dynamic_programming`
- `eoc`, `enoc`: Ftorek's two, on the line that `plain_line` makes of a task
- `phases`: start, cruise, coast, brake, `core/phase_planning`
- `speed_limits`: set speeds of sections, `core/limit_search`
"""

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules
from typing import TYPE_CHECKING, Any

from railjoule.core.best_known import with_best_known
from railjoule.core.bounds import bounded, check_seconds, run_to_prove, tightened
from railjoule.core.check import check_run
from railjoule.core.compilation import needs_compiler, require_compiled
from railjoule.core.errors import (
    CheckError,
    DriveRangeError,
    InfeasibleLineError,
    RailjouleError,
    ScenarioError,
    StrategyRefusedError,
)
from railjoule.core.jerk import limit_jerk
from railjoule.core.measures import MEASURES, measure
from railjoule.core.scenario import Scenario, as_scenario
from railjoule.core.strategies.arrival_windows import missed_windows
from railjoule.core.strategies.optimal import known_optimum
from railjoule.core.strategies.own import run_of_speeds
from railjoule.core.strategy import STRATEGIES, Strategy, register
from railjoule.core.task import Task, prepare_task
from railjoule.core.trajectory import Trajectory

if TYPE_CHECKING:
    import pandas

    from railjoule.core.strategies.own import OwnStrategy

for _module in iter_modules(__path__):
    import_module(f"{__name__}.{_module.name}")


@dataclass(frozen=True, eq=False)
class Comparison:
    """Runs of several strategies over one scenario, or runs of several scenarios.

    Parameters
    ----------
    runs : tuple of Trajectory
        The runs in the order of the strategies, with a common bound and the best known run; of several scenarios in
        the order of the scenarios, each with its own.
    refused : mapping of str to str
        Names of the strategies without a run, each with its reason in one sentence; none for several scenarios.
    shortest_times_s : tuple of float
        Shortest possible time of the scenario of each run, dwells included [s].
    """

    runs: tuple[Trajectory, ...]
    refused: Mapping[str, str]
    shortest_times_s: tuple[float, ...]

    def to_dataframe(self) -> "pandas.DataFrame":
        """Return a table with one row for each run: title of its scenario, strategy, and the measures of the run."""
        import pandas  # noqa: PLC0415  (slow to import)

        rows = ({"title": run.scenario.title, "strategy": run.strategy, **measure(run)} for run in self.runs)
        return pandas.DataFrame(rows, columns=["title", "strategy", *MEASURES])

    def plot(self, axes: Any = None) -> Any:
        """Draw the speeds of all runs over distance with matplotlib; return the axes."""
        from railjoule.core.plots import plot_speeds  # noqa: PLC0415  (matplotlib is an extra)

        return plot_speeds(self.runs, axes)


def solve(
    scenario: Scenario | str | Path,
    strategy: "str | OwnStrategy | None" = None,
    *,
    initial_speed_ms: float | None = None,
    final_speed_ms: float | None = None,
    check: bool = False,
    prove_seconds: float | None = None,
) -> Trajectory:
    """Return the run of a strategy over a scenario, with a bound that covers it and the best known run.

    Parameters
    ----------
    scenario : Scenario, str or Path
        A scenario, the name of a shipped one, or the path of a scenario file.
    strategy : str or callable, optional
        Overrides the scenario's own. A function of one's own takes a `Task` and returns the speeds at its nodes [m/s],
        shape (n + 1,), or a whole `Trajectory`; the check always judges its run.
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
    scenario = as_scenario(scenario)
    task = prepare_task(scenario, initial_speed_ms, final_speed_ms)
    trajectory = _solve_task(task, strategy, prove_seconds)
    if not (check or callable(strategy)):
        return trajectory
    result = check_run(scenario, trajectory, initial_speed_ms=initial_speed_ms, final_speed_ms=final_speed_ms)
    trajectory = replace(trajectory, check=result)
    if not result.ok:
        raise CheckError(trajectory)
    return trajectory


def _solve_task(task: Task, strategy: "str | OwnStrategy | None", prove_seconds: float | None) -> Trajectory:
    """Return the run of a strategy over a task with its bound and the best known run; errors as `solve`."""
    chosen = strategy or task.scenario.strategy
    trajectory = run_strategy(task, chosen)
    # an optimum is its own reference; without slack there is nothing to save, and no optimum is looked for
    if trajectory.reference is not None:
        trajectory = _tightened(task, trajectory, prove_seconds)
    elif task.has_slack:
        best = known_optimum(task)
        best = None if best is None else _tightened(task, best, prove_seconds)
        trajectory = bounded(task, trajectory, best.bound if best is not None else None)
        *_, trajectory = with_best_known([trajectory] if best is None else [best, trajectory])
    return limit_jerk(task, partial(run_strategy, strategy=chosen), trajectory)


def run_strategy(task: Task, strategy: "str | OwnStrategy") -> Trajectory:
    """Return the run of a strategy over a task, with the time that it took.

    Raises
    ------
    ScenarioError
        If an option of the strategy is out of its bounds.
    TimetableError
        If the timetable cannot be kept.
    StrategyRefusedError
        If there is no such strategy, it cannot honour the scenario, or it needs more than drive or line allow.
    SolverError
        If it ended without a run.
    """
    if callable(strategy):
        run, needs_solver = run_of_speeds(strategy), False
    elif strategy in STRATEGIES:
        run, needs_solver = STRATEGIES[strategy].run, needs_compiler(task.scenario, strategy)
    else:
        raise StrategyRefusedError(f"is not a strategy; choose one of {', '.join(STRATEGIES)}.")
    if needs_solver:
        require_compiled()
    started = time.perf_counter()
    try:
        trajectory = run(task)
    except (DriveRangeError, InfeasibleLineError) as error:
        raise StrategyRefusedError(f"finds no run that can be driven: {error}") from error
    seconds = time.perf_counter() - started
    times = filter(None, (task.scenario.time_note, *missed_windows(task, trajectory)))
    return replace(trajectory, solve_time_s=seconds, notes=(*trajectory.notes, *times))


def compare(
    scenario: Scenario | str | Path | Sequence[Scenario | str | Path],
    strategies: Sequence[str] = (),
    *,
    prove_seconds: float | None = None,
) -> Comparison:
    """Return the runs of several strategies over a scenario and why others refuse it, or the runs of several scenarios.

    Parameters
    ----------
    scenario : Scenario, str or Path, or a sequence of them
        As in `solve`; a sequence gives the runs of its scenarios.
    strategies : sequence of str
        Which ones; by default all, and for each of several scenarios its own.
    prove_seconds : float, optional
        As in `solve`.

    Raises
    ------
    TimetableError, InfeasibleLineError, ScenarioError, StrategyRefusedError
        As in `solve`; of several scenarios the first one that has no run raises.
    """
    check_seconds(prove_seconds)
    for name in strategies:
        if name not in STRATEGIES:
            raise StrategyRefusedError(f"{name!r} is not a strategy; choose one of {', '.join(STRATEGIES)}.")
    if isinstance(scenario, Sequence) and not isinstance(scenario, str):
        return _compare_scenarios([as_scenario(one) for one in scenario], strategies, prove_seconds)
    task = prepare_task(as_scenario(scenario))
    # a timetable that none can keep is one fault of the scenario, not a refusal of each strategy
    task.require_timetable()
    runs: list[Trajectory] = []
    refused: dict[str, str] = {}
    for name in strategies or STRATEGIES:
        try:
            runs.append(run_strategy(task, name))
        except RailjouleError as refusal:
            refused[name] = str(refusal)
    kept: list[Trajectory] = []
    for run in with_bounds(task, runs, prove_seconds):
        try:
            kept.append(limit_jerk(task, partial(run_strategy, strategy=run.strategy), run))
        except RailjouleError as refusal:
            refused[run.strategy] = str(refusal)
    return Comparison(tuple(kept), refused, (task.shortest_travel_time_s,) * len(kept))


def _compare_scenarios(
    scenarios: Sequence[Scenario], strategies: Sequence[str], prove_seconds: float | None
) -> Comparison:
    """Return the runs of scenarios, each with its own bound and best known run; errors as `compare`."""
    if not scenarios:
        raise ScenarioError("scenario: the list is empty; at least one scenario is needed.")
    runs: list[Trajectory] = []
    shortest_s: list[float] = []
    for scenario in scenarios:
        task = prepare_task(scenario)
        for name in strategies or (scenario.strategy,):
            runs.append(_solve_task(task, name, prove_seconds))
            shortest_s.append(task.shortest_travel_time_s)
    return Comparison(tuple(runs), {}, tuple(shortest_s))


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


__all__ = [
    "STRATEGIES",
    "Comparison",
    "Strategy",
    "Task",
    "compare",
    "prepare_task",
    "register",
    "run_strategy",
    "solve",
    "with_bounds",
]
