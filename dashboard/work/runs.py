"""The runs of several strategies over one scenario, and the proven bounds of their plans."""

import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial

from railjoule.core import RailjouleError, Scenario, StrategyRefusedError, Trajectory
from railjoule.core.best_known import with_best_known
from railjoule.core.bounds import (
    FIRST_STAGE_BOXES,
    ProofStep,
    bounded,
    run_to_prove,
    tightened,
    tightening,
    with_tighter_bound,
)
from railjoule.core.budget import PAGE
from railjoule.core.compilation import needs_compiler
from railjoule.core.compilation.light import NO_IDLE_LOSSES, estimated_cells
from railjoule.core.compiled import MODE
from railjoule.core.jerk import limit_jerk
from railjoule.core.lower_bound import Bound
from railjoule.core.strategies import STRATEGIES, Task, prepare_task, run_strategy
from railjoule.core.strategies.bellman import ControlLaw, bellman_with_law
from railjoule.dashboard.look.key_names import without_keys
from railjoule.dashboard.look.words import STRATEGY_WORDS


# results equal only themselves, as arrays have no single answer to `==`; requests are compared by their values
@dataclass(frozen=True, eq=False)
class Runs:
    """The runs of several strategies over one scenario.

    Parameters
    ----------
    scenario : Scenario
        The request.
    shortest_time_s : float
        Shortest possible time, dwells included [s].
    cell_count : int
        Cells of the mesh.
    runs : mapping
        The runs by strategy, each with its bound and what it is measured against.
    refused : mapping
        Why a strategy does not take the scenario.
    law : ControlLaw or None
        Decision of dynamic programming at any speed and place, if requested.
    """

    scenario: Scenario
    shortest_time_s: float
    cell_count: int
    runs: Mapping[str, Trajectory]
    refused: Mapping[str, str]
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

    @property
    def to_prove(self) -> Trajectory | None:
        """The run whose bound a proof may tighten; None where the first bound proves it already, or there is none."""
        bound = self.best.bound
        return None if bound is None or self.best.is_proven else run_to_prove(bound, self.runs.values())

    def with_bound(self, bound: Bound) -> "Runs":
        """Return the same runs, those with a greater bound that it covers."""
        return replace(self, runs={name: with_tighter_bound(run, bound) for name, run in self.runs.items()})


OTHERS_SECONDS_PER_CELL, SWITCHING_SECONDS_PER_CELL2 = 5e-5, 1.6e-7
"""Times of strategies that name none of their own [s], measured on one busy core: for each cell and, with idle losses,
for each squared cell."""
RELAY_SECONDS_PER_STEP = 1e-3
"""Of a search with the printed relay, which drives every combination of set speeds in steps of time."""
# a page that opens computes tasks shorter than AT_ONCE_S on the event loop, where all other pages wait
SLOW_S, AT_ONCE_S = 1.0, 0.1


def expected_s(scenario: Scenario, *strategies: str) -> float:
    """Return about how long strategies take [s]: for deciding where to compute them, not for telling it."""
    cells = estimated_cells(scenario)
    switching = 0.0 if isinstance(scenario.vehicle.drive, NO_IDLE_LOSSES) else SWITCHING_SECONDS_PER_CELL2 * cells
    per_cell = OTHERS_SECONDS_PER_CELL + switching + sum(STRATEGIES[name].seconds_per_cell for name in strategies)
    search = scenario.search
    searches_relay = "speed_limits" in strategies and search.regulator == "literal" and search.limits_kmh is None
    steps = scenario.travel_time_s / search.time_step_s if searches_relay else 0.0
    return cells * per_cell + RELAY_SECONDS_PER_STEP * steps


def is_slow(scenario: Scenario, *strategies: str) -> bool:
    """Return whether strategies take seconds."""
    return expected_s(scenario, *strategies) > SLOW_S


@dataclass(frozen=True)
class RunsRequest:
    """A scenario, the strategies to run on it, and whether the law of dynamic programming is asked for."""

    scenario: Scenario
    strategies: tuple[str, ...]
    with_law: bool = False

    @property
    def is_possible(self) -> bool:
        """Whether it can be computed by now: some runs need compiled code."""
        return MODE.is_compiled or not needs_compiler(self.scenario, "optimal", *self.strategies)

    @property
    def is_slow(self) -> bool:
        """Whether it takes seconds."""
        return is_slow(self.scenario, *self.strategies)

    @property
    def is_short(self) -> bool:
        """Whether a page that opens may wait for it."""
        return expected_s(self.scenario, *self.strategies) < AT_ONCE_S


class FirstRuns:
    """The runs with which pages open, which most visitors share: computed once a process, and never while one opens."""

    def __init__(self, most: int = 32) -> None:
        self._most = most
        self._wanted: set[RunsRequest] = set()
        self._known: dict[RunsRequest, Runs] = {}

    def known(self, request: RunsRequest) -> Runs | None:
        """Return runs that are known, or None; then they are kept the next time that they are computed."""
        if request not in self._known and len(self._known) < self._most:
            self._wanted.add(request)
        return self._known.get(request)

    def compute(self, request: RunsRequest) -> Runs:
        """Return the runs of a request, whether they are known or not; errors as `compute_runs`."""
        if request in self._known:
            return self._known[request]
        runs = compute_runs(request)
        if request in self._wanted and len(self._known) < self._most:
            self._known[request] = runs
            self._wanted.discard(request)
        return runs


def compute_runs(request: RunsRequest) -> Runs:
    """Return the runs of the requested strategies; the optimum, which proves the bound, is always among them.

    Raises
    ------
    RailjouleError
        If the timetable cannot be kept, or the line not be run over.
    """
    *_, runs = compute_runs_in_steps(request)
    return runs


def tightened_runs(runs: Runs, known: Bound | None = None, prove_seconds: float | None = None) -> Runs:
    """Return runs with the bound that the commands `solve` and `compare` prove of them, or a known one if greater.

    `prove_seconds` as for `railjoule.core.solve`.
    """
    if known is not None:
        runs = runs.with_bound(known)
    run = runs.to_prove
    if run is None or run.bound is None:
        return runs
    return runs.with_bound(tightened(prepare_task(runs.scenario), run.bound, run, seconds=prove_seconds))


def compute_runs_in_steps(request: RunsRequest) -> Iterator[Runs]:
    """Yield the runs of the requested strategies as they come, the optimum first; errors as `compute_runs`."""
    task = prepare_task(request.scenario)
    task.require_timetable()
    runs: dict[str, Trajectory] = {}
    refused: dict[str, str] = {}
    law: ControlLaw | None = None
    for name in dict.fromkeys(("optimal", *request.strategies)):
        try:
            if name == "bellman" and request.with_law:
                run, law = timed_with_law(task)
            else:
                run = run_strategy(task, name)
            # the optimum comes first, and its bound covers the runs over the same mesh that are in time
            run = bounded(task, run, runs["optimal"].bound if "optimal" in runs else None)
            runs[name] = limit_jerk(task, partial(run_strategy, strategy=name), run)
        except RailjouleError as refusal:
            refused[name] = without_keys(str(refusal))
        if runs:
            yield beside_each_other(task, runs, refused, law)
    if not runs:
        raise StrategyRefusedError("; ".join(f"{name} {reason}" for name, reason in refused.items()))


def beside_each_other(
    task: Task,
    runs: Mapping[str, Trajectory],
    refused: Mapping[str, str],
    law: ControlLaw | None,
) -> Runs:
    """Return the runs so far, each with its bound and what it is measured against."""
    return Runs(
        scenario=task.scenario,
        shortest_time_s=task.shortest_travel_time_s,
        cell_count=task.mesh.cell_count,
        runs=dict(zip(runs, with_best_known([*runs.values()]), strict=True)),
        refused=dict(refused),
        law=law,
    )


def timed_with_law(task: Task) -> tuple[Trajectory, ControlLaw]:
    """Return the run of dynamic programming with the time that it took, and its control law."""
    started = time.perf_counter()
    # `run_strategy`, which takes the time of all other runs, returns no law
    run, law = bellman_with_law(task)
    return replace(run, solve_time_s=time.perf_counter() - started), law


@contextmanager
def named_refusals(scenario: Scenario) -> Iterator[None]:
    """Let a refusal of a scenario's strategy name that strategy."""
    try:
        yield
    except StrategyRefusedError as refusal:
        raise StrategyRefusedError(f"{STRATEGY_WORDS[scenario.strategy]}: {refusal}") from None


# ---- tighter bounds

FURTHER_BOXES = PAGE.chain_boxes
"""Boxes of the stage that is started by hand: some 8 s on one core, and at most 1 GB while it lasts."""
PLANNED = ("vehicle", "line", "timetable", "solver")
"""The parts of a scenario on which a plan and its bound depend."""
MAX_PLANS = 16
"""Plans whose bounds a page stores, so that undo and a turn to another page need no proof again."""


def same_plan(one: Scenario, other: Scenario) -> bool:
    """Return whether two scenarios ask for the same plan: then a bound of one is a bound of the other."""
    return one is other or all(getattr(one, part) == getattr(other, part) for part in PLANNED)


@dataclass(frozen=True, eq=False)
class Proven:
    """The greatest bound proven for a plan, the last step of its proof, and boxes of the last stage that has ended."""

    scenario: Scenario
    bound: Bound
    step: ProofStep
    done_boxes: int = 0

    @property
    def is_complete(self) -> bool:
        """Whether the page can prove no more."""
        return self.step.reached or self.step.exhausted or self.done_boxes >= FURTHER_BOXES


class ProofRequest:
    """A run of a scenario whose bound is to be tightened, and with how many boxes; equal for the same plan."""

    def __init__(self, scenario: Scenario, run: Trajectory, budget: int = FIRST_STAGE_BOXES) -> None:
        self.scenario, self.run, self.budget = scenario, run, budget

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, ProofRequest):
            return NotImplemented
        return self.budget == other.budget and same_plan(self.scenario, other.scenario)

    def __hash__(self) -> int:
        return hash(self.budget)


def compute_proof(request: ProofRequest) -> Iterator[Proven]:
    """Yield the bound as it tightens; errors as `railjoule.core.bounds.minimise`."""
    bound, last = request.run.bound, None
    assert bound is not None
    for step in tightening(prepare_task(request.scenario), bound, request.run, request.budget):
        last = Proven(request.scenario, step.bound, step)
        yield last
    if last is not None:
        yield replace(last, done_boxes=request.budget)


class Proofs:
    """Proven bounds of the plans of one page; a bound that is looser than a known one of the same plan is dropped."""

    def __init__(self) -> None:
        self._known: tuple[Proven, ...] = ()

    def of(self, scenario: Scenario) -> Proven | None:
        """Return the proof of a plan."""
        return next((known for known in reversed(self._known) if same_plan(known.scenario, scenario)), None)

    def remember(self, proven: Proven) -> Proven:
        """Store a step of a proof, and return all that is proven of its plan."""
        before = self.of(proven.scenario)
        if before is not None:
            bound = max(before.bound, proven.bound, key=lambda bound: bound.energy_j)
            proven = replace(proven, bound=bound, done_boxes=max(proven.done_boxes, before.done_boxes))
        self._known = (*(one for one in self._known if one is not before), proven)[-MAX_PLANS:]
        return proven

    def bounded(self, run: Trajectory) -> Trajectory:
        """Return a run with the proven bound of its plan, where that is greater than its own."""
        known = self.of(run.scenario)
        return run if known is None else with_tighter_bound(run, known.bound)

    def laid_on(self, runs: Runs) -> Runs:
        """Return runs with the proven bound of their plan."""
        known = self.of(runs.scenario)
        return runs if known is None else runs.with_bound(known.bound)
