"""The button for a report, the form for its contents, and the progress."""

from collections.abc import Callable
from typing import Any

import panel as pn
import panel_material_ui as pmui

from railjoule.core import RailjouleError
from railjoule.dashboard.browser.browser import Browser
from railjoule.dashboard.browser.messages import added_to
from railjoule.dashboard.limits import LONGEST_NOTE
from railjoule.dashboard.parts.html import failure, html_pane, refusal, stack
from railjoule.dashboard.report.contents import Contents
from railjoule.dashboard.report.section_names import SECTION_TITLES
from railjoule.dashboard.report.work import ReportingModel

NARROW_PX = 700
MESSAGE_CSS = """
:host { position: fixed; top: 52px; right: 8px; max-width: min(420px, 90vw); z-index: 1300;
  background: var(--rj-surface); border-radius: 6px; }
"""
BELOW_THE_BAR = {"position": "fixed", "top": "45px", "left": "0", "right": "0", "width": "100%", "z-index": "1300"}
"""Place of the progress, with room on every screen."""
SMALL: dict[str, Any] = {"size": "small", "margin": 0, "align": "center"}
FIELD: dict[str, Any] = {"size": "small", "margin": (6, 0), "sizing_mode": "stretch_width"}
NOTE_HELP = f"Plain text of at most {LONGEST_NOTE} characters; an empty line begins a paragraph."


class ReportForm:
    """A dialog with the sections, the author and a note; its parts are made with it, when it is first opened.

    Parameters
    ----------
    make : callable
        Called with the contents that the user requests.
    """

    def __init__(self, make: Callable[[Contents], None]) -> None:
        self._make = make
        self.sections = pmui.CheckBoxGroup(
            label="Sections", options={title: name for name, title in SECTION_TITLES.items()}, value=[*SECTION_TITLES]
        )
        self.author = pmui.TextInput(label="Author", **FIELD)
        self.note = pmui.TextAreaInput(label="Note", description=NOTE_HELP, rows=5, max_length=10**6, **FIELD)
        self.refusal = html_pane(visible=False)
        self.cancel = pmui.Button(label="Cancel", variant="text", size="small")
        self.make = pmui.Button(label="Make the report", variant="contained", size="small")
        self.dialog = pmui.Dialog(
            self.sections,
            self.author,
            self.note,
            self.refusal,
            pn.Row(pn.HSpacer(), self.cancel, self.make, sizing_mode="stretch_width"),
            title="Report",
            title_variant="h6",
            close_on_click=True,
        )
        self.cancel.on_click(lambda _: self.dialog.param.update(open=False))
        self.make.on_click(self._take)

    def open(self) -> None:
        """Show the dialog."""
        self.refusal.visible = False
        self.dialog.open = True

    def _take(self, *_: Any) -> None:
        """Request the report, or show why there can be none."""
        try:
            contents = Contents(tuple(self.sections.value), self.author.value.strip(), self.note.value.strip())
        except RailjouleError as error:
            self.refusal.param.update(object=refusal(str(error)), visible=True)
            return
        self.dialog.open = False
        self._make(contents)


class ReportButton:
    """The report's part of the app bar.

    Parameters
    ----------
    model : ReportingModel
    browser : Browser
    save : callable
        Saves a file in the browser: takes its name, its text and its kind.
    """

    def __init__(self, model: ReportingModel, browser: Browser, save: Callable[[str, str, str], None]) -> None:
        self.model, self.browser, self._save_file = model, browser, save
        self.button = pmui.Button(label="Report", variant="outlined", height=30, **{**SMALL, "margin": (0, 6)})
        self.small = pmui.IconButton(icon="description", color="default", description="Report", visible=False, **SMALL)
        self.progress = pmui.LinearProgress(
            value=0, variant="determinate", margin=0, sizing_mode="stretch_width", styles=BELOW_THE_BAR, visible=False
        )
        self.stop = pmui.Button(label="Stop", variant="text", height=30, visible=False, **SMALL)
        self.message = html_pane(visible=False, sizing_mode=None)
        self.message.stylesheets = [*self.message.stylesheets, MESSAGE_CSS]
        self.form: ReportForm | None = None
        self.place = stack(sizing_mode=None, width=0)
        self.parts = [self.progress, self.stop, self.button, self.small, self.message, self.place]
        for button in (self.button, self.small):
            button.on_click(self._open)
        self.stop.on_click(lambda _: model.param.trigger("unwanted"))
        model.param.watch(self._show, ["busy", "share"])
        model.param.watch(self._save, "text")
        model.param.watch(self._show_failure, "failure")
        browser.follow(["window_width"], self._show)

    def _show(self, *_: Any) -> None:
        busy, narrow = self.model.busy, self.browser.window_width < NARROW_PX
        with pn.io.hold():
            self.progress.value = round(100 * self.model.share)
            self.progress.visible = self.stop.visible = busy
            self.button.visible = not busy and not narrow
            self.small.visible = not busy and narrow

    def _open(self, *_: Any) -> None:
        # every page that opens would pay for the form
        if self.form is None:
            self.form = ReportForm(self._make)
            self.form.dialog.param.watch(self._return_focus, "open")
            with added_to(self.place):
                self.place[:] = [self.form.dialog]
        self.form.open()

    def _return_focus(self, event: Any) -> None:
        # the library's dialog finds no element within another one's shadow root
        if not event.new:
            (self.button if self.button.visible else self.small).focus()

    def _make(self, contents: Contents) -> None:
        self.model.contents = contents
        self.model.param.trigger("wanted")

    def _save(self, *_: Any) -> None:
        if self.model.text:
            self._save_file(self.model.name_of_file, self.model.text, "text/html")
            # the browser has it by then, and a page need not keep megabytes
            self.model.text = ""

    def _show_failure(self, *_: Any) -> None:
        error: RailjouleError | None = self.model.failure
        self.message.visible = error is not None
        self.message.object = "" if error is None else failure("There is no report.", str(error), "")
