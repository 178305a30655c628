"""The work behind the page Compare: the runs of all strategies, while it is in sight."""

from typing import Any

from railjoule.core import RailjouleError
from railjoule.core.strategies import STRATEGIES
from railjoule.dashboard.state.page_work import PageWork
from railjoule.dashboard.state.scenario import RUN_FIELDS
from railjoule.dashboard.state.workbench import Workbench
from railjoule.dashboard.work.runs import Runs, RunsRequest, compute_runs_in_steps

PAGE = "Compare"
REST_MS = 400
"""While a slider moves, what is under way takes turns from the page."""
IN_TURN = tuple(sorted(STRATEGIES, key=lambda name: STRATEGIES[name].seconds_per_cell))
"""The slowest come last, as a strategy still under way is abandoned when the next scenario is asked for."""


class Compare(PageWork[Workbench]):
    """Asks for the runs of all strategies; those that are ticked come sooner, from the work behind Drive."""

    page = PAGE

    def __init__(self, state: Workbench) -> None:
        super().__init__(state, state)
        self.runs = self.study(compute_runs_in_steps, self._take)
        state.scenario.param.watch(self._ask, list(RUN_FIELDS))
        state.param.watch(self._ask, ["page", "compare_all"])

    def _ask(self, *_: Any) -> None:
        # whatever comes next: what is under way is of the scenario before, or for nobody to see
        self.end()
        if self.in_sight and self.state.compare_all:
            self.after(REST_MS, lambda: self.runs.ask(RunsRequest(self.state.scenario.scenario(), IN_TURN)))

    def _take(self, runs: Runs, last: bool) -> None:
        if last:
            self.state.compared = self.state.proof.laid_on(runs)

    def take_failure(self, failure: RailjouleError) -> None:
        """Leave it to the work behind Drive to tell: it runs over the same scenario."""
