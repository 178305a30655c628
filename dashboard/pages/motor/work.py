"""The work behind the page Motor: what is asked for when, and where its results go."""

from typing import Any

from railjoule.core import RailjouleError, Scenario
from railjoule.core.simulation.field_oriented import Ripple
from railjoule.core.studies.flux_sweep import FluxSweep
from railjoule.core.studies.table import StudyTable
from railjoule.dashboard.pages.motor.compute import (
    FluxRequest,
    LoopRequest,
    LoopRivals,
    LoopRun,
    MachineMap,
    RippleRequest,
    compute_detuning,
    compute_flux_sweep,
    compute_loop_run,
    compute_machine_map,
    compute_ripple,
    compute_rivals,
    machine_refusal,
)
from railjoule.dashboard.pages.motor.model import CONTROL_FIELDS, MotorModel
from railjoule.dashboard.state.page_work import PageWork
from railjoule.dashboard.state.scenario import RUN_FIELDS
from railjoule.dashboard.state.workbench import Workbench
from railjoule.dashboard.work.runs import is_slow

PAGE = "Motor"


class Motor(PageWork[MotorModel]):
    """Asks for the run of one page through the control loop, and for what hangs on it, while it is in sight."""

    page = PAGE
    at_rest = {"studying": False}  # noqa: RUF012

    def __init__(self, state: Workbench) -> None:
        super().__init__(state, state.motor)
        self.run = self.worker(
            compute_loop_run,
            self._take_run,
            marked=True,
            is_slow=lambda request: is_slow(request.scenario, request.strategy),
        )
        self.rivals = self.worker(compute_rivals, self._take_rivals)
        self.map = self.worker(compute_machine_map, self._take_map)
        self.ripple = self.worker(compute_ripple, self._take_ripple, self._take_no_ripple)
        self.flux = self.worker(compute_flux_sweep, self._take_flux, self._take_no_flux)
        self.detuning = self.study(compute_detuning, self._take_detuning)
        self._taken: Any = None
        state.scenario.param.watch(self._take_edits, "edits")
        # the plan may be ENOC's, which depends on its acceleration time as well
        state.scenario.param.watch(self._ask, list(RUN_FIELDS))
        state.param.watch(self._ask, ["page", "chosen"])
        self.model.param.watch(self._ask, list(CONTROL_FIELDS))
        self.model.param.watch(self._ask_ripple, "ripple_at_s")
        self.model.param.watch(self._ask_flux, "cruise_speed_kmh")
        self.model.param.watch(self._study, "study")
        self.model.param.watch(self._stop, "stop_study")
        self.forget()

    def forget(self, *_: Any) -> None:
        """Take over another scenario; what was found or asked for of the one before goes."""
        super().forget()
        with self.quiet():
            self._stop()
            results = ("run", "rivals", "machine_map", "ripple", "flux_sweep", "detuning", "failure")
            self.model.param.update(**dict.fromkeys(results))
            self._take(self.state.scenario.base)

    def _take_edits(self, *_: Any) -> None:
        """Take over a drive or a controller that was edited elsewhere."""
        scenario = self.state.scenario.edited
        # an edit of anything else leaves what was set on this page
        if self._taken != (scenario.vehicle.drive, scenario.simulation):
            with self.quiet():
                self._take(scenario)

    def _take(self, scenario: Scenario) -> None:
        self._taken = scenario.vehicle.drive, scenario.simulation
        self.model.take(scenario)

    def _request(self) -> LoopRequest:
        return LoopRequest(self.state.scenario.scenario(), self.state.chosen, self.model.changes)

    def _ask(self, *_: Any) -> None:
        if not self.in_sight or self._quiet:
            return
        self.model.no_machine = machine_refusal(self.state.scenario.scenario())
        request = self._request()
        if self.is_new(request):
            self._stop()
            # it was of the request before
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
        self._ask_flux()

    def _ask_ripple(self, *_: Any) -> None:
        if self.model.run is not None and not self._quiet:
            self.ripple.ask(RippleRequest(self.model.run, float(self.model.ripple_at_s)))

    def _ask_flux(self, *_: Any) -> None:
        if self.model.run is not None and not self._quiet:
            self.flux.ask(FluxRequest(self.model.run.scenario, float(self.model.cruise_speed_kmh)))

    def _study(self, *_: Any) -> None:
        if not self.model.no_machine:
            self.model.studying = True
            self.detuning.ask(self._request())

    def _stop(self, *_: Any) -> None:
        self.detuning.stop()
        self.model.studying = False

    def _take_rivals(self, rivals: LoopRivals) -> None:
        # another run may have come while these were computed
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

    def _take_flux(self, sweep: FluxSweep) -> None:
        if self.model.run is not None:
            self.model.flux_sweep = sweep

    def _take_no_flux(self, failure: RailjouleError) -> None:
        self.model.param.update(flux_sweep=None, failure=failure)

    def _take_detuning(self, table: StudyTable, last: bool) -> None:
        self.model.param.update(detuning=table, studying=not last)
