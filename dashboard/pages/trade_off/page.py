"""Trade-off: the energy-time frontier with the strategies beside it, and ENOC's energy over its acceleration time."""

from functools import partial
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param
from panel.viewable import Viewable

from railjoule.core.scenario import load_scenario
from railjoule.core.validation.ftorek_runs import TABLE_3_COPPER_WEIGHT
from railjoule.dashboard.charts.dress import line_style
from railjoule.dashboard.charts.plot import Plot, Stroke
from railjoule.dashboard.look import words
from railjoule.dashboard.look.tokens import NARROW_PX
from railjoule.dashboard.page import Page, Request, shows, work
from railjoule.dashboard.pages.trade_off import texts
from railjoule.dashboard.pages.trade_off.charts import TIME_TITLE, ContourChart, FrontierChart, SurfacePane, time_ends
from railjoule.dashboard.pages.trade_off.compute import EnocPoint, TradeOff, compute_trade_off
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.parts.choices import button, buttons
from railjoule.dashboard.parts.number_field import NumberField
from railjoule.dashboard.state.kept import result

ENOC_SCENARIO = "ftorek-300s"
"""A shipped scenario that ENOC accepts."""
FRONTIER = Plot(
    "frontier",
    heights=(400, 470, 290),
    chart=partial(FrontierChart, "frontier", "Net energy, kWh, over travel time, s"),
)
SHARE = Plot(
    "share",
    "ENOC above the optimum, %",
    {"share": Stroke("enoc", line_style("enoc"))},
    heights=(130, 150, 110),
    x_title=TIME_TITLE,
    ticks=3,
    from_zero=True,
    uprights={"now": "line2"},
)
SURFACE = Plot("surface", "", heights=(400, 500, 330), chart=SurfacePane)
CONTOUR = Plot(
    "contour",
    heights=(400, 500, 330),
    chart=partial(ContourChart, "contour", "ENOC: energy, kWh, as contours"),
)
MAPS = {
    "Realistic times": (False, 1.0),
    "Up to 5000 s": (True, 1.0),
    "As in the paper, Table 3": (True, TABLE_3_COPPER_WEIGHT),
}
"""Times of ENOC's map, up to 5000 s or not, and the copper loss over the vehicle's own."""
LAYOUT_CSS = """
:host { display: grid; grid-template-columns: minmax(0, 1fr) minmax(0, 1fr); column-gap: 28px;
  padding: 10px 20px 12px 14px; align-items: start; }
@media (max-width: 899px) { :host { grid-template-columns: minmax(0, 1fr); padding: 8px 12px; } }
"""
INVITATION = "A scenario that it accepts shows its energy as a surface:"
ENOC_TITLE = '<div class="block"><h2>ENOC: energy over travel and acceleration time</h2></div>'


class TradeOffPage(Page):
    """The minimum energy over travel time, and the energies of other strategies."""

    page = "Trade-off"
    kept = ("wide_map", "copper_weight", "map_view")
    figures = (FRONTIER, SHARE, SURFACE, CONTOUR)
    halves_from_px = NARROW_PX

    wide_map = param.Boolean(default=False, doc="Show ENOC's map up to 5000 s.")
    copper_weight = param.Number(default=1.0, bounds=(0.01, 100.0), doc="Copper loss of ENOC's map over its own.")
    map_view = param.Selector(default="surface", objects=["surface", "contours"], doc="How ENOC's map is drawn.")
    trade_off = result(TradeOff, "The last good trade-off.")

    # ---- what it computes

    @work("scenario", "desk.scenario.travel_time_range_s", "wide_map", "copper_weight", into="trade_off", marked=True)
    def _trade_off(self) -> Request:
        longest_s = self.desk.scenario.travel_time_range_s[1]
        # the same for all travel and acceleration times, so that a move of these is no new request
        scenario = self.desk.scenario.scenario().replace(
            **{"timetable.travel_time_s": longest_s, "enoc.acceleration_time_s": None}
        )
        return compute_trade_off, scenario, longest_s, self.wide_map, float(self.copper_weight)

    # ---- what it shows

    def layout(self) -> Viewable:
        """Make the parts of the page, and return them laid out."""
        self.table, self.times, self.refused, self.notes = (parts.html_pane() for _ in range(4))
        plots = self.host.plots
        plots["frontier"].on_time = lambda time_s: self.desk.scenario.param.update(travel_time_s=time_s)
        open_one = button(
            f"Open {load_scenario(ENOC_SCENARIO).title}",
            lambda _: self.desk.scenario.choose(ENOC_SCENARIO),
            margin=(8, 0, 12, 0),
        )
        self.invitation = parts.stack(self.refused, open_one, visible=False)
        self.map = pmui.Select(label="Range shown", options=MAPS, size="small", margin=(6, 12, 8, 0), width=220)
        self.map.param.watch(self._choose_map, "value")
        views = buttons(self, "map_view", {"Surface": "surface", "Contours": "contours"}, margin=(12, 0, 8, 0))
        self.ramp = NumberField(self.desk.scenario, "acceleration_time_s")
        self.best_ramp = pmui.Button(
            label="",
            variant="text",
            size="small",
            margin=(0, 8),
            on_click=lambda _: self.desk.scenario.param.update(acceleration_time_s=None),
        )
        self.enoc = parts.stack(
            parts.html_pane(ENOC_TITLE),
            pn.FlexBox(self.map, views, margin=0, sizing_mode="stretch_width"),
            self.ramp,
            self.best_ramp,
            plots["surface"].host,
            plots["contour"].host,
            visible=False,
        )
        left = parts.stack(plots["frontier"].host, plots["share"].host)
        right = parts.stack(self.times, self.table, self.invitation, self.enoc)
        return parts.stack(self.host.figures, parts.stack(left, right, css=LAYOUT_CSS), self.notes)

    def _choose_map(self, event: Any) -> None:
        wide, weight = event.new
        self.param.update(wide_map=wide, copper_weight=weight)

    @shows("wide_map", "copper_weight")
    def _show_map_choice(self) -> None:
        now = self.wide_map, self.copper_weight
        # a link may name another weight
        self.map.value = now if now in MAPS.values() else (self.wide_map, 1.0)

    @shows("failure", "desk.failure", "desk.runs", "scenario")
    def _show_failure(self) -> None:
        run = self.desk.run
        shown = "" if run is None else f"Showing the last feasible run, {words.number(run.travel_time_s)} s."
        self.host.tell(self.failure or self.desk.failure, shown)
        self.host.heading.object = parts.heading(self.page, self.desk.scenario.edited.title, "", "")

    @shows("trade_off", "map_view", "desk.runs")
    def _show(self) -> None:
        trade_off, runs = self.trade_off, self.desk.runs
        if trade_off is None or runs is None:
            return
        # not the chosen run: the frontier is that of the optima
        best = runs.best
        enoc = trade_off.enoc_point(best.travel_time_s, self.desk.scenario.acceleration_time_s)
        self.host.figures.object = parts.figures(texts.trade_off_figures(trade_off, best, enoc))
        self.table.object = texts.runs_table(trade_off, runs, enoc)
        self.times.object = texts.times_table(trade_off, best)
        others = {name: run for name, run in runs.runs.items() if run is not best}
        self.host.draw([FRONTIER], trade_off, best, others)
        refusal = trade_off.enoc_refusal(best.travel_time_s)
        self.enoc.visible = self.host.plots["share"].host.visible = enoc is not None
        self.invitation.visible = enoc is None
        if enoc is None:
            self.refused.object = parts.note_paragraphs([f"{refusal} {INVITATION}"])
            refusal = ""
        else:
            self._show_enoc(trade_off, enoc, time_ends(trade_off, runs.runs.values()))
        self.notes.object = parts.note_paragraphs(filter(None, [refusal, *trade_off.frontier.notes]), "margin:0 20px")

    def _show_enoc(self, trade_off: TradeOff, enoc: EnocPoint, ends: tuple[float, float]) -> None:
        """Show ENOC's curve and its map, one of the two pictures of it."""
        best = trade_off.enoc_point(enoc.travel_time_s)
        assert best is not None
        self.ramp.suggest(best.acceleration_time_s)
        self.best_ramp.visible = self.desk.scenario.acceleration_time_s is not None
        self.best_ramp.label = f"Best for {words.time(best.travel_time_s)} s: {words.time(best.acceleration_time_s)} s"
        time, _, _ = trade_off.enoc_curve
        self.host.draw([SHARE], {"share": (time, trade_off.enoc_share)}, {"now": enoc.travel_time_s}, ends)
        shown, hidden = (SURFACE, CONTOUR) if self.map_view == "surface" else (CONTOUR, SURFACE)
        self.host.plots[shown.name].host.visible = True
        self.host.plots[hidden.name].host.visible = False
        self.host.draw([shown], trade_off, enoc)
