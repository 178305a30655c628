"""What all pages share: they draw what is there when they are made, follow their sources, and outlive their errors."""

from collections.abc import Callable, Mapping
from typing import Any

import panel as pn
import param
from panel.viewable import Viewable

from railjoule.core import RailjouleError
from railjoule.dashboard.browser.browser import Browser
from railjoule.dashboard.browser.messages import unfrozen
from railjoule.dashboard.charts.chart import Chart
from railjoule.dashboard.charts.download import SavedNumbers
from railjoule.dashboard.charts.drawing import DrawingQueue
from railjoule.dashboard.charts.sketches import COMPUTING, numbers_sketch
from railjoule.dashboard.look.key_names import without_keys
from railjoule.dashboard.look.markup import markup
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.theme import padded
from railjoule.dashboard.look.tokens import NARROW_PX, WIDE_PX
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.parts.failures import failure_words
from railjoule.dashboard.state.page_work import PageWork
from railjoule.dashboard.state.programs import about_numbers
from railjoule.dashboard.state.workbench import Workbench

SIDEBAR_PX, EDGES_PX, NARROW_EDGES_PX, COLUMN_GAP_PX, LEAST_WIDTH_PX = 290, 48, 40, 28, 260
"""What stands beside the charts, the sidebar open, and how wide they are at least."""
STALE = "rj-stale"
# by colours and not by opacity, which would leave text with too little contrast
PAGE_CSS = """
:host(.rj-stale) { --rj-chart-filter: grayscale(1); --rj-number: var(--rj-ink3); --rj-verdict: var(--rj-ink3);
  --rj-words: var(--rj-ink3); }
"""
"""Numbers and charts from before the last change are grey until the next ones come."""
BODY_CSS = padded("4px 20px 0 14px", "4px 10px 0 6px")
"""Of charts that take the whole width of a page."""
NOT_SHOWN = "A part of this page could not be shown: a program error, which the server\u2019s log describes."


class PageView:
    """A page.

    A subclass makes its pieces in `make`, and names with `shows` what shows which values. It need not draw anything
    itself: all parts are called once when the page is made, whatever is there by then, and again when one of their
    values changes. While the page is out of sight they wait.
    """

    page = ""
    """Its name, one of PAGES."""
    works: tuple[Callable[[Workbench], PageWork[Any]], ...] = ()
    """What asks for what it shows, once for each open page; it waits while the page is out of sight."""
    heights: Mapping[str, tuple[int, int, int]] = {}
    """Height of each chart [px]: in usual, wide and narrow windows."""
    halves_from_px: int | None = None
    """From this width of the window on, two columns of charts stand beside each other; None where there is one."""
    rail_px = 0
    """What stands beside the charts in wide windows."""

    def __init__(self, state: Workbench, browser: Browser, palette: Palette) -> None:
        self.state, self.browser, self.palette = state, browser, palette
        self.heading = parts.html_pane(parts.heading(self.page, state.scenario.edited.title, "", ""))
        self.figures = parts.html_pane(numbers_sketch())
        self.message = parts.html_pane(visible=False)
        self._error = parts.html_pane(visible=False)
        self._parts: list[_Part] = []
        self._failed = self._busy = False
        self.queue = DrawingQueue(browser, state.faults, lambda: self.in_sight, self.settle)
        content = self.make()
        self.numbers = SavedNumbers(
            self.page,
            lambda: self.charts,
            content,
            lambda: state.scenario.edited.title,
            self.queue.draw_waiting,
            lambda: about_numbers(state),
        )
        self.view = parts.stack(self._error, content, self.numbers.button, css=PAGE_CSS)
        # after `make`, in which the page names its parts
        self._watch_sources()
        self.queue.take(self.charts)
        # sizes before the first drawing: where names of lines have room depends on them
        self._fit()
        self.redraw()
        state.param.watch(self._appear, "page")
        state.param.watch(self._mark, "late")
        browser.follow(["window_width"], self._refit)
        browser.follow(["charts_in_sight"], self._sight)
        browser.follow(["started"], self.queue.go_on)

    def make(self) -> Viewable:
        """Make the pieces of the page, and return them laid out."""
        raise NotImplementedError

    @property
    def charts(self) -> tuple[Chart, ...]:
        """All charts of the page, in the order in which they are read."""
        return ()

    def settle(self) -> None:
        """Tell a shared cursor of charts that were built or drawn; called last within a message."""

    def shows(self, draw: Any, *sources: tuple[Any, list[str]], is_open: Callable[[], bool] = lambda: True) -> None:
        """Call a part of the page when the page is made, and when any of the named values changes.

        Parameters
        ----------
        draw : callable
            The part, without arguments.
        sources : pairs
            A parameterized object and the names of its values.
        is_open : callable
            Returns whether the part can be seen: until then it is due.
        """
        self._parts.append(_Part(draw, sources, is_open))

    @property
    def in_sight(self) -> bool:
        """Whether this is the page in sight."""
        return bool(self.state.page == self.page)

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

    def _catch_up(self) -> None:
        """Call all parts that are due; one that fails is told of, and the others go on."""
        # what is due stays so until the page comes into sight, see `_appear`
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
            self.state.faults.note(error, f"a part of the page {self.page} could not be shown")

    def _appear(self, *_: Any) -> None:
        self._catch_up()

    def _fit(self) -> None:
        """Give the charts the heights that suit the window."""
        width = self.browser.window_width
        size = 1 if width >= WIDE_PX else 2 if width < NARROW_PX else 0
        room = self.room_px()
        for chart in self.charts:
            chart.width_px = room
            if chart.name in self.heights:
                chart.resize(self.heights[chart.name][size])

    def room_px(self) -> float:
        """Return how wide the place of a chart is at least."""
        width = self.browser.window_width
        room = width - (NARROW_EDGES_PX if width < NARROW_PX else SIDEBAR_PX + EDGES_PX)
        if width >= WIDE_PX:
            room -= self.rail_px
        if self.halves_from_px is not None and width >= self.halves_from_px:
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
        stale = self._failed or self.page in self.state.late
        classes = [STALE] if stale else []
        if self.view.css_classes != classes:
            self.view.css_classes = classes


class _Part:
    """A part of a page: what draws it, whether that is due, and whether it failed the last time."""

    def __init__(self, draw: Any, sources: tuple[tuple[Any, list[str]], ...], is_open: Callable[[], bool]) -> None:
        self.draw, self.sources, self.is_open = draw, sources, is_open
        self.due, self.failed = True, False
