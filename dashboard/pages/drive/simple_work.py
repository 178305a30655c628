"""The work behind the simple advice on Drive: computed when it is asked for, and stale once its scenario changes."""

from typing import TYPE_CHECKING, Any

from railjoule.core import RailjouleError, Scenario
from railjoule.dashboard.pages.drive.proof_compute import same_plan
from railjoule.dashboard.pages.drive.simple_model import SimpleModel, SimpleOrders
from railjoule.dashboard.state.page_work import PageWork
from railjoule.dashboard.state.scenario import PLAN_FIELDS
from railjoule.dashboard.state.workbench import Workbench
from railjoule.dashboard.work.simple_advice import compute_simple_advice, first_told

if TYPE_CHECKING:
    from railjoule.core.studies.simple_advice import SimpleAdvice

    _Answer = tuple[Scenario, SimpleAdvice | RailjouleError]


class SimpleAdvising(PageWork[SimpleModel]):
    """Asks for the simple advice of the scenario as it stands; what comes for another one is dropped."""

    page = "Drive"
    at_rest = {"computing": False}  # noqa: RUF012

    def __init__(self, state: Workbench) -> None:
        super().__init__(state, state.simple)
        # seconds on a long line: sliders of other pages need not wait for it
        self.advise = self.worker(_compute, self._take, self._take_fault, is_slow=lambda _: True)
        self._asked_for: Scenario | None = None
        state.scenario.param.watch(self._let_go, ["preset", "opened"])
        state.scenario.param.watch(self._look, list(PLAN_FIELDS))
        self.model.param.watch(self._ask, "ask")

    def _ask(self, *_: Any) -> None:
        scenario = self.state.scenario.scenario()
        if self._asked_for is not None and same_plan(self._asked_for, scenario):
            return
        self._asked_for = scenario
        self.model.param.update(computing=True, failure=None)
        self.advise.ask(scenario)

    def _let_go(self, *_: Any) -> None:
        """Forget all of it with the scenario that it was for."""
        self._asked_for = None
        self.model.param.update(found=None, changes=None, failure=None, stale=False, computing=False)

    def _look(self, *_: Any) -> None:
        """Tell whether what is there, or on its way, is still that of the scenario."""
        found = self.model.found
        if found is None and self._asked_for is None and self.model.failure is None:
            return
        scenario = self.state.scenario.scenario()
        if self._asked_for is not None and not same_plan(self._asked_for, scenario):
            self._asked_for = None
        self.model.param.update(
            computing=self._asked_for is not None,
            failure=None,
            stale=found is not None and not same_plan(found.scenario, scenario),
        )

    def _take(self, answer: "_Answer") -> None:
        scenario, advice = answer
        if scenario is not self._asked_for:
            return
        self._asked_for = None
        if isinstance(advice, RailjouleError):
            self.take_failure(advice)
            return
        found, changes = SimpleOrders(scenario, advice), first_told(advice).changes
        self.model.param.update(found=found, changes=changes, stale=False, computing=False, failure=None)

    def _take_fault(self, fault: RailjouleError) -> None:
        self._asked_for = None
        self.take_failure(fault)


def _compute(scenario: Scenario) -> "_Answer":
    # a refusal is an answer too: only with its scenario can one be told that nobody waits for any more
    try:
        return scenario, compute_simple_advice(scenario)
    except RailjouleError as refusal:
        return scenario, refusal
