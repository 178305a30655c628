"""The shell of all pages: app bar, sidebar, the page in sight."""

import json
from collections.abc import Callable
from functools import cache, cached_property
from importlib.resources import files
from typing import Any

import panel as pn
import panel_material_ui as pmui
from bokeh.document import Document
from bokeh.model import Model

from railjoule.dashboard.browser import BRAND, Browser, one_message, unfrozen
from railjoule.dashboard.keep.keeping import Keeping
from railjoule.dashboard.library_workarounds import keep_colours, leave_busy, name_sheets
from railjoule.dashboard.look import glossary
from railjoule.dashboard.look.markup import markup
from railjoule.dashboard.look.scripts import lent, source
from railjoule.dashboard.look.theme import document_css, material_theme
from railjoule.dashboard.look.tokens import NARROW_PX
from railjoule.dashboard.page_list import PAGES, bar_entries
from railjoule.dashboard.parts.html import heading, html_pane, stack
from railjoule.dashboard.shell.share import Share
from railjoule.dashboard.shell.sidebar import Sidebar
from railjoule.dashboard.workbench import Workbench

FIRST_SKETCH = (
    '<svg viewBox="0 0 100 100" preserveAspectRatio="none" aria-hidden="true">'
    '<path d="M0 98 C4 40 8 16 18 16 L78 16 C90 16 96 46 100 98"/><path d="M0 99 H100"/></svg>'
)
# assets/scripts/browser.js turns pages that were left by this class, too
AWAY = "rj-away"
AWAY_CSS = """
:host(.rj-away) { position: absolute !important; inset: 0 0 auto 0; content-visibility: hidden; pointer-events: none; }
"""
"""A page that was left keeps its size and its figures, so that turning back to it costs nothing."""
NOT_OPENED = (
    "This page could not be opened because of a program error; the server\u2019s log describes it. The other pages "
    "work; open this one again to try once more."
)
OWN_COLOURS = ["Axis", "Title", "Grid", "Figure", "Plot", "Legend", "ColorBar", "BaseColorBar"]
"""Kinds of Bokeh models that the page of panel-material-ui shall not dress."""
COMPILING = (
    '<div class="compiling" role="status">The solver is being compiled, once on this machine: {percent} %'
    '<progress aria-label="Compiled" value="{percent}" max="100"></progress>'
    "Simple runs are shown already. All other results appear here by themselves, within about a minute.</div>"
)
HEADER_STYLE = {
    ".MuiAppBar-root": {
        # only with this pair of names the library does not force colours of its own on the bar
        "bgcolor": "primary.contrastText",
        "color": "primary.main",
        "boxShadow": "none",
        "borderBottom": "1px solid var(--rj-line)",
        "height": "49px",
        "overflow": "hidden",
    },
    "& .MuiAppBar-root .MuiToolbar-root": {"height": "48px"},
    "& .MuiAppBar-root .MuiIconButton-root": {"color": "var(--rj-ink2)"},
    # pages without the sidebar have no button for it: assets/css/page.css sets the variable
    "& .MuiAppBar-root [aria-label$=' drawer']": {"display": "var(--rj-beside, inline-flex)"},
}
"""With the hairline below it the bar is 49 px high: there the drawer of the editor begins (BAR_PX)."""


def asset(*path: str) -> str:
    """Return the text of an asset."""
    return files("railjoule.assets").joinpath(*path).read_text(encoding="utf-8")


@cache
def first_paint() -> dict[str, Any]:
    """Return the document's content before its scripts are read."""
    return {
        "first": source("first"),
        "repairs": source("repairs") + lent("number_field"),
        # no text may end the element of the script in which it stands
        "glossary": json.dumps(glossary.texts()).replace("<", "\\u003c"),
        "css": asset("css", "first.css"),
        "brand": BRAND,
        "pages": bar_entries(),
        "sketch": FIRST_SKETCH + FIRST_SKETCH.replace("<svg", '<svg class="low"'),
    }


class Page(pmui.Page):
    """The page of panel-material-ui; the browser's half looks for this name of its class."""

    def __init__(self, **params: Any) -> None:
        with leave_busy():
            super().__init__(**params)

    def _populate_template_variables(self, template_variables: dict[str, Any]) -> None:
        super()._populate_template_variables(template_variables)
        template_variables["railjoule"] = first_paint()

    def get_root(self, doc: Document | None = None, comm: Any = None, preprocess: bool = True) -> Model:
        """Return the root model, whose figures keep their own colours."""
        if doc is not None:
            name_sheets(doc)
        root = super().get_root(doc, comm, preprocess)
        keep_colours(root, OWN_COLOURS)
        return root


def document_settings() -> dict[str, Any]:
    """Return the part that is equal for all pages."""
    return {
        # the library would write it in white on the white bar: the brand stands in the bar of pages
        "title": "",
        "meta_title": "railjoule",
        "theme_config": material_theme(),
        "raw_css": [document_css()],
        "template": asset("templates", "page.html"),
        # the library's is about all pages of the process; `Browser.working` is about this one
        "busy_indicator": None,
    }


def empty_page() -> Page:
    """Return a page without a session: the document around it is that of every page."""
    return Page(**document_settings())


class Shell:
    """App bar, sidebar and the page in sight.

    Parameters
    ----------
    state : Workbench
    browser : Browser
    keeping : Keeping
    pages : mapping of str to callable
        Makes a page, called when it is first in sight.
    editor : Viewable
        The scenario's editor, which lies over a side of the page.
    """

    def __init__(
        self,
        state: Workbench,
        browser: Browser,
        keeping: Keeping,
        pages: dict[str, Callable[[], pn.viewable.Viewable]],
        editor: pn.viewable.Viewable,
    ) -> None:
        self.state, self.browser, self._make = state, browser, pages
        self._made: dict[str, pn.viewable.Viewable] = {}
        self._failed: set[str] = set()
        self._wide = True
        self._open, self._beside = True, PAGES[state.page].has_sidebar
        self.share = Share(state, browser, keeping)
        self.top = self.share.view
        """Stands above every page: messages, and the forms that buttons of the bar open."""
        self.compiling: pn.pane.HTML | None = None
        self.main = stack()
        self._keeping, self._place = keeping, stack()
        self.page = Page(
            main=[self.top, self.main, editor],
            # without anything in it the library lays out the page beside a sidebar that is not there
            sidebar=[self._place],
            sidebar_width=272,
            sidebar_open=self._beside,
            # the handle to resize it has a name that its role forbids: aria-prohibited-attr of axe-core
            sidebar_resizable=False,
            header=[browser],
            dark_theme=state.dark,
            sx=HEADER_STYLE,
            **document_settings(),
        )
        browser.page = state.page
        browser.listen("turn", lambda message: self._turn(str(message.get("name"))))
        browser.listen("pin", lambda _: self._pin())
        state.param.watch(self._show_page, "page")
        state.param.watch(self._name_pin, ["pins", "runs", "chosen"])
        state.editor.param.watch(self._make_room, "open")
        browser.follow(["window_width"], self._fit)
        browser.follow(["wants_dark"], self._colour)
        self.page.param.watch(self._follow_library, "dark_theme")
        state.param.watch(self._colour, "colours")
        state.param.watch(self._tell_work, ["late", "page"])

    @cached_property
    def sidebar(self) -> Sidebar:
        """The scenario beside the pages; made with the first page that has it."""
        return Sidebar(self.state, self.browser, self._keeping)

    def open(self) -> None:
        """Show the page that the state names."""
        with one_message():
            self._show_page()

    def show_compiling(self, share: float) -> None:
        """Show which share of the solver is compiled, from 0 to 1, above the page."""
        if self.compiling is None:
            self.compiling = html_pane()
            self.top.append(self.compiling)
        self.compiling.object = markup(COMPILING, percent=round(100 * share))

    def hide_compiling(self) -> None:
        """Remove that line."""
        if self.compiling is not None:
            self.top.remove(self.compiling)
            self.compiling = None

    def _turn(self, page: str) -> None:
        if page in PAGES:
            with pn.io.hold():
                self.state.page = page

    def _show_page(self, *_: Any) -> None:
        """Show the page that the state names; those that were open before stay where they are, out of sight."""
        name = self.state.page
        with pn.io.hold():
            self._show_sidebar()
            # a page that could not be made is made again, as NOT_OPENED promises
            if name in self._failed:
                self.main.remove(self._made.pop(name))
            if name not in self._made:
                with one_message():
                    # the browser's half finds the page by this name: assets/scripts/browser.js
                    self._made[name] = stack(self._opened(name), css=AWAY_CSS, name=f"page {name}")
                    self.main.append(self._made[name])
            for other, holder in self._made.items():
                holder.css_classes = [] if other == name else [AWAY]
            self.browser.page = name

    def _opened(self, name: str) -> pn.viewable.Viewable:
        """Return a page, or what stands in its place where it cannot be made."""
        try:
            with unfrozen():
                view = self._make[name]()
        except Exception as error:
            self.state.faults.note(error, f"the page {name} could not be opened")
            self._failed.add(name)
            failed = markup('<div class="message" role="alert">{}</div>', NOT_OPENED)
            return html_pane(heading(name, "", "", "") + failed)
        self._failed.discard(name)
        return view

    def _pin(self) -> None:
        """Pin the run that is shown, or let go of it where it is pinned."""
        pin = self.state.pin_of_run
        if pin is None:
            self.state.pin()
        else:
            self.state.unpin(pin)

    def _name_pin(self, *_: Any) -> None:
        self.browser.name_button("pin", "Pin run" if self.state.pin_of_run is None else "Unpin")

    def _fit(self) -> None:
        """Close the sidebar on narrow screens."""
        was_wide, self._wide = self._wide, self.browser.window_width >= NARROW_PX
        # only where the border is crossed: at every other size it stays as the user has left it
        if was_wide != self._wide:
            self._open = self._wide
            self.page.sidebar_open = self._open and self._beside

    def _show_sidebar(self) -> None:
        """Open or close the sidebar as the user has left it; pages without one have the whole width."""
        # on a page without a sidebar, its being closed is not the user's choice
        if self._beside:
            self._open = self.page.sidebar_open
        self._beside = PAGES[self.state.page].has_sidebar
        if self._beside and not self._place.objects:
            self._place[:] = [self.sidebar.view]
        self.page.sidebar_open = self._open and self._beside

    def _make_room(self, event: Any) -> None:
        """Close the sidebar where it would stand before the editor."""
        if event.new and not self._wide:
            self.page.sidebar_open = False

    def _colour(self, *_: Any) -> None:
        """Take the colours that the state names, or those that the system asks for; all in one message."""
        chosen = self.state.colours
        dark = self.browser.wants_dark if chosen == "system" else chosen == "dark"
        with pn.io.hold():
            self.state.dark = self.browser.dark = self.page.dark_theme = dark

    def _follow_library(self, event: Any) -> None:
        """Take colours that were chosen with the library's button; those of the system need not be kept."""
        if event.new != self.state.dark:
            by_hand = "dark" if event.new else "light"
            self.state.colours = "system" if event.new == self.browser.wants_dark else by_hand
            self._colour()

    def _tell_work(self, *_: Any) -> None:
        self.browser.working = self.state.page in self.state.late
