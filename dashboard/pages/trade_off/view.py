"""Trade-off: the energy-time frontier with the present run on it, and ENOC's energy over its acceleration time."""

from typing import Any

import numpy as np
import panel_material_ui as pmui
from panel.viewable import Viewable

from railjoule.core import Trajectory
from railjoule.core.strategies.enoc import best_acceleration_time, enoc_energy
from railjoule.core.units import J_PER_KWH, MS_PER_KMH
from railjoule.core.validation.ftorek_runs import TABLE_3_COPPER_WEIGHT
from railjoule.dashboard.charts.chart import Chart
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.look.tokens import NARROW_PX
from railjoule.dashboard.pages.page import PageView
from railjoule.dashboard.pages.trade_off.charts import (
    ContourChart,
    FrontierChart,
    ShareChart,
    best_enoc_kwh,
    printed_points,
)
from railjoule.dashboard.pages.trade_off.compute import TradeOff
from railjoule.dashboard.pages.trade_off.surface import SurfacePane
from railjoule.dashboard.pages.trade_off.work import Frontiers
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.state.workbench import Workbench

HEIGHTS = {
    "frontier": (330, 450, 280),
    "share": (110, 150, 110),
    "surface": (400, 500, 330),
    "contour": (330, 380, 260),
}
"""Of each chart [px]: in usual, wide and narrow windows."""
LAYOUT_CSS = """
:host { display: grid; grid-template-columns: minmax(0, 1fr) minmax(0, 1fr); column-gap: 28px;
  padding: 10px 20px 12px 14px; align-items: start; }
:host(.rj-single) { grid-template-columns: minmax(0, 1fr); }
@media (max-width: 899px) { :host { grid-template-columns: minmax(0, 1fr); padding: 8px 12px; } }
"""
MAPS = {
    "Real timetables": (False, 1.0),
    "Up to 5000 s, copper loss that fits Table 2": (True, 1.0),
    "Up to 5000 s, 3.087 times that: Table 3, Figure 6a": (True, TABLE_3_COPPER_WEIGHT),
}
"""What ENOC's map may show: up to 5000 s or not, and the copper loss over the vehicle's own."""


def map_of(state: Workbench) -> tuple[bool, float]:
    """Return which of the maps the state names; the one of that reach where it names another weight."""
    now = state.wide_map, state.copper_weight
    return now if now in MAPS.values() else (state.wide_map, 1.0)


class TradeOffView(PageView):
    """The page of the trade-off."""

    page = "Trade-off"
    works = (Frontiers,)
    heights = HEIGHTS
    # in narrower windows LAYOUT_CSS has one column
    halves_from_px = NARROW_PX

    def make(self) -> Viewable:
        """Make the pieces of the page, and return them laid out."""
        state, palette = self.state, self.palette
        self.table, self.notes = (parts.html_pane() for _ in range(2))
        self.frontier = FrontierChart(HEIGHTS["frontier"][0], state, palette)
        self.share = ShareChart(HEIGHTS["share"][0], self.frontier.x_range, palette)
        self.surface = SurfacePane(HEIGHTS["surface"][0], palette)
        self.contour = ContourChart(HEIGHTS["contour"][0], palette)
        self.map = pmui.Select(
            label="ENOC's map",
            options=MAPS,
            value=map_of(state),
            size="small",
            margin=(6, 0, 8, 6),
            sizing_mode="stretch_width",
            max_width=360,
            visible=False,
        )
        self.left = parts.stack(self.frontier.host, self.share.host, self.table)
        self.right = parts.stack(self.map, self.surface.host, self.contour.host)
        self.body = parts.stack(self.left, self.right, css=LAYOUT_CSS)
        self.map.param.watch(self._choose_map, "value")
        state.param.watch(self._follow_map, ["wide_map", "copper_weight"])
        self.shows(self._show_failure, (state, ["failure", "runs"]))
        self.shows(self._show, (state, ["trade_off", "runs"]))
        return parts.stack(self.heading, self.message, self.figures, self.notes, self.body)

    def _choose_map(self, event: Any) -> None:
        wide, weight = event.new
        self.state.param.update(wide_map=wide, copper_weight=weight)

    def _follow_map(self, *_: Any) -> None:
        self.map.value = map_of(self.state)

    @property
    def charts(self) -> tuple[Chart, ...]:
        """All charts of the page."""
        return self.frontier, self.share, self.surface, self.contour

    def _show_failure(self) -> None:
        run = self.state.run
        shown = "" if run is None else f"Shown: the last valid run, {words.number(run.travel_time_s)} s."
        self.tell(self.state.failure, shown)

    def _show(self) -> None:
        trade_off, runs = self.state.trade_off, self.state.runs
        if trade_off is None or runs is None:
            return
        # not the chosen one: the frontier is that of the optima
        run = runs.best
        now = self._present(trade_off, run.travel_time_s)
        self._show_texts(trade_off, run, now)
        plain = trade_off.enoc_map is not None
        self.map.visible = self.right.visible = self.share.host.visible = plain
        self.body.css_classes = [] if plain else ["rj-single"]
        self.frontier.show(lambda: self.frontier.draw(trade_off, run))
        if not plain:
            return
        self.share.show(lambda: self.share.draw(trade_off, run))
        self.surface.show(
            lambda: self.surface.draw(trade_off.enoc_map, now, printed_points(trade_off, everywhere=True))
        )
        self.contour.show(lambda: self.contour.draw(trade_off, now))

    def _present(self, trade_off: TradeOff, time: float) -> tuple[float, float, float] | None:
        """Return travel time [s], acceleration time [s] and energy [kWh] of the present ENOC run."""
        if trade_off.coefficients is None:
            return None
        ramp = self.state.scenario.acceleration_time_s or best_acceleration_time(trade_off.coefficients, time)
        return time, ramp, float(enoc_energy(trade_off.coefficients, time, ramp)) / J_PER_KWH

    def _show_texts(self, trade_off: TradeOff, run: Trajectory, now: tuple[float, float, float] | None) -> None:
        frontier = trade_off.frontier
        solved = f"{len(frontier.travel_time_s)} optima in {words.number(1e3 * self.state.trade_off_duration_s, 0)} ms"
        self.heading.object = parts.heading(
            self.page,
            run.scenario.title,
            "energy against travel time" + ("; ENOC over its acceleration time" if now else ""),
            solved,
        )
        self.figures.object = parts.figures(self._cells(trade_off, run, now))
        refusal = enoc_refusal(trade_off, run.travel_time_s)
        sentences = [*frontier.notes, *([refusal] if refusal else [])]
        self.notes.object = parts.note_paragraphs(sentences, "margin:8px 20px 0")
        self.table.object = self._table(trade_off, run, now)

    def _cells(self, trade_off: TradeOff, run: Trajectory, now: tuple[float, float, float] | None) -> list[str]:
        frontier = trade_off.frontier

        def changed(factor: float, label: str) -> str:
            then = factor * run.travel_time_s
            if then < frontier.shortest_travel_time_s:
                return parts.figure(
                    label, words.UNKNOWN, "", f"no train can, in {words.time(then)} s", term="Change of time"
                )
            # the frontier's mesh may be coarser than that of the run: its differences are what counts
            more_kwh = frontier.energy_kwh_at(then) - frontier.energy_kwh_at(run.travel_time_s)
            if not np.isfinite(more_kwh):
                return parts.figure(
                    label, words.UNKNOWN, "", f"not known in {words.time(then)} s", term="Change of time"
                )
            value = run.energy_kwh + more_kwh
            more = comparisons.above(value, run.energy_kwh)
            return parts.figure(
                label, *more, f"{words.energy(value)} kWh at {words.time(then)} s", term="Change of time"
            )

        asked, waiting = comparisons.time_asked(run), comparisons.waiting_of(run)
        detail = f"{asked}: {waiting}" if waiting else asked or f"for {words.distance(run.distance_m)} km"
        if now:
            detail = f"ENOC {words.energy(now[2])} kWh, {comparisons.above(now[2], run.energy_kwh)}"
        optimum = "Optimum" if run.is_proven else words.strategy(run.strategy)
        cells = [
            parts.figure(
                f"{optimum} at {words.time(run.travel_time_s)} s",
                words.energy(run.energy_kwh),
                "kWh",
                detail,
                "main",
                term="Energy from the supply",
            ),
            parts.price_figure(run, run),
            changed(1.1, "10 % more time"),
            changed(0.9, "10 % less time"),
        ]
        if trade_off.coefficients is not None:
            best = best_acceleration_time(trade_off.coefficients, run.travel_time_s)
            cells.append(
                parts.figure(
                    "Best acceleration time", words.time(best), "s", f"ENOC at {words.time(run.travel_time_s)} s"
                )
            )
        return cells

    def _table(self, trade_off: TradeOff, run: Trajectory, now: tuple[float, float, float] | None) -> str:
        rows: list[tuple[tuple[str, ...], bool]] = [
            (
                (
                    parts.swatch("optimal") + "Optimal",
                    words.energy(run.energy_kwh),
                    comparisons.NOTHING.cell,
                    words.number(run.max_speed_kmh),
                    "\u2013",
                ),
                True,
            )
        ]

        coefficients, time = trade_off.coefficients, run.travel_time_s

        def enoc_row(name: str, ramp: float, energy: float) -> tuple[tuple[str, ...], bool]:
            assert coefficients is not None
            peak = float(coefficients.cruise_speed_ms(time, ramp)) / MS_PER_KMH
            cells = (
                parts.swatch("enoc") + name,
                words.energy(energy),
                comparisons.above(energy, run.energy_kwh).cell,
                words.number(peak),
                words.time(ramp),
            )
            return cells, False

        if coefficients is not None and now is not None:
            best = best_acceleration_time(coefficients, time)
            rows.append(enoc_row("ENOC, best", best, best_enoc_kwh(trade_off, time)))
            # nearer, both times would read the same in tenths
            if abs(now[1] - best) > 0.05:
                rows.append(enoc_row("ENOC, as set", now[1], now[2]))
            times, ramps, energies = printed_points(trade_off)
            for k in np.flatnonzero(np.abs(times - time) < 0.05):
                rows.append(enoc_row("ENOC as printed", float(ramps[k]), float(energies[k])))
        header = ("Strategy", "kWh", "above optimal, %", "top, km/h", "accelerates, s")
        return parts.inset(parts.table(f"At {words.time(time)} s", header, rows))


def enoc_refusal(trade_off: TradeOff, time: float) -> str:
    """Return why ENOC cannot be driven in a travel time [s], in one sentence; empty if it can."""
    if trade_off.enoc is None:
        return f"ENOC {trade_off.refusal}"
    nearest = float(trade_off.frontier.travel_time_s[np.argmin(np.abs(trade_off.frontier.travel_time_s - time))])
    reason = dict(trade_off.enoc.refused).get(nearest)
    sentence = f"ENOC is drawn without the vehicle\u2019s limits here: for {words.time(nearest)} s it {reason}"
    return sentence if reason else ""
