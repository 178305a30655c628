"""Figures with a line for each of some runs, as data: `RunPlot`, and the chart that draws it."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from operator import methodcaller
from types import MappingProxyType
from typing import Any

import numpy as np
from bokeh.models import GlyphRenderer

from railjoule.core.arrays import FloatArray
from railjoule.dashboard.charts.axis import Axis, nice_range
from railjoule.dashboard.charts.chart import Layer, zero_line
from railjoule.dashboard.charts.figures import DistanceChart
from railjoule.dashboard.charts.names import Box, Name
from railjoule.dashboard.charts.quantities import TIME, Quantity, along
from railjoule.dashboard.look.paint import Palette

Heights = tuple[int, int, int]
"""Of a figure [px]: in usual, wide and narrow windows."""
Ends = tuple[float, float]
Curve = tuple[FloatArray, FloatArray]
"""Places and values of a line, in the units of the axes."""
DRIVEN_DASH = [6, 3]
NAMES_PX, BORDERS_PX = 22, 9
"""Room above the lines for their names; what a figure takes above and below its frame."""
BAND_ALPHA = 0.16
NAMES: Layer = methodcaller("add_names")
"""The layer of the names of lines."""
BANDS: Layer = methodcaller(
    *("glyphs", "vstrip", "bands", "from", "to"),
    paint={"fill_color": "limit"},
    fill_alpha=BAND_ALPHA,
    line_color=None,
)


@dataclass(frozen=True)
class Line:
    """How a run is drawn.

    Parameters
    ----------
    token : str
        The colour.
    stroke : mapping
        Width and dash.
    of : str
        Which run is drawn, where that is not the one of the line's own name.
    quantity : Quantity or None
        Its quantity, if it is not the chart's.
    """

    token: str
    stroke: Mapping[str, Any]
    of: str = ""
    quantity: Quantity | None = None


@dataclass(frozen=True)
class RunPlot:
    """A figure over an axis that figures of a page share, with a line for each of some runs.

    Parameters
    ----------
    name : str
    quantity : Quantity
        Quantity of its lines, where they have none of their own.
    lines : mapping of str to Line
        From back to front, by their names in the figure; one without a name is the only one.
    heights : tuple of int
    caption : str
        Caption, if it is not that of the quantity.
    ticks, digits, zero, room
        As in `Plot`.
    last : bool
        Whether it has the numbers of the axis, as the lowest of its page.
    over_time : bool
        Whether it lies over time when it is built.
    zoom : bool
        Whether a drag zooms.
    axis : str
        The name of the axis, where a page has several.
    below, above : tuple of callable
        Layers below and above the lines.
    draws : callable
        Draws contents in its chart.
    """

    name: str
    quantity: Quantity
    lines: Mapping[str, Line]
    heights: Heights = (190, 220, 180)
    caption: str = ""
    ticks: int = 4
    digits: int = 0
    zero: bool = False
    room: float = 0.06
    last: bool = False
    over_time: bool = False
    zoom: bool = True
    axis: str = ""
    below: tuple[Layer, ...] = ()
    above: tuple[Layer, ...] = ()
    draws: Callable[..., None] = lambda chart, *drawn, **more: chart.draw_fitted(*drawn, **more)

    def made(self, axis: Axis, palette: Palette) -> "RunLines":
        """Return its chart."""
        return RunLines(self, axis, palette)


class RunLines(DistanceChart):
    """Draws a `RunPlot`."""

    def __init__(self, plot: RunPlot, axis: Axis, palette: Palette) -> None:
        # by name: charts of Drive have another class before it, which makes them of less
        DistanceChart.__init__(self, plot.name, plot.caption or plot.quantity.words, plot.heights[0], axis, palette)
        self.plot, self.quantity, self.lines = plot, plot.quantity, plot.lines
        self.unit, self.digits, self.stepped = plot.quantity.unit, plot.quantity.digits, plot.quantity.stepped
        self._over = along(plot.over_time)
        self.renderers: dict[str, GlyphRenderer] = {}

    def build(self) -> None:
        """Make the figure."""
        plot = self.plot
        self._over = along(plot.over_time)
        self.frame(zoom=plot.zoom, ticks=plot.ticks, digits=plot.digits, x_title=self._over.words if plot.last else "")
        self.add(*plot.below)
        if plot.zero:
            zero_line(self)
        self.add_lines()
        self.add(*plot.above)

    def draw(self, *drawn: Any, **more: Any) -> None:
        """Draw what the plot draws: without more, runs to which the axis is fitted."""
        self.plot.draws(self, *drawn, **more)

    def draw_fitted(self, runs: Mapping[str, Any], over_time: bool = False) -> None:
        """Draw runs, and fit the axis to them."""
        self.fit(self.fill(runs, over_time))

    def fit(self, curves: Mapping[str, Curve]) -> None:
        """Fit the axis to lines."""
        self.set_range(*nice_range(*data_range(curves.values()), self.plot.room))

    def name_lines(
        self,
        curves: Mapping[str, Curve],
        more: Mapping[str, Curve],
        taken: Sequence[Box],
        tokens: Mapping[str, str] = MappingProxyType({}),
    ) -> None:
        """Write the names of lines, the one on top first, clear of more lines and of boxes.

        Each has the colour of its line, where `tokens` has no other for it.
        """
        found = {name: tokens.get(name, self.lines[name].token) for name in reversed(list(curves))}
        names = [Name(name, name, self.palette.tokens[token]) for name, token in found.items()]
        self.place_names({**curves, **more}, names, taken)

    def add_lines(self) -> None:
        """Add the lines, which all draw columns of the axis' runs; each is hidden until there is a run for it."""
        assert self.figure is not None
        # "before", as `at_nodes` gives each node the value of the cell that ends there
        draw, mode = (self.figure.step, {"mode": "before"}) if self.stepped else (self.figure.line, {})
        for name, line in self.lines.items():
            column, source = self._column(line), self.axis.columns(line.of or name)
            source.declare(self._over.name, column)
            drawn = draw(self._over.name, column, source=source.source, **line.stroke, **mode)
            # hidden, as a line that came later would bring new models; saved tables call it by this name
            drawn.update(name=name, visible=False)
            self.palette.paint(drawn.glyph, line_color=line.token)
            self.renderers[name] = drawn

    def _column(self, line: Line) -> str:
        return (line.quantity or self.quantity).name

    def values(self, run: Any) -> FloatArray:
        """Return the quantity at the nodes of a run."""
        return self.quantity.values(run)

    def fill(self, runs: Mapping[str, Any], over_time: bool = False) -> dict[str, Curve]:
        """Draw exactly these runs; return their lines."""
        x = along(over_time)
        self._lie_over(x)
        drawn = {}
        for name, line in self.lines.items():
            key = line.of or name
            run, renderer = runs.get(key), self.renderers[name]
            if renderer.visible != (run is not None):
                renderer.visible = run is not None
            if run is not None:
                curve = x.values(run), line.quantity.values(run) if line.quantity else self.values(run)
                self.axis.columns(key).take(run, {x.name: curve[0], self._column(line): curve[1]})
                drawn[name] = curve
        order = list(runs)
        names = sorted(drawn, key=lambda name: order.index(self.lines[name].of or name))
        self.cursor_data["sources"] = [self.read(name, name) for name in names]
        return drawn

    def read(self, name: str, word: str, *unit: Any, y: str = "") -> list[Any]:
        """Return the cursor's data of a line: its word, its source and columns, its own unit and digits."""
        line = self.lines[name]
        source = self.axis.columns(line.of or name).source
        return [word, source, self._over.name, y or self._column(line), *unit]

    @property
    def over_time(self) -> bool:  # type: ignore[override]
        """Whether it lies over time."""
        return self._over is TIME

    def _lie_over(self, x: Quantity) -> None:
        """Draw the lines over time or distance; both are columns of the same sources."""
        if x is self._over:
            return
        self._over = x
        for name, line in self.lines.items():
            self.axis.columns(line.of or name).declare(x.name)
            self.renderers[name].glyph.x = x.name
        if self.plot.last and self.figure is not None:
            self.figure.xaxis.axis_label = x.words

    def forget(self) -> None:
        """Have nothing of any run on the page."""
        for name, line in self.lines.items():
            self.axis.columns(line.of or name).forget()


def data_range(curves: Collection[Curve]) -> tuple[float, float]:
    """Return the least and the greatest value of lines."""
    return min(float(y.min()) for _, y in curves), max(float(y.max()) for _, y in curves)


def draw_in_row(chart: RunLines, runs: Mapping[str, Any], bands: Sequence[Ends] = ()) -> None:
    """Draw the runs that there are over time, their names in a row above them, and bands from time to time [s]."""
    drawn = chart.fill(runs, over_time=True)
    chart.cursor_data["sources"] = [chart.read(word, word) for word in drawn]
    low, high = data_range([*drawn.values(), (np.zeros(1), np.zeros(1))])
    bottom, top = nice_range(low, high)
    bottom = bottom if low < 0 else 0.0
    if any(drawn):
        frame_px = chart.height - BORDERS_PX
        # the lines get the frame less the row of names, NAMES_PX of it
        top = high + (high - bottom) * NAMES_PX / (frame_px - NAMES_PX)
    chart.set_range(bottom, top)
    chart.put("bands", **{"from": [start for start, _ in bands], "to": [end for _, end in bands]})
    names = [word for word in drawn if word]
    chart.put(
        "names",
        x=[(0.02 + 0.98 * k / len(names)) * chart.axis.end for k in range(len(names))],
        y=[top] * len(names),
        text=names,
        colour=[chart.palette.tokens[chart.lines[word].token] for word in names],
    )


RowPlot = partial(
    RunPlot,
    zero=True,
    over_time=True,
    below=(BANDS,),
    above=(methodcaller("coloured_signs", "names", 12, text_baseline="top", y_offset=2),),
    draws=draw_in_row,
)
"""A figure of runs over time with their names in a row above them, and bands where a limit held the drive."""
