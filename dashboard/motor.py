"""The work behind the page Motor: what is asked for when, and where its results go."""

from typing import Any

from railjoule.core import RailjouleError, Scenario
from railjoule.core.simulate.field_oriented import Ripple
from railjoule.core.studies.detuning import DetuningTable
from railjoule.dashboard.models.motor import CONTROL_FIELDS
from railjoule.dashboard.models.scenario import PLAN_FIELDS
from railjoule.dashboard.models.workbench import Workbench
from railjoule.dashboard.store import (
    LoopRequest,
    LoopRivals,
    LoopRun,
    MachineMap,
    RippleRequest,
    Study,
    Worker,
    compute_detuning,
    compute_loop_run,
    compute_machine_map,
    compute_ripple,
    compute_rivals,
    is_slow,
    machine_refusal,
)

PAGE = "Motor"


class Motor:
    """Asks for the run of one page through the control loop, and for what hangs on it, while it is in sight."""

    def __init__(self, state: Workbench) -> None:
        self.state, self.model = state, state.motor
        self.run = Worker(
            compute_loop_run,
            self._take_run,
            self._take_failure,
            state.marks(PAGE),
            is_slow=lambda request: is_slow(request.scenario, request.strategy),
            about=state.scenario.identity,
        )
        about = state.scenario.identity
        self.rivals = Worker(compute_rivals, self._take_rivals, self._take_failure, about=about)
        self.map = Worker(compute_machine_map, self._take_map, self._take_failure, about=about)
        self.ripple = Worker(compute_ripple, self._take_ripple, self._take_no_ripple, about=about)
        self.detuning = Study(compute_detuning, self._take_detuning, self._take_failure)
        self._asked: LoopRequest | None = None
        self._quiet = False
        self._taken: Any = None
        state.scenario.param.watch(self._take_scenario, ["preset", "opened"])
        state.scenario.param.watch(self._take_edits, "edits")
        state.scenario.param.watch(self._ask, [*PLAN_FIELDS, "acceleration_time_s"])
        state.param.watch(self._ask, ["page", "chosen"])
        self.model.param.watch(self._ask, list(CONTROL_FIELDS))
        self.model.param.watch(self._ask_ripple, "ripple_at_s")
        self.model.param.watch(self._study, "study")
        self.model.param.watch(self._stop, "stop_study")
        self._take_scenario()

    def end(self) -> None:
        """End the study: the page is gone."""
        self.detuning.stop()

    def _take_scenario(self, *_: Any) -> None:
        """Take over a scenario; what was found or asked for the one before goes."""
        self._quiet, self._asked = True, None
        self._stop()
        self.model.param.update(run=None, rivals=None, machine_map=None, ripple=None, detuning=None, failure=None)
        self._take(self.state.scenario.base)
        self._quiet = False

    def _take_edits(self, *_: Any) -> None:
        """Take over a drive or a controller that was edited elsewhere."""
        scenario = self.state.scenario.edited
        if self._taken != (scenario.vehicle.drive, scenario.simulation):
            self._quiet = True
            self._take(scenario)
            self._quiet = False

    def _take(self, scenario: Scenario) -> None:
        self._taken = scenario.vehicle.drive, scenario.simulation
        self.model.take(scenario)

    def _request(self) -> LoopRequest:
        return LoopRequest(self.state.scenario.scenario(), self.state.chosen, self.model.changes)

    def _ask(self, *_: Any) -> None:
        if self.state.page != PAGE or self._quiet:
            return
        self.model.no_machine = machine_refusal(self.state.scenario.scenario())
        request = self._request()
        if request == self._asked:
            return
        self._asked = request
        self._stop()
        self.model.detuning = None
        if not self.model.no_machine:
            self.run.ask(request)

    def _take_run(self, loop: LoopRun) -> None:
        """Take a run, unless its scenario has gone meanwhile, and ask for what hangs on it."""
        if self.model.no_machine:
            return
        self.model.param.update(run=loop.run, failure=None)
        self.rivals.ask(loop)
        self.map.ask(loop.run)
        self._ask_ripple()

    def _ask_ripple(self, *_: Any) -> None:
        if self.model.run is not None and not self._quiet:
            self.ripple.ask(RippleRequest(self.model.run, float(self.model.ripple_at_s)))

    def _study(self, *_: Any) -> None:
        if not self.model.no_machine:
            self.model.studying = True
            self.detuning.ask(self._request())

    def _stop(self, *_: Any) -> None:
        self.detuning.stop()
        self.model.studying = False

    def _take_rivals(self, rivals: LoopRivals) -> None:
        if rivals.run is self.model.run:
            self.model.rivals = rivals

    def _take_map(self, found: MachineMap) -> None:
        if found.run is self.model.run:
            self.model.machine_map = found

    def _take_ripple(self, ripple: Ripple) -> None:
        if self.model.run is not None:
            self.model.ripple = ripple

    def _take_no_ripple(self, failure: RailjouleError) -> None:
        self.model.param.update(ripple=None, failure=failure)

    def _take_detuning(self, table: DetuningTable, last: bool) -> None:
        self.model.param.update(detuning=table, studying=not last)

    def _take_failure(self, failure: RailjouleError) -> None:
        self.model.param.update(failure=failure, studying=False)
