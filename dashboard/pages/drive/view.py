"""Drive: one run, its numbers, the advice to its driver, and the charts that explain it."""

from functools import partial
from typing import Any

import panel as pn
import panel_material_ui as pmui
from panel.viewable import Viewable

from railjoule.core import TimetableError, Trajectory
from railjoule.core.simulation.actual_run import ActualRun
from railjoule.dashboard.charts.chart import Axis, Chart
from railjoule.dashboard.charts.run_charts import (
    CurrentChart,
    DifferenceChart,
    EffortChart,
    EnergyChart,
    LineStrip,
    PhaseStrip,
    power_chart,
)
from railjoule.dashboard.charts.scene import RunScene, SceneChart
from railjoule.dashboard.charts.speed import SpeedChart
from railjoule.dashboard.look import words
from railjoule.dashboard.look.tokens import NARROW_PX, WIDE_PX
from railjoule.dashboard.pages.drive.actual_parts import actual_figures, belongs_to, causes_block, is_same_plan
from railjoule.dashboard.pages.drive.actual_work import Actual
from railjoule.dashboard.pages.drive.law_chart import LawChart
from railjoule.dashboard.pages.drive.price_chart import PriceChart
from railjoule.dashboard.pages.drive.proof_row import ProofRow
from railjoule.dashboard.pages.drive.proof_work import Proving
from railjoule.dashboard.pages.drive.sankey import SankeyChart
from railjoule.dashboard.pages.drive.simple_section import SimpleSection
from railjoule.dashboard.pages.drive.simple_work import SimpleAdvising
from railjoule.dashboard.pages.page import PageView
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.parts.choices import over_time_buttons
from railjoule.dashboard.work.runs import Runs

HEIGHTS = {
    "speed": (250, 310, 220),
    "phases": (26, 26, 26),
    "price": (120, 120, 120),
    "line": (104, 104, 104),
    "energy": (140, 140, 140),
    "difference": (92, 92, 92),
    "effort": (104, 104, 104),
    "current": (104, 104, 104),
    "power": (134, 134, 134),
    "law": (180, 180, 180),
    "sankey": (300, 300, 340),
    "orders": (190, 190, 190),
}
"""Of each chart [px]: in usual, wide and narrow windows."""
MARGIN_PX, NARROW_MARGIN_PX, LEAST_WIDTH_PX = 400, 40, 300
"""What stands beside the charts, and how wide they are at least."""
# the second column of LAYOUT_CSS, 330 px, and the gap of 20 px before it
RAIL_PX = 350
NO_CURRENT = (
    '<p class="note" style="padding:6px 8px">The current needs the voltage of the line: set it under Edit scenario, '
    "Vehicle.</p>"
)
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


class DriveView(PageView):
    """The page of one run."""

    page = "Drive"
    works = (
        Actual,
        Proving,
        SimpleAdvising,
    )
    heights = HEIGHTS
    rail_px = RAIL_PX

    def make(self) -> Viewable:
        """Make the pieces of the page, and return them laid out."""
        self.repair = pmui.Button(
            label="", variant="text", size="small", margin=(0, 20), visible=False, on_click=self._repair
        )
        self.advice = parts.html_pane()
        self.proof = ProofRow(self.state)
        self.account, self.runs, self.phases, self.notes = (parts.html_pane() for _ in range(4))
        self.over = over_time_buttons(self.state, margin=(8, 20, 0, 0))
        self.axis = Axis(self.palette)
        self.scenes = self._scene_charts()
        rail = parts.stack(self.account, self.runs, self.phases, self.notes, css=RAIL_CSS)
        self.law = LawChart(HEIGHTS["law"][0], self.axis, self.palette)
        self.sankey = SankeyChart(HEIGHTS["sankey"][0], self.palette)
        for name in ("difference", "current", "price"):
            self.scenes[name].host.visible = False
        self.law.host.visible = False
        self.causes = parts.html_pane(visible=False)
        self.no_current = parts.html_pane(NO_CURRENT, visible=False)
        self.simple = SimpleSection(self.state, HEIGHTS["orders"][0], self.palette)
        column = parts.stack(*(self._beside(chart) for chart in self.charts if chart is not self.simple.chart))
        body = parts.stack(column, rail, css=LAYOUT_CSS)
        tools = pn.Row(self.advice, self.over, margin=0, sizing_mode="stretch_width", stylesheets=[TOOLS_CSS])
        self.shows(self._show_failure, (self.state, ["failure", "runs"]), (self.state.day, ["on", "failure", "run"]))
        self.shows(
            self._show_run,
            (self.state, ["runs", "chosen", "ticked", "pins", "over_time"]),
            (self.state.day, ["on", "run", "failure"]),
        )
        self.shows(
            self._show_proof,
            (self.state, ["runs", "chosen", "pins", "tightened"]),
            (self.state.proof, ["stage", "step", "failure", "has_prices_open"]),
            (self.state.day, ["on", "run", "failure"]),
        )
        self.shows(self.simple.show, (self.state.simple, ["open", "computing", "found", "stale", "changes", "failure"]))
        self.shows(
            self.simple.show_beside_runs,
            (self.state, ["runs", "pins"]),
            (self.state.simple, ["found", "stale", "changes"]),
        )
        top = (self.heading, self.message, self.repair, self.figures, self.proof.view)
        return parts.stack(*top, tools, self.simple.view, body)

    def _beside(self, chart: Chart) -> Viewable:
        """Return a chart with what belongs to it."""
        if chart.name == "energy":
            return parts.stack(chart.host, self.causes)
        return parts.stack(chart.host, self.no_current) if chart.name == "current" else chart.host

    def _scene_charts(self) -> dict[str, SceneChart]:
        common = (self.axis, self.palette)
        charts: list[SceneChart] = [
            SpeedChart(HEIGHTS["speed"][0], *common),
            PhaseStrip(HEIGHTS["phases"][0], *common),
            PriceChart(HEIGHTS["price"][0], *common),
            LineStrip(HEIGHTS["line"][0], *common),
            CurrentChart(HEIGHTS["current"][0], *common),
            EnergyChart(HEIGHTS["energy"][0], *common),
            DifferenceChart(HEIGHTS["difference"][0], *common),
            EffortChart(HEIGHTS["effort"][0], *common),
            power_chart(HEIGHTS["power"][0], *common),
        ]
        return {chart.name: chart for chart in charts}

    @property
    def charts(self) -> tuple[Chart, ...]:
        """All charts of the page, in the order in which they are read."""
        return self.simple.chart, *self.scenes.values(), self.law, self.sankey

    def settle(self) -> None:
        """Tell the cursor of the runs that it may meet new charts."""
        self.axis.settle_over(self.state.over_time)

    def _repair(self, *_: Any) -> None:
        failure = self.state.failure
        if isinstance(failure, TimetableError):
            self.state.scenario.travel_time_s = failure.min_tenth_s

    def _show_failure(self) -> None:
        """Say why there is no run as asked for, and offer what mends it."""
        run, failure = self.state.run, self.state.failure
        shown = "" if run is None else f"Shown: the last valid run, {words.number(run.travel_time_s)} s."
        actual = self.state.day
        if failure is None and actual.on and actual.failure is not None:
            self.tell(actual.failure, "Shown: the plan.")
        else:
            self.tell(failure, shown)
        self.repair.visible = isinstance(failure, TimetableError)
        if isinstance(failure, TimetableError):
            self.repair.label = f"Use {words.number(failure.min_tenth_s)} s"

    def _show_run(self) -> None:
        state = self.state
        run, runs = state.run, state.runs
        if run is None or runs is None or self._waits(run):
            return
        actual = self._actual()
        # under target braking curves the actual run has a plan of its own
        if actual is not None and not is_same_plan(actual, run):
            run = actual.planned
        self._show_texts(run, runs, actual)
        narrow = self.browser.window_width < NARROW_PX
        shown = {name: r for name, r in runs.runs.items() if name in state.ticked}
        shown[state.chosen_now] = run
        width = max(self.browser.window_width - (NARROW_MARGIN_PX if narrow else MARGIN_PX), LEAST_WIDTH_PX)
        fastest = runs.runs.get("fastest")
        scene = RunScene(state.chosen_now, shown, state.pinned, state.over_time, narrow, width, actual, fastest)
        # narrow windows have no names at the ends of lines, for which the room would be
        self.axis.fit(scene.end, roomy=not narrow)
        self.scenes["difference"].host.visible = state.pinned is not None
        self.scenes["current"].host.visible = CurrentChart.knows(run)
        self.no_current.visible = not CurrentChart.knows(run)
        # a picture has even steps: those over places would be uneven over time
        law = None if state.over_time else runs.law
        self.law.host.visible = law is not None
        # each with the scene of now: a chart out of sight draws later, when the state may name another one
        for chart in self.scenes.values():
            chart.show(partial(chart.draw, scene))
        if law is not None:
            self.law.show(partial(self.law.draw, scene, law))
        self.sankey.show(partial(self.sankey.draw, run, self._column_px(width)))

    def _show_proof(self) -> None:
        """Show what changes with the bound alone."""
        run, runs = self.state.run, self.state.runs
        if run is None or runs is None or self._waits(run):
            return
        actual = self._actual()
        if actual is None:
            self.figures.object = parts.run_figures(runs, run, self.state.pinned, stale=False)
        elif not is_same_plan(actual, run):
            run = actual.planned
        # the bound of a plan stands below its numbers, where the actual run has none
        notes = parts.notes(run) if actual is not None else parts.note_paragraphs(run.all_notes)
        self.notes.object = parts.markup('<div class="block"><h2>Notes</h2>{}</div>', notes) if notes else ""
        self.scenes["price"].host.visible = self.state.proof.has_prices_open and PriceChart.is_known(run)
        self.proof.show(run, hidden=actual is not None)

    def _column_px(self, width: float) -> float:
        """Return how wide the column of charts is, the rail beside it taken off."""
        return width - RAIL_PX if self.browser.window_width >= WIDE_PX else width

    def _actual(self) -> ActualRun | None:
        """Return the actual run to draw; none where it is switched off or cannot be had."""
        model = self.state.day
        return model.run if model.on and model.failure is None else None

    def _waits(self, run: Trajectory) -> bool:
        """Return whether the actual run of a plan is still to come: what stands there stays until then."""
        model = self.state.day
        if not model.on or model.failure is not None:
            return False
        return model.run is None or not belongs_to(model.run, run)

    def _show_texts(self, run: Trajectory, runs: Runs, actual: ActualRun | None) -> None:
        state = self.state
        vehicle = run.scenario.vehicle
        subtitle = words.subtitle(run.distance_m, vehicle.name, vehicle.load_factor)
        cells = len(run.nodes_m) - 1
        solved = f"solved in {words.number(1e3 * run.solve_time_s)} ms, {run.iterations} iterations, {cells} cells"
        self.heading.object = parts.heading(self.page, run.scenario.title, subtitle, solved)
        self.causes.visible = actual is not None
        if actual is not None:
            self.figures.object = actual_figures(actual, runs, state.run or run)
            self.causes.object = causes_block(actual)
        self.advice.object = parts.advice(run, stale=False)
        self.account.object = parts.account(run)
        self.runs.object = parts.runs_table(runs, run.strategy, state.pins)
        self.phases.object = parts.phase_table(run)
