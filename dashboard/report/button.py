"""The button for a report, the form for its contents, and the progress."""

from collections.abc import Callable
from typing import Any

import panel as pn
import panel_material_ui as pmui

from railjoule.core import RailjouleError
from railjoule.dashboard.browser import Browser, one_message
from railjoule.dashboard.limits import LONGEST_NOTE
from railjoule.dashboard.parts.html import html_pane, refusal
from railjoule.dashboard.report.contents import Contents
from railjoule.dashboard.report.section_names import SECTION_TITLES
from railjoule.dashboard.report.work import ReportingModel
from railjoule.dashboard.workbench import Workbench

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
    """The report's part of the app bar: its button opens the form, and stops a report that is being made.

    Parameters
    ----------
    model : ReportingModel
    browser : Browser
    state : Workbench
        Shows why there is no report.
    place : Column
        Stands above the page; the form is put into it when it is first opened.
    """

    def __init__(self, model: ReportingModel, browser: Browser, state: Workbench, place: pn.Column) -> None:
        self.model, self.browser, self.state, self.place = model, browser, state, place
        self.form: ReportForm | None = None
        browser.listen("report", lambda _: self.press())
        model.param.watch(self._show, ["busy", "share"])
        model.param.watch(self._save, "text")
        model.param.watch(self._show_failure, "failure")

    def press(self) -> None:
        """Open the form, or stop the report that is being made."""
        if self.model.busy:
            self.model.param.trigger("unwanted")
            return
        if self.form is None:
            self.form = ReportForm(self._make)
            self.form.dialog.param.watch(self._return_focus, "open")
            # open from the beginning: a change that comes before the browser has drawn the dialog would be lost
            self.form.open()
            with one_message():
                self.place.append(self.form.dialog)
        else:
            self.form.open()

    def _return_focus(self, event: Any) -> None:
        # the library's dialog finds no element within another one's shadow root
        if not event.new:
            self.browser.focus("report")

    def _show(self, *_: Any) -> None:
        with pn.io.hold():
            self.browser.progress = self.model.share if self.model.busy else None
            self.browser.name_button("report", "Stop report" if self.model.busy else "Report")

    def _make(self, contents: Contents) -> None:
        self.model.contents = contents
        self.model.param.trigger("wanted")

    def _save(self, *_: Any) -> None:
        if self.model.text:
            self.browser.save(self.model.name_of_file, self.model.text, "text/html")
            # the browser has it by then, and a page need not keep megabytes
            self.model.text = ""

    def _show_failure(self, *_: Any) -> None:
        error: RailjouleError | None = self.model.failure
        if error is not None:
            self.state.notice = f"There is no report: {error}"
