"""Runs that Drive computes beside those of the strategies: the actual run, simpler advice, and a moved instruction."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from railjoule.core import RailjouleError, Scenario, Trajectory
from railjoule.core.simulation.actual_run import ActualRun, actual_run
from railjoule.core.strategies import prepare_task
from railjoule.dashboard.work.runs import named_refusals

# ---- the actual run


def compute_actual(scenario: Scenario, changes: Mapping[str, Any]) -> ActualRun:
    """Return the plan of a scenario and its actual run, with changes by the keys of the scenario's file.

    Raises
    ------
    RailjouleError
        If a value is out of its bounds, or there is no such plan or run.
    """
    scenario = scenario.replace(**changes)
    with named_refusals(scenario):
        return actual_run(scenario)


# ---- simpler advice, and a moved instruction


@dataclass(frozen=True, eq=False)
class Answer:
    """A request with its result, or with the reason why there is none."""

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
    """An optimum, the index of a phase, and the new position of its begin [m]."""

    run: Trajectory
    number: int
    place_m: float


def compute_moved(move: Move) -> Trajectory:
    """Return the best run with a moved instruction; errors as `moved_run`."""
    from railjoule.core.studies.moved_instruction import moved_run  # noqa: PLC0415

    return moved_run(prepare_task(move.run.scenario), move.run, move.number, move.place_m)
