"""The browser's half of the frame: the bar of pages, and all that only the browser can do.

It draws the bar with its buttons and listens to the keys. It reports the width of the window, the colours that the
system asks for and the charts in sight. It shows the state in the address, reads dropped files, writes to the
clipboard, and loads the page again when the server was lost. Requests that a user makes with a button, an element with
`data-ask`, a key or a file comes as a message, which `listen` hands on by its kind.
"""

import base64
import contextlib
from collections.abc import Callable, Iterator
from importlib.resources import files
from typing import Any

import panel as pn
import param
from markupsafe import Markup
from panel.custom import JSComponent

from railjoule.core.scenario.text_file import MAX_FILE_BYTES
from railjoule.dashboard.faults import handle
from railjoule.dashboard.library_workarounds import frozen, thaw
from railjoule.dashboard.look.scripts import module
from railjoule.dashboard.look.templates import template
from railjoule.dashboard.page_list import KEYED, PAGES, grouped_pages

ASSETS = files("railjoule.assets")
BRAND = (
    '<svg width="22" height="22" viewBox="0 0 22 22" aria-hidden="true">'
    '<path d="M2 18 C5 18 5 5 9 5 C13 5 13 11 16 14 C18 16.5 19 18 20 18" fill="none" stroke="var(--rj-accent)" '
    'stroke-width="2.4" stroke-linecap="round"/>'
    '<path d="M1 20.5H21" stroke="var(--rj-line2)" stroke-width="1.4"/></svg>'
    '<span class="name">railjoule</span>'
)

ICONS = {
    "undo": "M8 5 3 10l5 5M3 10h11a5 5 0 0 1 0 10h-3",
    "redo": "m16 5 5 5-5 5m5-5H10a5 5 0 0 0 0 10h3",
    "share": "M3 12a3 3 0 1 0 6 0 3 3 0 1 0-6 0M15 5a3 3 0 1 0 6 0 3 3 0 1 0-6 0"
    "m0 14a3 3 0 1 0 6 0 3 3 0 1 0-6 0M9 10l6-4m-6 8 6 4",
    "pin": "M8 3h8m-6 0v7l-4 4h12l-4-4V3m-2 11v7",
    "report": "M6 3h8l4 4v14H6zm8 0v5h4M9 13h6m-6 4h6",
}
"""The buttons of the bar by the kind of their message, as paths of SVG."""


def bar_html() -> str:
    """Return the bar of pages; the browser writes the page in sight and the words of buttons into it."""
    return template("bar").render(brand=Markup(BRAND), groups=grouped_pages(), pages=PAGES, icons=ICONS)


class Browser(JSComponent):
    """The browser's half of the frame.

    Messages come before the page has loaded, and changes until then never reach the browser; `follow` calls back after
    `start` only.
    """

    window_width = param.Integer(default=1280, doc="Width of the window [px].")
    wants_dark = param.Boolean(default=False, doc="Whether the system asks for dark colours.")
    dark = param.Boolean(default=False, doc="Whether the page is dark.")
    started = param.Boolean(default=False, doc="Whether the page has loaded.")
    hidden = param.Boolean(default=False, doc="Whether the browser shows another tab, or is minimised.")
    charts_in_sight = param.List(default=[], doc="Names of the charts in sight.")
    address = param.String(default="", doc="Query or fragment that contains the state of the page.")
    page = param.String(default="", doc="The page in sight, as the server has it.")
    drawer = param.Boolean(default=False, doc="Whether the scenario's editor is open.")
    working = param.Boolean(default=False, doc="Whether the page in sight waits for a result.")
    progress = param.Number(default=None, allow_None=True, doc="Share of a long piece of work that is done.")
    labels = param.Dict(
        default={"undo": "Undo", "redo": "Redo", "share": "Share", "pin": "Pin run", "report": "Report"},
        doc="The buttons of the bar: their labels by the kind of their message.",
    )
    disabled = param.List(default=["undo", "redo"], doc="Kinds of the buttons that have nothing to do.")
    bar = param.String(default=bar_html(), doc="The bar of pages, as HTML.")
    pages = param.List(default=list(PAGES), doc="The names of all pages.")
    bare = param.List(
        default=[name for name, entry in PAGES.items() if not entry.has_sidebar], doc="Those with the whole width."
    )
    keyed = param.List(default=list(KEYED), doc="The pages that the keys 1 to 9 open.")
    # the browser checks first: a message that is too large ends the connection (panel 6923)
    largest_bytes = param.Integer(default=MAX_FILE_BYTES, doc="Largest file that is read.")

    _esm = module("browser")
    _stylesheets = [(ASSETS / "css" / "navigation.css").read_text(encoding="utf-8")]  # noqa: RUF012
    _priority_changes = ("window_width", "wants_dark", "hidden", "charts_in_sight")
    """They are sent rarely: they need not wait for others to come."""

    def __init__(self, **params: object) -> None:
        super().__init__(**{"sizing_mode": "stretch_width", "height": 48, "margin": 0, **params})
        self._followers: list[tuple[list[str], list[Any], Callable[[], None]]] = []
        self._idle: list[Callable[[], None]] = []
        self._listeners: dict[str, Callable[[dict[str, Any]], None]] = {"idle": self._call_idle}

    def follow(self, names: list[str], callback: Callable[[], None]) -> None:
        """Call back when any of the named values changes, and when the page has loaded if any has changed by then."""
        self._followers.append((names, self._values(names), callback))
        self.param.watch(lambda *_: callback() if self.started else None, names)

    def start(self) -> None:
        """Begin to speak: the page has loaded."""
        self.started = True
        for names, known, callback in self._followers:
            if self._values(names) != known:
                callback()

    def listen(self, kind: str, callback: Callable[[dict[str, Any]], None]) -> None:
        """Call back with each message of a kind."""
        self._listeners[kind] = callback

    def when_idle(self, callback: Callable[[], None]) -> None:
        """Call back once, when the browser has nothing else to do."""
        self._idle.append(callback)
        # the browser answers once for all that wait
        if len(self._idle) == 1:
            self._send_msg({"kind": "when_idle"})

    def copy(self, text: str | None = None) -> None:
        """Put a text on the clipboard, or the address of the page; the answer is a message `copied`."""
        self._send_msg({"kind": "copy", "text": text})

    def save(self, name: str, content: str | bytes, kind: str = "application/toml") -> None:
        """Let the browser save a file of a kind."""
        if isinstance(content, str):
            self._send_msg({"kind": "save", "name": name, "text": content, "type": kind})
        else:
            data = base64.b64encode(content).decode()
            self._send_msg({"kind": "save", "name": name, "data": data, "type": kind})

    def focus(self, kind: str) -> None:
        """Give a button of the bar the focus."""
        self._send_msg({"kind": "focus", "name": kind})

    def name_button(self, kind: str, words: str) -> None:
        """Name a button of the bar."""
        if self.labels[kind] != words:
            self.labels = {**self.labels, kind: words}

    def _values(self, names: list[str]) -> list[Any]:
        return [getattr(self, name) for name in names]

    def _call_idle(self, _: dict[str, Any]) -> None:
        # a new list first: a callback may ask for the next idle moment, which the browser must be asked for again
        callbacks, self._idle = self._idle, []
        for callback in callbacks:
            # those that wait after one that fails would never be called
            try:
                callback()
            except Exception as error:
                handle(error)

    def _handle_msg(self, data: Any) -> None:
        # any client can send anything here
        listener = self._listeners.get(str(data.get("kind"))) if isinstance(data, dict) else None
        if listener is not None:
            listener(data)


@contextlib.contextmanager
def one_message() -> Iterator[None]:
    """Send all changes made within as one message, for which the document is searched once for new models.

    Bokeh searches the whole document whenever what a model contains changes.
    """
    document = pn.state.curdoc
    freeze = contextlib.nullcontext() if document is None else document.models.freeze()
    # the hold around the freeze: a search after the message would send the new models again with the next one
    with pn.io.hold(), unfrozen(), freeze:
        yield


@contextlib.contextmanager
def unfrozen() -> Iterator[None]:
    """Leave the document of this turn open to changes after an error within: Bokeh's own `freeze` does not."""
    document = pn.state.curdoc
    before = frozen(document)
    try:
        yield
    except Exception:
        thaw(document, before)
        raise
