"""Drive: one run, its numbers, the advice to its driver, and the charts that explain it."""

from functools import partial
from typing import Any

import panel as pn
import panel_material_ui as pmui

from railjoule.core import TimetableError
from railjoule.core.strategies import STRATEGIES
from railjoule.dashboard.browser import Browser
from railjoule.dashboard.look import words
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.models.workbench import Workbench
from railjoule.dashboard.views import parts
from railjoule.dashboard.views.charts import Axis, bring_into_sight
from railjoule.dashboard.views.drive_charts import (
    CurrentChart,
    DifferenceChart,
    EffortChart,
    EnergyChart,
    LineStrip,
    PhaseStrip,
    PowerChart,
)
from railjoule.dashboard.views.failures import failure_words
from railjoule.dashboard.views.fields import tie
from railjoule.dashboard.views.law_chart import LawChart
from railjoule.dashboard.views.sankey import SankeyChart
from railjoule.dashboard.views.scene import Scene, SceneChart
from railjoule.dashboard.views.speed_chart import SpeedChart

WIDE_PX, NARROW_PX = 1600, 900
MARGIN_PX, NARROW_MARGIN_PX, LEAST_WIDTH_PX = 400, 40, 300
"""What stands beside the charts, and how wide they are at least."""
SANKEY_PX, RAIL_PX = 260, 350
LAYOUT_CSS = """
:host { display: grid; grid-template-columns: minmax(0, 1fr) 330px; padding: 0 20px 12px 14px; column-gap: 20px; }
@media (max-width: 1599px) { :host { grid-template-columns: minmax(0, 1fr); } }
@media (max-width: 899px) { :host { padding: 0 10px 12px 6px; } }
"""
RAIL_CSS = """
:host { border-left: 1px solid var(--rj-line); padding: 4px 0 0 20px; }
@media (max-width: 1599px) { :host { border-left: 0; padding: 4px 6px 0 6px; display: grid;
  grid-template-columns: repeat(auto-fit, minmax(300px, 1fr)); column-gap: 32px; align-items: start; } }
"""

TOOLS_CSS = """
:host { display: grid; grid-template-columns: minmax(0, 1fr) auto; align-items: start; }
@media (max-width: 899px) { :host { grid-template-columns: minmax(0, 1fr); padding-left: 14px; } }
"""


class DriveView:
    """The page of one run."""

    def __init__(self, state: Workbench, browser: Browser, palette: Palette) -> None:
        self.state, self.browser, self.palette = state, browser, palette
        self.heading, self.message = parts.html_pane(), parts.html_pane(visible=False)
        self.repair = pmui.Button(
            label="", variant="text", size="small", margin=(0, 20), visible=False, on_click=self._repair
        )
        self.figures, self.advice = parts.html_pane(), parts.html_pane()
        self.account, self.runs, self.phases, self.notes = (parts.html_pane() for _ in range(4))
        self.over = pmui.RadioButtonGroup(
            options={"Distance": False, "Time": True},
            value=state.over_time,
            size="small",
            margin=(8, 20, 0, 0),
        )
        self.axis = Axis(palette)
        self.charts = self._charts()
        rail = parts.stack(self.account, self.runs, self.phases, self.notes, css=RAIL_CSS)
        self.law = LawChart(180, self.axis, palette)
        self.sankey = SankeyChart(SANKEY_PX, palette)
        column = parts.stack(*(chart.place for chart in self.charts.values()), self.law.place, self.sankey.place)
        body = parts.stack(column, rail, css=LAYOUT_CSS)
        tools = pn.Row(
            self.advice, self.over, margin=0, sizing_mode="stretch_width", styles={"align-items": "flex-start"}
        )
        self.view = parts.stack(self.heading, self.message, self.repair, self.figures, tools, body)
        tie(self.over, state, "over_time")
        state.param.watch(self._show, ["runs", "chosen", "ticked", "pins", "over_time", "failure"])
        browser.follow(["window_width"], self._fit)
        browser.follow(["charts_in_sight"], self._sight)
        self._sight()

    def _charts(self) -> dict[str, SceneChart]:
        lines = tuple(STRATEGIES)
        common = (self.axis, self.palette)
        charts: list[SceneChart] = [
            SpeedChart(250, *common, lines),
            PhaseStrip(26, *common),
            LineStrip(86, *common),
            EnergyChart(140, *common, lines),
            DifferenceChart(92, *common),
            EffortChart(104, *common, lines),
            CurrentChart(104, *common, lines),
            PowerChart(134, *common, lines),
        ]
        return {chart.name: chart for chart in charts}

    def _fit(self) -> None:
        """Give the speed chart the height that suits the window."""
        width = self.browser.window_width
        with pn.io.hold():
            self.charts["speed"].resize(310 if width >= WIDE_PX else 220 if width < NARROW_PX else 250)
            self._show()

    def _sight(self) -> None:
        with pn.io.hold():
            bring_into_sight([*self.charts.values(), self.law, self.sankey], self.browser.charts_in_sight)
            self._settle_axis()

    def _settle_axis(self) -> None:
        if self.state.over_time:
            self.axis.settle("s", 1)
        else:
            self.axis.settle("m", 0)

    def _repair(self, *_: Any) -> None:
        failure = self.state.failure
        if isinstance(failure, TimetableError):
            self.state.scenario.travel_time_s = failure.least_tenth_s

    def redraw(self) -> None:
        """Draw everything again, as after a change of theme."""
        self._show()

    def _show(self, *_: Any) -> None:
        state = self.state
        run, runs = state.run, state.runs
        if run is None or runs is None:
            return
        with pn.io.hold():
            self._show_texts()
            narrow = self.browser.window_width < NARROW_PX
            shown = {name: r for name, r in runs.runs.items() if name in state.ticked or r is run}
            width = max(self.browser.window_width - (NARROW_MARGIN_PX if narrow else MARGIN_PX), LEAST_WIDTH_PX)
            scene = Scene(self.state.chosen_now, shown, state.pinned, state.over_time, narrow, width)
            self.axis.fit(scene.end, roomy=not narrow)
            self.charts["difference"].place.visible = state.pinned is not None
            self.charts["current"].place.visible = run.current_a is not None
            self.law.place.visible = runs.law is not None and not state.over_time
            for chart in self.charts.values():
                chart.show(partial(chart.draw, scene))
            self.law.show(partial(self.law.draw, scene, runs.law))
            self.sankey.show(partial(self.sankey.draw, run, self._column_px(width)))
            self._settle_axis()

    def _column_px(self, width: float) -> float:
        """Return how wide the column of charts is, the rail beside it taken off."""
        return width - RAIL_PX if self.browser.window_width >= WIDE_PX else width

    def _show_texts(self) -> None:
        state = self.state
        run, runs = state.run, state.runs
        assert run is not None
        assert runs is not None
        vehicle = run.scenario.vehicle
        subtitle = f"{words.distance(run.distance_m)} km, {vehicle.name}, {words.load(vehicle.load_factor)}"
        solved = (
            f"solved in {words.number(1e3 * run.solve_time_s)} ms, {run.iterations} iterations, {runs.cell_count} cells"
        )
        self.heading.object = parts.heading(run.scenario.title, subtitle, solved)
        failure = state.failure
        self.message.visible = failure is not None
        self.repair.visible = isinstance(failure, TimetableError)
        if isinstance(failure, TimetableError):
            self.repair.label = f"Use {words.number(failure.least_tenth_s)} s"
        if failure is not None:
            shown = f"Shown: the last good run, {words.number(run.travel_time_s)} s."
            self.message.object = parts.failure(*failure_words(failure), shown)
        self.figures.object = parts.run_figures(runs, run, state.pinned, state.stale)
        self.advice.object = parts.advice(run, state.stale)
        self.account.object = parts.account(run)
        self.runs.object = parts.runs_table(runs, run.strategy, state.pins)
        self.phases.object = parts.phase_table(run)
        self.notes.object = f'<div class="block"><h2>What is proven</h2>{parts.notes(run)}</div>'
