"""The dashboard: composes one open page, and serves it. `panel serve` may run this file too."""

import gc
import logging
import time
from collections.abc import Callable
from typing import Any

import panel as pn
from bokeh.settings import settings
from panel.io.callbacks import PeriodicCallback
from panel.io.server import Server
from tornado.web import StaticFileHandler

from railjoule.core.compilation import compilation
from railjoule.core.compiled import MODE
from railjoule.dashboard.browser import Browser
from railjoule.dashboard.editor.view import EditorView
from railjoule.dashboard.faults import handle
from railjoule.dashboard.keep.keeping import Keeping
from railjoule.dashboard.keep.pins import Pins
from railjoule.dashboard.library_workarounds import (
    PageAnswer,
    PageConnection,
    collect_garbage_rarely,
    exchange,
    find_application,
    first_html,
    hide_tracebacks,
    write_all_messages,
)
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.page import Page
from railjoule.dashboard.page_host import PageHost
from railjoule.dashboard.page_work import PageWorks
from railjoule.dashboard.report.button import ReportButton
from railjoule.dashboard.report.work import Reporting
from railjoule.dashboard.scenario_folder import ScenarioFolder
from railjoule.dashboard.server.answers import KeptFileHandler, NotFoundHandler, extra_patterns
from railjoule.dashboard.server.guard import guard
from railjoule.dashboard.server.opening import TOKEN, Opening, PageHandler, PageSocket
from railjoule.dashboard.server.options import NO_LOGIN, ServerOptions
from railjoule.dashboard.shell.shell import Shell, empty_page
from railjoule.dashboard.state.files import serve_folder
from railjoule.dashboard.work import events
from railjoule.dashboard.workbench import Plans, Workbench

pn.extension("plotly", notifications=False, exception_handler=handle)
events.keep_quiet()
hide_tracebacks()
write_all_messages()
# Panel asks models for many attributes that they may not have: a tenth of a move went into guesses at what it meant
settings.perform_error_diagnostics = False
# and looks through the whole page for mistakes of programmers, which the log would name
settings.perform_document_validation = False

LOG = logging.getLogger(__name__)
POLL_MS = 300
COMPRESSION_LEVEL = 4
"""Of what pages are sent: a sixth of the bytes for 3 ms of the processor a page; higher levels hardly save more."""
LOOK_MS = 3000
"""How often Start lists the folder, which others may change too."""
EXTRA_PATTERNS = extra_patterns()


class Session:
    """One open page: its state, its work, its views."""

    def __init__(self) -> None:
        began_s = time.monotonic()
        self._polling: PeriodicCallback | None = None
        self.state = Workbench()
        self.browser = Browser()
        self.plans = Plans(self.state)
        self.pins = Pins(self.state)
        # before the page is read from its address: the works hear of what that changes
        self.works = [PageWorks(page) for page in self.state.pages.values()]
        self.keeping = Keeping(self.state, self.browser)
        self.keeping.begin(address_query())
        # from here on the address has been read: colours, first page and views begin with what it names
        self._begin_colours()
        self.palette = Palette(self.state.dark)
        self.views: dict[str, PageHost] = {}
        self.editor = EditorView(self.state, self.browser, self.palette)
        pages = {name: self._make(page) for name, page in self.state.pages.items()}
        self.shell = Shell(self.state, self.browser, self.keeping, pages, self.editor.view)
        self.plans.begin()
        self.state.param.watch(self._paint, "dark")
        self._document = pn.state.curdoc
        pn.state.on_session_destroyed(lambda _: self._end())
        self.shell.open()
        if MODE.is_compiled and self.state.scenario.is_shipped:
            # a page that is sent with its first run is there a second earlier than one that asks for it
            self.plans.take_first()
        self.reporting = Reporting(self.state)
        ReportButton(self.reporting.model, self.browser, self.state, self.shell.top)
        pn.state.onload(self._load)
        events.begin(self._document, lambda: str(self.state.page), began_s)

    def _begin_colours(self) -> None:
        """Take the colours of the address, else those for which the system asked when it was here last."""
        chosen, asked = self.state.colours, pn.state.cookies.get("railjoule_dark") == "1"
        self.browser.wants_dark = asked
        self.state.dark = self.browser.dark = asked if chosen == "system" else chosen == "dark"

    def _end(self) -> None:
        """End what still runs: the page is gone."""
        events.end(self._document)
        for work in self.works:
            work.end()
        self.reporting.end()

    def _make(self, page: Page) -> Callable[[], pn.viewable.Viewable]:
        def make() -> pn.viewable.Viewable:
            view = self.views[page.page] = PageHost(page, self.browser, self.palette)
            return view.view

        return make

    def _load(self) -> None:
        # what was changed before the page had loaded has not reached the browser: both are sent now
        self.browser.start()
        if self.state.files.folder is not None:
            self.state.param.watch(self._list_files, "page")
            pn.state.add_periodic_callback(self._list_files, period=LOOK_MS)
        compilation().begin()
        if self.state.runs is None:
            self.plans.ask()
        self._turn_to_page()
        if not MODE.is_compiled:
            self._polling = pn.state.add_periodic_callback(self._poll, period=POLL_MS)
            self._poll()

    def _list_files(self, *_: Any) -> None:
        if self.state.page == "Start":
            self.state.files.look()

    def _poll(self) -> None:
        """Show the progress of the compilation; once it has ended, ask for what had to wait for it."""
        if not MODE.is_compiled:
            self.shell.show_compiling(compilation().share)
        elif self._polling is not None:
            self._polling.stop()
            self._polling = None
            self.shell.hide_compiling()
            self.plans.ask()
            self._turn_to_page()

    def _turn_to_page(self) -> None:
        """Let the page on which the session begins ask for what it shows, as if one had turned to it."""
        self.state.param.trigger("page")

    def _paint(self, *_: Any) -> None:
        with pn.io.hold():
            # first, as charts write colours of the palette into their columns
            self.palette.switch(self.state.dark)
            for view in self.views.values():
                view.redraw()
            self.editor.redraw()


def address_query() -> str:
    """Return the query of the address that the session was opened with."""
    location = pn.state.location
    return "" if location is None else str(location.search or "")


def make_page() -> pn.viewable.Viewable:
    """Return a new page for one session."""
    return Session().shell.page


def serve(options: ServerOptions, folder: ScenarioFolder | None = None) -> None:
    """Serve the dashboard until it is stopped.

    Parameters
    ----------
    options : ServerOptions
        Where, and to whom.
    folder : ScenarioFolder, optional
        The folder that Start lists, and in which every visitor may save.
    """
    serve_folder(folder)
    events.write_down()
    if not options.is_for_this_machine:
        LOG.warning("%s A proxy that asks for a password belongs before it.", NO_LOGIN)
    compilation().begin()
    server = make_server(options)
    if folder is not None:
        # the page shows no path
        print(f"Scenario files: {folder.path}", flush=True)
    run(server)


def make_server(options: ServerOptions, *patterns: Any, **settings: Any) -> Server:
    """Return a server of the dashboard that is yet to run.

    Parameters
    ----------
    options : ServerOptions
    *patterns
        Further handlers, as tornado takes them.
    **settings
        Of Bokeh's server.
    """
    server = pn.serve(
        {"/": make_page},
        extra_patterns=[*EXTRA_PATTERNS, *patterns],
        address=options.address,
        port=options.port,
        prefix=options.prefix,
        show=False,
        start=False,
        websocket_origin=options.websocket_origins,
        title="railjoule",
        default_handler_class=NotFoundHandler,
        websocket_compression_level=COMPRESSION_LEVEL,
        **settings,
    )
    first = first_html(server, empty_page(), TOKEN)
    opening = Opening(first, options.sessions, lambda: open_pages(server), events.WAITS.someone_waits)
    exchange(
        server,
        {
            PageAnswer: (PageHandler, {"opening": opening}),
            PageConnection: (PageSocket, {"opening": opening}),
            StaticFileHandler: (KeptFileHandler, {}),
        },
    )
    guard(find_application(server), options, lambda: opening.taken_places)
    return server


def run(server: Server) -> None:
    """Run a server until it is stopped."""
    server.start()
    compilation().then(prepare)
    server.io_loop.start()


def prepare() -> None:
    """Make ready what all pages need, once the kernels are there."""
    Plans(Workbench()).compute_first()
    # or Python looks for garbage in all that stays until the end, again and again: half a second of all pages each time
    gc.collect()
    gc.freeze()
    collect_garbage_rarely()


def open_pages(server: Server) -> int:
    """Return how many pages a server has open."""
    # a session outlives its page for half a minute, in which it has no connection
    return sum(session.connection_count > 0 for session in server.get_sessions())


# the name under which `panel serve` runs a file
if __name__.startswith("bokeh_app"):
    make_page().servable()
