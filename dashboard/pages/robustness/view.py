"""Robustness: what a plan costs when load and place are not as planned, and what chance makes of it."""

from functools import partial
from typing import Any

import numpy as np
import panel as pn
import panel_material_ui as pmui
from panel.viewable import Viewable

from railjoule.core.studies.table import StudyTable
from railjoule.dashboard.charts.chart import Axis, Chart
from railjoule.dashboard.charts.driven import (
    BrakingChart,
    DrivenEffortChart,
    DrivenSpeedChart,
    PositionErrorChart,
    reality_words,
)
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.pages.page import PageView
from railjoule.dashboard.pages.robustness.chance_charts import HistogramChart, LoadScatter, chance_table, finite
from railjoule.dashboard.pages.robustness.compute import Reality
from railjoule.dashboard.pages.robustness.explorer import HEIGHTS as EXPLORER_HEIGHTS
from railjoule.dashboard.pages.robustness.explorer import Explorer
from railjoule.dashboard.pages.robustness.heat_map import (
    MEASURES,
    CostSurface,
    HeatMapChart,
    percent_difference,
    printed_table,
)
from railjoule.dashboard.pages.robustness.robust_section import HEIGHTS as ROBUST_HEIGHTS
from railjoule.dashboard.pages.robustness.robust_section import RobustSection
from railjoule.dashboard.pages.robustness.stop_table import stop_table
from railjoule.dashboard.pages.robustness.work import PAGE, Robustness
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.parts.number_field import tie

HEIGHTS = {
    "heatmap": (350, 440, 320),
    "costs": (410, 470, 270),
    "more": (190, 220, 170),
    "late": (190, 220, 170),
    "scatter": (220, 260, 200),
    "driven_speed": (250, 310, 220),
    "driven_effort": (134, 150, 120),
    "braking": (240, 280, 220),
    "place": (150, 170, 140),
    **ROBUST_HEIGHTS,
    **EXPLORER_HEIGHTS,
}
"""Of each chart [px]: in usual, wide and narrow windows."""
LAYOUT_CSS = """
:host { display: grid; grid-template-columns: minmax(0, 1fr) minmax(0, 1fr); column-gap: 28px;
  padding: 10px 20px 12px 14px; align-items: start; }
@media (max-width: 1099px) { :host { grid-template-columns: minmax(0, 1fr); padding: 8px 12px; } }
"""
KNOWS_WORDS = {
    "none": "nothing",
    "for the load": "load",
    "for the position": "place",
    "for both": "both",
}
SELECT: dict[str, Any] = {"size": "small", "margin": (6, 0, 6, 6), "sizing_mode": "stretch_width"}


class RobustnessView(PageView):
    """The page of what goes otherwise than planned."""

    page = PAGE
    works = (Robustness,)
    heights = HEIGHTS
    # as LAYOUT_CSS has it, which lays out one column up to 1099 px
    halves_from_px = 1100

    def make(self) -> Viewable:
        """Make the pieces of the page, and return them laid out."""
        self.model = model = self.state.robustness
        palette = self.palette
        self.printed, self.chance_table, self.stops = (parts.html_pane() for _ in range(3))
        self.measure = pmui.Select(
            label="Show",
            options={m.words: key for key, m in MEASURES.items()},
            value=model.measure,
            min_width=270,
            **SELECT,
        )
        self.knows = pmui.Select(label="Replanning", options=KNOWS_WORDS, value=model.knows, **SELECT)
        self.ways = pmui.RadioButtonGroup(
            options={"One direction": False, "Both directions": True},
            value=model.both_directions,
            size="small",
            margin=(10, 0, 0, 12),
            sx={"& .MuiToggleButton-root": {"whiteSpace": "nowrap"}},
        )
        self.axis = Axis(palette)
        self.heat_map = HeatMapChart(HEIGHTS["heatmap"][0], palette, self._choose)
        self.costs = CostSurface(HEIGHTS["costs"][0], palette)
        more, late = (
            "Monte Carlo: extra energy against a plan for the actual load, %",
            "Monte Carlo: delay at the stop, s",
        )
        self.more = HistogramChart("more", more, "Extra energy, %", percent_difference, HEIGHTS["more"][0], palette)
        self.late = HistogramChart("late", late, "Delay, s", words.delay, HEIGHTS["late"][0], palette)
        self.scatter = LoadScatter(HEIGHTS["scatter"][0], palette)
        self.speed = DrivenSpeedChart(HEIGHTS["driven_speed"][0], self.axis, palette)
        self.effort = DrivenEffortChart(HEIGHTS["driven_effort"][0], self.axis, palette)
        self.braking = BrakingChart(HEIGHTS["braking"][0], palette)
        self.position_error = PositionErrorChart(HEIGHTS["place"][0], palette)
        hint = f"Click a cell to see its run. {comparisons.MISSED}"
        note = parts.note_paragraphs([hint], "margin:10px 0 0 12px")
        left = parts.stack(
            pn.Row(self.measure, self.ways, margin=0, sizing_mode="stretch_width", stylesheets=[parts.WRAP_CSS]),
            self.heat_map.host,
            pn.Row(self.knows, parts.html_pane(note), margin=0, sizing_mode="stretch_width"),
            self.costs.host,
            self.stops,
            self.printed,
        )
        right = parts.stack(self.speed.host, self.effort.host, self.braking.host, self.position_error.host)
        upper = parts.stack(left, right, css=LAYOUT_CSS)
        lower = parts.stack(
            parts.stack(self.more.host, self.scatter.host),
            parts.stack(self.late.host, self.chance_table),
            css=LAYOUT_CSS,
        )
        self.robust = RobustSection(self.axis, palette, LAYOUT_CSS)
        self.explorer = Explorer(self.state, self._take_charts)
        tie(self.measure, model, "measure")
        tie(self.knows, model, "knows")
        tie(self.ways, model, "both_directions")
        self.shows(self._show_run, (model, ["reality", "failure"]))
        self.shows(self._show_table, (model, ["table", "measure"]))
        self.shows(self._show_chance, (model, ["chance", "drawing"]))
        self.shows(self._show_stops, (model, ["stops"]))
        self.shows(lambda: self.robust.show(self.model.robust), (model, ["robust"]))
        self.shows(self.explorer.follow, (model, ["chance", "drawing"]))
        return parts.stack(self.heading, self.message, self.figures, upper, lower, self.robust.view, self.explorer.view)

    @property
    def charts(self) -> tuple[Chart, ...]:
        """All charts of the page."""
        return (
            self.heat_map,
            self.costs,
            self.more,
            self.late,
            self.scatter,
            self.speed,
            self.effort,
            self.braking,
            self.position_error,
            *self.robust.charts,
            *self.explorer.charts,
        )

    def _take_charts(self) -> None:
        """Lead the charts that have come, and no longer those that have gone."""
        self.queue.take(self.charts)
        self._fit()

    def _choose(self, load_factor: float, error_m: float) -> None:
        self.state.day.param.update(actual_load_percent=100 * load_factor, coordinate_error_m=error_m)

    def settle(self) -> None:
        """Tell the cursor of the runs that it may meet new charts."""
        self.axis.settle("m", 0)

    def _show_run(self) -> None:
        reality = self.model.reality
        self.tell(self.model.failure, "Shown: the last run that could be computed." if reality is not None else "")
        if reality is None:
            return
        following = reality.following
        disturbance = following.actual.scenario.disturbance
        self.axis.fit(max(following.planned.position_m[-1], following.actual.position_m[-1]), roomy=False)
        name = reality_words(disturbance.actual_load_factor or 0.0, disturbance.coordinate_error_m)
        self.speed.show(partial(self.speed.draw, following, name))
        self.effort.show(partial(self.effort.draw, following))
        self.braking.show(partial(self.braking.draw, following))
        simulation = following.planned.scenario.simulation
        # sensors reset the position only under the target curve; without them and an error of speed it stays as it is
        self.position_error.host.visible = simulation.target_braking or simulation.speed_error != 0
        self.position_error.show(partial(self.position_error.draw, following))
        self._draw_map()
        self._show_texts()

    def _show_table(self) -> None:
        table = self.model.table
        if table is None or self.model.reality is None:
            return
        self._draw_map()
        if table.done < table.energy_kwh.size:
            self.costs.wait(f"Computing, {table.done} of {table.energy_kwh.size} runs")
            return
        measure = MEASURES[self.model.measure]
        if np.any(np.isfinite(measure.drawn(table))):
            self.costs.show(partial(self.costs.draw, table, measure))
        self.printed.object = printed_table(table, measure)
        self._show_texts()

    def _draw_map(self) -> None:
        """Draw the map of the table with the run's cell framed."""
        table, reality = self.model.table, self.model.reality
        if table is not None and reality is not None:
            disturbance = reality.following.actual.scenario.disturbance
            framed = disturbance.actual_load_factor or 0.0, disturbance.coordinate_error_m
            self.heat_map.show(partial(self.heat_map.draw, table, MEASURES[self.model.measure], *framed))

    def _show_chance(self) -> None:
        chance = self.model.chance
        if chance is None:
            return
        self.more.show(partial(self.more.draw, 100 * chance.over_replanned))
        self.late.show(partial(self.late.draw, chance.delay_s))
        self.scatter.show(partial(self.scatter.draw, chance))
        self._show_texts()
        self.chance_table.object = f"{chance_table(chance)}{parts.note_paragraphs(chance.notes)}"

    def _show_stops(self) -> None:
        if self.model.stops is not None:
            self.stops.object = stop_table(self.model.stops)

    def _show_texts(self) -> None:
        reality = self.model.reality
        if reality is None:
            return
        planned = reality.following.planned
        scenario = planned.scenario
        runs = self.model.table.done if self.model.table else 0
        braking = ", braking along the target curve" if scenario.simulation.target_braking else ""
        what = (
            f"{words.distance(planned.distance_m)} km in {words.time(planned.travel_time_s)} s, planned at "
            f"{words.setting(scenario.vehicle.load_factor)} % load{braking}; actual load and position differ"
        )
        self.heading.object = parts.heading(self.page, scenario.title, what, f"{runs} cells")
        self.figures.object = parts.figures(self._cells(reality), self.model.failure is not None)

    def _cells(self, reality: Reality) -> list[str]:
        following = reality.following
        energy, planned = following.actual.energy_kwh, following.planned.energy_kwh
        disturbance = following.actual.scenario.disturbance
        reference = planned if reality.replanned_kwh is None else reality.replanned_kwh
        missed = following.delay_s, following.stop_error_m
        false = comparisons.is_false_saving(energy, planned, *missed)
        against = "planned" if reality.replanned_kwh is None else "for the actual load"
        detail = f"{words.energy(energy)} kWh, {against} {words.energy(reference)}"
        amount, detail = comparisons.headline(energy, reference, *missed, detail)
        cells: list[str] = [
            parts.figure(
                reality_words(disturbance.actual_load_factor or 0.0, disturbance.coordinate_error_m).capitalize(),
                *amount,
                detail,
                "main",
                term="Extra energy",
            ),
            parts.figure(
                "Against the plan",
                words.energy_difference(energy - planned),
                "kWh",
                f"{'' if false else f'{comparisons.above(energy, planned)}, '}planned {words.energy(planned)}",
            ),
            parts.figure("Arrival", words.delay(following.delay_s), "s", "at the end"),
            parts.figure("Overshoot", words.stop_error(following.stop_error_m), "m", "beyond the stop"),
        ]
        table = self.model.table
        if table is not None and np.any(np.isfinite(table.over_replanned)):
            k, m = np.unravel_index(np.nanargmax(table.over_replanned), table.over_replanned.shape)
            worst = words.share_difference(float(table.over_replanned[k, m]))
            place = reality_words(table.load_factor[k], table.coordinate_error_m[m])
            cells.append(parts.figure("Largest in table", worst, "%", place))
        chance = self.model.chance
        return cells if chance is None else [*cells, *chance_figures(chance)]


def chance_figures(chance: StudyTable) -> list[str]:
    """Return what half of the runs drawn cost at most, and what nineteen of twenty do."""
    values = finite(chance.over_replanned)
    if not len(values):
        return []
    half, most = (float(np.quantile(values, share)) for share in (0.5, 0.95))
    return [
        parts.figure("Median", _at_most(half), "%", _unless_missed(half, f"of {words.number(chance.done, 0)} drawn")),
        parts.figure(
            "95th percentile", _at_most(most), "%", _unless_missed(most, f"seed {chance.scenario.montecarlo.seed}")
        ),
    ]


# so many runs need less by arriving late or missing the stop, which is no saving to tell
def _at_most(share: float) -> str:
    return f"< {words.share_difference(share)}" if share >= 0 else words.UNKNOWN


def _unless_missed(share: float, detail: str) -> str:
    return detail if share >= 0 else "less, with a miss"
