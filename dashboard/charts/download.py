"""The numbers of charts and tables, and the button at the end of a page that saves them."""

import asyncio
import io
import re
import zipfile
from collections.abc import Awaitable, Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import panel as pn
import panel_material_ui as pmui
from bokeh.models import GlyphRenderer, Image, Line, Step, Text
from bokeh.plotting import figure
from panel.viewable import Viewable

from railjoule.core.csv_text import csv_of_rows, csv_of_table
from railjoule.dashboard.charts.chart import Chart
from railjoule.dashboard.charts.surface import Scene
from railjoule.dashboard.look.words import slug
from railjoule.dashboard.parts.tables import named_tables

if TYPE_CHECKING:
    import pandas

DECORATIONS = frozenset({"fill", "ink", "colour", "align", "offset", "base", "middle", "index"})
"""Columns that only style glyphs."""
NOT_DATA = frozenset({"forbidden", "borders"})
"""Sources of background glyphs."""
ENDS = {"left": "x", "right": "x", "low": "y", "high": "y", "bottom": "y", "top": "y"}
"""The axes of columns that are ends of areas."""
X_WORDS = {"s": "Time, s", "m": "Distance, m"}
"""Names of shared axes by their unit, which is the second tag of their range: `Axis.settle`."""
Series = Mapping[str, Any]
"""Columns of one line or set of points."""
DRAWING = re.compile(r'<svg [^>]*data-figure="([^"]*)".*?</svg>', re.DOTALL)
"""A figure that is drawn as SVG; its attribute is its caption."""


def series(chart: Chart) -> tuple[list[tuple[str, Series]], dict[str, str]]:
    """Return the named series of a drawn chart, and the headings of its columns `x`, `y` and `z`.

    The columns are those of the chart and no copies: charts replace columns and do not change them.
    """
    drawn: Any = chart.figure
    if isinstance(drawn, figure):
        return list(_bokeh_series(drawn)), _bokeh_headings(drawn, chart.caption or chart.title)
    if isinstance(drawn, Scene) and drawn.traces:
        axes = drawn.frame["scene"]
        headings = {axis: axes[f"{axis}axis"]["title"]["text"] for axis in "xy"}
        return list(_scene_series(drawn.traces)), {**headings, "z": chart.caption or chart.title}
    return [], {}


def table(found: Sequence[tuple[str, Series]], headings: Mapping[str, str]) -> "pandas.DataFrame":
    """Return series below each other as one table, whose first column names the series."""
    # the page opens without it
    import pandas  # noqa: PLC0415

    tables = [pandas.DataFrame({"series": name, **columns}) for name, columns in found]
    return pandas.concat(tables, ignore_index=True).rename(columns=headings)


def _bokeh_headings(f: figure, caption: str) -> dict[str, str]:
    tags = f.x_range.tags
    x = f.xaxis[0].axis_label or (X_WORDS.get(tags[1], "") if tags else "")
    words = {"x": x or "x", "y": f.yaxis[0].axis_label or caption or "y"}
    return words | {end: f"{end}: {words[axis]}" for end, axis in ENDS.items()}


def _bokeh_series(f: figure) -> Iterator[tuple[str, Series]]:
    seen: set[str] = set()
    for renderer in f.renderers:
        if not isinstance(renderer, GlyphRenderer) or not renderer.visible:
            continue
        source, glyph = renderer.data_source, renderer.glyph
        if source.name in NOT_DATA or isinstance(glyph, Text):
            continue
        columns: Series = source.data
        if isinstance(glyph, Line | Step) and glyph.y not in ("y", None):
            # a line that draws two of the columns of its run
            columns = {"x": columns[glyph.x], "y": columns[glyph.y]}
        elif source.id in seen:
            continue
        else:
            seen.add(source.id)
            columns = _cells(columns) if isinstance(glyph, Image) else _numbers(columns)
        if any(len(column) for column in columns.values()):
            yield renderer.name or source.name or "points", columns


def _numbers(columns: Series) -> Series:
    """Return the columns of numbers and texts, without styles and without columns of lists."""
    return {
        name: column
        for name, column in columns.items()
        if name not in DECORATIONS and not (len(column) and isinstance(column[0], list | tuple | np.ndarray))
    }


def _cells(columns: Series) -> Series:
    """Return the middles of the cells of a picture, and their values."""
    if not len(columns["image"]):
        return {}
    values = np.asarray(columns["image"][0], dtype=float)
    rows, wide = values.shape
    x = columns["x"][0] + (np.arange(wide) + 0.5) * columns["dw"][0] / wide
    y = columns["y"][0] + (np.arange(rows) + 0.5) * columns["dh"][0] / rows
    return {"x": np.tile(x, rows), "y": np.repeat(y, wide), "value": values.ravel()}


def _scene_series(traces: Sequence[Mapping[str, Any]]) -> Iterator[tuple[str, Series]]:
    for number, trace in enumerate(traces, 1):
        x, y, z = (np.asarray(trace[axis], dtype=float) for axis in "xyz")
        if trace["type"] == "surface":
            yield "surface", {"x": np.tile(x, len(y)), "y": np.repeat(y, len(x)), "z": z.ravel()}
        elif len(x):
            yield str(trace.get("name", f"series {number}")), {"x": x, "y": y, "z": z}


class SavedNumbers:
    """Saves a ZIP with one CSV file for each figure and table of a page in sight.

    Parameters
    ----------
    page : str
        The name of the page.
    charts : callable
        Returns the charts of the page.
    content : Viewable
        The layout of the page, whose panes of HTML contain the tables.
    title : callable
        Returns the title of the scenario.
    draw : callable
        Draws the charts that wait for their turn, out of sight.
    about : callable
        Returns the text of a file with versions, the command that gives the same numbers, and the citation.
    """

    def __init__(
        self,
        page: str,
        charts: Callable[[], Sequence[Chart]],
        content: Viewable,
        title: Callable[[], str],
        draw: Callable[[], Awaitable[None]],
        about: Callable[[], str],
    ) -> None:
        self._page, self._charts, self._content, self._title, self._draw = page, charts, content, title, draw
        self._about = about
        self.button = pmui.FileDownload(
            callback=self._file,
            filename="numbers.zip",
            label="Save numbers of figures and tables as CSV",
            icon="download",
            size="small",
            margin=(4, 14, 12, 14),
        )
        # as an argument it makes Panel warn
        self.button.variant = "text"

    def follow(self) -> None:
        """Show the button while a figure is in sight."""
        self.button.visible = bool(self._charts_in_sight())

    def _charts_in_sight(self) -> list[Chart]:
        shown = set(map(id, in_sight(self._content)))
        return [chart for chart in self._charts() if id(chart.host) in shown]

    async def _file(self) -> io.BytesIO:
        await self._draw()
        figures = [
            (chart.caption or chart.title or chart.name, *series(chart))
            for chart in self._charts_in_sight()
            if chart.is_drawn
        ]
        panes = (part for part in in_sight(self._content) if isinstance(part, pn.pane.HTML))
        texts = [str(pane.object) for pane in panes if pane.object]
        self.button.filename = f"{slug(self._title()) or 'scenario'}-{slug(self._page)}.zip"
        return await asyncio.to_thread(archive, figures, texts, self._about())


def in_sight(part: Viewable) -> Iterator[Viewable]:
    """Yield a part of a page and all within it, without what is hidden: it may be of a former scenario."""
    if part.visible:
        yield part
        for inner in getattr(part, "objects", ()):
            yield from in_sight(inner)


def archive(figures: Sequence[tuple[str, Any, Any]], texts: Sequence[str], about: str) -> io.BytesIO:
    """Return a ZIP file with the numbers of figures, the tables and drawings of pieces of HTML, and their origin."""
    files: dict[str, str] = {"about.txt": about}

    def add(name: str, kind: str, text: str) -> None:
        stem, number = slug(name), 2
        while f"{stem}.{kind}" in files:
            stem, number = f"{slug(name)}-{number}", number + 1
        files[f"{stem}.{kind}"] = text

    for caption, found, headings in figures:
        if found:
            add(caption, "csv", csv_of_table(table(found, headings)))
    for text in texts:
        for name, rows in named_tables(text):
            add(name, "csv", csv_of_rows(rows))
        for drawing in DRAWING.finditer(text):
            add(drawing[1], "svg", drawing[0])
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as packed:
        for name, text in files.items():
            packed.writestr(name, text)
    return made
