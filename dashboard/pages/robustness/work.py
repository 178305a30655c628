"""The work behind the page Robustness: what is asked for when, and where its results go."""

from collections.abc import Mapping
from typing import Any

from railjoule.core import Scenario
from railjoule.core.studies.braking_sensors import BrakingSensors
from railjoule.core.studies.table import StudyTable
from railjoule.dashboard.day import CHANCE, FOLLOWING, LOAD_AND_POSITION
from railjoule.dashboard.pages.robustness.compute import (
    Reality,
    RealityRequest,
    RobustAnswer,
    RobustRequest,
    TableRequest,
    compute_chance,
    compute_reality,
    compute_robust,
    compute_stops,
    compute_table,
)
from railjoule.dashboard.pages.robustness.model import (
    FULL_RUNS,
    PREVIEW_RUNS,
    ROBUST_FIELDS,
    ROBUST_RUNS,
    TABLE_FIELDS,
    RobustnessModel,
)
from railjoule.dashboard.state.page_work import PageWork
from railjoule.dashboard.state.programs import page_run
from railjoule.dashboard.state.scenario import RUN_FIELDS
from railjoule.dashboard.state.workbench import Workbench
from railjoule.dashboard.work.runs import is_slow

PAGE = "Robustness"
NOTHING_WRONG = {"disturbance.actual_load_factor": 0.0, "disturbance.coordinate_error_m": 0.0}


class Robustness(PageWork[RobustnessModel]):
    """Asks for the run, the table and the draws of one page, while it is in sight."""

    page = PAGE
    at_rest = {"drawing": False, "searching": False}  # noqa: RUF012

    def __init__(self, state: Workbench) -> None:
        super().__init__(state, state.robustness)
        self.run = self.worker(
            compute_reality,
            self._take_run,
            marked=True,
            is_slow=lambda request: is_slow(request.scenario, request.scenario.strategy),
        )
        self.table = self.study(compute_table, self._take_table, marked=True)
        self.chance = self.study(compute_chance, self._take_chance, marked=True)
        self.stops = self.study(compute_stops, self._take_stops)
        # not marked: the page stays as it is while a search goes on
        self.robust = self.study(compute_robust, self._take_robust)
        self._all = False
        self._sought: RobustRequest | None = None
        self._waiting: dict[str, Any] = {}
        state.scenario.follow(lambda scenario: scenario.disturbance, self.model.take)
        self.model.take(state.scenario.edited)
        state.scenario.param.watch(self._ask, list(RUN_FIELDS))
        state.param.watch(self._ask, ["page", "chosen"])
        state.day.param.watch(self._ask, [*LOAD_AND_POSITION, *FOLLOWING, *CHANCE])
        self.model.param.watch(self._ask, [*ROBUST_FIELDS, *TABLE_FIELDS])
        self.model.param.watch(self._draw_all, "draw_all")
        self.model.param.watch(self._stop, "stop_drawing")
        self.model.param.watch(self._find_robust, "find_robust")
        self.model.param.watch(self._stop_search, "stop_search")

    def forget(self, *_: Any) -> None:
        """Forget what was asked for and end it, as the scenario has gone."""
        super().forget()
        self.table.stop()
        self.stops.stop()
        self._stop()
        self._drop_robust()
        self._waiting.clear()

    def _with_strategy(self, changes: Mapping[str, Any]) -> Mapping[str, Any]:
        return {"strategy": self.state.chosen, **changes}

    def _draws(self, scenario: Scenario, runs: int) -> RealityRequest:
        """Return the request for what chance draws."""
        return RealityRequest(scenario, self._with_strategy({**self.state.day.chance_changes(runs), **NOTHING_WRONG}))

    def _ask(self, *_: Any) -> None:
        """Ask for what the last change concerns, and only while the page is in sight.

        The run comes first, then table, chance and stopping errors: each waits until the one before is done.
        """
        if not self.in_sight:
            self._rest()
            return
        scenario, changes = self.state.scenario.scenario(), page_run(self.state).changes
        run = RealityRequest(scenario, changes)
        # a table and what chance draws have loads and errors of their own
        plan = RealityRequest(scenario, {**changes, **NOTHING_WRONG})
        table = TableRequest(plan, self.model.both_directions, self.model.knows)
        draws = self._draws(scenario, PREVIEW_RUNS)
        if self._sought is not None and self._sought != self._robust_request():
            self._drop_robust()
        if self.is_new(table, "table"):
            self.table.stop()
            self._waiting["table"] = table
        if self.is_new(draws, "chance"):
            self.chance.stop()
            self._waiting["chance"] = draws
        planned_load = {**NOTHING_WRONG, "disturbance.actual_load_factor": self.state.scenario.load_percent / 100}
        stops = RealityRequest(scenario, {**draws.changes, **planned_load})
        if self.is_new(stops, "stops"):
            self.stops.stop()
            self._waiting["stops"] = stops
        if self.is_new(run):
            self.run.ask(run)
        else:
            self._go_on()

    def _rest(self) -> None:
        """Leave studies that nobody sees, as they take turns from the page in sight; they begin anew with it.

        All runs that were asked for by hand go on.
        """
        for kind in self._waiting:
            # not begun: it must count as new when the page is in sight again
            self._asked.pop(kind, None)
        self._waiting.clear()
        if self.table.busy:
            self.table.stop()
            self._asked.pop("table", None)
        if self.chance.busy and not self._all:
            self._stop()
            self._asked.pop("chance", None)
        if self.stops.busy:
            self.stops.stop()
            self._asked.pop("stops", None)

    def _go_on(self) -> None:
        """Begin with the next study that waits."""
        if "table" in self._waiting:
            self.table.ask(self._waiting.pop("table"))
        elif "chance" in self._waiting and not self.table.busy:
            self._draw(self._waiting.pop("chance"))
        elif "stops" in self._waiting and not (self.table.busy or self.chance.busy):
            self.stops.ask(self._waiting.pop("stops"))

    def _draw(self, request: RealityRequest, all_runs: bool = False) -> None:
        self._all = all_runs
        self.model.drawing = True
        self.chance.ask(request)

    def _draw_all(self, *_: Any) -> None:
        self._waiting.pop("chance", None)
        self._draw(self._draws(self.state.scenario.scenario(), FULL_RUNS), all_runs=True)

    def _stop(self, *_: Any) -> None:
        self.chance.stop()
        self.model.drawing = False

    def _robust_request(self) -> RobustRequest:
        model = self.model
        accepted = {"disturbance.accepted_delay_s": float(model.accepted_delay_s)}
        draws = self.state.day.chance_changes(ROBUST_RUNS)
        changes = self._with_strategy({**draws, **accepted, **NOTHING_WRONG})
        reality = RealityRequest(self.state.scenario.scenario(), changes)
        return RobustRequest(reality, model.probability_percent / 100, model.candidates)

    def _find_robust(self, *_: Any) -> None:
        self._sought = self._robust_request()
        self.model.param.update(robust=None, searching=True)
        self.robust.ask(self._sought)

    def _stop_search(self, *_: Any) -> None:
        self.robust.stop()
        self.model.searching = False

    def _drop_robust(self) -> None:
        """Drop a robust plan of settings that have changed."""
        self._sought = None
        self._stop_search()
        self.model.robust = None

    def _take_robust(self, robust: RobustAnswer, last: bool) -> None:
        self.model.param.update(robust=robust, searching=not last)

    def _take_run(self, reality: Reality) -> None:
        self.model.param.update(reality=reality, failure=None)
        self._go_on()

    def _take_table(self, table: StudyTable, last: bool) -> None:
        self.model.table = table
        if last:
            self._go_on()

    def _take_chance(self, chance: StudyTable, last: bool) -> None:
        self.model.param.update(chance=chance, drawing=not last)
        if last:
            self._go_on()

    def _take_stops(self, stops: BrakingSensors, _: bool) -> None:
        self.model.stops = stops
