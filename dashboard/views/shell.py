"""The shell of all pages: app bar, sidebar, the page in sight."""

from collections.abc import Callable
from importlib.resources import files
from typing import Any

import panel as pn
import panel_material_ui as pmui
from bokeh.document import Document
from bokeh.model import Model

from railjoule.dashboard.browser import Browser
from railjoule.dashboard.look.theme import document_css, material_theme
from railjoule.dashboard.models.workbench import PAGES, Workbench
from railjoule.dashboard.views.parts import html_pane, stack
from railjoule.dashboard.views.saving import Saving
from railjoule.dashboard.views.share import Share
from railjoule.dashboard.views.sidebar import Sidebar
from railjoule.dashboard.views.starting import StartingView

NARROW_PX = 900
MENU_PX = 700
BRAND_PX = 480
BRAND = (
    '<div class="brand"><svg width="22" height="22" viewBox="0 0 22 22" aria-hidden="true">'
    '<path d="M2 18 C5 18 5 5 9 5 C13 5 13 11 16 14 C18 16.5 19 18 20 18" fill="none" stroke="var(--rj-accent)" '
    'stroke-width="2.4" stroke-linecap="round"/>'
    '<path d="M1 20.5H21" stroke="var(--rj-line2)" stroke-width="1.4"/></svg>'
    "railjoule</div>"
)
TEMPLATE = (
    "{% extends 'base.html' %}{% block postamble %}{{ super() }}<script>"
    + (files("railjoule.assets") / "scripts" / "follow.js").read_text(encoding="utf-8")
    + "</script>{% endblock %}"
)
"""Of the page around Panel's components, with a cure of theirs."""
OWN_COLOURS = ["Axis", "Title", "Grid", "Figure", "Plot", "Legend", "ColorBar", "BaseColorBar"]
"""Kinds of Bokeh models that the page of panel-material-ui shall not dress."""


class Page(pmui.Page):
    """The page of panel-material-ui, cured of two habits.

    It listens to a signal of the whole process and never stops, so that every closed page stays alive and every
    change anywhere costs all open pages; and it dresses all figures anew in the browser. The browser's half looks
    for the name of this class, so it must be Page.
    """

    def __init__(self, **params: Any) -> None:
        super().__init__(**params)
        private = self._param__private
        for _, watcher in list(private.ref_watchers):
            pn.state.param.unwatch(watcher)
        private.ref_watchers.clear()
        private.refs.pop("busy", None)

    def get_root(self, doc: Document | None = None, comm: Any = None, preprocess: bool = True) -> Model:
        """Return the root model, whose figures keep their own colours."""
        root = super().get_root(doc, comm, preprocess)
        root.data._custom_theme = OWN_COLOURS
        return root


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
        self._wide = True
        self.main = stack()
        self.editor = editor
        self.sidebar = Sidebar(state, share.keeping)
        self.tabs = pmui.TabMenu(
            items=list(PAGES), active=PAGES.index(state.page), variant="scrollable", scroll_buttons="false", margin=0
        )
        self.menu = pmui.MenuButton(
            label=state.page,
            items=[{"label": page} for page in PAGES],
            variant="text",
            size="small",
            margin=0,
            align="center",
            visible=False,
        )
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
        self.brand = html_pane(
            BRAND, sizing_mode="fixed", width=112, height=22, margin=(0, 10, 0, 0), styles={"align-self": "center"}
        )
        self.starting, self.saving = StartingView(), Saving()
        self.page = self._page()
        self.tabs.param.watch(self._turn, "active")
        self.menu.on_click(self._pick)
        self.pin.on_click(self._pin)
        self.pin_small.on_click(self._pin)
        state.param.watch(self._show_page, "page")
        state.param.watch(self._name_pin, ["pins", "runs", "chosen"])
        state.editor.param.watch(self._make_room, "open")
        browser.follow(["window_width"], self._fit)
        browser.follow(["wants_dark"], self._follow_system)
        self.page.param.watch(self._paint, "dark_theme")
        state.param.watch(self._colour, "colours")

    def _page(self) -> Page:
        space = pn.Spacer(sizing_mode="stretch_width")
        return Page(
            title="",
            meta_title="railjoule",
            main=[self.share.view, self.main, self.browser, self.saving, self.editor],
            sidebar=[self.sidebar.view],
            sidebar_width=272,
            sidebar_open=True,
            sidebar_resizable=False,
            header=[self.brand, self.tabs, self.menu, space, *self.share.buttons, self.pin, self.pin_small],
            dark_theme=self.state.dark,
            theme_config=material_theme(),
            raw_css=[document_css()],
            template=TEMPLATE,
            busy_indicator=None,
            sx={
                ".MuiAppBar-root": {
                    "bgcolor": "primary.contrastText",
                    "color": "primary.main",
                    "boxShadow": "none",
                    "borderBottom": "1px solid var(--rj-line)",
                    "height": "49px",
                    "overflow": "hidden",
                },
                "& .MuiAppBar-root .MuiToolbar-root": {"height": "48px"},
                "& .MuiAppBar-root .MuiIconButton-root": {"color": "var(--rj-ink2)"},
            },
        )

    def show_starting(self) -> None:
        """Show how far the kernels are, in the place of the page."""
        self.main[:] = [self.starting.view]

    def open(self) -> None:
        """Show the page that the state names."""
        self._show_page()

    def add(self, *parts: pn.viewable.Viewable) -> None:
        """Put parts at the right end of the app bar."""
        self.page.header = [*self.page.header, *parts]

    def _turn(self, event: Any) -> None:
        self.state.page = PAGES[event.new]

    def _pick(self, item: dict[str, str]) -> None:
        self.state.page = item["label"]

    def _show_page(self, *_: Any) -> None:
        name = self.state.page
        if name not in self._made:
            self._made[name] = self._make[name]()
        with pn.io.hold():
            self.main[:] = [self._made[name]]
            self.tabs.active = PAGES.index(name)
            self.menu.label = name

    def _pin(self, *_: Any) -> None:
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
        """Close the sidebar on narrow screens, and put the pages into a menu on the narrowest."""
        with pn.io.hold():
            narrow = self.browser.window_width < MENU_PX
            self.tabs.visible, self.menu.visible = not narrow, narrow
            self.pin.visible, self.pin_small.visible = not narrow, narrow
            self.brand.visible = self.browser.window_width >= BRAND_PX
            was_wide, self._wide = self._wide, self.browser.window_width >= NARROW_PX
            if was_wide != self._wide:
                self.page.sidebar_open = self._wide

    def _make_room(self, event: Any) -> None:
        """Close the sidebar where it would stand before the editor."""
        if event.new and not self._wide:
            self.page.sidebar_open = False

    def _follow_system(self) -> None:
        """Take the colours that the system asks for, where no others were chosen."""
        if self.state.colours == "system":
            self.page.dark_theme = self.browser.wants_dark

    def _colour(self, *_: Any) -> None:
        """Take the colours that the state names."""
        wish = self.state.colours
        self.page.dark_theme = self.browser.wants_dark if wish == "system" else wish == "dark"

    def _paint(self, event: Any) -> None:
        by_hand = "dark" if event.new else "light"
        colours = "system" if event.new == self.browser.wants_dark else by_hand
        self.state.param.update(dark=event.new, colours=colours)
        self.browser.dark = event.new
