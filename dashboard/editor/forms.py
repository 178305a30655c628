"""Components with a script of their own: a table whose cells are fields, and the editor's title."""

from collections.abc import Callable, Mapping
from typing import Any

import param
from panel.custom import JSComponent

from railjoule.dashboard.look.scripts import module
from railjoule.dashboard.look.templates import template
from railjoule.dashboard.look.theme import editor_css


class Form(JSComponent):
    """Base of all forms: style sheet, no space around them, handlers of browser messages.

    Parameters
    ----------
    hear : callable
        Called with each message of the browser.
    """

    def __init__(self, hear: Callable[[dict[str, Any]], None], **params: Any) -> None:
        super().__init__(
            **{"margin": 0, "sizing_mode": "stretch_width", "stylesheets": [editor_css()], **params},
        )
        self._hear = hear

    def _handle_msg(self, data: Any) -> None:
        if isinstance(data, dict):
            self._hear(data)


# not Panel's Tabulator (tried with 1.9.4 and 200 rows): a block pasted into a cell lands in that cell, or in range mode
# in the browser only, and the server gets nothing of it; Enter and Escape lose the focus to the page; axe finds a
# critical error (aria-required-children); a cell has no place for a refused text; 525 kB of script for each page
class TableForm(Form):
    """A table whose cells are fields."""

    table = param.Dict(default={}, doc="Content of the table.")
    html = param.String(default="", doc="Its head, and its cells without what they hold.")
    version = param.Integer(default=0, doc="Counts what was sent: the browser redraws at each.")

    _esm = module("table_form")
    _shape: Mapping[str, Any] = {}

    def show(self, table: dict[str, Any]) -> None:
        """Show a table; what a browser has typed since is written over."""
        shape = {**table, "rows": len(table["rows"]), "refusal": None}
        # 200 rows take some 10 ms
        if shape != self._shape:
            self._shape, self.html = shape, table_html(table)
        self.param.update(table=table, version=self.version + 1)


def table_html(table: dict[str, Any]) -> str:
    """Return a table without what its cells hold."""
    return template("table_form").render(table)


class EditorHead(Form):
    """The editor's title, the result, and the way out; it takes the focus in and gives it back."""

    status = param.String(default="", doc="The result.")
    alert = param.String(default="", doc="Why fields were refused, for screen readers.")
    open = param.Boolean(default=False, doc="Whether the editor is in sight.")

    _esm = module("editor_head")
