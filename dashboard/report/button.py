"""The button for a report, the form that it opens, and the progress."""

from typing import Any

import panel as pn

from railjoule.core import RailjouleError
from railjoule.dashboard.browser.browser import Browser
from railjoule.dashboard.browser.messages import one_message
from railjoule.dashboard.report.form import ReportForm, contents_of
from railjoule.dashboard.report.model import ReportingModel
from railjoule.dashboard.state.workbench import Workbench


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
            self.form = ReportForm(self._hear)
            with one_message():
                self.place.append(self.form)
        self.form.param.update(open=True, refusal="")

    def _show(self, *_: Any) -> None:
        with pn.io.hold():
            self.browser.progress = self.model.share if self.model.busy else None
            self.browser.name_button("report", "Stop report" if self.model.busy else "Report")

    def _hear(self, message: dict[str, Any]) -> None:
        assert self.form is not None
        if message.get("what") == "close":
            self.form.open = False
        elif message.get("what") == "make":
            self._make(self.form, message)

    def _make(self, form: ReportForm, message: dict[str, Any]) -> None:
        """Ask for the report of a message, or show why there is none."""
        try:
            self.model.contents = contents_of(message)
        except RailjouleError as error:
            form.refusal = str(error)
            return
        form.param.update(open=False, refusal="")
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
