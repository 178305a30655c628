"""Runs that Drive computes beside those of the strategies: the actual run, simple advice, and tighter bounds."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from railjoule.core import RailjouleError, Scenario, Trajectory
from railjoule.core.bounds import FIRST_STAGE_BOXES, ProofStep, tightening, with_tighter_bound
from railjoule.core.budget import PAGE
from railjoule.core.lower_bound import Bound
from railjoule.core.simulation.actual_run import ActualRun, actual_run
from railjoule.core.strategies import prepare_task
from railjoule.dashboard.work.refusals import named_refusals
from railjoule.dashboard.work.runs import Runs

FURTHER_BOXES = PAGE.chain_boxes
"""Boxes of the stage that is started by hand: some 8 s on one core, and at most 1 GB while it lasts."""
PLANNED = ("vehicle", "line", "timetable", "solver")
"""The parts of a scenario on which a plan and its bound depend."""
MAX_PLANS = 16
"""Plans whose bounds a page stores, so that undo and a turn to another page need no proof again."""


def same_plan(one: Scenario, other: Scenario) -> bool:
    """Return whether two scenarios ask for the same plan: then a bound of one is a bound of the other."""
    return one is other or all(getattr(one, part) == getattr(other, part) for part in PLANNED)


# ---- the actual run


@dataclass(frozen=True)
class ActualRequest:
    """A scenario, and its differences from the plan, by the keys of the scenario's file."""

    scenario: Scenario
    changes: Mapping[str, Any]


def compute_actual(request: ActualRequest) -> ActualRun:
    """Return the plan of a scenario and its actual run.

    Raises
    ------
    RailjouleError
        If a value is out of its bounds, or there is no such plan or run.
    """
    scenario = request.scenario.replace(**request.changes)
    with named_refusals(scenario):
        return actual_run(scenario)


# ---- simple advice, and a moved instruction


@dataclass(frozen=True, eq=False)
class Answer:
    """A request with its result, or with the reason why there is none: a refusal is an answer too."""

    request: Any
    found: Any
    refusal: str = ""


def answer(compute: Callable[[Any], Any], request: Any) -> Answer:
    """Compute the answer to a request."""
    try:
        return Answer(request, compute(request))
    except RailjouleError as refusal:
        return Answer(request, None, str(refusal))


@dataclass(frozen=True)
class Move:
    """An optimum, the index of a phase, and the place where that is to begin [m]."""

    run: Trajectory
    number: int
    place_m: float


def compute_moved(move: Move) -> Trajectory:
    """Return the best run with a moved instruction; errors as `moved_run`."""
    from railjoule.core.studies.moved_instruction import moved_run  # noqa: PLC0415

    return moved_run(prepare_task(move.run.scenario), move.run, move.number, move.place_m)


# ---- the bound


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
