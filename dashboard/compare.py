"""The work behind the page Compare: the runs of all strategies, while it is in sight."""

from typing import Any

from railjoule.core import RailjouleError
from railjoule.core.scenario import StrategyName
from railjoule.core.strategies import STRATEGIES
from railjoule.dashboard.models.scenario import PLAN_FIELDS
from railjoule.dashboard.models.workbench import Workbench
from railjoule.dashboard.store import Runs, RunsWish, Study, compute_runs_in_steps

PAGE = "Compare"
SLOW: tuple[StrategyName, ...] = ("bellman", "speed_limits")
"""What is still under way when the next scenario is asked for is left, so these come last."""
IN_TURN = (*(name for name in STRATEGIES if name not in SLOW), *SLOW)


class Compare:
    """Asks for the runs of all strategies; those that are ticked come sooner, from the work behind Drive."""

    def __init__(self, state: Workbench) -> None:
        self.state = state
        self.runs = Study(compute_runs_in_steps, self._take, self._take_failure)
        state.scenario.param.watch(self._ask, [*PLAN_FIELDS, "acceleration_time_s"])
        state.param.watch(self._ask, ["page", "compare_all"])

    def end(self) -> None:
        """End the work under way: the page is gone."""
        self.runs.stop()

    def _ask(self, *_: Any) -> None:
        if self.state.page == PAGE and self.state.compare_all:
            self.runs.ask(RunsWish(self.state.scenario.scenario(), IN_TURN))
        else:
            self.runs.stop()

    def _take(self, runs: Runs, last: bool) -> None:
        if last:
            self.state.compared = runs

    def _take_failure(self, failure: RailjouleError) -> None:
        """Leave it to the work behind Drive to tell: it runs over the same scenario."""
