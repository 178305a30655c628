"""The dashboard: composes one open page, and serves it. `panel serve` may run this file too."""

import logging
import time
from collections.abc import Callable
from typing import Any

import panel as pn
from bokeh.settings import settings

from railjoule.core import RailjouleError
from railjoule.dashboard.browser.browser import Browser
from railjoule.dashboard.editor.view import EditorView
from railjoule.dashboard.faults import handle
from railjoule.dashboard.keep.keeping import Keeping
from railjoule.dashboard.keep.lifeline import Lifeline
from railjoule.dashboard.keep.pins import Pins
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.page_list import PAGES
from railjoule.dashboard.pages.page import PageView, view_of
from railjoule.dashboard.pages.trade_off.compute import TradeOff, TradeOffRequest, compute_trade_off
from railjoule.dashboard.report.button import ReportButton
from railjoule.dashboard.report.work import Reporting
from railjoule.dashboard.server.health import HealthHandler
from railjoule.dashboard.server.logs import keep_quiet, write_down
from railjoule.dashboard.server.not_found import NotFoundHandler
from railjoule.dashboard.shell.share import Share
from railjoule.dashboard.shell.shell import Page, Shell
from railjoule.dashboard.state.scenario import PLAN_FIELDS
from railjoule.dashboard.state.workbench import Workbench
from railjoule.dashboard.work.runs import Runs, RunsRequest, compute_runs
from railjoule.dashboard.work.warmup import warmup
from railjoule.dashboard.work.worker import Worker

pn.extension("plotly", notifications=False, exception_handler=handle)
keep_quiet()
# Panel asks models for many attributes that they may not have: a tenth of a move went into guesses at what it meant
settings.perform_error_diagnostics = False

LOG = logging.getLogger(__name__)
POLL_MS = 300
EXTRA_PATTERNS = [("/health", HealthHandler)]
VIEWS: dict[str, type[PageView]] = {name: view_of(name) for name in PAGES}
"""What draws each page."""


class Session:
    """One open page: its state, its work, its views."""

    def __init__(self) -> None:
        self.state = Workbench()
        self.browser = Browser()
        self.runs = Worker(
            compute_runs,
            self._take_runs,
            self._take_failure,
            self.state.marks("Start", "Drive", "Compare", "Trade-off"),
            is_slow=lambda request: request.is_slow,
            about=self.state.scenario.identity,
        )
        self.trade_off = Worker(
            compute_trade_off,
            self._take_trade_off,
            self._take_failure,
            self.state.marks("Trade-off"),
            about=self.state.scenario.identity,
        )
        self.pins = Pins(self.state)
        # before the page is read from its address: the works hear of what that changes
        self.works = [work(self.state) for view in VIEWS.values() for work in view.works]
        self.lifeline = Lifeline()
        self.keeping = Keeping(self.state, self.lifeline)
        self.keeping.begin(address_query())
        # from here on the address has been read: colours, first page and views begin with what it names
        self._begin_colours()
        self.palette = Palette(self.state.dark)
        self.views: dict[str, PageView] = {}
        self.editor = EditorView(self.state, self.browser, self.palette)
        pages = {name: self._make(view) for name, view in VIEWS.items()}
        share = Share(self.state, self.keeping)
        self.shell = Shell(self.state, self.browser, share, pages, self.editor.view)
        scenario = self.state.scenario
        # only now, so that what the address has changed is asked for once, not at each of its changes
        scenario.param.watch(self._ask_runs, [*PLAN_FIELDS, "acceleration_time_s"])
        scenario.param.watch(
            self._ask_trade_off, ["load_percent", "recuperation_percent", "edits", "travel_time_range_s"]
        )
        self.state.param.watch(self._ask_runs, ["ticked", "chosen"])
        self.state.param.watch(self._ask_trade_off, ["page", "wide_map", "copper_weight"])
        self.state.param.watch(self._paint, "dark")
        self._opened_s = time.monotonic()
        pn.state.on_session_destroyed(lambda _: self._end())
        self.shell.open()
        self._ask_trade_off()
        request = self._request()
        if warmup().first.is_set() and self.state.scenario.is_shipped and request.is_short:
            # a page that is sent with its first run is there a second earlier than one that asks for it
            self.runs.do(request)
        self.reporting = Reporting(self.state)
        self.shell.add(*ReportButton(self.reporting.model, self.browser, self.lifeline.save).parts)
        pn.state.onload(self._load)

    def _begin_colours(self) -> None:
        """Take the colours of the address, else those for which the system asked when it was here last."""
        chosen, asked = self.state.colours, pn.state.cookies.get("railjoule_dark") == "1"
        self.browser.wants_dark, self.browser.follows_system = asked, chosen == "system"
        self.state.dark = self.browser.dark = asked if chosen == "system" else chosen == "dark"

    def _end(self) -> None:
        """End what still runs: the page is gone."""
        LOG.info("a page was open for %.0f s, at last %s", time.monotonic() - self._opened_s, self.state.page)
        for work in (*self.works, self.reporting):
            work.end()

    def _make(self, view: type[PageView]) -> Callable[[], pn.viewable.Viewable]:
        def make() -> pn.viewable.Viewable:
            made = view(self.state, self.browser, self.palette)
            self.views[view.__name__] = made
            return made.view

        return make

    def _load(self) -> None:
        # what was changed before the page had loaded has not reached the browser: both are told now
        self.browser.start()
        self.lifeline.started = True
        warmup().start()
        self._opened = warmup().first.is_set()
        if self._opened:
            self._begin()
        else:
            self.shell.show_starting()
        if not warmup().ready.is_set():
            self.shell.starting.tell_behind(self._opened and warmup().compiles)
            self._polling = pn.state.add_periodic_callback(self._poll, period=POLL_MS)

    def _begin(self) -> None:
        if self.state.runs is None:
            self._ask_runs()
        self._turn_to_page()

    def _poll(self) -> None:
        """Tell how far the kernels are; open when the first ones are there, go on where a page waits for the rest."""
        ready = warmup().ready.is_set()
        if not self._opened and warmup().first.is_set():
            self._opened = True
            self.shell.starting.tell_behind(not ready and warmup().compiles)
            self.shell.open()
            self._begin()
        elif not self._opened:
            self.shell.starting.tell(*warmup().progress)
        elif ready:
            self._polling.stop()
            self.shell.starting.tell_behind(False)
            self._turn_to_page()

    def _turn_to_page(self) -> None:
        """Let the page on which the session begins ask for what it shows, as if one had turned to it."""
        self.state.param.trigger("page")

    def _ask_runs(self, *_: Any) -> None:
        self.runs.ask(self._request())

    def _request(self) -> RunsRequest:
        with_law = self.state.chosen == "bellman"
        return RunsRequest(self.state.scenario.scenario(), self.state.drawn, with_law)

    def _ask_trade_off(self, *_: Any) -> None:
        """Ask for the frontier, but only while its page is in sight."""
        if self.state.page != "Trade-off":
            return
        scenario = self.state.scenario
        longest = scenario.travel_time_range_s[1]
        self.trade_off.ask(TradeOffRequest(scenario.scenario(), longest, self.state.wide_map, self.state.copper_weight))

    def _take_runs(self, runs: Runs) -> None:
        self.state.param.update(runs=self.state.proof.laid_on(runs), failure=None)

    def _take_trade_off(self, trade_off: TradeOff) -> None:
        self.state.param.update(trade_off=trade_off, trade_off_duration_s=self.trade_off.last_duration_s)

    def _take_failure(self, failure: RailjouleError) -> None:
        self.state.failure = failure

    def _paint(self, *_: Any) -> None:
        with pn.io.hold():
            self.palette.switch(self.state.dark)
            for view in self.views.values():
                view.redraw()
            self.editor.redraw()


def address_query() -> str:
    """Return the query of the address that the session was opened with."""
    location = pn.state.location
    return "" if location is None else str(location.search or "")


def make_page() -> Page:
    """Return a new page for one session."""
    return Session().shell.page


def serve(address: str = "127.0.0.1", port: int = 5006) -> None:
    """Serve the dashboard until it is stopped.

    Parameters
    ----------
    address : str
        Where to listen.
    port : int
        The port to listen on.
    """
    # a browser on this machine may call it by either name
    origins = [f"{address}:{port}", f"localhost:{port}", f"127.0.0.1:{port}"]
    write_down()
    warmup().start()
    pn.serve(
        {"/": make_page},
        extra_patterns=EXTRA_PATTERNS,
        address=address,
        port=port,
        show=False,
        websocket_origin=origins,
        title="railjoule",
        default_handler_class=NotFoundHandler,
    )


# the name under which `panel serve` runs a file
if __name__.startswith("bokeh_app"):
    make_page().servable()
