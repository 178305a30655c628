"""The figures of a report: those of the pages, drawn once, and their changes with theme and travel time."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from operator import methodcaller
from typing import Any

import numpy as np
from bokeh.document import Document
from bokeh.models import ColumnDataSource

from railjoule.core import Trajectory
from railjoule.core.simulation.field_oriented import FieldOrientedRun
from railjoule.dashboard.charts.axis import Axis, nice_range, points, same, xy
from railjoule.dashboard.charts.chart import axis_line
from railjoule.dashboard.charts.dress import line_style
from railjoule.dashboard.charts.driven import EFFORTS, SPEEDS
from railjoule.dashboard.charts.figures import DistanceChart
from railjoule.dashboard.charts.names import Name, placed_names
from railjoule.dashboard.charts.quantities import SPEED
from railjoule.dashboard.charts.run_charts import (
    CurrentChart,
    EffortChart,
    EnergyChart,
    LineStrip,
    PhaseStrip,
    PowerChart,
)
from railjoule.dashboard.charts.run_lines import NAMES, RunLines
from railjoule.dashboard.charts.scene import RunScene, SceneChart
from railjoule.dashboard.charts.speed import SpeedChart
from railjoule.dashboard.library_workarounds import document_json
from railjoule.dashboard.look import words
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.tokens import THEMES
from railjoule.dashboard.pages.compare.charts import FIRST, PAIR_PLOTS, SECOND
from railjoule.dashboard.report.findings import Findings

WIDTH_PX = 640
"""Words are left out that have no room in figures of this width, about that of a printed page."""
ANY_WIDTH_PX = 1e6
"""Of the phases, whose words assets/scripts/report.js shortens to the room that there is."""
STEEPEST_SHARE = 1.03
"""The scale of the frontier ends with the optimum at this multiple of the first time: nearer to it, energy rises out of
any scale."""
SPARE = {"energy": "ends", "line": "signs"}
"""Sources of words that have no room in narrow figures, by figure."""
PAIR_SPEEDS = tuple(replace(plot, last=plot.name.startswith(SECOND)) for plot in PAIR_PLOTS if plot.quantity is SPEED)
"""The figures of two scenarios, the second with the numbers of the axis that both share."""
State = Mapping[str, Mapping[str, Any]]
"""Columns by their names, by the ids of their sources."""


@dataclass(frozen=True)
class Place:
    """The place of a figure in the file."""

    name: str
    element: str
    height: int
    caption: str


class TimeChart(DistanceChart):
    """The least energy over travel time, with the run of each strategy as a point."""

    unit, digits = "kWh", 2

    look: Mapping[str, Any] = {"digits": 1, "x_title": "Travel time, s"}
    layers = (
        axis_line,
        methodcaller("line", "optimal", "optimal", **line_style("optimal")),
        methodcaller("source", "runs", "x", "y", "colour"),
        methodcaller(
            *("glyphs", "scatter", "runs", "x", "y"), paint={}, size=7, fill_color="colour", line_color="colour"
        ),
        NAMES,
        methodcaller("dots", "point", size=11, line_width=2),
    )

    def draw(self, optima: Sequence[Trajectory], runs: Mapping[str, Trajectory]) -> None:
        """Draw the optima as a line, the runs as points."""
        times, energies = (np.array([getattr(run, name) for run in optima]) for name in ("travel_time_s", "energy_kwh"))
        # the optimum is on the line, and the fastest run needs more than the scale shows
        others = {name: run for name, run in runs.items() if name not in {"optimal", "fastest"}}
        room = 0.02 * float(times[-1] - times[0])
        start, end = float(times[0]) - room, float(times[-1]) + room
        # not by `fit`, which begins at zero
        self.axis.range.update(bounds=(start, end), reset_start=start, reset_end=end, start=start, end=end)
        steepest = float(np.interp(STEEPEST_SHARE * times[0], times, energies))
        levels = [steepest, float(energies.min()), *(run.energy_kwh for run in others.values())]
        ends = nice_range(min(levels), max(levels))
        self.y_range.update(start=ends[0], end=ends[1])
        self.put("optimal", **xy(times, energies))
        self.follow_line("optimal")
        places = {name: (run.travel_time_s, run.energy_kwh) for name, run in others.items()}
        tokens, own = self.palette.tokens, (runs["optimal"].travel_time_s, runs["optimal"].energy_kwh)
        self.put("runs", **points(places.values()), colour=[tokens[name] for name in others])
        self.put("point", **points([own]))
        frame = self.frame_over((start, end), ends)
        dots = [frame.dot(*place) for place in (*places.values(), own)]
        names = [Name(name, words.STRATEGY_WORDS[name], tokens[name], point=places[name]) for name in others]
        self.put("names", **placed_names(frame, {"optimal": (times, energies)}, names, dots))


class Figures:
    """The figures of a report by section, and what its script needs to change them."""

    def __init__(self, findings: Findings) -> None:
        self.findings, self.palette = findings, Palette(dark=False)
        self.charts = {section: self._charts(section) for section in ("result", "second", "trade-off", "reality")}
        for chart in self._all():
            chart.build()
        self._draw_reality()
        self._draw_pair()
        self.draw()
        document = Document()
        # the library searches the document at each root; frozen, it does so once
        with document.models.freeze():
            for chart in self._all():
                assert chart.content is not None
                assert chart.figure is not None
                chart.figure.html_attributes = {"role": "figure", "aria-label": self._alternative(chart)}
                document.add_root(chart.content.object)
        # before the charts are drawn with other optima, which the file has as data
        docs, item = document_json(document)
        self.embedding = {"docs": docs, "items": [item.to_json()]}
        self._elements = list(item.to_json().get("roots", {}).values())
        self._sources = [model for model in document.models if isinstance(model, ColumnDataSource)]
        # from now on columns have the names of colours: the browser puts in those of the theme
        light = self._state()
        self.palette.tokens = {name: name for name in self.palette.tokens}
        self._draw_reality()
        self._draw_pair()
        self.draw()
        self._own = self._state()
        self.colours = _changes(light, self._own)

    def _all(self) -> Iterator[DistanceChart]:
        for charts in self.charts.values():
            yield from charts

    # ---- drawing

    def _charts(self, section: str) -> list[DistanceChart]:
        """Return the charts of a section that there are results for; none is built yet."""
        findings, reality = self.findings, self.findings.reality
        missing = {
            "result": False,
            "second": findings.pair is None,
            "trade-off": len(findings.optima) < 2,
            "reality": reality is None,
        }
        if missing[section] or not findings.contents.has(section):
            return []
        axis = Axis(self.palette)
        if section == "trade-off":
            caption = "Least energy, kWh, over travel time, s"
            return [TimeChart("frontier", caption, 300, axis, self.palette)]
        if section == "second" and findings.pair is not None:
            axis.fit(max(float(run.position_m[-1]) for run in findings.pair.runs), roomy=False)
            return [plot.made(axis, self.palette) for plot in PAIR_SPEEDS]
        if section == "result":
            axis.fit(self._scene(None).end, roomy=True)
            kinds = [(SpeedChart, 270), (PhaseStrip, 26), (LineStrip, 104), (EnergyChart, 160), (EffortChart, 120)]
            kinds += [(CurrentChart, 120)] if CurrentChart.has_current(findings.run) else []
            return [make(height, axis, self.palette) for make, height in [*kinds, (PowerChart, 150)]]
        assert reality is not None
        axis.fit(max(run.position_m[-1] for run in (reality.planned, reality.actual)), roomy=False)
        return [
            replace(SPEEDS, heights=(220, 220, 220)).made(axis, self.palette),
            replace(EFFORTS, heights=(130, 130, 130)).made(axis, self.palette),
        ]

    def _scene(self, optimum: Trajectory | None) -> RunScene:
        runs = self.findings.runs.runs
        chosen = next(name for name, run in runs.items() if run is self.findings.run)
        if optimum is not None:
            chosen, runs = "optimal", {**runs, "optimal": optimum}
        return RunScene(
            chosen, runs, None, over_time=False, narrow=False, width_px=WIDTH_PX, fastest=runs.get("fastest")
        )

    def draw(self, optimum: Trajectory | None = None) -> None:
        """Draw the runs, with another optimum in the place of the timetable's where one is given."""
        scene = self._scene(optimum)
        for chart in self.charts["result"]:
            assert isinstance(chart, SceneChart)
            chart.draw(replace(scene, width_px=ANY_WIDTH_PX) if isinstance(chart, PhaseStrip) else scene)
            chart.axis.settle("m", 0)
        for chart in self.charts["trade-off"]:
            assert isinstance(chart, TimeChart)
            chart.draw(self.findings.optima, scene.runs)
            chart.axis.settle("s", 1)

    def _draw_reality(self) -> None:
        # all kinds of reality have the two runs that these charts draw
        reality: Any = self.findings.reality
        in_closed_loop = isinstance(reality, FieldOrientedRun)
        for chart in self.charts["reality"]:
            assert isinstance(chart, RunLines)
            driven = "in closed loop" if in_closed_loop else "under the disturbance"
            chart.draw(*(reality, driven) if chart.name == SPEEDS.name else (reality,))
            chart.axis.settle("m", 0)

    def _draw_pair(self) -> None:
        for chart in self.charts["second"]:
            assert isinstance(chart, RunLines)
            assert self.findings.pair is not None
            chart.draw(dict(zip((FIRST, SECOND), self.findings.pair.runs, strict=True)), False)
            chart.axis.settle("m", 0)

    # ---- contents of the file

    def places(self, section: str) -> list[Place]:
        """Return the places of the figures of a section in their order."""
        elements = dict(zip(self._all(), self._elements, strict=True))
        return [Place(one.name, elements[one], one.height, one.caption) for one in self.charts[section]]

    def _alternative(self, chart: DistanceChart) -> str:
        """Return in words what a figure shows."""
        if isinstance(chart, SceneChart):
            return chart.alternative(self._scene(None))
        if isinstance(chart, TimeChart):
            ends = (self.findings.optima[0], self.findings.optima[-1])
            points = (f"{words.energy(run.energy_kwh)} kWh at {words.number(run.travel_time_s)} s" for run in ends)
            return f"Least energy over travel time: {', '.join(points)}; a table follows."
        if chart in self.charts["second"]:
            return f"{chart.caption}, over distance, with the other run; a table follows."
        return f"{chart.caption}, over distance, as planned and as driven."

    def data(self) -> dict[str, Any]:
        """Return the names of the models that assets/scripts/report.js changes, and their colours."""
        figures = {one.name: one.figure.id for one in self._all() if one.figure is not None}
        phases = next((one.sources["phases"].id for one in self.charts["result"] if one.name == "phases"), "")
        spare = [
            renderer.id
            for one in self.charts["result"]
            if one.figure is not None and one.name in SPARE
            for renderer in one.figure.renderers
            if renderer.data_source is one.sources[SPARE[one.name]]
        ]
        return {
            "figures": figures,
            "phases": phases,
            "spare": spare,
            "tokens": THEMES,
            "worn": [[model.id, attribute, token] for model, attribute, token in self.palette.worn],
            "colours": self.colours,
        }

    def moved(self, optimum: Trajectory | None) -> dict[str, Any]:
        """Return the columns that differ once an optimum is drawn in the place of the own one, and the ends of axes."""
        self.draw(optimum)
        ends = {one.y_range.id: [float(one.y_range.start), float(one.y_range.end)] for one in self._all()}
        return {"sources": _changes(self._own, self._state()), "ends": ends}

    def _state(self) -> State:
        return {source.id: dict(source.data) for source in self._sources}


def _changes(before: State, after: State) -> dict[str, dict[str, list[Any]]]:
    """Return the columns that differ."""
    found = {
        key: {
            name: _plain(column)
            for name, column in columns.items()
            if name not in before[key] or not same(before[key][name], column)
        }
        for key, columns in after.items()
    }
    return {key: columns for key, columns in found.items() if columns}


def _plain(column: Any) -> list[Any]:
    """Return a column as JSON, numbers with about five digits, which no figure can tell from all."""
    if not len(column) or isinstance(column[0], str):
        return list(column)
    values = np.asarray(column, dtype=float)
    size = float(np.nanmax(np.abs(values), initial=0.0))
    # of a maximum from 100 on, five digits leave two decimals: 4 less the power of ten
    digits = 5 - int(np.floor(np.log10(size))) if size > 0 else 0
    # JSON has no NaN
    return [None if np.isnan(value) else float(value) for value in np.round(values, digits - 1)]
