"""Figures as data: the descriptions of figures by a page, and the charts that draw them.

`Plot` is a figure with axes of its own; `RunPlot` one over the axis that the figures of a page share, with a line for
each of some runs; `AxisPlot` one over that axis that a chart of its own draws.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from railjoule.dashboard.charts.axis import Axis, nice_range, xy
from railjoule.dashboard.charts.chart import Chart, Layer, SketchKind, zero_line
from railjoule.dashboard.charts.figures import LoneChart
from railjoule.dashboard.charts.names import Name
from railjoule.dashboard.charts.run_lines import DRIVEN_DASH, Curve, Ends, Heights, RunPlot, data_range
from railjoule.dashboard.look.paint import Palette

SOLID: Mapping[str, Any] = {"line_width": 1.8}
DASHED: Mapping[str, Any] = {"line_width": 1.7, "line_dash": DRIVEN_DASH}


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
        low, high = data_range(drawn.values())
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


AnyPlot = Plot | RunPlot | AxisPlot
"""A figure as data."""
