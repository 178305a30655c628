"""The shell of all pages: app bar, sidebar, the page in sight."""

import json
from collections.abc import Callable
from functools import cache
from importlib.resources import files
from typing import Any

import panel as pn
import panel_material_ui as pmui
from bokeh.document import Document
from bokeh.model import Model

from railjoule.dashboard.browser.browser import Browser
from railjoule.dashboard.browser.messages import added_to, one_message, unfrozen
from railjoule.dashboard.browser.navigation import BRAND, Navigation
from railjoule.dashboard.browser.presenting import Presenting
from railjoule.dashboard.browser.saving import Saving
from railjoule.dashboard.insides import keep_colours, leave_busy, name_sheets
from railjoule.dashboard.look import glossary
from railjoule.dashboard.look.markup import markup
from railjoule.dashboard.look.scripts import lent, source
from railjoule.dashboard.look.theme import document_css, material_theme
from railjoule.dashboard.look.tokens import NARROW_PX
from railjoule.dashboard.page_list import PAGES, bar_entries
from railjoule.dashboard.parts.html import heading, html_pane, stack
from railjoule.dashboard.shell.compiling import CompilingNote
from railjoule.dashboard.shell.share import Share
from railjoule.dashboard.shell.sidebar import Sidebar
from railjoule.dashboard.state.workbench import Workbench

COMPACT_PX = 1000
"""In narrower windows the bar has no room for words on its buttons."""
# with the hairline beneath it the bar is 49 px high: there the drawer of the editor begins (BAR_PX)
NAVIGATION = {"sizing_mode": "stretch_width", "height": 48, "margin": 0}
FIRST_SKETCH = (
    '<svg viewBox="0 0 100 100" preserveAspectRatio="none" aria-hidden="true">'
    '<path d="M0 98 C4 40 8 16 18 16 L78 16 C90 16 96 46 100 98"/><path d="M0 99 H100"/></svg>'
)
# browser.js and mends.js in assets/scripts know pages that were left by this class, too
AWAY = "rj-away"
AWAY_CSS = """
:host(.rj-away) { position: absolute !important; inset: 0 0 auto 0; content-visibility: hidden; pointer-events: none; }
"""
"""A page that was left keeps its size and its figures, so that turning back to it costs nothing."""
NOT_OPENED = (
    "This page could not be opened: a program error, which the server\u2019s log describes. The other pages "
    "work; turn to this one again to try once more."
)
OWN_COLOURS = ["Axis", "Title", "Grid", "Figure", "Plot", "Legend", "ColorBar", "BaseColorBar"]
"""Kinds of Bokeh models that the page of panel-material-ui shall not dress."""


def asset(*path: str) -> str:
    """Return the text of an asset."""
    return files("railjoule.assets").joinpath(*path).read_text(encoding="utf-8")


@cache
def first_paint() -> dict[str, Any]:
    """Return what the document shows and does before its scripts are read."""
    return {
        "first": source("first"),
        "mends": "".join(source(name) for name in ("follow", "mends", "glossary")) + lent("number_field"),
        "opening": source("opening"),
        # no text may end the element of the script in which it stands
        "glossary": json.dumps(glossary.texts()).replace("<", "\\u003c"),
        "css": asset("css", "first.css"),
        "brand": BRAND,
        "pages": bar_entries(),
        "sketch": FIRST_SKETCH + FIRST_SKETCH.replace("<svg", '<svg class="low"'),
    }


class Page(pmui.Page):
    """The page of panel-material-ui, cured of two habits; the browser's half looks for this name of its class."""

    def __init__(self, **params: Any) -> None:
        super().__init__(**params)
        leave_busy(self)

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


def of_the_document() -> dict[str, Any]:
    """Return what is the same for all pages."""
    return {
        # the library would write it in white on the white bar: the brand stands in the bar of pages
        "title": "",
        "meta_title": "railjoule",
        "theme_config": material_theme(),
        "raw_css": [document_css()],
        "template": asset("templates", "page.html"),
        # the library's tells of all pages of the process; `Browser.working` tells of this one
        "busy_indicator": None,
    }


def empty_page() -> Page:
    """Return a page of nobody: the document around it is that of every page."""
    return Page(**of_the_document())


class Shell:
    """App bar, sidebar and the page in sight.

    Parameters
    ----------
    state : Workbench
    browser : Browser
    share : Share
        Undo, redo and what leaves the page.
    pages : mapping of str to callable
        What makes each page, called when it is first in sight.
    editor : Viewable
        The scenario's editor, which lies over a side of the page.
    """

    def __init__(
        self,
        state: Workbench,
        browser: Browser,
        share: Share,
        pages: dict[str, Callable[[], pn.viewable.Viewable]],
        editor: pn.viewable.Viewable,
    ) -> None:
        self.state, self.browser, self.share, self._make = state, browser, share, pages
        self._made: dict[str, pn.viewable.Viewable] = {}
        self._failed: set[str] = set()
        self._wide = True
        self._open, self._beside = True, PAGES[state.page].has_sidebar
        self.main = stack()
        self.editor = editor
        self.sidebar = Sidebar(state, share.keeping)
        self.navigation = Navigation(self._turn_to, self._pin, page=state.page, **NAVIGATION)
        self.pin = pmui.Button(
            label="Pin run", icon="push_pin", variant="outlined", size="small", margin=(0, 6), align="center", height=30
        )
        self.pin_small = pmui.IconButton(
            icon="push_pin",
            size="small",
            margin=0,
            align="center",
            color="default",
            description="Pin run",
            visible=False,
        )
        slider = state.scenario.param["travel_time_s"].label
        self.presenting = Presenting(page=state.page, slider=slider, margin=0)
        self.compiling, self.saving = CompilingNote(), Saving()
        self.page = self._page()
        self.presenting.param.watch(lambda event: setattr(browser, "figure_px", event.new), "figure_px")
        self.pin.on_click(lambda _: self._pin())
        self.pin_small.on_click(lambda _: self._pin())
        state.param.watch(self._show_page, "page")
        state.param.watch(self._name_pin, ["pins", "runs", "chosen"])
        state.editor.param.watch(self._make_room, "open")
        browser.follow(["window_width"], self._fit)
        browser.follow(["wants_dark"], self._colour)
        browser.on_toggle(self._toggle)
        self.page.param.watch(self._follow_library, "dark_theme")
        state.param.watch(self._colour, "colours")
        state.param.watch(self._tell_work, ["late", "page"])

    def _page(self) -> Page:
        return Page(
            main=[self.share.view, self.compiling.view, self.main, self.browser, self.saving, self.editor],
            sidebar=[self.sidebar.view],
            sidebar_width=272,
            sidebar_open=self._beside,
            # the handle to resize it has a name that its role forbids: aria-prohibited-attr of axe-core
            sidebar_resizable=False,
            header=[self.navigation, self.presenting, *self.share.buttons, self.pin, self.pin_small],
            dark_theme=self.state.dark,
            **of_the_document(),
            sx={
                ".MuiAppBar-root": {
                    # with this pair of names alone the library does not force colours of its own on the bar
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
            },
        )

    def open(self) -> None:
        """Show the page that the state names."""
        with one_message():
            self._show_page()

    def add(self, *parts: pn.viewable.Viewable) -> None:
        """Put parts at the right end of the app bar."""
        # a new list, as nobody hears of what is added to the old one
        self.page.header = [*self.page.header, *parts]

    def _turn_to(self, page: str) -> None:
        with pn.io.hold():
            self.state.page = page

    def _show_page(self, *_: Any) -> None:
        """Show the page that the state names; those that were open before stay where they are, out of sight."""
        name = self.state.page
        with pn.io.hold():
            self.navigation.page = self.presenting.page = name
            self._show_sidebar()
            # a page that could not be made is made again, as NOT_OPENED promises
            if name in self._failed:
                self.main.remove(self._made.pop(name))
            if name not in self._made:
                # the browser's half knows by this name where the page stands: assets/scripts/browser.js
                self._made[name] = stack(self._opened(name), css=AWAY_CSS, name=f"page {name}")
                with added_to(self._made[name]):
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
        label = "Pin run" if self.state.pin_of_run is None else "Unpin"
        if self.pin.label != label:
            self.pin.label = self.pin_small.description = label

    def _fit(self) -> None:
        """Close the sidebar on narrow screens, and make the buttons small where the bar needs the room."""
        with pn.io.hold():
            compact = self.browser.window_width < COMPACT_PX
            self.pin.visible, self.pin_small.visible = not compact, compact
            was_wide, self._wide = self._wide, self.browser.window_width >= NARROW_PX
            # only where the border is crossed: at every other size it stays as the user has left it
            if was_wide != self._wide:
                self._open = self._wide
                self.page.sidebar_open = self._open and self._beside

    def _show_sidebar(self) -> None:
        """Open or close the sidebar as the user has left it; pages without one have the whole width."""
        # on a page without a sidebar, its being closed says nothing of what the user wants
        if self._beside:
            self._open = self.page.sidebar_open
        self._beside = PAGES[self.state.page].has_sidebar
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
            self.browser.follows_system = chosen == "system"
            self.state.dark = self.browser.dark = self.page.dark_theme = dark

    def _toggle(self, dark: bool) -> None:
        """Take colours that were asked for by hand; those of the system need not be kept."""
        by_hand = "dark" if dark else "light"
        self.state.colours = "system" if dark == self.browser.wants_dark else by_hand
        self._colour()

    def _follow_library(self, event: Any) -> None:
        """Take colours that the library has changed by itself."""
        if event.new != self.state.dark:
            self._toggle(bool(event.new))

    def _tell_work(self, *_: Any) -> None:
        self.browser.working = self.state.page in self.state.late
