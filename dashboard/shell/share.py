"""Undo and redo, and what leaves the page: its link, its program, its command line, its file."""

from typing import Any

import panel as pn
import panel_material_ui as pmui
from panel.viewable import Viewable

from railjoule.core import RailjouleError
from railjoule.dashboard.browser.messages import added_to
from railjoule.dashboard.keep.keeping import Keeping
from railjoule.dashboard.look.markup import markup
from railjoule.dashboard.look.words import slug
from railjoule.dashboard.parts.html import html_pane, refusal, stack
from railjoule.dashboard.state.programs import page_recipe
from railjoule.dashboard.state.recipes import Recipe, as_command, as_python, as_toml
from railjoule.dashboard.state.workbench import Workbench

COPIED = {
    True: "Copied.",
    False: "The browser does not allow copying here: mark the text, or the address above, and copy it by hand.",
}
STATUS = '<p class="note" role="status" style="margin: 2px 20px 6px">{}</p>'
LAYOUT_CSS = """
:host { display: grid; grid-template-columns: repeat(2, minmax(0, 1fr)); gap: 8px 28px; padding: 0 20px 14px; }
@media (max-width: 899px) { :host { grid-template-columns: minmax(0, 1fr); padding: 0 14px 10px; } }
"""
LINE_CSS = ":host { border-bottom: 1px solid var(--rj-line); }"


class Share:
    """The buttons of the app bar, and the part above the page that one of them opens."""

    def __init__(self, state: Workbench, keeping: Keeping) -> None:
        self.state, self.keeping = state, keeping
        self.undo = _icon("undo", "Undo", lambda _: keeping.undo(), disabled=True)
        self.redo = _icon("redo", "Redo", lambda _: keeping.redo(), disabled=True)
        self.open = _icon("share", "Share", self._turn)
        self.buttons = [self.undo, self.redo, self.open]
        self.python, self.command = html_pane(), html_pane()
        self.status = html_pane(STATUS.format(""))
        # filled when it is first opened: it would cost every page that opens
        self.part = stack(css=LINE_CSS, visible=False)
        self.notice = html_pane()
        self.dismiss = _icon("close", "Close the message", lambda _: setattr(state, "notice", ""))
        self.message = pn.Row(self.notice, self.dismiss, margin=0, sizing_mode="stretch_width", visible=False)
        # the lifeline shows nothing, but its browser's half begins only where it stands on the page
        self.view = stack(self.part, self.message, keeping.lifeline)
        keeping.param.watch(self._follow, ["can_undo", "can_redo"])
        keeping.param.watch(self._write, "noted")
        keeping.param.watch(self._tell_copied, "copied")
        # runs too: they decide whether the chosen strategy or the optimum is written down
        state.param.watch(self._write, "runs")
        state.param.watch(self._tell, "notice")
        self._follow()
        self._tell()

    def _contents(self) -> list[Viewable]:
        buttons = [
            _button("Copy link", "link", lambda _: self.keeping.lifeline.copy_link()),
            _button("Copy as Python", "code", lambda _: self._copy(as_python)),
            _button("Copy as command line", "terminal", lambda _: self._copy(as_command)),
            _button("Save as TOML", "save", self._save),
        ]
        return [
            html_pane('<div class="head"><h2>Share what this page shows</h2></div>'),
            pn.FlexBox(*buttons, margin=(0, 14)),
            self.status,
            stack(self.python, self.command, css=LAYOUT_CSS),
        ]

    def _turn(self, *_: Any) -> None:
        self.part.visible = not self.part.visible
        self.open.description = "Close sharing" if self.part.visible else "Share"
        self.status.object = STATUS.format("")
        self._write()
        # last: what changes in one message before it is told where it stands, the browser does not know
        if not self.part.objects:
            with added_to(self.part):
                self.part[:] = self._contents()

    def _follow(self, *_: Any) -> None:
        self.undo.disabled, self.redo.disabled = not self.keeping.can_undo, not self.keeping.can_redo

    def _write(self, *_: Any) -> None:
        """Write down what the page computes, while this is in sight."""
        if not self.part.visible:
            return
        for pane, title, make in ((self.python, "Python", as_python), (self.command, "Command line", as_command)):
            text = self._made(make)
            pane.object = markup('<h2>{0}</h2><pre class="code" tabindex="0" aria-label="{0}">{1}</pre>', title, text)

    def _made(self, make: Any) -> str:
        """Return a text about the scenario as it stands, or why there is none."""
        try:
            return str(make(self._recipe()))
        except RailjouleError as refusal:
            # a comment to the shell and to Python, if it is copied
            return f"# {refusal}"

    def _recipe(self) -> Recipe:
        return page_recipe(self.state)

    def _copy(self, make: Any) -> None:
        self.keeping.lifeline.copy(self._made(make))

    def _save(self, *_: Any) -> None:
        download(self.state, self.keeping)

    def _tell_copied(self, event: Any) -> None:
        if event.new is not None:
            self.status.object = STATUS.format(COPIED[event.new])

    def _tell(self, *_: Any) -> None:
        text = self.state.notice
        self.message.visible = bool(text)
        self.notice.object = refusal(text) if text else ""


def download(state: Workbench, keeping: Keeping) -> None:
    """Let the browser save the scenario as a file."""
    try:
        recipe = page_recipe(state)
        keeping.lifeline.save(file_name(recipe.base.title), as_toml(recipe))
        if recipe.program.of_scenario and recipe.untold:
            state.notice = recipe.untold
    except RailjouleError as refusal:
        state.notice = str(refusal)


def file_name(title: str) -> str:
    """Return what the file of a scenario is called: letters and digits of its title."""
    return (slug(title) or "scenario") + ".toml"


def _icon(icon: str, description: str, on_click: Any, **params: Any) -> pmui.IconButton:
    return pmui.IconButton(
        icon=icon,
        description=description,
        on_click=on_click,
        size="small",
        margin=0,
        align="center",
        color="default",
        **params,
    )


def _button(label: str, icon: str, on_click: Any) -> pmui.Button:
    return pmui.Button(label=label, icon=icon, variant="text", size="small", margin=(2, 2), on_click=on_click)
