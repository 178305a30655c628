"""The work behind the page Line: what is asked for when, and where its results go."""

from typing import Any

from railjoule.core import RailjouleError
from railjoule.dashboard.pages.line.compute import LineRequest, LineRuns, compute_line
from railjoule.dashboard.pages.line.model import LineModel
from railjoule.dashboard.state.page_work import Items, PageWork
from railjoule.dashboard.state.scenario import PLAN_FIELDS
from railjoule.dashboard.state.workbench import Workbench
from railjoule.dashboard.work.runs import is_slow


class WholeLines(PageWork[LineModel]):
    """Asks for the runs over the line of one page, while it is in sight."""

    page = "Line"

    def __init__(self, state: Workbench) -> None:
        super().__init__(state, state.line)
        self.run = self.worker(compute_line, self._take, marked=True, is_slow=lambda request: is_slow(request.scenario))
        self._stations = Items(self._take_change)
        state.scenario.param.watch(self._take_scenario, ["preset", "opened", "edits"])
        state.scenario.param.watch(self._ask, list(PLAN_FIELDS))
        state.param.watch(self._ask, "page")
        self.model.param.watch(self._watch_stations, "stations")
        self._take_scenario()

    def _take_scenario(self, *_: Any) -> None:
        with self.quiet():
            self.model.take(self.state.scenario.edited)

    def _watch_stations(self, *_: Any) -> None:
        self._stations.follow(self.model.stations, lambda _: ("dwell_s", "fixed", "arrival_s"))
        self._ask()

    def _take_change(self, *events: Any) -> None:
        changes = {"dwell_s": self._take_dwell, "fixed": self._fix, "arrival_s": self._ask}
        for event in events:
            changes[event.name](event)

    def _take_dwell(self, *_: Any) -> None:
        """Lay the dwells over the scenario, so that every page has them."""
        if self._quiet:
            return
        scenario = self.state.scenario
        try:
            scenario.edit(self.model.dwell_changes(scenario.edited))
        except RailjouleError as error:
            self.take_failure(error)

    def _fix(self, event: Any) -> None:
        """Fix an arrival at first where the optimum has it."""
        station, runs = event.obj, self.model.runs
        if event.new and runs is not None:
            with self.quiet():
                # quietly, as it is asked for once, below
                station.arrival_s = round(runs.best.legs[station.number].arrival_s, 1)
        self._ask()

    def _ask(self, *_: Any) -> None:
        if not self.in_sight or self._quiet:
            return
        scenario = self.state.scenario.scenario()
        if not scenario.line.in_running_order().inner_stations:
            self.model.param.update(runs=None, failure=None)
            return
        self.run.ask(LineRequest(scenario, self.model.arrivals_s))

    def _take(self, runs: LineRuns) -> None:
        self.model.param.update(runs=runs, failure=None)
