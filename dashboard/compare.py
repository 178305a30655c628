"""The work behind the page Compare: the runs of all strategies, while it is in sight."""

from typing import Any

from railjoule.core import RailjouleError
from railjoule.core.strategies import STRATEGIES
from railjoule.dashboard.models.scenario import PLAN_FIELDS
from railjoule.dashboard.models.workbench import Workbench
from railjoule.dashboard.store import Runs, RunsWish, Worker, compute_runs

PAGE = "Compare"


class Compare:
    """Asks for the runs of all strategies; those that are ticked come sooner, from the work behind Drive."""

    def __init__(self, state: Workbench) -> None:
        self.state = state
        self.runs = Worker(compute_runs, self._take, self._take_failure)
        state.scenario.param.watch(self._ask, [*PLAN_FIELDS, "acceleration_time_s"])
        state.param.watch(self._ask, ["page", "compare_all"])

    def _ask(self, *_: Any) -> None:
        if self.state.page == PAGE and self.state.compare_all:
            self.runs.ask(RunsWish(self.state.scenario.scenario(), tuple(STRATEGIES)))

    def _take(self, runs: Runs) -> None:
        self.state.compared = runs

    def _take_failure(self, failure: RailjouleError) -> None:
        """Leave it to the work behind Drive to tell: it runs over the same scenario."""
