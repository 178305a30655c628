"""Figures as data: the descriptions of figures by a page, and the charts that draw them.

`Plot` is a figure with axes of its own; `RunPlot` one over the axis that the figures of a page share, with a line for
each of some runs; `AxisPlot` one over that axis that a chart of its own draws.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from operator import methodcaller
from typing import Any

import numpy as np
from bokeh.models import GlyphRenderer

from railjoule.core.arrays import FloatArray
from railjoule.dashboard.charts.axis import Axis, nice_range, xy
from railjoule.dashboard.charts.chart import Chart, Layer, zero_line
from railjoule.dashboard.charts.figures import DistanceChart, LoneChart
from railjoule.dashboard.charts.names import Name
from railjoule.dashboard.charts.quantities import TIME, Quantity, along
from railjoule.dashboard.charts.sketches import SketchKind
from railjoule.dashboard.look.paint import Palette

Heights = tuple[int, int, int]
"""Of a figure [px]: in usual, wide and narrow windows."""
Ends = tuple[float, float]
Curve = tuple[FloatArray, FloatArray]
"""Places and values of a line, in the units of the axes."""
DRIVEN_DASH = [6, 3]
SOLID: Mapping[str, Any] = {"line_width": 1.8}
DASHED: Mapping[str, Any] = {"line_width": 1.7, "line_dash": DRIVEN_DASH}
NAMES_PX, BORDERS_PX = 22, 9
"""Room above the lines for their names; what a figure takes above and below its frame."""
BAND_ALPHA = 0.16
NAMES: Layer = methodcaller("add_names")
"""The layer of the names of lines."""


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
        What of it, where that is not the chart's.
    """

    token: str
    stroke: Mapping[str, Any]
    of: str = ""
    quantity: Quantity | None = None


@dataclass(frozen=True)
class Stroke:
    """How a curve is drawn.

    Parameters
    ----------
    token : str
        The colour.
    style : mapping
        Width and dash.
    word : str
        Its name in the figure; without one it has none.
    marks : bool
        Whether its points are marked.
    line : bool
        Whether there is a line at all.
    """

    token: str
    style: Mapping[str, Any] = field(default_factory=lambda: SOLID)
    word: str = ""
    marks: bool = False
    line: bool = True


@dataclass(frozen=True)
class Plot:
    """A figure with axes of its own.

    Parameters
    ----------
    name, caption : str
        As in `Chart`.
    curves : mapping of str to Stroke
        By the name under which they are drawn, and saved.
    heights : tuple of int
    x_title, y_title : str
        Of the axes; where the y axis has none, the caption names it.
    ticks : int
        Requested on the y axis.
    digits, x_digits : int
        Decimals of the numbers at the axes.
    zero : bool
        Whether there is a line at zero.
    from_zero : bool
        Whether the y axis begins at zero.
    uprights : mapping of str to str
        Colours of upright dashed lines, by the name under which they are drawn.
    room : float
        Share of the values' range that is left free above and below.
    sketch : str
        Kind of its sketch.
    layers : tuple of callable
        Layers above the curves, from back to front.
    draws : callable, optional
        Draws contents in its chart, where these are not only curves.
    chart : callable, optional
        Makes its chart from height and palette, where it is none of curves and layers.
    """

    name: str
    caption: str = ""
    curves: Mapping[str, Stroke] = field(default_factory=dict)
    heights: Heights = (190, 220, 180)
    x_title: str = ""
    y_title: str = ""
    ticks: int = 4
    digits: int = 0
    x_digits: int = 0
    zero: bool = False
    from_zero: bool = False
    uprights: Mapping[str, str] = field(default_factory=dict)
    room: float = 0.06
    sketch: SketchKind = "lines"
    layers: tuple[Layer, ...] = ()
    draws: Callable[..., None] | None = None
    chart: Callable[[int, Palette], Chart] | None = None

    def made(self, axis: Axis, palette: Palette) -> Chart:
        """Return its chart."""
        make = self.chart or (lambda height, colours: CurveChart(self, height, colours))
        return make(self.heights[0], palette)


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


@dataclass(frozen=True)
class AxisPlot:
    """A figure over an axis that figures of a page share, drawn by a chart of its own.

    Parameters
    ----------
    name : str
        As in `Chart`.
    chart : callable
        Makes its chart from height, axis and palette.
    heights : tuple of int
    axis : str
        The name of the axis, where a page has several.
    """

    name: str
    chart: Callable[[int, Axis, Palette], Chart]
    heights: Heights = (190, 220, 180)
    axis: str = ""

    def made(self, axis: Axis, palette: Palette) -> Chart:
        """Return its chart."""
        return self.chart(self.heights[0], axis, palette)


class CurveChart(LoneChart):
    """Draws a `Plot`."""

    def __init__(self, plot: Plot, height: int, palette: Palette) -> None:
        self.plot, self.kind = plot, plot.sketch
        super().__init__(plot.name, plot.caption, height, palette)

    def build(self) -> None:
        """Make the figure."""
        plot = self.plot
        f = self.frame(plot.ticks, plot.digits, plot.x_title, plot.y_title)
        f.xaxis[0].formatter.args = {"digits": plot.x_digits}
        if plot.zero:
            zero_line(self)
        for name, stroke in plot.curves.items():
            if stroke.line:
                self.line(name, stroke.token, **stroke.style)
            if stroke.marks:
                self.dots(name, stroke.token, size=8, line_width=1.5)
        for name, token in plot.uprights.items():
            self.glyphs("segment", name, "x", "from", "x", "to", paint={"line_color": token}, line_dash=DRIVEN_DASH)
        self.add(*plot.layers)
        if any(stroke.word for stroke in plot.curves.values()):
            self.add_names(size=11)

    def draw(self, *drawn: Any, **more: Any) -> None:
        """Draw what the plot draws: curves, as `draw_curves`, unless it has a function of its own."""
        if self.plot.draws is None:
            self.draw_curves(*drawn, **more)
        else:
            self.plot.draws(self, *drawn, **more)

    def draw_curves(
        self,
        curves: Mapping[str, Curve],
        uprights: Mapping[str, float] | None = None,
        x_ends: Ends | None = None,
        y_ends: Ends | None = None,
    ) -> None:
        """Draw curves and upright lines.

        Parameters
        ----------
        curves : mapping of str to pair of array
            By their names in the plot; those that are missing are taken off.
        uprights : mapping of str to float, optional
            Places of the upright lines.
        x_ends, y_ends : tuple of float, optional
            Ends of the axes, where they do not follow from the curves.
        """
        for name in self.plot.curves:
            self.put(name, **xy(*curves.get(name, (np.empty(0), np.empty(0)))))
        drawn = {name: curve for name, curve in curves.items() if len(curve[0])}
        if not drawn:
            return
        x = x_ends or (min(float(x.min()) for x, _ in drawn.values()), max(float(x.max()) for x, _ in drawn.values()))
        low, high = ends_of(drawn.values())
        y = y_ends or nice_range(0.0 if self.plot.from_zero else low, high, self.plot.room)
        self.set_ranges(x, (0.0, y[1]) if self.plot.from_zero and y_ends is None else y)
        for name, place in (uprights or {}).items():
            self.put(name, x=[place], **{"from": [self.y_range.start], "to": [self.y_range.end]})
        strokes = self.plot.curves
        names = [
            Name(name, stroke.word, self.palette.tokens[stroke.token])
            for name, stroke in strokes.items()
            if stroke.word and name in drawn
        ]
        if "names" in self.sources:
            self.place_names(drawn, names, [], size=11)


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
        self.set_range(*nice_range(*ends_of(curves.values()), self.plot.room))

    def name_lines(self, curves: Mapping[str, Curve], *taken: Any, **preferred: float) -> None:
        """Write the names of lines in their colours, the one on top first; `preferred` are places along the frame."""
        names = [
            Name(name, name, self.palette.tokens[self.lines[name].token], preferred=preferred.get(name, 0.4))
            for name in reversed(list(curves))
        ]
        self.place_names(curves, names, *taken)

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
        """Draw these runs and no other; return what their lines are."""
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
        self.told["sources"] = [self.read(name, name) for name in names]
        return drawn

    def read(self, name: str, word: str, *unit: Any, y: str = "") -> list[Any]:
        """Return what the cursor needs of a line: its word, its source and columns, a unit and digits of its own."""
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


def ends_of(curves: Collection[Curve]) -> tuple[float, float]:
    """Return the least and the greatest value of lines."""
    return min(float(y.min()) for _, y in curves), max(float(y.max()) for _, y in curves)


def draw_in_row(chart: RunLines, runs: Mapping[str, Any], bands: Sequence[Ends] = ()) -> None:
    """Draw the runs that there are over time, their names in a row above them, and bands from time to time [s]."""
    drawn = chart.fill(runs, over_time=True)
    chart.told["sources"] = [chart.read(word, word) for word in drawn]
    low, high = ends_of([*drawn.values(), (np.zeros(1), np.zeros(1))])
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


BANDS: Layer = methodcaller(
    *("glyphs", "vstrip", "bands", "from", "to"),
    paint={"fill_color": "limit"},
    fill_alpha=BAND_ALPHA,
    line_color=None,
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
AnyPlot = Plot | RunPlot | AxisPlot
"""A figure as data."""
