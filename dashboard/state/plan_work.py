"""The work behind what all pages begin with: the runs of the scenario as it stands."""

from typing import Any

import panel as pn

from railjoule.dashboard.state.page_work import PageWork
from railjoule.dashboard.state.scenario import RUN_FIELDS
from railjoule.dashboard.state.workbench import Workbench
from railjoule.dashboard.work.runs import FirstRuns, Runs, RunsRequest
from railjoule.dashboard.work.worker import Worker

FIRST = FirstRuns()


class Plans(PageWork[Workbench]):
    """Asks for the runs of the strategies that are drawn, whatever page is in sight."""

    def __init__(self, state: Workbench) -> None:
        super().__init__(state, state)
        self._mark_pages = state.marks("Start", "Drive", "Compare", "Trade-off")
        self.runs = Worker(
            FIRST.compute,
            self._take,
            self.take_failure,
            self._mark,
            is_slow=lambda request: request.is_slow,
            about=state.scenario.identity,
        )

    def _mark(self, late: bool) -> None:
        """Mark the pages as late, unless only more strategies are under way: those that are shown stay valid."""
        state, runs = self.state, self.state.runs
        is_shown = runs is not None and runs.scenario == state.scenario.scenario() and state.chosen in runs.runs
        self._mark_pages(late and not is_shown)

    def begin(self) -> None:
        """Listen to what runs depend on: what the address has changed before is asked for once."""
        self.state.scenario.param.watch(self.ask, list(RUN_FIELDS))
        self.state.param.watch(self.ask, ["ticked", "chosen"])

    def ask(self, *_: Any) -> None:
        """Ask for the runs; the page asks again for those that need compiled code before there is any."""
        request = self._request()
        if request.is_possible:
            self.runs.ask(request)

    def take_first(self) -> None:
        """Take short runs that are known into a page that opens; others it asks for when it is there."""
        request = self._request()
        if not request.is_short:
            return
        known = FIRST.known(request)
        if known is not None:
            self._take(known)
        # without a page around it nobody else waits
        elif pn.state.curdoc is None:
            self.runs.do(request)

    def compute_first(self) -> None:
        """Compute what a page opens with, for those that will."""
        request = self._request()
        if FIRST.known(request) is None:
            FIRST.compute(request)

    def _request(self) -> RunsRequest:
        return RunsRequest(self.state.scenario.scenario(), self.state.drawn, with_law=self.state.chosen == "bellman")

    def _take(self, runs: Runs) -> None:
        self.state.param.update(runs=self.state.proof.laid_on(runs), failure=None)
