"""Line: a whole line with its stations; how the time is shared among its legs, and what that saves."""

from functools import partial
from io import StringIO
from typing import Any

import panel as pn
import panel_material_ui as pmui
from panel.viewable import Viewable

from railjoule.core.units import J_PER_KWH
from railjoule.dashboard.charts.chart import Axis, Chart
from railjoule.dashboard.charts.run_charts import LineStrip
from railjoule.dashboard.charts.scene import RunScene
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.pages.line.charts import (
    SHARING_TOKENS,
    SHARING_WORDS,
    LegBars,
    LineSpeedChart,
    PathChart,
    energy_kwh,
    supplement_s,
)
from railjoule.dashboard.pages.line.compute import LineRuns
from railjoule.dashboard.pages.line.model import StationModel
from railjoule.dashboard.pages.line.work import WholeLines
from railjoule.dashboard.pages.page import NARROW_PX, PageView
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.parts.number_field import number_fields

PAGE = "Line"
SHIPPED, SHIPPED_TITLE = "metro-10-stations", "Metro, ten stations"
HEIGHTS = {
    "line_speed": (230, 290, 210),
    "line": (98, 106, 94),
    "line_path": (180, 230, 170),
    "supplements": (120, 140, 110),
    "leg_energy": (140, 160, 130),
}
"""Of each chart [px]: in usual, wide and narrow windows."""
BODY_CSS = ":host { padding: 4px 20px 0 14px; } @media (max-width: 899px) { :host { padding: 4px 10px 0 6px; } }"
LOWER_CSS = """
:host { padding: 4px 20px 20px 20px; }
@media (max-width: 1099px) { :host { padding: 4px 14px 16px; } }
"""
WIDE_TABLE = '<div style="overflow-x:auto" tabindex="0" role="region" aria-label="{}">{}</div>'
STATIONS_CSS = """
:host { display: grid; grid-template-columns: repeat(auto-fill, minmax(240px, 1fr)); gap: 0 24px; }
"""
STATION_CSS = ":host { border-top: 1px solid var(--rj-line); padding: 6px 0; }"
SMALL: dict[str, Any] = {"size": "small", "sx": {"& .MuiToggleButton-root": {"whiteSpace": "nowrap"}}}


class LineView(PageView):
    """The page of whole lines."""

    page = PAGE
    works = (WholeLines,)
    heights = HEIGHTS

    def make(self) -> Viewable:
        """Make the pieces of the page, and return them laid out."""
        state, palette = self.state, self.palette
        self.model = state.line
        self.key = parts.html_pane(key_words())
        self.table, self.notes, self.empty_text = (parts.html_pane() for _ in range(3))
        self.axis = Axis(palette)
        self.speed = LineSpeedChart(HEIGHTS["line_speed"][0], self.axis, palette)
        self.line = LineStrip(HEIGHTS["line"][0], self.axis, palette)
        self.path = PathChart(HEIGHTS["line_path"][0], self.axis, palette)
        self.supplements = LegBars(
            "supplements",
            "Time supplement of each leg, s, over its shortest time",
            HEIGHTS["supplements"][0],
            self.axis,
            palette,
            supplement_s,
            words.time,
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
        self.other = pmui.RadioButtonGroup(
            options={"Proportional reserve": "proportional", "Equal reserve": "equal"},
            value=self.model.other,
            margin=(8, 4, 4, 20),
            **SMALL,
        )
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
        self.other.param.watch(lambda event: setattr(self.model, "other", event.new), "value")
        self.shows(self._list_stations, (self.model, ["stations"]))
        self.shows(self._show, (self.model, ["runs", "failure", "other", "stations"]))
        return self._laid_out()

    def _laid_out(self) -> pn.Column:
        body = parts.stack(*(chart.host for chart in self.charts), css=BODY_CSS)
        title = parts.html_pane('<div class="block"><h2>Timetable of the stations</h2></div>')
        lower = parts.stack(title, self.stations, self.table, self.download, self.notes, css=LOWER_CSS)
        self.full = parts.stack(self.figures, self.other, self.key, body, lower)
        self.empty = parts.stack(self.empty_text, self.open)
        return parts.stack(self.heading, self.message, self.full, self.empty)

    @property
    def charts(self) -> tuple[Chart, ...]:
        """All charts of the page."""
        return self.speed, self.line, self.path, self.supplements, self.energy

    def settle(self) -> None:
        """Tell the cursor that it may meet new charts."""
        self.axis.settle("m", 0)

    def _csv(self) -> StringIO:
        """Return the legs under all sharing rules as a file."""
        runs = self.model.runs
        text = (
            "\n".join(
                line.to_dataframe().to_csv(index=False, header=first)
                for first, line in zip((True, False, False), runs.runs.values(), strict=True)
            )
            if runs is not None
            else ""
        )
        return StringIO(text.replace("\n\n", "\n"))

    def _list_stations(self) -> None:
        self.stations[:] = [station_row(station) for station in self.model.stations]

    def _show(self) -> None:
        runs = self.model.runs
        self.tell(self.model.failure, "Shown: the last runs that could be computed." if runs is not None else "")
        alone = not self.model.stations
        self.full.visible, self.empty.visible = not alone, alone
        if alone:
            self._show_empty()
        if runs is None or alone:
            return
        other, room = self.model.other, self._room()
        self.axis.fit(runs.best.run.distance_m, roomy=False)
        self.speed.show(partial(self.speed.draw, runs, other, room))
        narrow = self.browser.window_width < NARROW_PX
        scene = RunScene("optimal", {"optimal": runs.best.run}, None, False, narrow, room)
        self.line.show(partial(self.line.draw, scene))
        self.path.show(partial(self.path.draw, runs, other))
        self.supplements.show(partial(self.supplements.draw, runs, room))
        self.energy.show(partial(self.energy.draw, runs, room))
        self._show_texts(runs)

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
        self.figures.object = parts.figures(figure_cells(runs), self.model.failure is not None)
        self.table.object = WIDE_TABLE.format("Legs", legs_table(runs))
        self.notes.object = parts.notes(best.run)


def station_row(station: StationModel) -> pn.Column:
    """Return the fields of a station: its dwell, and its arrival where that is fixed."""
    of = f"{station.station or 'Station'}: "
    dwell, arrival = number_fields(station, "dwell_s", "arrival_s", of=of)
    fixed = pmui.Checkbox(
        # the number counts from 0 between the ends, and the start is station 1
        label=f"{station.station or f'Station {station.number + 2}'}: arrival fixed",
        value=station.fixed,
        size="small",
        margin=(0, 8, 0, 8),
        sx={"& .MuiFormControlLabel-label": {"fontSize": "13px"}},
    )

    def show(*_: Any) -> None:
        arrival.visible = station.fixed

    def tick(event: Any) -> None:
        station.fixed = event.new

    fixed.param.watch(tick, "value")
    station.param.watch(show, "fixed")
    show()
    return parts.stack(fixed, dwell, arrival, css=STATION_CSS)


def figure_cells(runs: LineRuns) -> list[str]:
    """Return the numbers above the charts."""
    best, plain = runs.best, runs.runs["proportional"].run.energy_kwh
    equal = runs.runs["equal"].run.energy_kwh
    prices = [leg.price_of_time_w for leg in best.legs]
    # up to rounding: without a fixed arrival all legs have one price
    one = max(prices) - min(prices) <= 1e-9 * max(prices)
    price = words.price(prices[0]) if one else f"{words.price(min(prices))}\u2013{words.price(max(prices))}"
    costs = [comparisons.above(other, best.run.energy_kwh) for other in (plain, equal)]
    return [
        parts.figure("Energy of the whole line", words.energy(best.run.energy_kwh), "kWh", "optimal reserve", "main"),
        parts.figure("Proportional reserve", *costs[0], f"{words.energy(plain)} kWh"),
        parts.figure("Equal reserve", *costs[1], f"{words.energy(equal)} kWh"),
        parts.figure(
            "Extra second saves",
            price,
            "Wh/s",
            "same on every leg" if one else "same between fixed arrivals",
        ),
        parts.proof_figure(best.run),
        parts.figure(
            "Running-time supplement",
            words.number(best.run.travel_time_s - runs.shortest_time_s),
            "s",
            f"shortest {words.number(runs.shortest_time_s)} s",
        ),
    ]


def key_words() -> parts.Markup:
    """Return what the colours of lines and bars mean."""
    bar = '<span style="margin-right:16px"><span class="patch" style="background:var(--rj-{})"></span>{}</span>'
    return parts.markup(
        '<p class="small" style="padding:2px 20px 0;color:var(--rj-ink2)">{}numbers above bars: {}</p>',
        parts.joined(parts.markup(bar, token, SHARING_WORDS[sharing]) for sharing, token in SHARING_TOKENS.items()),
        SHARING_WORDS["optimum"],
    )


def legs_table(runs: LineRuns) -> str:
    """Return the legs of the optimum, with what the other sharing rules give and need."""
    best, plain, equal = (runs.runs[sharing] for sharing in SHARING_TOKENS)
    header = (
        "Leg",
        "m",
        "arrives, s",
        "runs, s",
        "shortest, s",
        "supplement, s",
        "proportional, s",
        "kWh",
        "proportional, kWh",
        "equal, kWh",
    )
    rows = []
    for leg, one, two in zip(best.legs, plain.legs, equal.legs, strict=True):
        cells = (
            f"{leg.departs_from} \u2013 {leg.arrives_at}",
            words.number(leg.end_m - leg.start_m, 0),
            words.number(leg.arrival_s),
            words.number(leg.running_time_s),
            words.number(leg.shortest_time_s),
            words.number(leg.supplement_s),
            words.number(one.supplement_s),
            *(words.energy(part.energy_j / J_PER_KWH) for part in (leg, one, two)),
        )
        rows.append((cells, False))
    return parts.table("Legs", header, rows)
