"""The tabs of a page."""

from collections.abc import Callable, Mapping
from typing import Any

import panel_material_ui as pmui
from panel.viewable import Viewable

from railjoule.dashboard.browser import one_message
from railjoule.dashboard.parts.html import stack

TABS_PX = 42
TABS_STYLE = {
    "& .MuiTabs-root": {"minHeight": TABS_PX},
    "& .MuiTab-root": {"textTransform": "none", "fontSize": "14px", "minHeight": TABS_PX, "padding": "8px 12px"},
}


class TabBodies:
    """The parts of the tab of a page that is open.

    Parameters
    ----------
    page : Page
        Its `tab` names the open one.
    makers : mapping of str to callable
        Make the parts of each tab when it is first open.
    """

    def __init__(self, page: Any, makers: Mapping[str, Callable[[], Viewable]]) -> None:
        self.page, self.makers = page, makers
        self.bodies = {tab: stack(visible=False) for tab in makers}
        self.view = stack(*self.bodies.values())
        # before the figures of the tab are drawn
        page.param.watch(self._turn, "tab")
        self._turn()

    def is_made(self, tab: str) -> bool:
        """Return whether the parts of a tab are there."""
        return bool(list(self.bodies[tab]))

    def _turn(self, *_: Any) -> None:
        tab = self.page.tab
        if not self.is_made(tab):
            with one_message():
                self.bodies[tab][:] = [self.makers[tab]()]
        for name, body in self.bodies.items():
            body.visible = name == tab


class PageTabs(TabBodies):
    """A bar of tabs over the parts of the one that is open; `titles` has their names."""

    def __init__(self, page: Any, titles: Mapping[str, str], makers: Mapping[str, Callable[[], Viewable]]) -> None:
        places = list(titles)
        self.bar = pmui.Tabs(
            *((title, stack()) for title in titles.values()),
            active=places.index(page.tab),
            height=TABS_PX,
            margin=(0, 8),
            sizing_mode="stretch_width",
            sx=TABS_STYLE,
        )
        self.bar.param.watch(lambda event: page.param.update(tab=places[event.new]), "active")
        page.param.watch(lambda event: self.bar.param.update(active=places.index(event.new)), "tab")
        super().__init__(page, makers)
        self.view.insert(0, self.bar)
