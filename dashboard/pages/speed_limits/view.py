"""Speed limits: one for each section, their cost beside the optimum, what the drive and a storage make of it."""

from collections.abc import Sequence
from functools import partial

import numpy as np
import panel as pn
import panel_material_ui as pmui
from panel.viewable import Viewable

from railjoule.core import Scenario, Trajectory
from railjoule.core.energy import share_above
from railjoule.core.energy_along import BRAKES
from railjoule.core.limit_search.search import LimitSearch
from railjoule.core.units import J_PER_KWH, W_PER_KW
from railjoule.dashboard.charts.chart import Axis, Chart
from railjoule.dashboard.charts.machine_map import MotorMapChart
from railjoule.dashboard.charts.quantities import EFFORT, ENERGY
from railjoule.dashboard.charts.run_charts import LineStrip
from railjoule.dashboard.charts.scene import RunScene
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.look.markup import Markup, markup
from railjoule.dashboard.look.theme import padded
from railjoule.dashboard.look.tokens import NARROW_PX
from railjoule.dashboard.pages.page import BODY_CSS, PageView
from railjoule.dashboard.pages.speed_limits.compute import InterStationRuns, LimitRun, run_figures
from railjoule.dashboard.pages.speed_limits.fields import PAGE
from railjoule.dashboard.pages.speed_limits.limit_charts import LimitChart, LimitSpeedChart, both
from railjoule.dashboard.pages.speed_limits.search_charts import SearchPathChart, SearchPlaneChart, search_words
from railjoule.dashboard.pages.speed_limits.storage import StorageChart, storage_table
from railjoule.dashboard.pages.speed_limits.work import SpeedLimits
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.parts.choices import box, buttons

HEIGHTS = {
    "limit_speed": (290, 360, 240),
    "line": (104, 112, 98),
    "limit_effort": (104, 120, 96),
    "limit_energy": (130, 150, 120),
    "search_plane": (280, 330, 260),
    "search_path": (220, 260, 200),
    "motor_map": (300, 360, 280),
    "storage": (220, 260, 200),
}
"""Of each chart [px]: in usual, wide and narrow windows."""
LOWER_CSS = """
:host { display: grid; grid-template-columns: minmax(0, 1fr) minmax(0, 1fr); column-gap: 28px;
  padding: 14px 20px 12px 14px; align-items: start; }
@media (max-width: 1099px) { :host { grid-template-columns: minmax(0, 1fr); padding: 8px 10px 12px 6px; } }
"""
GAP_CSS = ":host { row-gap: 10px; }"
NOTES_CSS = padded("0 20px 16px", "0 12px 16px")
REGULATOR_WORDS = {"coast": "Coasts", "brake": "Brakes", "literal": "As printed"}
REGULATOR_DOES = {
    "coast": "coasts above a set speed",
    "brake": "brakes for a set speed",
    "literal": "is the published relay",
}
RUNS_WORDS = {"All runs together": "together", "Each run by itself": "separate"}
"""The two ways to search the inter-station runs of a line."""
RULES = {
    "coast": "The train drives below its set speed and coasts above it.",
    "brake": "The train drives below its set speed and brakes ahead of a lower one.",
    "literal": "The train drives below its set speed and brakes above it; within {zone} km/h of it, it does neither.",
}
"""What each regulator does at a set speed; `zone` is half of the dead zone of the published relay."""
TARGETS = (
    "Set speeds are targets, not limits of the line. The travel time may differ from the timetable within a window."
)


class SpeedLimitsView(PageView):
    """The page of limits of sections."""

    page = PAGE
    works = (SpeedLimits,)
    heights = HEIGHTS

    def make(self) -> Viewable:
        """Make the pieces of the page, and return them laid out."""
        palette = self.palette
        self.model = model = self.state.speed_limits
        self.table, self.search_text, self.storage_text, self.no_map, self.notes = (parts.html_pane() for _ in range(5))
        self.runs, self.losses = parts.html_pane(), parts.html_pane()
        self.axis = Axis(palette)
        self.speed = LimitSpeedChart(HEIGHTS["limit_speed"][0], self.axis, palette, model.move, self._release)
        self.line = LineStrip(HEIGHTS["line"][0], self.axis, palette)
        self.effort = LimitChart(EFFORT, HEIGHTS["limit_effort"][0], self.axis, palette)
        self.energy = LimitChart(ENERGY, HEIGHTS["limit_energy"][0], self.axis, palette, last=True)
        self.plane = SearchPlaneChart(HEIGHTS["search_plane"][0], palette)
        self.path = SearchPathChart(HEIGHTS["search_path"][0], palette)
        self.map = MotorMapChart(HEIGHTS["motor_map"][0], palette)
        self.storage = StorageChart(HEIGHTS["storage"][0], palette)
        regulators = {word: name for name, word in REGULATOR_WORDS.items()}
        self.regulator = buttons(model, "regulator", regulators, margin=(8, 4, 0, 20))
        self.together = buttons(model, "inter_station_runs", RUNS_WORDS, margin=(8, 4, 0, 16))
        self.free = box(model, "free_borders", "Section ends may move", margin=(8, 8, 0, 16))
        self.search = pmui.Button(
            label="Search set speeds",
            variant="outlined",
            size="small",
            margin=(8, 20, 0, 8),
            height=28,
            on_click=lambda _: setattr(model, "found", True),
        )
        self.pair = pmui.Select(
            label="Sections",
            options={"1 and 2": 0},
            value=0,
            size="small",
            margin=(6, 0, 0, 46),
            width=130,
        )
        maps = {"Powertrain": "drive", "Motor": "motor"}
        self.whose = buttons(model, "shown_map", maps, margin=(6, 0, 0, 46))
        self.pair.visible = self.whose.visible = False
        self._listen()
        return self._laid_out()

    def _laid_out(self) -> pn.Column:
        tools = pn.FlexBox(
            self.regulator,
            self.together,
            self.free,
            self.search,
            align_items="center",
            margin=0,
            sizing_mode="stretch_width",
        )
        body = parts.stack(*(chart.host for chart in (self.speed, self.line, self.effort, self.energy)), css=BODY_CSS)
        left = parts.stack(
            self.runs, self.table, self.plane.host, self.pair, self.path.host, self.search_text, css=GAP_CSS
        )
        motors = self.no_map, self.map.host, self.whose, self.losses
        right = parts.stack(*motors, self.storage.host, self.storage_text, css=GAP_CSS)
        lower = parts.stack(left, right, css=LOWER_CSS)
        notes = parts.stack(self.notes, css=NOTES_CSS)
        return parts.stack(self.heading, self.message, self.figures, tools, body, lower, notes)

    def _listen(self) -> None:
        model = self.model
        self.shows(self._show_run, (model, ["run", "failure"]))
        self.shows(self._show_trip, (model, ["trip"]))
        self.shows(self._show_search, (model, ["path"]), (self.pair, ["value"]))
        self.shows(self._show_found, (model, ["found"]))
        self.shows(self._show_comparison, (model, ["comparison", "path"]))
        self.shows(self._show_map, (model, ["motor_map", "no_map", "shown_map"]))
        self.shows(self._show_storage, (model, ["storage"]))

    @property
    def charts(self) -> tuple[Chart, ...]:
        """All charts of the page."""
        return self.speed, self.line, self.effort, self.energy, self.plane, self.path, self.map, self.storage

    def _release(self) -> None:
        self.model.moving = False

    def settle(self) -> None:
        """Tell the cursor of the runs that it may meet new charts."""
        self.axis.settle("m", 0)

    def _show_found(self) -> None:
        self.search.disabled = self.model.found

    def _show_run(self) -> None:
        run = self.model.run
        self.tell(self.model.failure, "Shown: the last run that could be computed." if run is not None else "")
        if run is None:
            return
        self.axis.fit(run.run.distance_m, roomy=False)
        # under a drag the chart has the speeds of the trip, and the browser its steps
        if not self.model.moving:
            self.speed.show(partial(self.speed.draw, run, *self._steps()))
        self.effort.show(partial(self.effort.draw, both(run)))
        self.energy.show(partial(self.energy.draw, both(run)))
        self.line.show(partial(self.line.draw, self._scene(run)))
        self._show_texts(run)
        # it has the points of the run
        self._show_map()

    def _steps(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Return the limits and borders that stand now, be they possible or not."""
        return self.model.limits_kmh, self.model.borders_m

    def _scene(self, run: LimitRun) -> RunScene:
        width = self.browser.window_width
        room = width - (80 if width < NARROW_PX else 360)
        return RunScene("speed_limits", {"speed_limits": run.run}, None, False, width < NARROW_PX, room)

    def _show_trip(self) -> None:
        """Show the trip of a step that is being moved: its speeds, time and energy; the rest waits."""
        trip, run = self.model.trip, self.model.run
        if trip is None:
            return
        self.speed.show(partial(self.speed.draw_trip, trip))
        # a trip is compared with nothing: the optimum in its time is asked for with the whole run
        wait = "release the step to compare"
        cells = [
            parts.figure("Extra energy of set speeds", "\u2013", "", wait, "main"),
            parts.figure("Energy", words.energy(trip.energy_kwh), "kWh", "from the supply"),
            parts.figure("Optimum", "\u2013", "", ""),
            self._time_figure(trip.travel_time_s),
            parts.figure("Storage needed", "\u2013", "", ""),
        ]
        # were this row lower than the one before, the chart would move away under the mouse that drags its step
        self.figures.object = parts.figures_in_place(cells, self._cells(run) if run is not None else ())

    def _show_search(self) -> None:
        path = self.model.path
        if path is None:
            return
        pairs = section_pairs(path.search)
        options = {name: k for k, name in enumerate(pairs)}
        if self.pair.options != options:
            self.pair.param.update(options=options, value=0)
        self.pair.visible = len(pairs) > 1
        # of inter-station runs that are searched separately, each has a search of its own
        number, first, before = list(pairs.values())[self.pair.value]
        search = path.search.runs[number] if path.search.runs else path.search
        sections = len(search.best.limits_ms)
        self.plane.host.visible = sections > 1
        if sections > 1:
            self.plane.show(partial(self.plane.draw, search, first, before))
        self.path.show(partial(self.path.draw, search))
        self.search_text.object = parts.note_paragraphs([search_words(path.search)], "padding-left:6px")

    def _show_comparison(self) -> None:
        self.together.visible = self.model.has_stations
        shown, path = self.model.comparison, self.model.path
        # a table of another run would stand beside this one's charts
        is_current = shown is not None and path is not None and path.run in shown.runs.values()
        self.runs.visible = is_current
        if is_current:
            self.runs.object = inter_station_table(shown)

    def _show_map(self) -> None:
        found, run, refusal = self.model.motor_map, self.model.run, self.model.no_map
        self.map.host.visible = not refusal
        self.whose.visible = found is not None and found.motor is not None
        self.no_map.visible = bool(refusal)
        self.losses.visible = not refusal
        if refusal:
            self.no_map.object = parts.note_paragraphs([refusal], "padding-left:6px")
        if found is not None and run is not None:
            self.map.show(partial(self.map.draw, found, self.model.shown_map, run.points))
            self.losses.object = losses_table(run.run)

    def _show_storage(self) -> None:
        storage = self.model.storage
        if storage is not None:
            self.storage.show(partial(self.storage.draw, storage))
            self.storage_text.object = storage_table(storage)

    def _show_texts(self, run: LimitRun) -> None:
        scenario, count = run.run.scenario, len(run.limits_kmh)
        how = "found by search" if scenario.search.limits_kmh is None else "given"
        what = (
            f"{words.distance(run.run.distance_m)} km in {words.time(run.planned_s)} s, {count} "
            f"section{'' if count == 1 else 's'}, set speeds {how}; the regulator "
            f"{REGULATOR_DOES[scenario.search.regulator]}"
        )
        self.heading.object = parts.heading(self.page, scenario.title, what, "") + rule_html(scenario)
        self.figures.object = parts.figures(self._cells(run), self.model.failure is not None)
        self.table.object = sections_table(run)
        without = run.no_optimum and f"No optimum in the time of the run: {run.no_optimum}"
        first = parts.note_paragraphs([without] if without else [])
        self.notes.object = parts.markup('<div class="columns">{}</div>', first + parts.notes(run.run))

    def _cells(self, run: LimitRun) -> list[str]:
        need = run.need
        return [
            cost_figure(run),
            parts.figure("Energy", words.energy(run.run.energy_kwh), "kWh", "from the supply"),
            optimum_figure(run),
            self._time_figure(run.run.travel_time_s),
            parts.figure(
                "Storage needed",
                words.energy(need.max_drop_kwh),
                "kWh",
                f"{words.number(need.charging_peak_kw, 0)} kW at most",
            ),
        ]

    def _time_figure(self, time_s: float) -> str:
        """Return the travel time, and whether the window allows it."""
        planned = self.state.scenario.travel_time_s
        share = self.model.time_window_percent / 100
        first, last = planned * (1 - share), planned * (1 + share)
        # time is what the search pays with: its run takes all that the window allows, up to rounding
        rounding = 1e-5 * planned
        if first - rounding <= time_s <= last + rounding:
            detail = f"allowed {words.number(first)} to {words.number(last)} s"
        elif time_s > last:
            detail = parts.markup('<span class="worse">{} s too late</span>', words.number(time_s - last))
        else:
            detail = parts.markup('<span class="open">{} s too early</span>', words.number(first - time_s))
        return parts.figure("Travel time", words.time(time_s), "s", detail)


def losses_table(run: Trajectory) -> str:
    """Return the losses of a run's drive by kind; their mean powers are over the time in motion."""
    losses_j = {kind: joules for kind, joules in run.energy.losses_j.items() if kind not in BRAKES}
    whole_j, moves = sum(losses_j.values()), np.diff(run.position_m) > 0
    seconds = float(np.sum(np.diff(run.time_s)[moves]))

    def row(name: str, joules: float, strong: bool = False) -> tuple[tuple[str, ...], bool]:
        share = words.share(joules / whole_j) if whole_j > 0 else ""
        power = words.number(joules / seconds / W_PER_KW)
        return (name, words.energy(joules / J_PER_KWH), share, power), strong

    rows = [row(words.LOSS_WORDS[kind], joules) for kind, joules in losses_j.items()]
    head = ("Lost to", "kWh", "%", "mean power, kW")
    return parts.inset(parts.table("Losses of the powertrain", head, [*rows, row("All", whole_j, True)]))


def rule_html(scenario: Scenario) -> Markup:
    """Return what the regulator of a scenario does at its set speeds, and how its travel time is set."""
    search = scenario.search
    rule = RULES[search.regulator].format(zone=words.number(search.dead_zone_kmh))
    return markup('<p style="padding:0 20px 8px;max-width:90ch">{} {} {}</p>', rule, TARGETS, scenario.time_note)


def cost_figure(run: LimitRun) -> str:
    """Return what the limits cost beside the best known run of the same time."""
    cost, reference = comparisons.above_reference(run.run), run.run.reference
    if cost is None or reference is None:
        return parts.figure("Extra energy of set speeds", words.UNKNOWN, "", "no optimum to compare with", "main")
    name = comparisons.reference_noun(reference.proven)
    return parts.figure("Extra energy of set speeds", *cost, f"above the {name} in the same time", "main")


def optimum_figure(run: LimitRun) -> str:
    """Return the energy of the best known run in the time that the limits take, and how far it is from its bound."""
    reference, bound = run.run.reference, run.run.lower_bound_kwh
    if reference is None:
        return parts.figure("Optimum", words.UNKNOWN, "", "not found")
    whole = ""
    if reference.proven:
        detail: str = parts.PROVEN
    elif bound is None:
        detail = "no bound is known"
    else:
        amount = comparisons.above(reference.energy_kwh, bound)
        detail = parts.markup('<span class="open">\u25d0</span> {} bound', amount.sentence)
        whole = f"Not proven: the bound is {words.energy(bound)} kWh"
    name = comparisons.reference_noun(reference.proven).capitalize()
    return parts.figure(
        name,
        words.energy(reference.energy_kwh),
        "kWh",
        detail,
        whole=whole,
        term="Optimum" if reference.proven else "Best known",
    )


def sections_table(run: LimitRun) -> str:
    """Return the limits of the sections with the speeds that the run reaches in them."""
    ends = [0.0, *run.borders_m.tolist(), run.run.distance_m]
    rows = []
    for number, (limit, start, end) in enumerate(zip(run.limits_kmh, ends[:-1], ends[1:], strict=True), 1):
        inside = (run.run.position_m >= start) & (run.run.position_m <= end)
        top = words.speed(float(run.run.speed_ms[inside].max()), 1) if inside.any() else "\u2013"
        cells = (str(number), words.number(start, 0), words.number(end, 0), words.number(float(limit)), top)
        rows.append((cells, False))
    table = parts.table("Sections", ("Section", "from, m", "to, m", "set speed, km/h", "top speed, km/h"), rows)
    return parts.inset(table)


def section_pairs(search: LimitSearch) -> dict[str, tuple[int, int, int]]:
    """Return the pairs of neighbouring sections that one search moves: its run, the first of the two there, and before.

    All are counted from 0; the last number is that of the sections before the run.
    """
    pairs: dict[str, tuple[int, int, int]] = {}
    before = 0
    for number, run in enumerate(search.runs or (search,)):
        sections = len(run.best.limits_ms)
        for k in range(max(sections - 1, 1)):
            name = f"{before + k + 1} and {before + k + 2}" if sections > 1 else f"{before + 1}"
            pairs[name] = number, k, before
        before += sections
    return pairs


def inter_station_table(found: InterStationRuns) -> str:
    """Return times and energies of the inter-station runs, searched each by itself and all together."""
    ways = {way: found.runs[way] for way in RUNS_WORDS.values() if way in found.runs}
    columns = [values for run in ways.values() for values in run_figures(run)]
    header = ("Run", *(f"{way}, {unit}" for way in ways for unit in ("s", "kWh")))
    shown = (words.time, words.energy) * len(ways)
    names = [name.removeprefix("from ") for name in found.names]
    cells = [[show(float(value)) for value in column] for show, column in zip(shown, columns, strict=True)]
    rows: list[tuple[Sequence[str], bool]] = [(row, False) for row in zip(names, *cells, strict=True)]
    # the whole energy has the auxiliaries in dwells, too
    whole = [value for run in ways.values() for value in (run.travel_time_s, run.energy_kwh)]
    totals = [show(value) for show, value in zip(shown, whole, strict=True)]
    rows.append((("All, with dwells", *totals), True))
    notes = list(found.refusals.values())
    if len(ways) == len(RUNS_WORDS):
        together, separate = (found.runs[way].energy_kwh for way in ("together", "separate"))
        more = share_above(separate, together)
        notes.append(
            f"Separate runs each keep their own time and need {words.share(more)} % more than together, where the "
            "search can move time from one to another."
        )
    return parts.inset(parts.table("Inter-station runs", header, rows), parts.note_paragraphs(notes))
