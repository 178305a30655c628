"""The work behind the actual run on Drive: when it is asked for, and where it goes."""

from typing import Any

from railjoule.core.simulation.actual_run import ActualRun
from railjoule.dashboard.actual.compute import ActualRequest, compute_actual
from railjoule.dashboard.actual.follower import FOLLOWER, REALITY
from railjoule.dashboard.actual.model import ActualModel, actual_changes
from railjoule.dashboard.state.page_work import PageWork
from railjoule.dashboard.state.scenario import RUN_FIELDS
from railjoule.dashboard.state.workbench import Workbench
from railjoule.dashboard.work.runs import is_slow


class Actual(PageWork[ActualModel]):
    """Asks for the actual run while Drive is in sight and it is switched on."""

    page = "Drive"

    def __init__(self, state: Workbench) -> None:
        super().__init__(state, state.actual)
        self.run = self.worker(
            compute_actual,
            self._take,
            marked=True,
            is_slow=lambda request: is_slow(request.scenario, request.scenario.strategy),
        )
        state.scenario.follow(lambda scenario: scenario.disturbance, self.model.take)
        self.model.take(state.scenario.edited)
        state.scenario.param.watch(self._ask, list(RUN_FIELDS))
        # the runs too: only they tell which strategy the plan is by, `chosen_now`
        state.param.watch(self._ask, ["page", "chosen", "runs"])
        state.robustness.param.watch(self._ask, [*REALITY, *FOLLOWER])
        state.disturbances.param.watch(self._ask, ["events", "accepted_delay_s", "changed"])
        self.model.param.watch(self._ask, ["on", "reaction"])

    def _ask(self, *_: Any) -> None:
        if not self.in_sight or not self.model.on:
            return
        request = ActualRequest(
            self.state.scenario.scenario(), {"strategy": self.state.chosen_now, **actual_changes(self.state)}
        )
        if self.is_new(request):
            self.run.ask(request)

    def _take(self, run: ActualRun) -> None:
        self.model.param.update(run=run, failure=None)
