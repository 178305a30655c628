"""The bound of a scenario's runs, as a proof tightens it."""

from collections.abc import Iterator
from dataclasses import dataclass

from railjoule.core import Scenario, Trajectory
from railjoule.core.bounds import FIRST_STAGE_BOXES, ProofStep, tightening
from railjoule.core.budget import PAGE
from railjoule.core.strategies import prepare_task

FURTHER_BOXES = PAGE.chain_boxes
"""Boxes of the stage that is asked for by hand: some 8 s on one core, and at most 1 GB while it lasts."""
PLANNED = ("vehicle", "line", "timetable", "solver")
"""What a plan and its bound depend on."""


def same_plan(one: Scenario, other: Scenario) -> bool:
    """Return whether two scenarios ask for the same plan: then a bound of one is a bound of the other."""
    return one is other or all(getattr(one, part) == getattr(other, part) for part in PLANNED)


@dataclass(frozen=True, eq=False)
class ProofRequest:
    """A run of a scenario with its bound, which is to be tightened, and with how many boxes."""

    scenario: Scenario
    run: Trajectory
    budget: int = FIRST_STAGE_BOXES


def compute_proof(request: ProofRequest) -> Iterator[ProofStep]:
    """Yield the bound as it tightens; errors as `railjoule.core.bounds.minimise`."""
    bound = request.run.bound
    assert bound is not None
    yield from tightening(prepare_task(request.scenario), bound, request.run, request.budget)
