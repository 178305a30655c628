"""The button at the end of a page that saves the numbers of its figures and tables."""

import asyncio
import io
import re
import zipfile
from collections.abc import Awaitable, Callable, Iterator, Sequence
from typing import Any

import panel as pn
import panel_material_ui as pmui
from panel.viewable import Viewable

from railjoule.core.csv_text import csv_of_rows, csv_of_table
from railjoule.dashboard.charts.chart import Chart
from railjoule.dashboard.charts.numbers import series, table
from railjoule.dashboard.look.words import slug
from railjoule.dashboard.parts.tables import named_tables

DRAWING = re.compile(r'<svg [^>]*data-figure="([^"]*)".*?</svg>', re.DOTALL)
"""A figure that is drawn as SVG; its attribute is its caption."""


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
