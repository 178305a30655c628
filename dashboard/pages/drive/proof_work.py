"""The work behind the bound on Drive: a first stage by itself once the run is there, more when it is asked for."""

from typing import Any

from railjoule.core import Scenario
from railjoule.core.bounds import FIRST_STAGE_BOXES, ProofStep
from railjoule.dashboard.pages.drive.proof_compute import FURTHER_BOXES, ProofRequest, compute_proof, same_plan
from railjoule.dashboard.pages.drive.proof_model import ProofModel
from railjoule.dashboard.state.page_work import PageWork
from railjoule.dashboard.state.scenario import PLAN_FIELDS
from railjoule.dashboard.state.workbench import Workbench
from railjoule.dashboard.work.worker import PROOF_THREADS, SLOW_THREADS, Study

REST_MS = 300
"""While a slider moves, each of its runs is gone before a proof could be of use."""


class Proving(PageWork[ProofModel]):
    """Tightens the bound of the runs in sight; what changes the plan, and leaving the page, ends it."""

    page = "Drive"
    at_rest = {"stage": ""}  # noqa: RUF012

    def __init__(self, state: Workbench) -> None:
        super().__init__(state, state.proof)
        self.first = self.study(compute_proof, self._take, threads=SLOW_THREADS)
        self.further = self.study(compute_proof, self._take, threads=PROOF_THREADS)
        self._scenario: Scenario | None = None
        # at once, as the next runs may take seconds, and what is under way proves a plan that has gone
        state.scenario.param.watch(self.end, list(PLAN_FIELDS))
        state.param.watch(self._ask, ["page", "runs"])
        self.model.param.watch(self._go_on, "go_on")
        self.model.param.watch(self.end, "stop")

    def end(self, *_: Any) -> None:
        """End the work under way; what is proven by then stands."""
        super().end()
        self.model.stage = ""

    def _ask(self, *_: Any) -> None:
        """Begin with the first stage, unless it is done or under way."""
        runs = self.state.runs
        if not self.in_sight or runs is None:
            self.end()
            return
        same = self._scenario is not None and same_plan(self._scenario, runs.scenario)
        # runs of other strategies over the same plan leave its proof under way
        if self.model.stage and same:
            return
        self.end()
        self._scenario = runs.scenario
        known = self.model.of(runs.scenario)
        if runs.to_prove is None or (known is not None and (known.done_boxes > 0 or known.is_complete)):
            return
        self.after(REST_MS, lambda: self._prove("first", self.first, FIRST_STAGE_BOXES))

    def _go_on(self, *_: Any) -> None:
        """Prove further; also where the first stage was stopped."""
        self.end()
        self._prove("further", self.further, FURTHER_BOXES)

    def _prove(self, stage: str, study: "Study[ProofRequest, ProofStep]", budget: int) -> None:
        runs = self.state.runs
        run = None if runs is None else runs.to_prove
        if runs is not None and run is not None:
            self._scenario = runs.scenario
            self.model.param.update(stage=stage, step=None, failure=None)
            study.ask(ProofRequest(runs.scenario, run, budget))

    def _take(self, step: ProofStep, last: bool) -> None:
        assert self._scenario is not None
        known = self.model.remember(self._scenario, step, last)
        self.state.take_bound(known.scenario, known.bound)
        self.model.param.update(step=step, stage="" if last else self.model.stage)
