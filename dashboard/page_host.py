"""Draws a page: its figures and its message; each part again when a source changes, and whatever fails beside it."""

from collections.abc import Callable, Iterable
from functools import partial
from typing import Any

import panel as pn
import param

from railjoule.core import RailjouleError
from railjoule.dashboard.browser import Browser, unfrozen
from railjoule.dashboard.charts.axis import Axis
from railjoule.dashboard.charts.chart import COMPUTING, Chart, numbers_sketch
from railjoule.dashboard.charts.download import SavedNumbers
from railjoule.dashboard.charts.drawing import DrawingQueue
from railjoule.dashboard.charts.plot import AnyPlot
from railjoule.dashboard.look.key_names import without_keys
from railjoule.dashboard.look.markup import markup
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.tokens import NARROW_PX, WIDE_PX
from railjoule.dashboard.look.words import failure_words
from railjoule.dashboard.page import Page
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.state.recipes import about_numbers

SIDEBAR_PX, EDGES_PX, NARROW_EDGES_PX, COLUMN_GAP_PX, LEAST_WIDTH_PX = 290, 48, 40, 28, 260
"""Width beside the charts with the sidebar open, and their minimum width."""
STALE = "rj-stale"
# by colours and not by opacity, which would leave text with too little contrast
PAGE_CSS = """
:host(.rj-stale) { --rj-chart-filter: grayscale(1); --rj-number: var(--rj-ink3); --rj-verdict: var(--rj-ink3);
  --rj-words: var(--rj-ink3); }
"""
"""Numbers and charts from before the last change are grey until the next ones come."""
NOT_SHOWN = "A part of this page could not be shown: a program error, which the server\u2019s log describes."


class PageHost:
    """The view of a page.

    All parts that the page marks with `shows` are called once when it is made, whatever is there by then, and again
    when a source changes. While the page is out of sight they wait.
    """

    def __init__(self, page: Page, browser: Browser, palette: Palette) -> None:
        self.of, self.state, self.browser, self.palette = page, page.desk, browser, palette
        state = self.state
        self.heading = parts.html_pane(parts.heading(page.page, state.scenario.edited.title, "", ""))
        self.figures = parts.html_pane(numbers_sketch())
        self.message = parts.html_pane(visible=False)
        self._error = parts.html_pane(visible=False)
        self._parts: list[_Part] = []
        self._failed = self._busy = False
        self.queue = DrawingQueue(browser, state.faults, lambda: self.in_sight, self.settle)
        self.heights = {plot.name: plot.heights for plot in page.figures}
        self.axes: dict[str, Axis] = {}
        self.plots: dict[str, Any] = {plot.name: plot.made(self._find_axis(plot), palette) for plot in page.figures}
        page.host = self
        content = parts.stack(self.heading, self.message, page.layout())
        # after `layout`: sources may be parts that it makes
        self._parts = [_Part(page, name, names) for name, names in page.methods("shown")]
        self.numbers = SavedNumbers(
            page.page,
            lambda: self.charts,
            content,
            lambda: state.scenario.edited.title,
            self.queue.draw_waiting,
            lambda: about_numbers(state),
        )
        self.view = parts.stack(self._error, content, self.numbers.button, css=PAGE_CSS)
        self._watch_sources()
        self.queue.take(self.charts)
        # sizes before the first drawing: where names of lines have room depends on them
        self._fit()
        self.redraw()
        if "tab" in page.param:
            page.param.watch(self._catch_up, "tab")
        state.param.watch(self._catch_up, "page")
        state.param.watch(self._mark, "late")
        browser.follow(["window_width"], self._refit)
        browser.follow(["charts_in_sight"], self._sight)
        browser.follow(["started"], self.queue.go_on)

    @property
    def in_sight(self) -> bool:
        """Whether this is the page in sight."""
        return bool(self.state.page == self.of.page)

    # ---- figures

    @property
    def axis(self) -> Axis:
        """The axis that the figures share, where the page has only one."""
        return self.axes[""]

    def _find_axis(self, plot: AnyPlot) -> Axis:
        name = getattr(plot, "axis", "")
        if name not in self.axes:
            self.axes[name] = Axis(self.palette)
        return self.axes[name]

    def draw(self, plots: Iterable[AnyPlot], *drawn: Any, **more: Any) -> None:
        """Draw the same in figures of the page, each as its chart draws; what is out of sight is drawn later."""
        for plot in plots:
            chart = self.plots[plot.name]
            chart.show(partial(chart.draw, *drawn, **more))

    def take_charts(self, charts: Iterable[Chart]) -> None:
        """Have these charts besides those of the page's figures, in place of those taken before."""
        named = {plot.name: self.plots[plot.name] for plot in self.of.figures}
        self.plots = {**named, **{chart.name: chart for chart in charts}}
        self.queue.take(self.charts)
        self._fit()

    @property
    def charts(self) -> tuple[Chart, ...]:
        """All charts of the page."""
        return tuple(self.plots.values())

    def settle(self) -> None:
        """Tell the cursor of the figures that it may meet new ones."""
        for name, axis in self.axes.items():
            axis.settle_over(self.of.is_over_time(name))

    # ---- parts

    def redraw(self) -> None:
        """Draw everything again, as after a change of theme."""
        for part in self._parts:
            part.due = True
        self._catch_up()

    def tell(self, failure: RailjouleError | None, shown: str) -> None:
        """Show why what was asked for cannot be had, and what is shown instead; or nothing."""
        self._failed = failure is not None
        self.message.visible = self._failed
        if failure is not None:
            what, why = failure_words(failure)
            self.message.object = parts.failure(what, without_keys(why), shown)
        for chart in self.charts:
            # a chart that waits to be drawn will be in a moment, whatever has failed
            if not chart.is_drawn and chart.waiting is None:
                chart.wait("" if self._failed else COMPUTING)
        self._mark()

    def _watch_sources(self) -> None:
        """Listen to all sources, to each of them once: its parts are drawn together, however many values change."""
        watched: dict[int, tuple[Any, dict[str, None]]] = {}
        for part in self._parts:
            for source, names in part.sources:
                watched.setdefault(id(source), (source, {}))[1].update(dict.fromkeys(names))
        for source, all_names in watched.values():
            source.param.watch(self._hear, list(all_names))

    def _hear(self, *events: param.parameterized.Event) -> None:
        for part in self._parts:
            part.due |= any(
                event.obj is source and event.name in names for event in events for source, names in part.sources
            )
        self._catch_up()

    def _catch_up(self, *_: Any) -> None:
        """Call all parts that are due; a failure is reported, and the others continue."""
        # what is due stays so until the page comes into sight, see `__init__`
        if not self.in_sight:
            return
        # a part that changes what another one shows leads back here: `_run_all` finds what has become due
        if self._busy:
            return
        self._busy = True
        try:
            with pn.io.hold():
                self._run_all()
        finally:
            self._busy = False
        self.queue.go_on()

    def _run_all(self) -> None:
        for chart in self.charts:
            chart.scenario_title = self.state.scenario.edited.title
        # a part may change what another one shows
        while due := [part for part in self._parts if part.due and part.is_open()]:
            for part in due:
                part.due = False
                self._run(part)
        self.settle()
        self.numbers.follow()
        self._error.visible = any(part.failed for part in self._parts)
        if self._error.visible:
            self._error.object = markup('<div class="message" role="alert">{}</div>', NOT_SHOWN)

    def _run(self, part: "_Part") -> None:
        try:
            with unfrozen():
                part.draw()
            part.failed = False
        except Exception as error:
            part.failed = True
            self.state.faults.note(error, f"a part of the page {self.of.page} could not be shown")

    # ---- sizes and marks

    def _fit(self) -> None:
        """Give the charts the heights that suit the window."""
        width = self.browser.window_width
        size = 1 if width >= WIDE_PX else 2 if width < NARROW_PX else 0
        for chart in self.charts:
            chart.width_px = self.room_px(chart.name not in self.of.full_width)
            if chart.name in self.heights:
                chart.resize(self.heights[chart.name][size])

    def room_px(self, in_halves: bool = True) -> float:
        """Return the least width of the place of a chart, in its column or across all."""
        width = self.browser.window_width
        room = width - (NARROW_EDGES_PX if width < NARROW_PX else SIDEBAR_PX + EDGES_PX)
        if width >= WIDE_PX:
            room -= self.of.rail_px
        if in_halves and self.of.halves_from_px is not None and width >= self.of.halves_from_px:
            room = (room - COLUMN_GAP_PX) // 2
        return float(max(room, LEAST_WIDTH_PX))

    def _refit(self) -> None:
        with pn.io.hold():
            self._fit()
            self.redraw()

    def _sight(self) -> None:
        self.queue.sight(self.browser.charts_in_sight)

    def _mark(self, *_: Any) -> None:
        """Grey what is from before the last change."""
        stale = self._failed or self.of.page in self.state.late
        classes = [STALE] if stale else []
        if self.view.css_classes != classes:
            self.view.css_classes = classes


class _Part:
    """A part of a page: the method that draws it, whether that is due, and whether it failed the last time."""

    def __init__(self, page: Page, name: str, sources: Iterable[str]) -> None:
        self.draw = getattr(page, name)
        self.sources = page.sources(sources)
        self.is_open: Callable[[], bool] = partial(page.is_shown, self.draw.tab)
        self.due, self.failed = True, False
