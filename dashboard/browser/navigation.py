"""The bar of pages: what the browser shows of it, and the keys that open pages or pin the run."""

from collections.abc import Callable
from importlib.resources import files
from typing import Any

import param
from panel.custom import JSComponent

from railjoule.dashboard.look.scripts import module
from railjoule.dashboard.page_list import KEYED, PAGES

ASSETS = files("railjoule.assets")
BRAND = (
    '<svg width="22" height="22" viewBox="0 0 22 22" aria-hidden="true">'
    '<path d="M2 18 C5 18 5 5 9 5 C13 5 13 11 16 14 C18 16.5 19 18 20 18" fill="none" stroke="var(--rj-accent)" '
    'stroke-width="2.4" stroke-linecap="round"/>'
    '<path d="M1 20.5H21" stroke="var(--rj-line2)" stroke-width="1.4"/></svg>'
    '<span class="name">railjoule</span>'
)


class Navigation(JSComponent):
    """The bar of pages; it is drawn in the browser, which opens lists and marks the page before the server answers."""

    page = param.String(default="", doc="The page in sight.")
    entries = param.List(
        default=[{"name": name, "place": entry.place, "group": entry.group} for name, entry in PAGES.items()],
        doc="Name, place and group of each page.",
    )
    keyed = param.List(default=list(KEYED), doc="The pages that the keys 1 to 9 open.")
    brand = param.String(default=BRAND, doc="The brand, as HTML.")

    _esm = module("navigation")
    _stylesheets = [(ASSETS / "css" / "navigation.css").read_text(encoding="utf-8")]  # noqa: RUF012

    def __init__(self, turn: Callable[[str], None], pin: Callable[[], None], **params: object) -> None:
        super().__init__(**params)
        self._turn, self._pin = turn, pin

    def _handle_msg(self, data: Any) -> None:
        kind = data.get("kind") if isinstance(data, dict) else None
        # any client can send any text here, and the state takes no other page than these
        if kind == "page" and data.get("page") in PAGES:
            self._turn(data["page"])
        elif kind == "pin":
            self._pin()
