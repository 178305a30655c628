"""Set speeds: one for each section and their cost beside the optimum; in a second tab losses and storage."""

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any, get_args

import numpy as np
import panel as pn
import param
from panel.viewable import Viewable

from railjoule.core import Scenario, Trajectory
from railjoule.core.scenario.options import LITERAL_KEYS, SearchOptions
from railjoule.core.strategies.speed_limits import MAX_SECTIONS
from railjoule.core.studies.motor_map import MotorMap
from railjoule.dashboard.charts.scene import RunScene
from railjoule.dashboard.look.theme import padded
from railjoule.dashboard.look.tokens import NARROW_PX
from railjoule.dashboard.page import BODY_CSS, Own, Page, Request, Section, shows, study, work
from railjoule.dashboard.pages.set_speeds import texts
from railjoule.dashboard.pages.set_speeds.charts import MAP, OTHERS, SAVED, SPEED, TRACK, both
from railjoule.dashboard.pages.set_speeds.compute import (
    InterStationRuns,
    LimitRun,
    LimitTrip,
    MapRequest,
    StorageCurve,
    compute_counts,
    compute_inter_station_runs,
    compute_limit_run,
    compute_limit_trip,
    compute_map,
    compute_storage,
)
from railjoule.dashboard.pages.set_speeds.sections import (
    FIRST_SECTIONS,
    LONGEST_M,
    SectionModel,
    borders_on_drive,
    even_borders,
    list_sections,
    make_sections,
    sections_in_file,
)
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.parts.choices import box, button, buttons
from railjoule.dashboard.parts.number_field import number_fields
from railjoule.dashboard.parts.tabs import PageTabs
from railjoule.dashboard.state.kept import Items, result
from railjoule.dashboard.state.numbers import TypedInteger, TypedNumber, core_bounds, keyed
from railjoule.dashboard.state.recipes import SOLVE, PageRun
from railjoule.dashboard.work.runs import is_slow

REGULATORS = get_args(SearchOptions.model_fields["regulator"].annotation)
INTER_STATION_RUNS = get_args(SearchOptions.model_fields["inter_station_runs"].annotation)
SEARCH = ("regulator", "free_borders", "inter_station_runs", "time_window_percent", "stop_deceleration_ms2")
SPEEDS, LOSSES = "speeds", "losses"
TABS: Mapping[str, str] = {SPEEDS: "Set speeds", LOSSES: "Losses and storage"}
"""The tabs by their names in the address."""
COUNTS = (1, 2, 3, 4, 6, 8)
"""Numbers of sections that are compared on a line without stations."""
REST_MS = 800
"""They are compared once nothing has changed for this time."""
STORAGE = ("storage_size_kwh", "storage_power_kw", "charging_percent", "discharging_percent")
Settings = tuple[Scenario, Mapping[str, Any]]
"""A scenario, with sections and search by the keys of its file."""
LOWER_CSS = """
:host { display: grid; grid-template-columns: minmax(0, 1fr) minmax(0, 1fr); column-gap: 28px;
  padding: 14px 20px 12px 14px; align-items: start; }
@media (max-width: 1099px) { :host { grid-template-columns: minmax(0, 1fr); padding: 8px 10px 12px 6px; } }
"""
GAP_CSS = ":host { row-gap: 10px; }"
NOTES_CSS = padded("0 20px 16px", "0 12px 16px")


class SetSpeeds(Page):
    """Set speeds of sections, given or found by search."""

    page = "Set speeds"
    kept = ("tab", "section_count", "sections", "found", *SEARCH, *STORAGE, "shown_map")
    passing = ("moving",)
    fields = (
        Section("Sections", "set speed and end of each"),
        Own(list_sections),
        Section("Search"),
        "section_count",
        "time_window_percent",
        "stop_deceleration_ms2",
    )
    figures = (SPEED, TRACK, *OTHERS, MAP, SAVED)

    tab = param.Selector(default=SPEEDS, objects=list(TABS), doc="The tab in sight.")
    sections = param.List(default=[], item_type=SectionModel, doc="From the start to the end of the line.")
    found = param.Boolean(default=True, doc="Whether the search finds the set speeds, instead of given ones.")
    regulator = param.Selector(default="coast", objects=list(REGULATORS), doc="The regulator above a set speed.")
    free_borders = param.Boolean(default=False, doc="Whether the search can move the section ends.")
    inter_station_runs = param.Selector(
        default="together",
        objects=list(INTER_STATION_RUNS),
        doc="Whether each inter-station run is searched by itself.",
    )
    section_count = TypedInteger("Sections", default=FIRST_SECTIONS, bounds=(1, MAX_SECTIONS))
    time_window_percent = TypedNumber(
        "Time window, \u00b1 %", "%", 1, default=1.0, **core_bounds(SearchOptions, "time_window", 100)
    )
    stop_deceleration_ms2 = keyed(SearchOptions, "stop_deceleration_ms2", "Braking rate", "m/s\u00b2", 2)
    storage_size_kwh = TypedNumber(
        "Storage, kWh", "kWh", 2, default=None, allow_None=True, bounds=(0.0, 1e4), softbounds=(0, 5), step=0.01
    )
    storage_power_kw = TypedNumber(
        "Power, kW", "kW", default=None, allow_None=True, bounds=(0.0, 1e5), softbounds=(0, 5000), step=10
    )
    charging_percent = TypedNumber("Charging efficiency, %", "%", 1, default=95.0, bounds=(1.0, 100.0))
    discharging_percent = TypedNumber("Discharging efficiency, %", "%", 1, default=95.0, bounds=(1.0, 100.0))
    shown_map = param.Selector(default="drive", objects=["drive", "motor"], doc="Which efficiency is shown.")

    run = result(LimitRun, "The last good run.")
    path = result(LimitRun, "The last run with set speeds found by search.")
    trip = result(LimitTrip, "The trip while a step moves.")
    comparison = result(InterStationRuns, "The run found by search beside that of the other way to search.")
    counts = result(tuple, "A request, and the runs found by search by the number of equal sections.")
    storage = result(StorageCurve, "Energy saved by storages.")
    motor_map = result((MotorMap, str), "Efficiency of the powertrain, or why there is none.")
    moving = param.Boolean(default=False, doc="Whether a step is being moved.")
    moved = param.Event(doc="A step has been moved a little further.")
    typed = param.Event(doc="A set speed or an end has been typed.")

    # the bounds of core/scenario, until `take` receives line and vehicle
    _stops_m: tuple[float, ...] = (0.0, LONGEST_M)
    _max_kmh = 600.0

    def __init__(self, *args: Any, **params: Any) -> None:
        self._items, self._settling = Items(self._take_section), False
        self._asked: Settings | None = None
        # the request that its own result would lead to, and the one that led to the result
        self._settled: tuple[Settings | None, Settings | None] = (None, None)
        super().__init__(*args, **params)

    # ---- the sections

    def part(self, scenario: Scenario) -> object:
        """Return the search's settings, the line's borders and stops, and the maximum speed of the vehicle."""
        line = scenario.line
        lengths = [section.length_m for section in line.sections]
        return scenario.search, lengths, line.stops_m, line.reverse, scenario.vehicle.traction.max_speed_kmh

    def take(self, scenario: Scenario) -> None:
        """Give the fields the sections and the search of a scenario."""
        options, stops = scenario.search, scenario.line.in_running_order().stops_m
        most = scenario.vehicle.traction.max_speed_kmh
        limits, borders, counts = sections_in_file(scenario)
        # before the sections below, which are made with both
        self._stops_m, self._max_kmh = stops, most
        self.param.section_count.bounds = counts
        self.param.update(
            sections=self._make_sections(limits or [most] * (len(borders) + 1), borders),
            section_count=len(borders) + 1,
            found=limits is None,
            regulator=options.regulator,
            free_borders=options.free_boundaries,
            inter_station_runs=options.inter_station_runs,
            time_window_percent=100 * options.time_window,
            stop_deceleration_ms2=options.stop_deceleration_ms2,
            storage_size_kwh=None,
            storage_power_kw=None,
        )

    def _make_sections(self, limits_kmh: Sequence[float], borders_m: Sequence[float]) -> list[SectionModel]:
        return make_sections(limits_kmh, [*borders_m, self._stops_m[-1]], self._max_kmh)

    def keep(self) -> dict[str, Any]:
        """Return the kept values by field; without limits and borders that the search finds again."""
        values = super().keep()
        if self.found:
            borders = [{"to_m": section["to_m"]} for section in values["sections"]]
            values["sections"] = [] if self.free_borders else borders
        if values["sections"]:
            values["sections"][-1].pop("to_m")  # that is where the line ends
        return values

    def lay(self, values: Mapping[str, Any]) -> None:
        """Take over checked values by field; sections that are not named are cut again.

        Raises
        ------
        ValueError
            If there are too few or too many sections; then nothing changes.
        """
        before = self.keep()
        named, count = values.get("sections") or [], values.get("section_count", self.section_count)
        new = {field: value for field, value in values.items() if field not in before or value != before[field]}
        new.pop("section_count", None)
        if new.pop("sections", []):
            low, high = self.param.section_count.bounds
            if not low <= len(named) <= high:
                raise ValueError(f"sections must be {low} to {high}, not {len(named)}")
            limits = [section.get("limit_kmh", self._max_kmh) for section in named]
            borders = [section.get("to_m", self._stops_m[-1]) for section in named[:-1]]
            new.update(sections=self._make_sections(limits, borders), section_count=len(named))
        elif not named and count != self.section_count:
            self.cut(count)
            new["section_count"] = count
        self.param.update(**new)

    def use_line_sections(self, *_: Any) -> None:
        """Cut the line as the strategy does on the other pages, and let the search find the set speeds."""
        borders = borders_on_drive(self.desk.scenario.scenario())
        count = len(borders) + 1
        made = self._make_sections([self._max_kmh] * count, borders)
        self.param.update(sections=made, section_count=count, found=True)

    def cut(self, count: int) -> None:
        """Cut the line into sections that are equal between two stops, whose set speeds the search shall find."""
        borders = even_borders(self._stops_m, count)
        self.param.update(sections=self._make_sections([self._max_kmh] * count, borders), found=True)

    @param.depends("section_count", watch=True)
    def _cut(self) -> None:
        if self.section_count != len(self.sections):
            self.cut(self.section_count)

    @param.depends("sections", watch=True)
    def _follow_sections(self) -> None:
        self._items.follow(self.sections, lambda _: ("limit_kmh", "to_m"))

    def _take_section(self, *_: Any) -> None:
        """Drive with a set speed that was typed."""
        if not self._settling and not self.moving:
            self.found = False
            self.param.trigger("typed")

    def move(self, limits_kmh: Sequence[float], borders_m: Sequence[float]) -> None:
        """Set limits [km/h] and borders [m] while a step is being moved."""
        # before the sections change, which would each request a whole run
        self.moving = True
        self.set(limits_kmh, borders_m)
        self.found = False
        self.param.trigger("moved")

    def release(self) -> None:
        """Release the step that is being moved."""
        self.moving = False

    def set(self, limits_kmh: Sequence[float], borders_m: Sequence[float]) -> None:
        """Set all limits [km/h] and borders [m] of the sections that there are."""
        for section, limit in zip(self.sections, limits_kmh, strict=True):
            section.limit_kmh = float(limit)
        # not strict: the last section ends with the line
        for section, border in zip(self.sections, borders_m, strict=False):
            section.to_m = float(border)

    @contextmanager
    def _settle(self) -> Iterator[None]:
        """Change sections without a request for a run with them."""
        self._settling = True
        try:
            yield
        finally:
            self._settling = False

    @param.depends("run", watch=True)
    def _take_run(self) -> None:
        """Take over the sections that a search found, unless others were requested in the meantime."""
        run: LimitRun | None = self.run
        if run is None or run.run.scenario.search.limits_kmh is not None:
            # with another scenario, its path goes too
            self.path = run and self.path
            return
        limits, borders = run.limits_kmh.tolist(), run.borders_m.tolist()
        if self.found:
            with self._settle():
                if len(limits) != len(self.sections):
                    self.param.update(sections=self._make_sections(limits, borders), section_count=len(limits))
                self.set(limits, borders)
            # where the search moves borders, those that it found are no new request
            self._settled = self._request(), self._asked
        self.path = run

    @property
    def has_stations(self) -> bool:
        """Whether the line has stations between its ends."""
        return len(self._stops_m) > 2

    @property
    def limits_kmh(self) -> tuple[float, ...]:
        """The set speeds of the sections [km/h]."""
        return tuple(float(section.limit_kmh) for section in self.sections)

    @property
    def borders_m(self) -> tuple[float, ...]:
        """The borders between the sections [m]."""
        return tuple(float(section.to_m) for section in self.sections[:-1])

    @property
    def changes(self) -> Mapping[str, Any]:
        """Sections and search by the keys of the file; limits are given unless the search finds them."""
        # a file of the literal regulator names keys that the others do not have
        of_literal = {} if self.regulator == "literal" else {f"search.{key}": None for key in LITERAL_KEYS}
        return {
            **of_literal,
            "strategy": "speed_limits",
            "search.regulator": self.regulator,
            "search.boundaries_m": list(self.borders_m),
            "search.free_boundaries": self.free_borders if self.found else None,
            "search.inter_station_runs": self.inter_station_runs if self.found and self.has_stations else None,
            "search.limits_kmh": None if self.found else list(self.limits_kmh),
            "search.time_window": self.time_window_percent / 100,
            "search.stop_deceleration_ms2": float(self.stop_deceleration_ms2),
        }

    def page_run(self) -> PageRun:
        """Return the run with these set speeds as a program."""
        return PageRun(SOLVE, self.changes)

    # ---- what it computes

    def _request(self) -> Settings:
        return self.desk.scenario.scenario(), self.changes

    @work(
        *("scenario", "sections", "typed", "found", *SEARCH, "moving"),
        into="run",
        marked=True,
        is_slow=lambda scenario, changes: changes["search.regulator"] == "literal" or is_slow(scenario, "speed_limits"),
        only_last=False,
    )
    def _run(self) -> Request:
        if not self.moving and not self._settling:
            request, (after, before) = self._request(), self._settled
            self._asked = before if request == after else request
        return None if self._asked is None else (compute_limit_run, *self._asked)

    @work("moved", "moving", into="trip", only_last=False)
    def _trip(self) -> Request:
        return (compute_limit_trip, *self._request()) if self.moving else None

    @work("path", into="comparison", is_slow=lambda *_: True, clears=True)
    def _comparison(self) -> Request:
        return (compute_inter_station_runs, self.path) if self.path is not None and self.has_stations else None

    @study("scenario", *SEARCH, into="counts", rest_ms=REST_MS, tab=SPEEDS)
    def _counts(self) -> Request:
        low, high = self.param.section_count.bounds
        if self.has_stations:
            return None
        borders = [even_borders(self._stops_m, count) for count in COUNTS if low <= count <= high]
        changes = {**self.changes, "search.limits_kmh": None, "search.free_boundaries": self.free_borders}
        return compute_counts, self.desk.scenario.scenario(), {**changes, "search.boundaries_m": None}, borders

    @work("run", *STORAGE, into="storage", tab=LOSSES)
    def _storage(self) -> Request:
        if self.run is None:
            return None
        efficiencies = self.charging_percent / 100, self.discharging_percent / 100
        return compute_storage, self.run, self.storage_size_kwh, self.storage_power_kw, *efficiencies

    @work("run", into="motor_map", tab=LOSSES)
    def _map(self) -> Request:
        if self.run is None:
            return None
        vehicle = self.run.run.scenario.vehicle
        return compute_map, MapRequest(self.run.run.scenario, vehicle.drive, vehicle.traction, vehicle.braking)

    # ---- what it shows

    def is_over_time(self, axis: str) -> bool:
        """Return that the figures are over positions."""
        return False

    def layout(self) -> Viewable:
        """Make the parts of the page, and return them laid out."""
        self.finding, self.notes, self.runs, self.by_count = (parts.html_pane() for _ in range(4))
        self.tabs = PageTabs(self, TABS, {SPEEDS: self._layout_speeds, LOSSES: self._layout_losses})
        return parts.stack(self.finding, self.host.figures, self.tabs.view, parts.stack(self.notes, css=NOTES_CSS))

    def _layout_speeds(self) -> Viewable:
        speed = self.host.plots[SPEED.name]
        speed.move, speed.release = self.move, self.release
        self.together = buttons(self, "inter_station_runs", texts.RUNS_WORDS, margin=(8, 4, 0, 16))
        self.search = button(
            "Search set speeds", lambda _: setattr(self, "found", True), margin=(8, 20, 0, 8), height=28
        )
        self.as_on_drive = button("", self.use_line_sections, margin=(8, 20, 0, 20), height=28)
        tools = pn.FlexBox(
            parts.html_pane("Above the set speed", margin=(12, 8, 0, 20), sizing_mode="fixed"),
            buttons(self, "regulator", texts.REGULATOR_WORDS, margin=(8, 4, 0, 0)),
            self.together,
            box(self, "free_borders", "Section ends may move", margin=(8, 8, 0, 16)),
            self.search,
            self.as_on_drive,
            align_items="center",
            margin=0,
            sizing_mode="stretch_width",
        )
        body = parts.stack(*(self.host.plots[plot.name].host for plot in (SPEED, TRACK, *OTHERS)), css=BODY_CSS)
        return parts.stack(tools, body, parts.stack(self.by_count, self.runs, css=NOTES_CSS))

    def _layout_losses(self) -> Viewable:
        self.storage_text, self.no_map, self.losses = (parts.html_pane() for _ in range(3))
        maps, hosts = {"Powertrain": "drive", "Motor": "motor"}, self.host.plots
        self.whose = buttons(self, "shown_map", maps, margin=(6, 0, 0, 46), visible=False)
        self.storage_fields = number_fields(self, *STORAGE)
        storage = parts.stack(self.storage_text, hosts[SAVED.name].host, *self.storage_fields, css=GAP_CSS)
        losses = parts.stack(self.no_map, hosts[MAP.name].host, self.whose, self.losses, css=GAP_CSS)
        return parts.stack(losses, storage, css=LOWER_CSS)

    @property
    def window_s(self) -> tuple[float, float]:
        """The earliest and the latest arrival that the search may use [s]."""
        planned, share = self.desk.scenario.travel_time_s, self.time_window_percent / 100
        return planned * (1 - share), planned * (1 + share)

    @shows("run", "failure")
    def _show_numbers(self) -> None:
        run, host = self.run, self.host
        host.tell(self.failure, "Shown: the last run that could be computed." if run is not None else "")
        if run is None:
            return
        host.heading.object = texts.heading(run)
        host.figures.object = parts.figures(texts.run_cells(run, self.window_s), self.failure is not None)
        self.notes.object = texts.notes(run)

    @property
    def shown_counts(self) -> Mapping[int, Trajectory]:
        """The runs by the number of sections, where they are those of the present settings."""
        request = self._counts() if self.counts else None
        return self.counts[1] if request and self.counts[0] == request[1:] else {}

    @shows("run", "counts")
    def _show_finding(self) -> None:
        if self.run is not None:
            self.finding.object = texts.finding(self.run, self.shown_counts)

    @shows("run", "counts", tab=SPEEDS)
    def _show_counts(self) -> None:
        counts = self.shown_counts
        self.by_count.object = texts.counts_table(counts, len(self.sections)) if counts else ""

    @shows("run", tab=SPEEDS)
    def _show_run(self) -> None:
        run, host = self.run, self.host
        if run is None:
            return
        host.axis.fit(run.run.distance_m, roomy=False)
        count, most = len(borders_on_drive(self.desk.scenario.scenario())) + 1, self.param.section_count.bounds[1]
        self.as_on_drive.param.update(
            visible=count <= most and count != len(run.limits_kmh),
            label=f"Use {count} sections, as on the other pages",
        )
        # under a drag the figure has the speeds of the trip, and the browser its steps
        if not self.moving:
            host.draw([SPEED], run, self.limits_kmh, self.borders_m)
        host.draw(OTHERS, both(run))
        width = host.browser.window_width
        narrow = width < NARROW_PX
        scene = RunScene(
            "speed_limits", {"speed_limits": run.run}, None, False, narrow, width - (80 if narrow else 360)
        )
        host.draw([TRACK], scene)

    @shows("found", tab=SPEEDS)
    def _show_found(self) -> None:
        self.search.disabled = self.found

    @shows("trip", tab=SPEEDS)
    def _show_trip(self) -> None:
        """Show the trip of a step that is being moved: its speeds, time and energy; the rest waits."""
        if self.trip is None:
            return
        chart = self.host.plots[SPEED.name]
        chart.show(lambda: chart.draw_trip(self.trip) if self.trip is not None else None)
        before = texts.run_cells(self.run, self.window_s) if self.run is not None else ()
        # were this row lower than the one before, the figure would move away under the mouse that drags its step
        self.host.figures.object = parts.figures_in_place(texts.trip_cells(self.trip, self.window_s), before)

    @shows("comparison", "path", tab=SPEEDS)
    def _show_comparison(self) -> None:
        self.together.visible = self.has_stations
        shown, path = self.comparison, self.path
        # a table of another run would stand beside this one's figures
        is_current = shown is not None and path is not None and path.run in shown.runs.values()
        self.runs.object = texts.inter_station_table(shown) if is_current else ""

    @shows("motor_map", "run", "shown_map", tab=LOSSES)
    def _show_map(self) -> None:
        found, run = self.motor_map, self.run
        refusal = found if isinstance(found, str) else ""
        self.host.plots[MAP.name].host.visible = not refusal
        self.no_map.object = parts.note_paragraphs([refusal] if refusal else [], "padding-left:6px")
        self.losses.object = "" if refusal or run is None else texts.losses_table(run.run)
        self.whose.visible = isinstance(found, MotorMap) and found.motor is not None
        if isinstance(found, MotorMap) and run is not None:
            self.host.draw([MAP], found, self.shown_map, run.points)

    @shows("storage", tab=LOSSES)
    def _show_storage(self) -> None:
        storage = self.storage
        if storage is None:
            return
        chosen, sizes = storage.chosen, storage.size_kwh
        most = chosen.with_resistors_kwh - chosen.with_receptive_line_kwh
        curves = {
            "receptive": (sizes, 0 * sizes + most),
            "curve": (sizes, storage.saved_kwh),
            "chosen": (np.array([chosen.storage.size_kwh]), np.array([chosen.saved_kwh])),
        }
        self.host.draw([SAVED], curves, {"needed": storage.need.max_drop_kwh})
        self.storage_text.object = texts.storage_words(storage)
        # the storage needed is suggested until one is named; whole kilowatts upwards, as less would not do
        size, power, *_ = self.storage_fields
        size.suggest(chosen.storage.size_kwh)
        power.suggest(math.ceil(chosen.storage.power_kw))
