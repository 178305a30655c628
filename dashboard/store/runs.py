"""The runs of several strategies over one scenario."""

import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from railjoule.core import Scenario, SolverError, StrategyRefusedError, TimetableError, Trajectory
from railjoule.core.best_known import measured
from railjoule.core.scenario import StrategyName
from railjoule.core.strategies import Task, prepare_task, run_strategy
from railjoule.core.strategies.bellman import ControlLaw, bellman_with_law


@dataclass(frozen=True, eq=False)
class Runs:
    """The runs of several strategies over one scenario.

    Parameters
    ----------
    scenario : Scenario
        What was asked for.
    shortest_time_s : float
        Shortest possible time, dwells included [s].
    cell_count : int
        Cells of the mesh.
    runs : mapping
        The runs by strategy, each with its bound and what it is measured against.
    refused : mapping
        Why a strategy does not take the scenario.
    law : ControlLaw or None
        What dynamic programming would do at any speed and place, if asked for.
    """

    scenario: Scenario
    shortest_time_s: float
    cell_count: int
    runs: Mapping[StrategyName, Trajectory]
    refused: Mapping[StrategyName, str]
    law: ControlLaw | None = None

    @property
    def best(self) -> Trajectory:
        """The optimum; where it refuses the scenario or fails, the run of least energy."""
        if "optimal" in self.runs:
            return self.runs["optimal"]
        return min(self.runs.values(), key=lambda run: run.energy.net_j)

    @property
    def best_known(self) -> Trajectory:
        """The run that those within the timetable are measured against."""
        reference = self.best.reference
        known = (run for run in self.runs.values() if reference and run.energy.net_j == reference.energy_j)
        return next(known, self.best)

    @property
    def is_proven(self) -> bool:
        """Whether what runs within the timetable are measured against is proven to be the optimum."""
        reference = self.best.reference
        return reference is not None and reference.proven


@dataclass(frozen=True)
class RunsWish:
    """A scenario, the strategies to run on it, and whether the law of dynamic programming is asked for."""

    scenario: Scenario
    strategies: tuple[StrategyName, ...]
    with_law: bool = False


def compute_runs(wish: RunsWish) -> Runs:
    """Return the runs of the wished strategies; the optimum, which proves the bound, is always among them.

    Raises
    ------
    RailjouleError
        If the timetable cannot be kept, or the line not be run over.
    """
    *_, runs = compute_runs_in_steps(wish)
    return runs


def compute_runs_in_steps(wish: RunsWish) -> Iterator[Runs]:
    """Yield the runs of the wished strategies as they come, the optimum first; errors as `compute_runs`."""
    task = prepare_task(wish.scenario)
    task.require_timetable()
    runs: dict[StrategyName, Trajectory] = {}
    refused: dict[StrategyName, str] = {}
    law: ControlLaw | None = None
    for name in dict.fromkeys(("optimal", *wish.strategies)):
        try:
            if name == "bellman" and wish.with_law:
                runs[name], law = timed_with_law(task)
            else:
                runs[name] = run_strategy(task, name)
        except (StrategyRefusedError, SolverError, TimetableError) as refusal:
            refused[name] = str(refusal)
        if runs:
            yield beside_each_other(task, runs, refused, law)
    if not runs:
        raise StrategyRefusedError("; ".join(f"{name} {reason}" for name, reason in refused.items()))


def beside_each_other(
    task: Task,
    runs: Mapping[StrategyName, Trajectory],
    refused: Mapping[StrategyName, str],
    law: ControlLaw | None,
) -> Runs:
    """Return the runs so far, each with its bound and what it is measured against."""
    return Runs(
        scenario=task.scenario,
        shortest_time_s=task.shortest_travel_time_s,
        cell_count=task.course.cell_count,
        runs=dict(zip(runs, measured([*runs.values()]), strict=True)),
        refused=dict(refused),
        law=law,
    )


def timed_with_law(task: Task) -> tuple[Trajectory, ControlLaw]:
    """Return the run of dynamic programming with the time that it took, and its control law."""
    started = time.perf_counter()
    run, law = bellman_with_law(task)
    return replace(run, solve_time_s=time.perf_counter() - started), law
