"""The figures of a table of runs: the runs over two axes, histograms of all quantities, and a map of medians.

A rectangle that is dragged over any of them selects runs in all. Bokeh's own selection does this, and not HoloViews'
`link_selections`: measured on a scatter with two histograms, that takes 0.3 to 0.7 s of the server for each selection.
"""

from collections.abc import Callable
from functools import partial
from operator import methodcaller
from typing import Any

import numpy as np
from bokeh.events import SelectionGeometry, Tap
from bokeh.models import (
    BoxAnnotation,
    BoxSelectTool,
    FixedTicker,
    HoverTool,
    LinearColorMapper,
)
from bokeh.plotting import figure

from railjoule.core.arrays import FloatArray
from railjoule.dashboard.charts.chart import no_grid
from railjoule.dashboard.charts.dress import ink_on, point_tip
from railjoule.dashboard.charts.figures import LoneChart
from railjoule.dashboard.charts.plot import CurveChart, Plot
from railjoule.dashboard.charts.surface import CIVIDIS
from railjoule.dashboard.look import words
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.tokens import DARK
from railjoule.dashboard.pages.explore.compute import CELLS, Bounds, Look, Raster
from railjoule.dashboard.work.run_table import Column, Ends, digits_for

RUNS, ALONG_X, ALONG_Y, MAP = "explore_runs", "explore_along_x", "explore_along_y", "explore_map"
LEVELS = 256
LEAST_ALPHA = 0.45
"""Opacity of a pixel with one run, so that it is still seen."""
QUANTILE_WORDS = "5 %", "median", "95 %"
BOTTOM_PX = 46
"""Numbers and title of the lower axis: the histogram beside it ends where the frame of the runs does."""
OTHER_HEIGHTS = (116, 130, 116)
FEW_RUNS, LARGE_PX, SMALL_PX = 1000, 6, 3
"""Up to so many runs have large dots."""
Select = Callable[[dict[str, Ends]], None]


def colours_for(dark: bool) -> tuple[str, ...]:
    """Return the colours of runs, from the lowest number to the highest."""
    # the darkest would not be seen on the dark sheet
    return CIVIDIS[2:] if dark else CIVIDIS


def _levels(colours: tuple[str, ...]) -> Any:
    known = np.array([[int(colour[k : k + 2], 16) for k in (1, 3, 5)] for colour in colours], dtype=float)
    places = np.linspace(0, len(colours) - 1, LEVELS)
    return np.column_stack([np.interp(places, np.arange(len(colours)), part) for part in known.T]).astype(np.uint8)


SCALES = {dark: _levels(colours_for(dark)) for dark in (False, True)}
"""The colours of runs in `LEVELS` steps, by whether the sheet is dark; shape (LEVELS, 3)."""


class SelectingChart(LoneChart):
    """A figure over which a rectangle is dragged to select runs.

    Its columns are those of its horizontal and its vertical axis; an axis without one selects nothing.
    """

    select: Select = staticmethod(lambda _: None)
    columns: tuple[str, str] = ("", "")
    dimensions = "both"

    def let_select(self, f: figure) -> None:
        """Give the figure its tool, and the box that shows the selection."""
        self.box = BoxAnnotation(visible=False, fill_alpha=0.12, line_alpha=0.9, line_width=1.5)
        tool = BoxSelectTool(renderers=[], dimensions=self.dimensions, visible=False)
        for one in (self.box, tool.overlay):
            self.palette.paint(one, fill_color="accent", line_color="accent")
        f.add_layout(self.box)
        f.add_tools(tool)
        f.toolbar.active_drag = tool
        f.on_event(SelectionGeometry, self._take)

    def _take(self, event: Any) -> None:
        geometry = event.geometry
        ends = {}
        for name, axis in zip(self.columns, "xy", strict=True):
            found = sorted(geometry.get(f"{axis}{k}") or 0.0 for k in (0, 1))
            if name and np.isfinite(found).all():
                ends[name] = (float(found[0]), float(found[1]))
        if ends:
            self.select(ends)

    def show_box(self, choice: Bounds) -> None:
        """Draw the selection where it is one of the figure's columns."""
        bounds = [choice.get(name, (-np.inf, np.inf)) for name in self.columns]
        # an end without a number lies at the edge of the frame
        (left, right), (bottom, top) = ([end if np.isfinite(end) else None for end in ends] for ends in bounds)
        visible = any(name in choice for name in self.columns)
        self.box.update(left=left, right=right, bottom=bottom, top=top, visible=visible)


class RunsChart(SelectingChart):
    """The runs over two axes: as points, or as a raster above so many; grey where they are not selected."""

    kind = "map"
    title = "Runs over two axes"

    def __init__(self, height: int, palette: Palette) -> None:
        super().__init__(RUNS, "", height, palette)
        self.pick: Callable[[int], None] = lambda _: None
        self._look: Look | None = None

    def build(self) -> None:
        """Make the figure."""
        f = self.frame(ticks=5, x_title=" ")
        f.min_border_bottom = BOTTOM_PX
        place = ("image", "x", "y", "dw", "dh")
        for name, more in (("seen", ()), ("known", ("count",))):
            self.source(name, *place, *more)
        f.image_rgba(*place, source=self.sources["seen"])
        # not seen: what the tooltip contains
        known = f.image(*place, source=self.sources["known"], alpha=0, palette=list(CIVIDIS))
        others = self.glyphs("scatter", "others", "x", "y", paint={"fill_color": "line2"}, line_color=None)
        self.mapper = LinearColorMapper(palette=list(CIVIDIS), low=0, high=1)
        self.source("points", "x", "y", "colour", "row")
        colour = {"field": "colour", "transform": self.mapper}
        points = f.scatter("x", "y", source=self.sources["points"], line_color=None, fill_color=colour)
        self.marks = others.glyph, points.glyph
        self.tips = [HoverTool(renderers=[one], visible=False, tooltips="") for one in (points, known)]
        f.add_tools(*self.tips)
        self.let_select(f)
        f.on_event(Tap, self._pick)

    def draw(self, look: Look) -> None:
        """Draw the runs."""
        f, asked, table, dark = self.figure, look.asked, look.table, self.palette.tokens is DARK
        assert f is not None
        x, y, colour = (table.columns[name] for name in (asked.x, asked.y, asked.colour))
        ends = look.ends[asked.x], look.ends[asked.y]
        self.columns = look.axes
        self.set_ranges(*ends)
        f.xaxis.axis_label = x.label
        for axis, (low, high) in zip((f.xaxis[0], f.yaxis[0]), ends, strict=True):
            axis.formatter.args = {"digits": digits_for(40 * (high - low))}
        low, high = look.colour_ends
        self.mapper.update(low=low, high=high, palette=list(colours_for(dark)))
        self.tips[0].tooltips = point_tip(
            ("Run", "@row"), (x.label, "@x{0,0.00}"), (y.label, "@y{0,0.00}"), (colour.label, "@colour{0,0.00}")
        )
        mean = f"Mean {colour.within_sentence}, {colour.unit}".rstrip(", ")
        self.tips[1].tooltips = point_tip(("Runs here", "@count"), (mean, "@image"))
        self._look = look
        if look.raster is None:
            self.clear("seen", "known")
            self._put_points(look)
        else:
            self.clear("points", "others")
            self._put_raster(look.raster, ends, (low, high), SCALES[dark])
        self.show_box(asked.choice)

    def _put_points(self, look: Look) -> None:
        asked, held = look.asked, look.held
        for mark in self.marks:
            mark.size = LARGE_PX if len(held) <= FEW_RUNS else SMALL_PX
        names = {"x": asked.x, "y": asked.y, "colour": asked.colour}
        numbers = {key: np.asarray(look.table.values[name], dtype=np.float32) for key, name in names.items()}
        self.put("others", x=numbers["x"][~held], y=numbers["y"][~held])
        rows = look.table.rows[held].astype(np.int32)
        self.put("points", **{name: of[held] for name, of in numbers.items()}, row=rows)

    def _put_raster(self, runs: Raster, ends: tuple[Ends, Ends], colour_ends: Ends, scale: Any) -> None:
        (left, right), (bottom, top) = ends
        place = {"x": [left], "y": [bottom], "dw": [right - left], "dh": [top - bottom]}
        grey = self.palette.tokens["line2"]
        self.sources["seen"].data = {"image": [coloured(runs, colour_ends, scale, grey)], **place}
        mean, count = runs.mean.astype(np.float32), runs.count.astype(np.float32)
        self.sources["known"].data = {"image": [mean], "count": [count], **place}

    def _pick(self, event: Any) -> None:
        """Report the number of the run nearest to a press."""
        look, x, y = self._look, self.x_range, self.y_range
        if look is None or event.x is None or not len(look.table.rows):
            return
        right, up = (look.table.values[name] for name in look.axes)
        away = ((right - event.x) / (x.end - x.start)) ** 2 + ((up - event.y) / (y.end - y.start)) ** 2
        self.pick(int(look.table.rows[int(np.argmin(away))]))


def coloured(raster: Raster, ends: Ends, scale: Any, grey: str) -> Any:
    """Return a raster as pixels, shape (rows, columns).

    The colour shows the mean, the opacity grows with the count; pixels without selected runs are grey.
    """
    low, high = ends
    share = np.clip((np.nan_to_num(raster.mean, nan=low) - low) / max(high - low, 1e-12), 0.0, 1.0)
    alpha = LEAST_ALPHA + (1 - LEAST_ALPHA) * np.log1p(raster.count) / np.log1p(max(float(raster.count.max()), 1.0))
    pixels = np.empty((*raster.count.shape, 4), dtype=np.uint8)
    pixels[..., :3] = scale[(share * (LEVELS - 1)).astype(int)]
    pixels[..., 3] = np.where(raster.count > 0, 255 * alpha, 0)
    pixels[(raster.count == 0) & (raster.others > 0)] = [int(grey[k : k + 2], 16) for k in (1, 3, 5)] + [255]
    return pixels.view(np.uint32)[..., 0]


class HistogramChart(SelectingChart):
    """Histogram of a column, over all runs and over the selected ones.

    Parameters
    ----------
    name : str
    title : str
        Of its horizontal axis, if the figure has its own.
    place : str
        "above" or "beside" the figure of the runs, whose axis it then shares; else it has its own axes.
    """

    kind = "bars"

    def __init__(self, name: str, title: str, place: str, height: int, palette: Palette) -> None:
        super().__init__(name, "", height, palette)
        self.place, self.title = place, title
        self.is_sideways = place == "beside"
        self.dimensions = "height" if self.is_sideways else "width"

    def build(self) -> None:
        """Make the figure."""
        f = self.frame(ticks=3, x_title="" if self.place else self.title)
        f.yaxis.visible = f.ygrid.visible = False
        f.xaxis.visible = not self.place
        for name, token in (("all", "line2"), ("selected", "accent")):
            paint = {"fill_color": token, "line_color": "surface"}
            self.glyphs("quad", name, "left", "right", "bottom", "top", paint=paint, line_width=0.5)
        if self.place == "above":
            f.min_border_bottom = 0
        elif not self.place:
            f.min_border_left = 14
            f.xaxis[0].ticker.desired_num_ticks = 4
        if self.is_sideways:
            f.update(min_border_left=2, min_border_right=2, min_border_bottom=BOTTOM_PX)
            self.glyphs("segment", "marks", "x", "y", "end", "y", paint={"line_color": "ink"}, line_width=1.2)
            self.signs("signs", "ink2", text_baseline="middle", x_offset=4)
        self.let_select(f)

    def draw(self, look: Look, name: str = "") -> None:
        """Draw the histogram of a column, or of the axis that it shares."""
        f = self.figure
        assert f is not None
        name = name or (look.asked.y if self.is_sideways else look.asked.x)
        found, ends, column = look.histograms[name], look.ends[name], look.table.columns[name]
        self.columns = ("", name) if self.is_sideways else (name, "")
        f.xaxis[0].formatter.args = {"digits": digits_for(40 * (ends[1] - ends[0]))}
        # all runs are grey until some of them are selected
        layers = {"all": found.counts, "selected": found.held if look.asked.choice else np.zeros(len(found.counts))}
        sides = ("bottom", "top", "left", "right") if self.is_sideways else ("left", "right", "bottom", "top")
        for layer, counts in layers.items():
            bars = (found.edges[:-1], found.edges[1:], np.zeros(len(counts)), counts)
            self.put(layer, **dict(zip(sides, bars, strict=True)))
        most = max(float(found.counts.max()), 1.0)
        if self.is_sideways:
            self.set_ranges((0.0, 3.0 * most), ends)
            self._mark(found.places, ends, column, 1.12 * most)
        else:
            self.set_ranges(ends, (0.0, 1.04 * most))
        self.show_box(look.asked.choice)

    def _mark(self, quantiles: tuple[float, ...], ends: Ends, column: Column, end: float) -> None:
        """Mark the quantiles and write their values."""
        shown = [(place, word) for place, word in zip(quantiles, QUANTILE_WORDS, strict=False) if place <= ends[1]]
        places = [place for place, _ in shown]
        self.put("marks", x=[0.0] * len(shown), y=places, end=[end] * len(shown))
        signs = [f"{word} {column.show(place)}" for place, word in shown]
        self.put("signs", x=[end] * len(shown), y=spread_signs(places, ends), text=signs)


def spread_signs(places: list[float], ends: Ends, least: float = 0.055) -> list[float]:
    """Return places of signs, moved up where two would overlap; `least` is a share of the axis."""
    moved: list[float] = []
    for place in places:
        moved.append(max(place, moved[-1] + least * (ends[1] - ends[0])) if moved else place)
    return moved


def draw_medians(chart: CurveChart, look: Look) -> None:
    """Draw the median energies, in equal steps: the numbers at the axes say where the cells lie."""
    f, found, columns = chart.figure, look.medians, look.table.columns
    assert f is not None
    if found is None:
        chart.clear()
        return
    x, y = columns[look.asked.map_x], columns[look.asked.map_y]
    for axis, column, edges in zip((f.xaxis[0], f.yaxis[0]), (x, y), (found.x_edges, found.y_edges), strict=True):
        labels = dict(enumerate(short_numbers((edges[1:] + edges[:-1]) / 2)))
        axis.update(ticker=FixedTicker(ticks=list(labels)), major_label_overrides=labels, axis_label=column.label)
    kwh = found.kwh.ravel()
    known = kwh[np.isfinite(kwh)]
    low, high = (float(known.min()), float(known.max())) if len(known) else (0.0, 1.0)
    shares = np.nan_to_num((kwh - low) / max(high - low, 1e-12))
    colours = (
        f"#{red:02x}{green:02x}{blue:02x}" for red, green, blue in SCALES[False][(shares * (LEVELS - 1)).astype(int)]
    )
    ground = chart.palette.tokens["ground"]
    fills = [colour if np.isfinite(number) else ground for colour, number in zip(colours, kwh, strict=True)]
    rows, places = (index.ravel() for index in np.indices(found.kwh.shape))
    sides = {"left": places - 0.5, "right": places + 0.5, "bottom": rows - 0.5, "top": rows + 0.5}
    chart.put("cells", **sides, fill=fills, kwh=kwh)
    texts = [words.number(number, 1 if high >= 10 else 2) for number in kwh]
    chart.put("signs", x=places, y=rows, text=texts, colour=[ink_on(fill) for fill in fills])
    chart.set_ranges((-0.5, CELLS - 0.5), (-0.5, CELLS - 0.5))


def short_numbers(places: FloatArray) -> list[str]:
    """Return numbers with the fewest decimals that resolve a thousandth of their span."""
    within = 1e-3 * float(np.ptp(places))
    digits = next((d for d in range(10) if np.all(np.abs(np.round(places, d) - places) <= within)), 9)
    return [words.number(float(place), digits) for place in places]


PLOTS = (
    Plot(
        ALONG_X,
        "",
        heights=(44, 50, 30),
        chart=partial(HistogramChart, ALONG_X, "Histogram of the horizontal axis", "above"),
    ),
    Plot(RUNS, "", heights=(400, 470, 300), chart=RunsChart),
    Plot(
        ALONG_Y,
        "",
        heights=(400, 470, 300),
        chart=partial(HistogramChart, ALONG_Y, "Histogram of the vertical axis", "beside"),
    ),
    Plot(
        MAP,
        "Median energy, kWh, over two inputs",
        heights=(260, 300, 240),
        x_title=" ",
        y_title=" ",
        sketch="map",
        layers=(
            no_grid,
            methodcaller("source", "cells", "left", "right", "bottom", "top", "fill", "kwh"),
            methodcaller(
                *("glyphs", "quad", "cells", "left", "right", "bottom", "top"),
                paint={"line_color": "surface"},
                fill_color="fill",
                line_width=2,
            ),
            methodcaller("coloured_signs", "signs", 12, text_align="center", text_baseline="middle"),
        ),
        draws=draw_medians,
    ),
)


def histogram_name(column: str) -> str:
    """Return the name of the figure that shows the histogram of a column."""
    return f"explore_{column.replace('.', '_')}"
