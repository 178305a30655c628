"""The work behind the page Speed limits: what is asked for when, and where its results go."""

from typing import Any

from railjoule.core import RailjouleError, Scenario
from railjoule.core.studies.motor_map import MotorMap, motor_map
from railjoule.dashboard.pages.speed_limits.compute import (
    InterStationRuns,
    LimitRun,
    LimitsRequest,
    LimitTrip,
    StorageCurve,
    StorageRequest,
    compute_inter_station_runs,
    compute_limit_run,
    compute_limit_trip,
    compute_storage,
)
from railjoule.dashboard.pages.speed_limits.model import STORAGE_FIELDS, SpeedLimitsModel
from railjoule.dashboard.state.page_work import Items, PageWork
from railjoule.dashboard.state.scenario import PLAN_FIELDS
from railjoule.dashboard.state.workbench import Workbench
from railjoule.dashboard.work.runs import is_slow

SEARCH = ("found", "regulator", "free_borders", "inter_station_runs", "time_window_percent", "stop_deceleration_ms2")


class SpeedLimits(PageWork[SpeedLimitsModel]):
    """Asks for the run under the limits of one page, and for what hangs on it, while it is in sight."""

    page = "Speed limits"

    def __init__(self, state: Workbench) -> None:
        super().__init__(state, state.speed_limits)
        self.run = self.worker(
            compute_limit_run,
            self._take_run,
            marked=True,
            is_slow=lambda request: (
                request.changes["search.regulator"] == "literal" or is_slow(request.scenario, "speed_limits")
            ),
        )
        self.trip = self.worker(compute_limit_trip, self._take_trip)
        # no failure of the page: the refusal stands in the table's place
        self.comparison = self.worker(compute_inter_station_runs, self._take_comparison, is_slow=lambda _: True)
        self.storage = self.worker(compute_storage, self._take_storage)
        # a drive without a map is no failure of the page: the sentence stands in the map's place
        self.motor = self.worker(motor_map, self._take_map, self._take_no_map)
        self._sections = Items(self._take_section)
        # before `_ask` listens to edits, too: what it asks for must be about the sections of the scenario that has come
        state.scenario.follow(_what_sections_depend_on, self._take_scenario)
        state.scenario.param.watch(self._ask, list(PLAN_FIELDS))
        state.param.watch(self._ask, "page")
        self.model.param.watch(self._watch_sections, "sections")
        self.model.param.watch(self._cut, "section_count")
        self.model.param.watch(self._ask, list(SEARCH))
        self.model.param.watch(self._ask_trip, "moved")
        self.model.param.watch(self._let_go, "moving")
        self.model.param.watch(self._ask_storage, list(STORAGE_FIELDS))
        self._take_scenario(state.scenario.edited)

    def _take_scenario(self, scenario: Scenario) -> None:
        with self.quiet():
            self.model.take(scenario)

    def _watch_sections(self, *_: Any) -> None:
        self._sections.follow(self.model.sections, lambda _: ("limit_kmh", "to_m"))
        self._ask()

    def _take_section(self, *_: Any) -> None:
        """Drive under a limit that was typed."""
        if not self._quiet and not self.model.moving:
            with self.quiet():
                self.model.found = False
            self._ask()

    def _cut(self, *_: Any) -> None:
        if not self._quiet and self.model.section_count != len(self.model.sections):
            with self.quiet():
                self.model.cut(self.model.section_count)
            self._ask()

    def _request(self) -> LimitsRequest:
        return LimitsRequest(self.state.scenario.scenario(), self.model.changes)

    def _ask(self, *_: Any) -> None:
        if not self.in_sight or self._quiet or self.model.moving:
            return
        request = self._request()
        if self.is_new(request):
            self.run.ask(request)

    def _ask_trip(self, *_: Any) -> None:
        self.trip.ask(self._request())

    def _let_go(self, *_: Any) -> None:
        self.model.trip = None
        self._ask()

    def _ask_storage(self, *_: Any) -> None:
        model = self.model
        if model.run is not None:
            efficiencies = model.charging_percent / 100, model.discharging_percent / 100
            self.storage.ask(StorageRequest(model.run, model.storage_size_kwh, model.storage_power_kw, *efficiencies))

    def _take_run(self, run: LimitRun) -> None:
        """Take a run; a search also sets the limits, unless others were asked for meanwhile."""
        searched = run.run.scenario.search.limits_kmh is None
        if searched and self.model.found:
            with self.quiet():
                self.model.show_found(run.limits_kmh.tolist(), run.borders_m.tolist())
            # where the search moves borders, those that it found are no new request
            self.is_new(self._request())
        self.model.param.update(run=run, failure=None, **({"path": run} if searched else {}))
        self._ask_storage()
        if searched and self.model.has_stations:
            self.comparison.ask(run)
        self._ask_map(run.run.scenario)

    def _ask_map(self, scenario: Scenario) -> None:
        # all that a map depends on: other limits leave it as it is
        vehicle = scenario.vehicle.drive, scenario.vehicle.traction, scenario.vehicle.braking
        if self.is_new(vehicle, "map"):
            self.motor.ask(scenario)

    def _take_trip(self, trip: LimitTrip | None) -> None:
        if self.model.moving and trip is not None:
            self.model.trip = trip

    def _take_comparison(self, comparison: InterStationRuns) -> None:
        if self.model.path is not None and self.model.path.run in comparison.runs.values():
            self.model.comparison = comparison

    def _take_storage(self, storage: StorageCurve) -> None:
        self.model.storage = storage

    def _take_map(self, found: MotorMap) -> None:
        self.model.param.update(motor_map=found, no_map="")

    def _take_no_map(self, refusal: RailjouleError) -> None:
        self.model.param.update(motor_map=None, no_map=str(refusal))


def _what_sections_depend_on(scenario: Scenario) -> object:
    """Return the search's settings, the line's own borders and stops, and the vehicle's largest speed."""
    lengths = [section.length_m for section in scenario.line.sections]
    return (
        scenario.search,
        lengths,
        scenario.line.stops_m,
        scenario.line.reverse,
        scenario.vehicle.traction.max_speed_kmh,
    )
