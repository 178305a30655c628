"""The work behind the page Line: what is asked for when, and where its results go."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from railjoule.core import RailjouleError
from railjoule.core.studies.whole_line import WholeLine
from railjoule.dashboard.pages.line.compute import GivenRequest, LineRequest, LineRuns, compute_given, compute_line
from railjoule.dashboard.pages.line.model import LineModel, StationModel, station_rows
from railjoule.dashboard.state.page_work import Items, PageWork
from railjoule.dashboard.state.scenario import PLAN_FIELDS
from railjoule.dashboard.state.workbench import Workbench
from railjoule.dashboard.work.runs import is_slow

TIMES = ("dwell_s", "arrival", "arrival_s", "earliest_s", "latest_s", "given_s")


class WholeLines(PageWork[LineModel]):
    """Asks for the runs over the line of one page, while it is in sight."""

    page = "Line"

    def __init__(self, state: Workbench) -> None:
        super().__init__(state, state.line)
        self.run = self.worker(compute_line, self._take, marked=True, is_slow=lambda request: is_slow(request.scenario))
        self.given = self.worker(compute_given, self._take_given, self._take_no_given)
        self._stations = Items(self._take_change)
        self._own_edit = False
        state.scenario.param.watch(self._forget_drag, ["preset", "opened"])
        state.scenario.param.watch(self._take_scenario, ["preset", "opened", "edits"])
        state.scenario.param.watch(self._ask, list(PLAN_FIELDS))
        state.param.watch(self._ask, "page")
        self.model.param.watch(self._watch_stations, "inner_stations")
        self.model.param.watch(self._ask_given, "moved")
        self.model.param.watch(self._let_go, "moving")
        self._take_scenario()

    def _forget_drag(self, *_: Any) -> None:
        """Forget what is dragged: the station was one of another scenario."""
        self.model.param.update(moving=False, moved=None)

    def _take_scenario(self, *_: Any) -> None:
        with self.quiet():
            self.model.take(self.state.scenario.edited, self._own_edit)

    def _watch_stations(self, *_: Any) -> None:
        self._stations.follow(self.model.inner_stations, lambda _: TIMES)
        self._ask()

    def _take_change(self, *events: Any) -> None:
        """Lay what was set at a station over the scenario, so that every page has it."""
        if self._quiet:
            return
        station: StationModel = events[-1].obj
        names = {event.name for event in events}
        if "arrival" in names and self.model.runs is not None:
            with self.quiet():
                station.begin_kind(self.model.runs.best.legs[station.number].arrival_s)
        self._edit({station.number: station.row})

    def _edit(self, times: Mapping[int, Mapping[str, Any]]) -> None:
        """Lay times over the scenario, or tell the page why they cannot be."""
        self._own_edit = True
        try:
            self.model.edit(times)
        except RailjouleError as error:
            self.take_failure(error)
            self._take_scenario()
        finally:
            self._own_edit = False

    def _ask_given(self, *_: Any) -> None:
        """Ask for the given timetable as it is while a station is dragged; the rest stands."""
        if self.model.moved is None or self.model.runs is None:
            return
        number, arrival_s = self.model.moved
        scenario = self.state.scenario.scenario()
        rows = station_rows(scenario.line, {number: {"arrival_s": arrival_s}})
        self.given.ask(GivenRequest(scenario, tuple(rows)))

    def _let_go(self, *_: Any) -> None:
        """Lay the arrival of the station that was dragged over the scenario: one step to undo."""
        if self.model.moving or self.model.moved is None:
            return
        number, arrival_s = self.model.moved
        self.model.moved = None
        self._edit({number: {"arrival_s": arrival_s}})

    def _ask(self, *_: Any) -> None:
        if not self.in_sight or self._quiet:
            return
        scenario = self.state.scenario.scenario()
        if not scenario.line.in_running_order().inner_stations:
            self.model.param.update(runs=None, failure=None)
            return
        self.run.ask(LineRequest(scenario))

    def _take(self, runs: LineRuns) -> None:
        before = self.model.runs
        # a timetable that has just been given is what one wants to see
        new = before is not None and "given" in runs.runs and "given" not in before.runs
        self.model.param.update(runs=runs, failure=None, **({"other": "given"} if new else {}))

    def _take_given(self, line: WholeLine) -> None:
        # what comes once the station is let go is older than what is asked for then
        if self.model.moving and self.model.runs is not None:
            self.model.param.update(runs=self.model.runs.with_given(line), other="given")

    def _take_no_given(self, error: RailjouleError) -> None:
        if self.model.moving and self.model.runs is not None:
            self.model.runs = replace(self.model.runs, refusal=str(error))
