"""Order in which the charts of a page are drawn: those in sight immediately, the others while the browser is idle.

A chart that has never been drawn costs the server and the browser some hundredths of a second each; so each goes to the
browser by itself, and actions of the user come between. One that exists and is out of sight is drawn
again when it comes into sight: while a slider moves that may be never.
"""

import asyncio
from collections.abc import Callable
from contextlib import nullcontext

import panel as pn
from bokeh.document import Document
from panel.io.state import set_curdoc

from railjoule.dashboard.browser import Browser, one_message, unfrozen
from railjoule.dashboard.charts.chart import Chart
from railjoule.dashboard.faults import Faults
from railjoule.dashboard.work import events

AT_FIRST = 4
"""Number of charts that are drawn before the browser has reported which are in sight."""
LONGEST_WAIT_S, LATER_MS = 0.5, 20


class DrawingQueue:
    """Draws the charts of one page.

    Parameters
    ----------
    browser : Browser
    faults : Faults
    in_sight : callable
        Returns whether the page is in sight.
    settle : callable
        Called after a chart was drawn by itself, within the same message; a caller that draws several together settles
        after         the last of them.
    """

    def __init__(
        self, browser: Browser, faults: Faults, in_sight: Callable[[], bool], settle: Callable[[], None]
    ) -> None:
        self.browser, self.faults, self._in_sight, self._settle = browser, faults, in_sight, settle
        self._charts: list[Chart] = []
        self._document: Document | None = None
        self._called = False
        self._has_news = False

    def take(self, charts: tuple[Chart, ...]) -> None:
        """Lead these charts, in the order in which they stand on the page."""
        self._charts = list(charts)
        for chart in charts:
            chart.enqueue = self.add

    def sight(self, names: list[str]) -> None:
        """Take note of the charts that the browser has in sight."""
        if not self._in_sight():
            return
        # reports on another page's charts do not apply to these
        self._has_news = self._has_news or any(chart.name in names for chart in self._charts)
        for chart in self._charts:
            chart.visible = chart.name in names
        self.go_on()

    def add(self, chart: Chart) -> None:
        """Draw what waits of a chart: now if it stands in sight already, later if not."""
        document = pn.state.curdoc
        if document is None or (chart.is_drawn and chart.visible and self._in_sight()):
            self._draw(chart)
        else:
            self._document = document
            self.go_on()

    def go_on(self) -> None:
        """Draw the next chart soon, if any waits."""
        # one at a time, so that what the user does comes between; before the page has loaded, a change would be lost
        if self._called or not self.browser.started or not self._in_sight():
            return
        document = pn.state.curdoc or self._document
        if document is None:
            return
        if (chart := self._next_in_sight()) is not None:
            self._called = True
            # a page that opens lets those go first that wait for the answer to a move
            if not chart.is_drawn and events.WAITS.someone_waits(LONGEST_WAIT_S):
                document.add_timeout_callback(self._draw_next, LATER_MS)
            else:
                document.add_next_tick_callback(self._draw_next)
        elif self._next_out_of_sight() is not None:
            self._called = True
            self.browser.when_idle(self._draw_next)

    async def draw_waiting(self) -> None:
        """Draw all charts that wait, and let the event loop run between them."""
        document = pn.state.curdoc or self._document
        for chart in self._waiting:
            with set_curdoc(document) if document is not None else nullcontext():
                self._draw(chart, single=True)
            await asyncio.sleep(0)

    @property
    def _waiting(self) -> list[Chart]:
        return [chart for chart in self._charts if chart.waiting is not None and chart.host.visible]

    def _next_in_sight(self) -> Chart | None:
        """Return the first chart in sight that waits; before the browser has reported, one of the first on the page."""
        if self._has_news:
            return next((chart for chart in self._waiting if chart.visible), None)
        drawn = sum(chart.is_drawn for chart in self._charts)
        return self._waiting[0] if self._waiting and drawn < AT_FIRST else None

    def _next_out_of_sight(self) -> Chart | None:
        """Return the first chart that has never been drawn."""
        return next((chart for chart in self._waiting if not chart.is_drawn), None)

    def _draw_next(self) -> None:
        self._called = False
        document = self._document or pn.state.curdoc
        with set_curdoc(document) if document is not None else nullcontext():
            chart = self._next_in_sight() or self._next_out_of_sight() if self._in_sight() else None
            if chart is not None:
                self._draw(chart, single=True)
            self.go_on()

    def _draw(self, chart: Chart, single: bool = False) -> None:
        # charts that are drawn together settle together, once: each column of their runs goes to the browser once
        # a chart that is new brings models with it: where they go is known, so that the document need not be searched
        with pn.io.hold() if chart.is_drawn else one_message():
            try:
                with unfrozen():
                    chart.settle()
            except Exception as error:
                self.faults.note(error, f"the chart {chart.name!r} could not be drawn")
                chart.fail()
            if single:
                self._settle()
