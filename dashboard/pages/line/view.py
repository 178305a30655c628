"""Line: a whole line with its stations; how the time is shared among its legs, and what that saves."""

from functools import partial
from io import StringIO
from typing import Any

import panel as pn
import panel_material_ui as pmui
from panel.viewable import Viewable

from railjoule.core.csv_text import csv_of_table
from railjoule.core.units import J_PER_WH
from railjoule.dashboard.charts.chart import Axis, Chart
from railjoule.dashboard.charts.run_charts import LineStrip
from railjoule.dashboard.charts.scene import RunScene
from railjoule.dashboard.look import words
from railjoule.dashboard.look.tokens import NARROW_PX
from railjoule.dashboard.pages.line.charts import (
    SHARING_WORDS,
    LegBars,
    LineSpeedChart,
    PathChart,
    SlackChart,
    energy_kwh,
    price_wh_per_s,
)
from railjoule.dashboard.pages.line.compute import LineRuns
from railjoule.dashboard.pages.line.model import StationModel
from railjoule.dashboard.pages.line.texts import figure_cells, key_words, legs_tables, missed_words, sharing_words
from railjoule.dashboard.pages.line.work import WholeLines
from railjoule.dashboard.pages.page import BODY_CSS, PageView
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.parts.number_field import number_fields, tie

PAGE = "Line"
SHIPPED, SHIPPED_TITLE = "metro-10-stations", "Metro, ten stations"
HEIGHTS = {
    "line_speed": (230, 290, 210),
    "line": (98, 106, 94),
    "line_path": (180, 230, 170),
    "supplements": (140, 170, 140),
    "leg_price": (110, 130, 100),
    "leg_energy": (140, 160, 130),
}
"""Of each chart [px]: in usual, wide and narrow windows."""
LOWER_CSS = """
:host { padding: 4px 20px 20px 20px; }
@media (max-width: 1099px) { :host { padding: 4px 14px 16px; } }
"""
WIDE_TABLE = '<div style="overflow-x:auto" tabindex="0" role="region" aria-label="{}">{}</div>'
STATIONS_CSS = """
:host { display: grid; grid-template-columns: repeat(auto-fill, minmax(240px, 1fr)); gap: 0 24px; }
"""
STATION_CSS = ":host { border-top: 1px solid var(--rj-line); padding: 6px 0; }"
ARRIVAL_WORDS = {"Free": "free", "Fixed": "fixed", "Window": "window"}
OTHER_WORDS = {"Proportional reserve": "proportional", "Equal reserve": "equal", "Given timetable": "given"}
GIVEN_HELP = (
    "A given timetable, set by its arrivals here or by stations dragged in the chart of supplements, is shown beside "
    "the optimum. Where a station has no given arrival, the optimum shares the time between its neighbours."
)
SMALL: dict[str, Any] = {"size": "small", "sx": {"& .MuiToggleButton-root": {"whiteSpace": "nowrap"}}}
STATION_STYLE = {
    **SMALL,
    "stylesheets": [
        ".MuiFormControl-root > .MuiFormLabel-root { font-weight: 600; font-size: 14px; color: var(--rj-ink); }"
    ],
}


class LineView(PageView):
    """The page of whole lines."""

    page = PAGE
    works = (WholeLines,)
    heights = HEIGHTS

    def make(self) -> Viewable:
        """Make the pieces of the page, and return them laid out."""
        state = self.state
        self.model = state.line
        self._resting: list[str] = []
        self.key = parts.html_pane()
        self.verdict, self.table, self.notes, self.empty_text = (parts.html_pane() for _ in range(4))
        self._make_charts()
        self.other = pmui.RadioButtonGroup(options=OTHER_WORDS, value=self.model.other, margin=(8, 4, 4, 20), **SMALL)
        self.download = pmui.FileDownload(
            callback=self._csv,
            filename="legs.csv",
            label="Legs as CSV",
            variant="text",
            size="small",
            margin=(0, 0, 8, -10),
        )
        self.open = pmui.Button(
            label=f"Open {SHIPPED_TITLE}",
            variant="outlined",
            size="small",
            margin=(8, 20),
            on_click=lambda _: state.scenario.choose(SHIPPED),
        )
        self.stations = parts.stack(css=STATIONS_CSS)
        self.take_best, self.take_other, self.take_away = (
            pmui.Button(label=label, variant="outlined", size="small", margin=(4, 8, 8, 0), on_click=act)
            for label, act in (
                ("Take over the optimal arrivals", lambda _: self.model.take_over("optimum")),
                ("", lambda _: self.model.take_over(self.model.shown_other)),
                ("Remove the given timetable", lambda _: self.model.take_over(None)),
            )
        )
        self.other.param.watch(self._choose_other, "value")
        self.shows(self._list_stations, (self.model, ["inner_stations"]))
        self.shows(self._show, (self.model, ["runs", "failure", "other", "inner_stations", "moving"]))
        return self._laid_out()

    def _make_charts(self) -> None:
        palette = self.palette
        self.axis = Axis(palette)
        self.speed = LineSpeedChart(HEIGHTS["line_speed"][0], self.axis, palette)
        self.line = LineStrip(HEIGHTS["line"][0], self.axis, palette)
        self.path = PathChart(HEIGHTS["line_path"][0], self.axis, palette)
        self.supplements = SlackChart(HEIGHTS["supplements"][0], self.axis, palette, self._drag, self._release)
        self.price = LegBars(
            "leg_price",
            "An extra second on each leg saves, Wh/s",
            HEIGHTS["leg_price"][0],
            self.axis,
            palette,
            price_wh_per_s,
            lambda wh_per_s: words.price(wh_per_s * J_PER_WH),
        )
        self.energy = LegBars(
            "leg_energy",
            "Energy of each leg, kWh",
            HEIGHTS["leg_energy"][0],
            self.axis,
            palette,
            energy_kwh,
            words.energy,
            last=True,
        )

    def _laid_out(self) -> pn.Column:
        body = parts.stack(*(chart.host for chart in self.charts), css=BODY_CSS)
        title = parts.html_pane('<div class="block"><h2>Timetable of the stations</h2></div>')
        about = parts.html_pane(parts.note_paragraphs([GIVEN_HELP]))
        acts = pn.FlexBox(self.take_best, self.take_other, self.take_away, margin=0, sizing_mode="stretch_width")
        lower = parts.stack(
            self.verdict, title, about, acts, self.stations, self.table, self.download, self.notes, css=LOWER_CSS
        )
        self.full = parts.stack(self.figures, self.other, self.key, body, lower)
        self.empty = parts.stack(self.empty_text, self.open)
        return parts.stack(self.heading, self.message, self.full, self.empty)

    @property
    def charts(self) -> tuple[Chart, ...]:
        """All charts of the page."""
        return self.speed, self.line, self.path, self.supplements, self.price, self.energy

    def settle(self) -> None:
        """Tell the cursor that it may meet new charts."""
        self.axis.settle("m", 0)

    def _choose_other(self, event: Any) -> None:
        # what is shown where the chosen one is not there is no choice
        if event.new != self.model.shown_other:
            self.model.other = event.new

    def _drag(self, number: int, arrival_s: float) -> None:
        """Show the given timetable with a station's arrival as it is being dragged."""
        if number < len(self.model.inner_stations):
            self.model.param.update(moving=True, moved=(number, arrival_s))

    def _release(self) -> None:
        self.model.moving = False

    def _csv(self) -> StringIO:
        """Return the legs under all sharing rules as a file."""
        runs = self.model.runs
        lines = () if runs is None else runs.runs.values()
        return StringIO(
            "".join(csv_of_table(line.to_dataframe(), header=first == 0) for first, line in enumerate(lines))
        )

    def _list_stations(self) -> None:
        self.stations[:] = [station_row(station) for station in self.model.inner_stations]

    def _show(self) -> None:
        runs = self.model.runs
        self.tell(self.model.failure, "Shown: the last runs that could be computed." if runs is not None else "")
        alone = not self.model.inner_stations
        self.full.visible, self.empty.visible = not alone, alone
        if alone:
            self._show_empty()
        if runs is None or alone:
            return
        other, room = self.model.shown_other, self._room()
        self._show_choices(runs)
        self.axis.fit(runs.best.run.distance_m, roomy=False)
        self.speed.show(partial(self.speed.draw, runs, other, room))
        narrow = self.browser.window_width < NARROW_PX
        scene = RunScene("optimal", {"optimal": runs.best.run}, None, False, narrow, room)
        self.line.show(partial(self.line.draw, scene))
        self.path.show(partial(self.path.draw, runs, other))
        self.supplements.show(partial(self.supplements.draw_slack, runs, room, self.model.moving))
        self.price.show(partial(self.price.draw, runs, room))
        self.energy.show(partial(self.energy.draw, runs, room))
        self._show_texts(runs)

    def _show_choices(self, runs: LineRuns) -> None:
        """Offer a given timetable to compare with where there is one, and to take over what is shown."""
        there = {word: name for word, name in OTHER_WORDS.items() if name in runs.runs}
        if self.other.options != there:
            self.other.options = there
        if self.other.value != self.model.shown_other:
            self.other.value = self.model.shown_other
        other = self.model.shown_other
        self.take_other.visible = other != "given"
        self.take_other.label = f"Take over the arrivals of the {SHARING_WORDS[other]}"
        self.take_away.visible = any(station.given_s is not None for station in self.model.inner_stations)

    def _room(self) -> float:
        width = self.browser.window_width
        return float(width - (90 if width < NARROW_PX else 370))

    def _show_empty(self) -> None:
        scenario = self.state.scenario.edited
        self.heading.object = parts.heading(self.page, scenario.title, "one leg", "")
        self.empty_text.object = (
            '<p style="padding:6px 20px;max-width:70ch">This line has no stations between its ends, so there is no '
            "time to share. Add stations in the editor under Track, or open a line that has some.</p>"
        )

    def _show_texts(self, runs: LineRuns) -> None:
        best, scenario = runs.best, runs.best.run.scenario
        standing = sum(station.dwell_s for station in scenario.line.inner_stations)
        what = (
            f"{words.distance(best.run.distance_m)} km, {len(best.legs)} legs in "
            f"{words.time(best.run.travel_time_s)} s, including {words.time(standing)} s of dwell"
        )
        self.heading.object = parts.heading(self.page, scenario.title, what, "")
        self.key.object = key_words(runs)
        cells = figure_cells(runs)
        if self.model.moving:
            # the chart must not move away under the hand that drags in it
            self.figures.object = parts.figures_in_place(cells, self._resting)
        else:
            self._resting = cells
            self.figures.object = parts.figures(cells, self.model.failure is not None)
        self.verdict.object = parts.note_paragraphs(sharing_words(runs))
        self.table.object = WIDE_TABLE.format("Legs", legs_tables(runs))
        self.notes.object = parts.note_paragraphs(missed_words(runs)) + parts.notes(best.run)


def station_row(station: StationModel) -> pn.Column:
    """Return the fields of a station: its dwell, what its arrival may be, and its arrival in a given timetable."""
    of = f"{station.name_or_number}: "
    dwell, arrival, earliest, latest, given = number_fields(
        station, "dwell_s", "arrival_s", "earliest_s", "latest_s", "given_s", of=of
    )
    kind = pmui.RadioButtonGroup(
        label=f"{of}arrival", options=ARRIVAL_WORDS, value=station.arrival, margin=(2, 8, 4, 8), **STATION_STYLE
    )
    # a field is hidden by what it stands in: its own style sheet would show it
    fixed, window = parts.stack(arrival), parts.stack(earliest, latest)

    def show(*_: Any) -> None:
        fixed.visible, window.visible = station.arrival == "fixed", station.arrival == "window"

    tie(kind, station, "arrival")
    station.param.watch(show, "arrival")
    show()
    return parts.stack(kind, fixed, window, dwell, given, css=STATION_CSS)
