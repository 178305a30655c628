"""The state of the proof on Drive: what is known of each plan, and what is under way."""

from dataclasses import dataclass
from typing import Any

import param

from railjoule.core import Scenario, Trajectory
from railjoule.core.bounds import ProofStep, with_tighter_bound
from railjoule.core.lower_bound import Bound
from railjoule.dashboard.pages.drive.proof_compute import FURTHER_BOXES, same_plan
from railjoule.dashboard.state.page_model import PageModel, result
from railjoule.dashboard.work.runs import Runs

MOST_KNOWN = 16
"""Plans whose bounds a page remembers, so that undo and a turn to another page need no proof again."""


@dataclass(frozen=True, eq=False)
class Proven:
    """What is proven of a plan: its greatest bound, how far the last proof went, and boxes of the last stage done."""

    scenario: Scenario
    bound: Bound
    step: ProofStep
    done_boxes: int = 0

    @property
    def is_complete(self) -> bool:
        """Whether the page can prove no more."""
        return self.step.reached or self.step.exhausted or self.done_boxes >= FURTHER_BOXES


class ProofModel(PageModel):
    """What is proven of the plans of one page; a bound that is looser than one known of the same plan is dropped."""

    go_on = param.Event(doc="The user asks to prove further.")
    stop = param.Event(doc="The user has waited long enough.")
    stage = param.Selector(default="", objects=["", "first", "further"], doc="The stage that is under way.")
    step = result(ProofStep, "How far that stage is.")
    has_prices_open = param.Boolean(default=False, doc="Whether the prices that prove the bound are in sight.")

    def __init__(self, **params: Any) -> None:
        super().__init__(**params)
        self._known: tuple[Proven, ...] = ()

    def of(self, scenario: Scenario) -> Proven | None:
        """Return what is proven of a plan."""
        return next((known for known in reversed(self._known) if same_plan(known.scenario, scenario)), None)

    def remember(self, scenario: Scenario, step: ProofStep, done: bool) -> Proven:
        """Take note of a step of a proof, the last one of its stage or not, and return what is proven by now."""
        before = self.of(scenario)
        bound, done_boxes = step.bound, step.budget if done else 0
        if before is not None:
            done_boxes = max(done_boxes, before.done_boxes)
            if before.bound.energy_j >= bound.energy_j:
                bound = before.bound
        known = Proven(scenario, bound, step, done_boxes)
        self._known = (*(one for one in self._known if one is not before), known)[-MOST_KNOWN:]
        return known

    def bounded(self, run: Trajectory) -> Trajectory:
        """Return a run with what is proven of its plan, where that is more than it has."""
        known = self.of(run.scenario)
        return run if known is None else with_tighter_bound(run, known.bound)

    def laid_on(self, runs: Runs) -> Runs:
        """Return runs with what is proven of them."""
        known = self.of(runs.scenario)
        return runs if known is None else runs.with_bound(known.bound)
