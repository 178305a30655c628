"""What only the browser knows, and what it can do without waiting for the server.

It tells the width of the window, whether the system asks for dark colours and which charts are in sight; it turns to
pages that are open already and opens the drawer at once; it names what screen readers would otherwise find without a
name.
"""

from collections.abc import Callable
from typing import Any

import param
from panel.custom import JSComponent

from railjoule.dashboard.faults import handle
from railjoule.dashboard.look.scripts import module
from railjoule.dashboard.page_list import PAGES


class Browser(JSComponent):
    """The reader of the page's browser.

    It speaks before the page has loaded, and what is changed on the page until then never reaches the browser; so
    those who `follow` it hear nothing before `start`.
    """

    window_width = param.Integer(default=1280, doc="Width of the window [px].")
    wants_dark = param.Boolean(default=False, doc="Whether the system asks for dark colours.")
    follows_system = param.Boolean(default=True, doc="Whether the page takes the colours that the system asks for.")
    dark = param.Boolean(default=False, doc="Whether the page is dark.")
    started = param.Boolean(default=False, doc="Whether the page has loaded.")
    hidden = param.Boolean(default=False, doc="Whether the browser shows another tab, or is minimised.")
    charts_in_sight = param.List(default=[], doc="Names of the charts in sight.")
    pages = param.List(default=list(PAGES), doc="Names of all pages.")
    questions = param.Dict(
        default={name: entry.question for name, entry in PAGES.items()}, doc="What each page answers."
    )
    bare = param.List(
        default=[name for name, entry in PAGES.items() if not entry.has_sidebar], doc="Pages without the sidebar."
    )
    page = param.String(default="", doc="The page in sight, as the server has it.")
    drawer = param.Boolean(default=False, doc="Whether the scenario's editor is open.")
    working = param.Boolean(default=False, doc="Whether the page in sight waits for a result.")

    _esm = module("browser")
    _priority_changes = ("window_width", "wants_dark", "hidden", "charts_in_sight")
    """They are sent rarely: they need not wait for others to come."""

    def __init__(self, **params: object) -> None:
        super().__init__(**params)
        self._followers: list[tuple[list[str], list[Any], Callable[[], None]]] = []
        self._idle: list[Callable[[], None]] = []
        self._toggle: Callable[[bool], None] = lambda _: None
        self._open: Callable[[str], None] = lambda _: None
        self._open_file: Callable[[str], None] = lambda _: None

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

    def when_idle(self, callback: Callable[[], None]) -> None:
        """Call back once, when the browser has nothing else to do."""
        self._idle.append(callback)
        # the browser answers once for all that wait
        if len(self._idle) == 1:
            self._send_msg({"kind": "when_idle"})

    def on_toggle(self, callback: Callable[[bool], None]) -> None:
        """Call back when the user asks for dark colours, or for light ones."""
        self._toggle = callback

    def on_open(self, callback: Callable[[str], None]) -> None:
        """Call back with the name of a shipped scenario when the user opens one of Start's cards."""
        self._open = callback

    def on_file(self, callback: Callable[[str], None]) -> None:
        """Call back with the name of a file when the user opens one of Start's list."""
        self._open_file = callback

    def _values(self, names: list[str]) -> list[Any]:
        return [getattr(self, name) for name in names]

    def _handle_msg(self, data: Any) -> None:
        kind = data.get("kind") if isinstance(data, dict) else None
        if kind == "idle":
            # a new list first: a callback may ask for the next idle moment, which the browser must be asked for again
            callbacks, self._idle = self._idle, []
            for callback in callbacks:
                # those that wait after one that fails would never be called
                try:
                    callback()
                except Exception as error:
                    handle(error)
        elif kind == "dark":
            self._toggle(bool(data.get("dark")))
        elif kind == "scenario":
            self._open(str(data.get("name")))
        elif kind == "file":
            self._open_file(str(data.get("name")))
