"""Explore the draws: any two quantities of the runs that chance draws over each other, the others beside, to brush.

It is opened by hand: before that nothing of it is loaded, computed or on the page, and nothing once it is closed.
"""

import json
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

import panel_material_ui as pmui
from bokeh.models import CustomJS
from panel import Row

from railjoule.core import RailjouleError
from railjoule.core.studies.table import StudyTable
from railjoule.dashboard.charts.figures import FinishedChart
from railjoule.dashboard.charts.sketches import SketchKind
from railjoule.dashboard.look.scripts import function
from railjoule.dashboard.pages.what_if.draw_columns import (
    COLUMNS,
    FIRST,
    POINTS,
    Bounds,
    Request,
    brushes_of,
    common,
    histogram_name,
    varied,
)
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.work.worker import Worker

if TYPE_CHECKING:
    from railjoule.dashboard.pages.what_if.draws import BrushedFigure, Drawn

EVENTS = "panstart", "pan", "panend", "tap"
OPEN, CLOSE = "Explore the draws", "Close the draws"
WAITS = "The draws can be explored once all of them are there."
GRID_CSS = """
:host { display: grid; grid-template-columns: repeat(3, minmax(0, 1fr)); gap: 4px 16px; align-items: start; }
@media (max-width: 1099px) { :host { grid-template-columns: repeat(2, minmax(0, 1fr)); } }
@media (max-width: 599px) { :host { grid-template-columns: minmax(0, 1fr); } }
"""
PLACE_CSS = ":host { padding: 0 20px 20px 14px; } @media (max-width: 899px) { :host { padding: 0 12px 16px; } }"
HEIGHTS = {POINTS: (320, 400, 280), **{histogram_name(name): (110, 130, 110) for name in COLUMNS}}
"""Of each chart [px], as on all pages."""
SELECT: dict[str, Any] = {"size": "small", "margin": (6, 12, 6, 0), "width": 270}


def draw(request: Request) -> "Drawn":
    """Return the figures of a request; runs in a thread, as HoloViews takes its time to load and to draw."""
    from railjoule.dashboard.pages.what_if.draws import draw as drawn  # noqa: PLC0415

    return drawn(request)


class BrushedChart(FinishedChart):
    """A chart of the draws."""

    title = "Draws"

    def __init__(self, name: str, caption: str, kind: SketchKind) -> None:
        # before its sketch is made
        self.kind = kind
        super().__init__(name, caption, HEIGHTS[name][0])
        self._join: Callable[[], None] | None = None

    def take(self, taken: "BrushedFigure", brushing: "_Brushing") -> None:
        """Draw a figure, and let it be brushed."""
        self._join = partial(brushing.add, self.name, taken)
        self.show(partial(self.draw, taken.figure))

    def settle(self) -> None:
        """Draw what waits."""
        super().settle()
        # Only now, as figures that are brushed together refer to each other: the library gives all that a figure refers
        # to the look of its own theme when it makes the figure's place.
        if self.is_drawn and self._join is not None:
            join, self._join = self._join, None
            join()


class Explorer:
    """The part of the page.

    Parameters
    ----------
    page : Page
        With the draws as `chance`, and whether they are still `drawing`.
    changed : callable
        Called when `charts` has become another list.
    """

    def __init__(self, page: Any, changed: Callable[[], None]) -> None:
        self.state, self.model, self._changed = page.desk, page, changed
        self.charts: tuple[BrushedChart, ...] = ()
        self.is_open = False
        self._table: StudyTable | None = None
        self._axes = FIRST
        self._brushing: _Brushing | None = None
        # by the threads for single runs of seconds: short requests do not wait for it
        self._worker: Worker[Request, Drawn] = Worker(
            draw, self._take, self._fail, is_slow=lambda _: True, about=lambda: self._table
        )
        self.button = pmui.Button(
            label=OPEN, variant="outlined", size="small", margin=(8, 0, 4, 6), on_click=lambda _: self._turn()
        )
        self.waiting = parts.html_pane(parts.note_paragraphs([WAITS]))
        self.place = parts.stack()
        self.view = parts.stack(self.button, self.place, css=PLACE_CSS)

    def follow(self) -> None:
        """Follow the draws and the colours: other draws are other figures, and those of before are let go of."""
        if self.model.chance is not self._table:
            self._table = self.model.chance
            if self.charts:
                self._let_go()
        if self._brushing is not None:
            self._brushing.wear(self.state.dark)
        if self.is_open and not self.charts:
            self._begin()

    def _turn(self) -> None:
        self.is_open = not self.is_open
        self.button.label = CLOSE if self.is_open else OPEN
        if self.is_open:
            self._begin()
        else:
            self._let_go()

    def _let_go(self) -> None:
        self._brushing, self.charts = None, ()
        self.place.clear()
        self._changed()

    def _begin(self) -> None:
        """Lay out what can be drawn of the table, and ask for it."""
        columns = [] if self._table is None or self.model.drawing else list(varied(self._table))
        if len(columns) < 2:
            if list(self.place) != [self.waiting]:
                self.place[:] = [self.waiting]
            return
        self._lay_out(columns)
        self._ask()

    def _lay_out(self, columns: list[str]) -> None:
        """Lay out the controls; the axes stay as they were chosen, where the table has such columns."""
        x, y = self._axes if set(self._axes) <= set(columns) else columns[:2]
        options = {COLUMNS[name].words: name for name in columns}
        self.x, self.y = (
            pmui.Select(label=label, options=options, value=value, **SELECT)
            for label, value in (("To the right", x), ("Upwards", y))
        )
        for select in (self.x, self.y):
            select.param.watch(self._choose, "value")
        # what stands beneath must not move while one brushes
        self.words = parts.html_pane(styles={"min-height": "76px"})
        self.reset = pmui.Button(
            label="Let go of all brushes",
            variant="text",
            size="small",
            margin=(10, 0, 0, 0),
            disabled=True,
            on_click=lambda _: self._release(),
        )
        self.figures = parts.stack()
        row = Row(self.y, self.x, self.reset, margin=(0, 0, 0, 6), stylesheets=[parts.WRAP_CSS])
        self.place[:] = [row, self.words, self.figures]

    def _choose(self, event: Any) -> None:
        """Draw the chosen quantities; where both would be one, they change places."""
        other = self.y if event.obj is self.x else self.x
        if other.value == event.new:
            # leads back here, with two that differ
            other.value = event.old
        else:
            self._ask()

    def _ask(self) -> None:
        """Ask for figures, and lay out where they will be."""
        self._axes = x, y = self.x.value, self.y.value
        others = [name for name in self.x.options.values() if name not in self._axes]
        points = BrushedChart(POINTS, "", "map")
        histograms = [BrushedChart(histogram_name(name), COLUMNS[name].words, "bars") for name in others]
        self.charts = (points, *histograms)
        self._changed()
        self.figures[:] = [points.host, parts.stack(*(chart.host for chart in histograms), css=GRID_CSS)]
        if self._table is not None:
            self._worker.ask(Request(self._table, x, y, self.state.dark))

    def _take(self, drawn: "Drawn") -> None:
        # closed meanwhile, or about to be drawn over another axis
        if not self.charts or (drawn.request.x, drawn.request.y) != self._axes:
            return
        before = {} if self._brushing is None else self._brushing.brushes
        brushes = {name: brush for name, brush in before.items() if name in drawn.figures and name != POINTS}
        self._brushing = _Brushing(drawn, brushes, self.state.dark, self._tell)
        self._tell(common(brushes))
        for chart in self.charts:
            chart.take(drawn.figures[chart.name], self._brushing)

    def _release(self) -> None:
        if self._brushing is not None:
            self._brushing.set({})

    def _tell(self, bounds: Bounds) -> None:
        """Say what lies within all brushes."""
        if self._brushing is not None:
            self.reset.disabled = not bounds
            self.words.object = parts.note_paragraphs(self._brushing.drawn.told(bounds))

    def _fail(self, failure: RailjouleError) -> None:
        self._let_go()
        self.place[:] = [parts.html_pane(parts.failure("The draws cannot be explored.", str(failure), ""))]


class _Brushing:
    """Figures of the same rows, over which the browser brushes; assets/scripts/brush.js has the other half.

    Parameters
    ----------
    drawn : Drawn
        The figures.
    brushes : dict
        What is brushed from the first.
    dark : bool
    tell : callable
        Takes the bounds of all brushes together, once one of them has changed.
    """

    def __init__(self, drawn: "Drawn", brushes: dict[str, Bounds], dark: bool, tell: Callable[[Bounds], None]) -> None:
        self.drawn, self._dark, self._tell = drawn, dark, tell
        self._count = 0
        self.rows = drawn.source()
        self.rows.tags = [json.dumps(brushes), 0]
        self.rows.on_change("tags", self._hear)
        self._callback = CustomJS(code=function("brush", "brush({rows, parts}, cb_obj)"))
        self.rows.js_on_change("tags", self._callback)
        self._figures: dict[str, BrushedFigure] = {}

    @property
    def brushes(self) -> dict[str, Bounds]:
        """Where the brush of each figure lies that has one."""
        return brushes_of(str(self.rows.tags[0])) if self.rows.tags else {}

    def add(self, name: str, added: "BrushedFigure") -> None:
        """Let a figure be brushed."""
        # made for a theme that may have changed since
        added.palette.switch(self._dark)
        for event in EVENTS:
            added.figure.js_on_event(event, self._callback)
        self._figures[name] = added
        told = [
            {"name": key, "figure": one.figure, "columns": one.columns, "box": one.box, "brushed": one.brushed}
            for key, one in self._figures.items()
        ]
        self._callback.args = {"rows": self.rows, "parts": told}
        if self.brushes:
            # what has just come does not show them yet
            self.set(self.brushes)

    def set(self, brushes: dict[str, Bounds]) -> None:
        """Let the browser have these brushes and no others."""
        self._count += 1
        # as a text: a dict of ours would be a map there, and an object of the browser's a dict here
        self.rows.tags = [json.dumps(brushes), -self._count]
        # within a message that is still to be sent, the library calls nobody for what we have set ourselves
        self._tell(common(brushes))

    def wear(self, dark: bool) -> None:
        """Wear the colours of the theme, all that is drawn by now."""
        if dark != self._dark:
            self._dark = dark
            for one in self._figures.values():
                one.palette.switch(dark)

    def _hear(self, _attribute: str, _old: Any, _new: Any) -> None:
        self._tell(common(self.brushes))
