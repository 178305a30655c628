"""The runs that chance draws as a dataset of HoloViews, its figures, and what a brush over them holds.

HoloViews' own linked selections take seconds of the server's time for each brush (2.5 s over five figures of 500 runs,
8 s over eight of 10,000, measured with 1.23.2); so HoloViews makes the figures, once, and the browser brushes over them
by itself: see assets/scripts/brush.js. The server is told where the brushes lie, and tells what they hold.
"""

from dataclasses import dataclass
from typing import Any

import holoviews as hv
import numpy as np
from bokeh.models import BoxAnnotation, ColumnDataSource
from bokeh.plotting import figure
from holoviews.operation import histogram

from railjoule.core.arrays import FloatArray
from railjoule.core.studies.table import StudyTable
from railjoule.dashboard.charts.chart import nice_range
from railjoule.dashboard.charts.elements import figure_of
from railjoule.dashboard.charts.figures import dress_alone
from railjoule.dashboard.look import words
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.pages.what_if.chance_charts import SHOWN
from railjoule.dashboard.pages.what_if.draw_columns import (
    COLUMNS,
    OUTCOMES,
    POINTS,
    Bounds,
    Request,
    histogram_name,
    varied,
)

BINS = 30
HINT = "Drag over the points or along a histogram to brush; click in a figure to let go of its brush."


@dataclass(frozen=True, eq=False)
class BrushedFigure:
    """A figure that can be brushed over.

    Parameters
    ----------
    figure : figure
    columns : tuple of str
        What lies along x, and along y where that is a column too.
    box : BoxAnnotation
        Where its brush lies.
    brushed : ColumnDataSource
        Of what lies within all brushes.
    palette : Palette
        The colours that it alone wears: they go with it.
    """

    figure: figure
    columns: tuple[str, ...]
    box: BoxAnnotation
    brushed: ColumnDataSource
    palette: Palette


@dataclass(frozen=True, eq=False)
class Drawn:
    """The figures of a request by their names, and all rows."""

    request: Request
    rows: hv.Dataset
    figures: dict[str, BrushedFigure]

    def source(self) -> ColumnDataSource:
        """Return all columns, as the browser counts them."""
        return ColumnDataSource({str(d.name): self.rows.dimension_values(d) for d in self.rows.dimensions()})

    def told(self, bounds: Bounds) -> list[str]:
        """Return what lies within brushes, in sentences."""
        return brush_words(self.request.table, self.rows, bounds)


def draw(request: Request) -> Drawn:
    """Return the figures that are asked for; they stand in no document yet, so any thread may make them."""
    rows, dark = dataset(request.table), request.dark
    others = [str(dimension.name) for dimension in rows.dimensions() if dimension.name not in {request.x, request.y}]
    points = {POINTS: _points(rows, request.x, request.y, Palette(dark))}
    return Drawn(
        request, rows, points | {histogram_name(name): _histogram(rows, name, Palette(dark)) for name in others}
    )


def dataset(table: StudyTable) -> hv.Dataset:
    """Return the runs that reached the end: what was drawn as key dimensions, the results as value dimensions."""
    columns = varied(table)
    keys, values = (
        [hv.Dimension(name, label=COLUMNS[name].words) for name in columns if COLUMNS[name].is_drawn == drawn]
        for drawn in (True, False)
    )
    return hv.Dataset(columns, keys, values)


def _shown(values: FloatArray) -> tuple[float, float]:
    low, high = np.quantile(values, SHOWN)
    return nice_range(float(low), float(high))


def _points(rows: hv.Dataset, x: str, y: str, palette: Palette) -> BrushedFigure:
    def element() -> hv.Overlay:
        points = hv.Points(rows, [x, y], [])
        return _in_two(points, "point", size=3.5, fill_alpha=0.6, line_color=None).opts(
            backend="bokeh",
            xlim=_shown(rows.dimension_values(x)),
            ylim=_shown(rows.dimension_values(y)),
            xlabel=COLUMNS[x].words,
            ylabel=COLUMNS[y].words,
        )

    return _brushed(figure_of(element), (x, y), f"{COLUMNS[y].words}, over {COLUMNS[x].name}", palette)


def _histogram(rows: hv.Dataset, name: str, palette: Palette) -> BrushedFigure:
    ends = _shown(rows.dimension_values(name))

    def element() -> hv.Overlay:
        bars = histogram(rows, dimension=name, bin_range=ends, num_bins=BINS, normed=False)
        most = float(bars.dimension_values(1).max())
        return _in_two(bars, "bar", line_width=0.5).opts(
            backend="bokeh",
            xlim=ends,
            ylim=(0.0, 1.06 * max(most, 1.0)),
            yaxis=None,
            xlabel="",
        )

    return _brushed(figure_of(element), (name,), COLUMNS[name].words, palette)


def _in_two(element: hv.Element, word: str, **style: Any) -> hv.Overlay:
    """Return an element twice: all of it, and above it what is brushed."""
    layers = [element.relabel(f"{layer} {word}s") for layer in ("all", "brushed")]
    return hv.Overlay([layer.opts(backend="bokeh", **style) for layer in layers]).opts(
        backend="bokeh", show_legend=False, default_tools=[], responsive=True, min_height=100
    )


def _dress(f: figure, name: str, palette: Palette) -> None:
    dress_alone(f, name, palette, ticks=4)
    if not f.yaxis.visible or f.yaxis[0].axis_label is None:
        f.ygrid.visible = False
    f.xaxis.axis_label = f.xaxis.axis_label or None
    for layer, token in zip(f.renderers, ("line2", "driven"), strict=True):
        palette.paint(layer.glyph, fill_color=token)
        if layer.glyph.line_color is not None:
            palette.paint(layer.glyph, line_color="surface")


def _brushed(f: figure, columns: tuple[str, ...], name: str, palette: Palette) -> BrushedFigure:
    """Return a figure, dressed, with a box for its brush, which the browser shows."""
    _dress(f, name, palette)
    box = BoxAnnotation(visible=False, fill_alpha=0.12, line_alpha=0.8, line_width=1)
    palette.paint(box, fill_color="accent", line_color="accent")
    f.add_layout(box)
    return BrushedFigure(f, columns, box, f.renderers[1].data_source, palette)


# ---- what brushes hold


def brush_words(table: StudyTable, rows: hv.Dataset, bounds: Bounds) -> list[str]:
    """Return in sentences how many runs lie within the bounds, and what became of them beside all others."""
    stuck = table.done - len(rows)
    lost = f" In {words.number(stuck, 0)} more the train comes to a stand." if stuck else ""
    if not bounds:
        return [f"{words.number(len(rows), 0)} draws that reached the end.{lost} {HINT}"]
    held = rows.select(**bounds) if all(low <= high for low, high in bounds.values()) else rows.iloc[:0]
    share = words.share(len(held) / len(rows))
    where = "; ".join(
        f"{COLUMNS[name].name} {COLUMNS[name].show(low)} to {COLUMNS[name].told(high)}"
        for name, (low, high) in bounds.items()
    )
    counted = f"{words.number(len(held), 0)} of {words.number(len(rows), 0)} draws ({share} %): {where}.{lost}"
    if not len(held):
        return [counted]
    told = [name for name in OUTCOMES if name in rows]
    medians = ", ".join(f"{COLUMNS[name].name} {_median(held, name)} (all: {_median(rows, name)})" for name in told)
    return [counted, f"Medians of these: {medians}."]


def _median(rows: hv.Dataset, name: str) -> str:
    return COLUMNS[name].told(float(np.median(rows.dimension_values(name))))
