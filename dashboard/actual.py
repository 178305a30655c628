"""The work behind the actual run on Drive: when it is asked for, and where it goes."""

from typing import Any

from railjoule.core import RailjouleError
from railjoule.core.simulate.actual_run import ActualRun
from railjoule.dashboard.models.actual import actual_changes
from railjoule.dashboard.models.scenario import PLAN_FIELDS
from railjoule.dashboard.models.workbench import Workbench
from railjoule.dashboard.robustness import FOLLOWER, REALITY
from railjoule.dashboard.store import ActualRequest, Worker, compute_actual, is_slow

PAGE = "Drive"


class Actual:
    """Asks for the actual run while Drive is in sight and it is switched on."""

    def __init__(self, state: Workbench) -> None:
        self.state, self.model = state, state.actual
        self.worker = Worker(
            compute_actual,
            self._take,
            self._take_failure,
            state.marks(PAGE),
            is_slow=lambda request: is_slow(request.scenario, request.scenario.strategy),
            about=state.scenario.identity,
        )
        self._asked: ActualRequest | None = None
        state.scenario.follow(lambda scenario: scenario.disturbance, self.model.take)
        self.model.take(state.scenario.edited)
        state.scenario.param.watch(self._forget, ["preset", "opened"])
        state.scenario.param.watch(self._ask, list(PLAN_FIELDS))
        state.param.watch(self._ask, ["page", "chosen", "runs"])
        state.robustness.param.watch(self._ask, [*REALITY, *FOLLOWER])
        state.disturbances.param.watch(self._ask, ["events", "accepted_delay_s", "changed"])
        self.model.param.watch(self._ask, ["on", "reaction"])

    def _forget(self, *_: Any) -> None:
        """Forget what was asked for: what comes of it is dropped, as the scenario has gone."""
        self._asked = None

    def _ask(self, *_: Any) -> None:
        if self.state.page != PAGE or not self.model.on:
            return
        request = ActualRequest(
            self.state.scenario.scenario(), {"strategy": self.state.chosen_now, **actual_changes(self.state)}
        )
        if request != self._asked:
            self._asked = request
            self.worker.ask(request)

    def _take(self, run: ActualRun) -> None:
        self.model.param.update(run=run, failure=None)

    def _take_failure(self, failure: RailjouleError) -> None:
        self.model.failure = failure
