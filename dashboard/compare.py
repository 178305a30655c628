"""The work behind the page Compare: the runs of all strategies, while it is in sight."""

from contextlib import nullcontext
from functools import partial
from typing import Any

import panel as pn
from bokeh.document import Document
from panel.io.state import set_curdoc

from railjoule.core import RailjouleError
from railjoule.core.scenario import StrategyName
from railjoule.core.strategies import STRATEGIES
from railjoule.dashboard.models.scenario import PLAN_FIELDS
from railjoule.dashboard.models.workbench import Workbench
from railjoule.dashboard.store import Runs, RunsRequest, Study, compute_runs_in_steps

PAGE = "Compare"
SLOW: tuple[StrategyName, ...] = ("bellman", "speed_limits")
"""What is still under way when the next scenario is asked for is left, so these come last."""
REST_MS = 400
IN_TURN = (*(name for name in STRATEGIES if name not in SLOW), *SLOW)


class Compare:
    """Asks for the runs of all strategies; those that are ticked come sooner, from the work behind Drive."""

    def __init__(self, state: Workbench) -> None:
        self.state, self._asked = state, 0
        self.runs = Study(compute_runs_in_steps, self._take, self._take_failure)
        state.scenario.param.watch(self._ask, [*PLAN_FIELDS, "acceleration_time_s"])
        state.param.watch(self._ask, ["page", "compare_all"])

    def end(self) -> None:
        """End the work under way: the page is gone."""
        self._asked += 1
        self.runs.stop()

    def _ask(self, *_: Any) -> None:
        """Ask once the sliders rest: what is under way while they move takes turns from the page."""
        self.end()
        if self.state.page != PAGE or not self.state.compare_all:
            return
        document = pn.state.curdoc
        if document is None:
            self._begin(None, self._asked)
        else:
            document.add_timeout_callback(partial(self._begin, document, self._asked), REST_MS)

    def _begin(self, document: Document | None, asked: int) -> None:
        if asked == self._asked:
            with set_curdoc(document) if document is not None else nullcontext():
                self.runs.ask(RunsRequest(self.state.scenario.scenario(), IN_TURN))

    def _take(self, runs: Runs, last: bool) -> None:
        if last:
            self.state.compared = self.state.proof.laid_on(runs)

    def _take_failure(self, failure: RailjouleError) -> None:
        """Leave it to the work behind Drive to tell: it runs over the same scenario."""
