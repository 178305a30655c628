"""The work behind the page Line: what is asked for when, and where its results go."""

from typing import Any

from railjoule.core import RailjouleError
from railjoule.dashboard.models.line import StationModel
from railjoule.dashboard.models.scenario import PLAN_FIELDS
from railjoule.dashboard.models.workbench import Workbench
from railjoule.dashboard.store import LineRequest, LineRuns, Worker, compute_line, is_slow

PAGE = "Line"


class WholeLines:
    """Asks for the runs over the line of one page, while it is in sight."""

    def __init__(self, state: Workbench) -> None:
        self.state, self.model = state, state.line
        self.run = Worker(
            compute_line,
            self._take,
            self._take_failure,
            state.marks(PAGE),
            is_slow=lambda request: is_slow(request.scenario),
            about=state.scenario.identity,
        )
        self._watched: list[StationModel] = []
        self._quiet = False
        state.scenario.param.watch(self._take_scenario, ["preset", "opened", "edits"])
        state.scenario.param.watch(self._ask, list(PLAN_FIELDS))
        state.param.watch(self._ask, "page")
        self.model.param.watch(self._watch_stations, "stations")
        self.model.param.watch(self._ask, "stations")
        self._take_scenario()

    def _take_scenario(self, *_: Any) -> None:
        self._quiet = True
        self.model.take(self.state.scenario.edited)
        self._quiet = False

    def _watch_stations(self, *_: Any) -> None:
        for station in self.model.stations:
            if not any(station is known for known in self._watched):
                station.param.watch(self._take_dwell, "dwell_s")
                station.param.watch(self._fix, "fixed")
                station.param.watch(self._ask, "arrival_s")
        self._watched = list(self.model.stations)

    def _take_dwell(self, *_: Any) -> None:
        """Lay the dwells over the scenario, so that every page has them."""
        if self._quiet:
            return
        scenario = self.state.scenario
        try:
            scenario.edit(self.model.dwell_changes(scenario.edited))
        except RailjouleError as error:
            self._take_failure(error)

    def _fix(self, event: Any) -> None:
        """Fix an arrival at first where the optimum has it."""
        station, runs = event.obj, self.model.runs
        if event.new and runs is not None:
            self._quiet = True
            station.arrival_s = round(runs.best.legs[station.number].arrival_s, 1)
            self._quiet = False
        self._ask()

    def _ask(self, *_: Any) -> None:
        if self.state.page != PAGE or self._quiet:
            return
        scenario = self.state.scenario.scenario()
        if not scenario.line.in_running_order().inner_stations:
            self.model.param.update(runs=None, failure=None)
            return
        self.run.ask(LineRequest(scenario, self.model.arrivals_s))

    def _take(self, runs: LineRuns) -> None:
        self.model.param.update(runs=runs, failure=None)

    def _take_failure(self, failure: RailjouleError) -> None:
        self.model.failure = failure
