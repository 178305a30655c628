"""The work behind the actual run on Drive: its request, and its result."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from railjoule.core import Scenario
from railjoule.core.simulation.actual_run import ActualRun, actual_run
from railjoule.dashboard.day import FOLLOWING, LOAD_AND_POSITION, Day
from railjoule.dashboard.state.page_work import PageWork
from railjoule.dashboard.state.scenario import RUN_FIELDS
from railjoule.dashboard.state.workbench import Workbench
from railjoule.dashboard.work.refusals import named_refusals
from railjoule.dashboard.work.runs import is_slow


@dataclass(frozen=True)
class ActualRequest:
    """A scenario, and its differences from the plan, by the keys of the scenario's file."""

    scenario: Scenario
    changes: Mapping[str, Any]


def compute_actual(request: ActualRequest) -> ActualRun:
    """Return the plan of a scenario and its actual run.

    Raises
    ------
    RailjouleError
        If a value is out of its bounds, or there is no such plan or run.
    """
    scenario = request.scenario.replace(**request.changes)
    with named_refusals(scenario):
        return actual_run(scenario)


class Actual(PageWork[Day]):
    """Requests the actual run while Drive is in sight and it is switched on."""

    page = "Drive"

    def __init__(self, state: Workbench) -> None:
        super().__init__(state, state.day)
        self.run = self.worker(
            compute_actual,
            self._take,
            marked=True,
            is_slow=lambda request: is_slow(request.scenario, request.scenario.strategy),
        )
        state.scenario.param.watch(self._ask, list(RUN_FIELDS))
        # the runs too, as they decide the strategy of the plan: `chosen_now`
        state.param.watch(self._ask, ["page", "chosen", "runs"])
        watched = [*LOAD_AND_POSITION, *FOLLOWING, "events", "changed", "accepted_delay_s", "on", "reaction"]
        self.model.param.watch(self._ask, watched)

    def _ask(self, *_: Any) -> None:
        if not self.in_sight or not self.model.on:
            return
        request = ActualRequest(
            self.state.scenario.scenario(), {"strategy": self.state.chosen_now, **self.model.actual_changes}
        )
        if self.is_new(request):
            self.run.ask(request)

    def _take(self, run: ActualRun) -> None:
        self.model.param.update(run=run, failure=None)
