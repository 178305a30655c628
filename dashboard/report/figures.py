"""The report's figures: those of the page, drawn once, with what a browser needs to repaint and to move them."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from bokeh.document import Document

from railjoule.core import Trajectory
from railjoule.core.simulation.field_oriented import FieldOrientedRun
from railjoule.dashboard.charts.chart import Axis, Chart, DistanceChart
from railjoule.dashboard.charts.driven import DrivenEffortChart, DrivenSpeedChart
from railjoule.dashboard.charts.run_charts import (
    CurrentChart,
    EffortChart,
    EnergyChart,
    LineStrip,
    PhaseStrip,
    power_chart,
)
from railjoule.dashboard.charts.run_lines import RunLines
from railjoule.dashboard.charts.scene import RunScene, SceneChart
from railjoule.dashboard.charts.speed import SpeedChart
from railjoule.dashboard.library_workarounds import document_json
from railjoule.dashboard.look import words
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.tokens import THEMES
from railjoule.dashboard.report.findings import Findings
from railjoule.dashboard.report.frontier import TimeChart
from railjoule.dashboard.report.surfaces import surfaces_of

WIDTH_PX = 640
"""Words are left out that have no room in figures of this width, about that of a printed page."""
COLOUR_COLUMNS = ("colour", "fill", "ink")


@dataclass(frozen=True)
class Plot:
    """One figure in the file: the place where it goes, its caption, and what it shows in words."""

    name: str
    place: str
    height: int
    caption: str
    alternative: str


class Figures:
    """All figures of a report, in light colours, and what is needed to change them."""

    def __init__(self, findings: Findings) -> None:
        self.findings = findings
        self.palette = Palette(dark=False)
        self.surfaces = surfaces_of(findings)
        has = findings.contents.has
        self.groups: dict[str, list[DistanceChart]] = {
            "runs": self._run_charts() if has("result") else [],
            "frontier": self._frontier() if has("trade-off") else [],
            "reality": self._reality() if has("reality") else [],
        }
        charts = [chart for group in self.groups.values() for chart in group]
        self.document = Document()
        # the library searches the document at each root; frozen, it does so once
        with self.document.models.freeze():
            for chart in charts:
                if chart.figure is not None:
                    chart.figure.html_attributes = {"role": "figure", "aria-label": self.alternative(chart)}
                assert chart.content is not None
                self.document.add_root(chart.content.object)
        # before the charts are drawn in other colours and over other times, which the file has as data
        self.docs, self.item = document_json(self.document)
        # the roots stand there in the order in which they were added
        # without figures there are no roots
        roots = self.item.to_json().get("roots", {}).values()
        self.places: dict[Chart, str] = dict(zip(charts, roots, strict=True))

    # ---- drawing

    def _run_charts(self) -> list[DistanceChart]:
        axis, run = Axis(self.palette), self.findings.run
        common = (axis, self.palette)
        charts: list[SceneChart] = [
            SpeedChart(270, *common),
            PhaseStrip(26, *common),
            LineStrip(104, *common),
            EnergyChart(160, *common),
            EffortChart(120, *common),
            *([CurrentChart(120, *common)] if run.current_a is not None else []),
            power_chart(150, *common),
        ]
        scene = self._scene()
        axis.fit(scene.end, roomy=True)
        for chart in charts:
            chart.build()
        self._draw(charts)
        axis.settle("m", 0)
        return list(charts)

    def _scene(self) -> RunScene:
        runs = self.findings.runs.runs
        chosen = next(name for name, run in runs.items() if run is self.findings.run)
        return RunScene(
            chosen, runs, None, over_time=False, narrow=False, width_px=WIDTH_PX, fastest=runs.get("fastest")
        )

    def _draw(self, charts: Iterable[DistanceChart]) -> None:
        scene = self._scene()
        for chart in charts:
            if isinstance(chart, SceneChart):
                chart.draw(scene)

    def _frontier(self) -> list[DistanceChart]:
        findings = self.findings
        if len(findings.optima) < 2:
            return []
        axis = Axis(self.palette)
        chart = TimeChart(300, axis, self.palette)
        chart.build()
        self._draw_frontier(chart)
        axis.settle("s", 1)
        return [chart]

    def _draw_frontier(self, chart: TimeChart) -> None:
        findings = self.findings
        chart.draw(findings.optima, findings.runs.runs, findings.runs.runs["optimal"])

    def _reality(self) -> list[DistanceChart]:
        reality = self.findings.reality
        if reality is None:
            return []
        axis = Axis(self.palette)
        axis.fit(max(run.position_m[-1] for run in (reality.planned, reality.actual)), roomy=False)
        speed, effort = DrivenSpeedChart(220, axis, self.palette), DrivenEffortChart(130, axis, self.palette)
        for chart in (speed, effort):
            chart.build()
        self._draw_reality(speed, effort)
        axis.settle("m", 0)
        return [speed, effort]

    def _draw_reality(self, speed: DistanceChart, effort: DistanceChart) -> None:
        assert isinstance(speed, DrivenSpeedChart)
        assert isinstance(effort, DrivenEffortChart)
        # all kinds of reality have the two runs that these charts draw
        reality: Any = self.findings.reality
        in_closed_loop = isinstance(reality, FieldOrientedRun)
        speed.draw(reality, "in closed loop" if in_closed_loop else "under the disturbance")
        effort.draw(reality)

    # ---- words

    def alternative(self, chart: DistanceChart) -> str:
        """Return in words what a figure shows."""
        if isinstance(chart, SceneChart):
            return chart.alternative(self._scene())
        if isinstance(chart, TimeChart):
            first, last = self.findings.optima[0], self.findings.optima[-1]
            return (
                f"Least energy over travel time: {words.energy(first.energy_kwh)} kWh at "
                f"{words.number(first.travel_time_s)} s, {words.energy(last.energy_kwh)} kWh at "
                f"{words.number(last.travel_time_s)} s; a table follows."
            )
        return f"{chart.caption}, over distance, as planned and as driven."

    def plots(self, group: str) -> list[Plot]:
        """Return the figures of a group in their order."""
        return [
            Plot(chart.name, self.places[chart], chart.height, chart.caption, self.alternative(chart))
            for chart in self.groups[group]
        ]

    # ---- what a browser needs

    def embedding(self) -> dict[str, Any]:
        """Return what Bokeh's own script needs to build the figures."""
        return {"docs": self.docs, "items": [self.item.to_json()]}

    def paints(self) -> dict[str, Any]:
        """Return how the figures change with the theme: attributes by token, and columns of colours."""
        # colours in columns follow no token of the theme: they are drawn in both, and both go into the file
        light = self._colour_columns()
        self.palette.switch(dark=True)
        self._draw_all()
        dark = self._colour_columns()
        self.palette.switch(dark=False)
        return {
            "tokens": THEMES,
            "worn": [[model.id, attribute, token] for model, attribute, token in self.palette.worn],
            "columns": [[*key, light[key], dark[key]] for key in light],
        }

    def _draw_all(self) -> None:
        self._draw(self.groups["runs"])
        for chart in self.groups["frontier"]:
            assert isinstance(chart, TimeChart)
            self._draw_frontier(chart)
        if self.groups["reality"]:
            self._draw_reality(*self.groups["reality"])

    def _colour_columns(self) -> dict[tuple[str, str], list[str]]:
        return {
            (source.id, column): list(source.data[column])
            for chart in self.places
            for source in chart.sources.values()
            for column in COLOUR_COLUMNS
            if column in source.data and len(source.data[column])
        }

    def handles(self) -> dict[str, Any]:
        """Return the models that move with the travel time, by the names of their charts."""
        return {
            chart.name: {
                "figure": chart.figure.id,
                "caption": chart.told["caption"].id,
                "range": chart.y_range.id,
                "fits": isinstance(chart, SceneChart) and chart.fits,
                "room": chart.form.room if isinstance(chart, RunLines) else 0.0,
                "names": chart.names_in if isinstance(chart, SceneChart) else "names",
                "lines": self._lines(chart),
                "sources": {name: source.id for name, source in chart.sources.items()},
            }
            for group in self.groups.values()
            for chart in group
            if chart.figure is not None
        }

    @property
    def optimum(self) -> str:
        """The source of the optimum, whose columns all charts over the distance draw; empty without such charts."""
        charts = self.groups["runs"]
        return str(charts[0].axis.columns("optimal").source.id) if charts else ""

    def _lines(self, chart: DistanceChart) -> list[tuple[str, str]]:
        """Return source and column of all lines that a chart shows."""
        shown = []
        if isinstance(chart, RunLines):
            shown = [(drawn.data_source.id, chart.quantity.name) for drawn in chart.renderers.values() if drawn.visible]
        return shown + [(chart.sources[name].id, "y") for name in ("largest",) if name in chart.sources]

    def names_of(self, optima: Sequence[Trajectory]) -> list[dict[str, dict[str, list[object]]]]:
        """Return for each optimum the columns of the names in the charts of speed and energy, by chart."""
        charts = [chart for chart in self.groups["runs"] if isinstance(chart, SpeedChart | EnergyChart)]
        scene, result = self._scene(), []
        for run in optima:
            runs = {**scene.runs, "optimal": run}
            told = {}
            for chart in charts:
                chart.draw(replace(scene, runs=runs))
                source = chart.sources[chart.names_in]
                # without colours, of which the file has those of both themes: see `paints`
                told[chart.name] = {key: list(values) for key, values in source.data.items() if key != "colour"}
            result.append(told)
        self._draw(charts)
        return result

    def spare_texts(self) -> list[str]:
        """Return the words that have no room in narrow figures."""
        spare = [(EnergyChart, "ends"), (LineStrip, "signs")]
        return [
            renderer.id
            for chart in self.groups["runs"]
            if chart.figure is not None
            for kind, name in spare
            if isinstance(chart, kind)
            for renderer in chart.figure.renderers
            if renderer.data_source is chart.sources[name]
        ]
