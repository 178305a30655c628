"""Undo, redo and messages, and what leaves the page: its link, its program, its command line, its file."""

from typing import Any

import panel as pn

from railjoule.core import RailjouleError
from railjoule.dashboard.browser import Browser, one_message
from railjoule.dashboard.keep.keeping import Keeping
from railjoule.dashboard.look.markup import Markup, markup
from railjoule.dashboard.look.words import slug
from railjoule.dashboard.parts.html import html_pane, refusal, stack
from railjoule.dashboard.scenario_folder import FileExistsInFolderError, checked_name
from railjoule.dashboard.state.recipes import as_command, as_python, as_toml, page_recipe
from railjoule.dashboard.workbench import Workbench

COPIED = {
    True: "Copied.",
    False: "The browser does not allow copying here: select the text, or the address above, and copy it by hand.",
}
SHARE = Markup(
    '<div class="head"><h2>Share what this page shows</h2></div><div class="asks">'
    '<button type="button" class="text-button" data-ask="copy" data-name="link">Copy link</button>'
    '<button type="button" class="text-button" data-ask="copy" data-name="python">Copy as Python</button>'
    '<button type="button" class="text-button" data-ask="copy" data-name="command">Copy as command line</button>'
    '<button type="button" class="text-button" data-ask="download">Save as TOML</button></div>'
)
TEXTS = (
    '<p class="note" role="status">{status}</p><div class="shared"><div><h2>Python</h2>'
    '<pre class="code" tabindex="0" aria-label="Python">{python}</pre></div><div><h2>Command line</h2>'
    '<pre class="code" tabindex="0" aria-label="Command line">{command}</pre></div></div>'
)
MESSAGE = (
    '<div class="dismissible">{}<button type="button" class="text-button" data-ask="dismiss" '
    'aria-label="Close the message">\u00d7</button></div>'
)
REFUSED = '<div class="row"><p class="error" role="alert">{}</p></div>'
SAVED = '<div class="row"><p class="small muted" role="status">{}</p></div>'
BUTTON_CSS = ".bk-btn { font-size: 13px !important; padding: 4px 10px; }"
MAKERS = {"python": as_python, "command": as_command}


class Share:
    """The buttons of the app bar that undo, redo and share; the place above the page for messages and texts to copy."""

    def __init__(self, state: Workbench, browser: Browser, keeping: Keeping) -> None:
        self.state, self.browser, self.keeping = state, browser, keeping
        self.notice = html_pane(visible=False)
        self.view = stack(self.notice)
        self.part: pn.Column | None = None
        self.texts: pn.pane.HTML | None = None
        browser.listen("undo", lambda _: keeping.undo())
        browser.listen("redo", lambda _: keeping.redo())
        browser.listen("share", lambda _: self._turn())
        browser.listen("escape", lambda _: self._close())
        browser.listen("copy", lambda message: self._copy(str(message.get("name"))))
        browser.listen("download", lambda _: download(state, browser))
        browser.listen("dismiss", lambda _: setattr(state, "notice", ""))
        keeping.param.watch(self._follow, ["can_undo", "can_redo"])
        keeping.param.watch(lambda *_: self._write(), "noted")
        keeping.param.watch(self._show_copied, "copied")
        # runs too: they decide whether the chosen strategy or the optimum is written down
        state.param.watch(lambda *_: self._write(), "runs")
        state.param.watch(self._show_notice, "notice")
        self._follow()
        self._show_notice()

    def _close(self) -> None:
        if self.part is not None:
            self._turn()

    def _turn(self) -> None:
        with one_message():
            if self.part is None:
                self.texts = html_pane()
                self.part = stack(html_pane(SHARE), self.texts)
                self.view.insert(0, self.part)
            else:
                self.view.remove(self.part)
                self.part = self.texts = None
            self.browser.name_button("share", "Share" if self.part is None else "Close sharing")
            self._write()

    def _follow(self, *_: Any) -> None:
        can = {"undo": self.keeping.can_undo, "redo": self.keeping.can_redo}
        disabled = [kind for kind, is_possible in can.items() if not is_possible]
        if self.browser.disabled != disabled:
            self.browser.disabled = disabled

    def _write(self, status: str = "") -> None:
        """Write down what the page computes, while this is in sight."""
        if self.texts is not None:
            made = {name: self._made(name) for name in MAKERS}
            self.texts.object = markup(TEXTS, status=status, **made)

    def _made(self, name: str) -> str:
        """Return a text about the scenario as it stands, or why there is none."""
        try:
            return str(MAKERS[name](page_recipe(self.state)))
        except RailjouleError as refusal:
            # a comment to the shell and to Python, if it is copied
            return f"# {refusal}"

    def _copy(self, name: str) -> None:
        self.browser.copy(self._made(name) if name in MAKERS else None)

    def _show_copied(self, event: Any) -> None:
        if event.new is not None:
            self._write(COPIED[event.new])

    def _show_notice(self, *_: Any) -> None:
        text = self.state.notice
        self.notice.object = markup(MESSAGE, refusal(text)) if text else ""
        self.notice.visible = bool(text)


class SaveScenario:
    """The form in the sidebar that saves the scenario to the server's folder; a download where the server has none."""

    def __init__(self, state: Workbench, browser: Browser, keeping: Keeping, view: pn.Column) -> None:
        self.state, self.browser, self.keeping, self.files = state, browser, keeping, state.files
        self._sidebar = view
        self.form: pn.Column | None = None
        self.refusal = self.status = ""
        browser.listen("save_scenario", lambda _: self.press())
        self.files.param.watch(self._suggest, "current")
        state.scenario.param.watch(self._clear, ["preset", "opened", "edits"])

    def press(self) -> None:
        """Open or close the form, or save where the server has no folder."""
        if self.files.folder is None:
            download(self.state, self.browser)
        elif self.form is None:
            self._make()
        else:
            self._sidebar.remove(self.form)
            self.form = None

    def _make(self) -> None:
        self.name = pn.widgets.TextInput(label="Name", max_length=200, sizing_mode="stretch_width", margin=(4, 16))
        self.message = html_pane()
        save, self.replace, close = (
            pn.widgets.Button(label=label, margin=4, stylesheets=[BUTTON_CSS])
            for label in ("Save", "Replace it", "Close")
        )
        self.replace.visible = False
        self.name.param.watch(lambda _: self.save(), "enter_pressed")
        save.on_click(lambda _: self.save())
        self.replace.on_click(lambda _: self.save(replace=True))
        close.on_click(lambda _: self.press())
        buttons = pn.Row(save, self.replace, close, margin=(0, 12))
        with one_message():
            self.form = stack(self.name, self.message, buttons)
            self._show()
            self._sidebar.insert(2, self.form)

    def _suggest(self, *_: Any) -> None:
        # a refused name stays beside its reason
        if self.form is not None and not self.refusal:
            self.name.value = self._suggested_name()

    def _clear(self, *_: Any) -> None:
        """Remove the message: the scenario is no longer the saved one."""
        if self.form is not None:
            self._show()

    def _show(self, status: str = "", refusal: str = "", can_replace: bool = False) -> None:
        self.status, self.refusal = status, refusal
        self.replace.visible = can_replace
        self.message.object = markup(REFUSED, refusal) if refusal else markup(SAVED, status) if status else ""
        if not refusal:
            self.name.value = self._suggested_name()

    def _suggested_name(self) -> str:
        return self.files.current or file_name(self.state.scenario.edited.title).removesuffix(".toml")

    def save(self, replace: bool = False) -> None:
        """Save the scenario under the name in the form."""

        def take(saved: str, toml: str) -> None:
            self.keeping.rebase(toml)
            self._show(status=f"Saved as {saved}.toml.")

        def refuse(error: RailjouleError) -> None:
            self._show(refusal=str(error), can_replace=isinstance(error, FileExistsInFolderError))

        try:
            name = checked_name(self.name.value)
            recipe = page_recipe(self.state)
            # a page without a scenario of its own, such as Papers, changes nothing in it
            scenario = recipe.scenario if recipe.program.of_scenario else self.state.scenario.scenario()
            # a copy under another name would be mistaken for its original in pins, links and reports
            if name != self.files.current and slug(name) != slug(scenario.title) and "title" not in recipe.changes:
                scenario = scenario.replace(title=name)
        except RailjouleError as error:
            refuse(error)
            return
        self.files.save(name, scenario, replace, take, refuse)


def download(state: Workbench, browser: Browser) -> None:
    """Let the browser save the scenario as a file."""
    try:
        recipe = page_recipe(state)
        browser.save(file_name(recipe.base.title), as_toml(recipe))
        if recipe.program.of_scenario and recipe.program_note:
            state.notice = recipe.program_note
    except RailjouleError as refusal:
        state.notice = str(refusal)


def file_name(title: str) -> str:
    """Return the name of the file of a scenario: letters and digits of its title."""
    return (slug(title) or "scenario") + ".toml"
