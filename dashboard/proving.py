"""The work behind the bound on Drive: a first stage by itself once the run is there, more when it is asked for."""

from contextlib import nullcontext
from functools import partial
from typing import Any

import panel as pn
from bokeh.document import Document
from panel.io.state import set_curdoc

from railjoule.core import RailjouleError, Scenario
from railjoule.core.bounds import ProofStep
from railjoule.dashboard.models.scenario import PLAN_FIELDS
from railjoule.dashboard.models.workbench import Workbench
from railjoule.dashboard.store import (
    FIRST_STAGE_BOXES,
    FURTHER_BOXES,
    PROOF_THREADS,
    SLOW_THREADS,
    ProofRequest,
    Study,
    compute_proof,
    same_plan,
)

PAGE = "Drive"
REST_MS = 300
"""While a slider moves, each of its runs is gone before a proof could be of use."""


class Proving:
    """Tightens the bound of the runs in sight; what changes the plan, and leaving the page, ends it."""

    def __init__(self, state: Workbench) -> None:
        self.state, self.model = state, state.proof
        self.first = Study(compute_proof, self._take, self._fail, threads=SLOW_THREADS)
        self.further = Study(compute_proof, self._take, self._fail, threads=PROOF_THREADS)
        self._scenario: Scenario | None = None
        self._asked = 0
        state.scenario.param.watch(self.end, list(PLAN_FIELDS))
        state.param.watch(self._ask, ["page", "runs"])
        self.model.param.watch(self._go_on, "go_on")
        self.model.param.watch(self.end, "stop")

    def end(self, *_: Any) -> None:
        """End the work under way; what is proven by then stands."""
        self._asked += 1
        self.first.stop()
        self.further.stop()
        self.model.stage = ""

    def _ask(self, *_: Any) -> None:
        """Begin with the first stage, unless it is done or under way."""
        runs = self.state.runs
        if self.state.page != PAGE or runs is None:
            self.end()
            return
        same = self._scenario is not None and same_plan(self._scenario, runs.scenario)
        if self.model.stage and same:
            return
        self.end()
        self._scenario = runs.scenario
        known = self.model.of(runs.scenario)
        if runs.to_prove is None or (known is not None and (known.done_boxes > 0 or known.is_complete)):
            return
        document = pn.state.curdoc
        if document is None:
            self._begin(None, self._asked)
        else:
            document.add_timeout_callback(partial(self._begin, document, self._asked), REST_MS)

    def _begin(self, document: Document | None, asked: int) -> None:
        if asked == self._asked:
            with set_curdoc(document) if document is not None else nullcontext():
                self._prove("first", self.first, FIRST_STAGE_BOXES)

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

    def _fail(self, failure: RailjouleError) -> None:
        self.model.param.update(stage="", failure=failure)
