"""The button for a report, the form that it opens, and the progress."""

from collections.abc import Callable
from typing import Any

import panel as pn
import panel_material_ui as pmui

from railjoule.core import RailjouleError
from railjoule.dashboard.browser.browser import Browser
from railjoule.dashboard.browser.messages import added_to
from railjoule.dashboard.parts.html import failure, html_pane, stack
from railjoule.dashboard.report.form import ReportForm, contents_of
from railjoule.dashboard.report.model import ReportingModel

NARROW_PX = 700
MESSAGE_CSS = """
:host { position: fixed; top: 52px; right: 8px; max-width: min(420px, 90vw); z-index: 1300;
  background: var(--rj-surface); border-radius: 6px; }
"""
BENEATH_THE_BAR = {"position": "fixed", "top": "45px", "left": "0", "right": "0", "width": "100%", "z-index": "1300"}
"""Where the progress has room on every screen."""


class ReportButton:
    """The report's part of the app bar.

    Parameters
    ----------
    model : ReportingModel
    browser : Browser
    save : callable
        Lets the browser save a file: takes its name, its text and its kind.
    """

    def __init__(self, model: ReportingModel, browser: Browser, save: Callable[[str, str, str], None]) -> None:
        self.model, self.browser, self._save_file = model, browser, save
        self.button = pmui.Button(
            label="Report", variant="outlined", size="small", margin=(0, 6), align="center", height=30
        )
        self.small = pmui.IconButton(
            icon="description",
            size="small",
            margin=0,
            align="center",
            color="default",
            description="Report",
            visible=False,
        )
        self.progress = pmui.LinearProgress(
            value=0, variant="determinate", margin=0, sizing_mode="stretch_width", styles=BENEATH_THE_BAR, visible=False
        )
        self.stop = pmui.Button(
            label="Stop", variant="text", size="small", margin=0, align="center", height=30, visible=False
        )
        self.message = html_pane(visible=False, sizing_mode=None)
        self.message.stylesheets = [*self.message.stylesheets, MESSAGE_CSS]
        self.form = ReportForm(self._hear)
        # empty until the form is asked for, as it would cost every page that opens
        self.place = stack(sizing_mode=None, width=0)
        self.parts = [self.progress, self.stop, self.button, self.small, self.message, self.place]
        for button in (self.button, self.small):
            button.on_click(self._open)
        self.stop.on_click(lambda _: model.param.trigger("unwanted"))
        model.param.watch(self._show, ["busy", "share"])
        model.param.watch(self._save, "text")
        model.param.watch(self._tell, "failure")
        browser.follow(["window_width"], self._show)

    def _show(self, *_: Any) -> None:
        busy, narrow = self.model.busy, self.browser.window_width < NARROW_PX
        with pn.io.hold():
            self.progress.value = round(100 * self.model.share)
            self.progress.visible = self.stop.visible = busy
            self.button.visible = not busy and not narrow
            self.small.visible = not busy and narrow

    def _open(self, *_: Any) -> None:
        self.form.param.update(open=True, refusal="")
        # last: what changes in one message before it is told where it stands, the browser does not know
        if not self.place.objects:
            with added_to(self.place):
                self.place[:] = [self.form]

    def _hear(self, message: dict[str, Any]) -> None:
        if message.get("what") == "close":
            self.form.open = False
        elif message.get("what") == "make":
            self._make(message)

    def _make(self, message: dict[str, Any]) -> None:
        """Ask for the report of a message, or tell why there is none."""
        try:
            self.model.contents = contents_of(message)
        except RailjouleError as error:
            self.form.refusal = str(error)
            return
        self.form.param.update(open=False, refusal="")
        self.model.param.trigger("wanted")

    def _save(self, *_: Any) -> None:
        if self.model.text:
            self._save_file(self.model.name_of_file, self.model.text, "text/html")
            # the browser has it by then, and a page need not keep megabytes
            self.model.text = ""

    def _tell(self, *_: Any) -> None:
        error: RailjouleError | None = self.model.failure
        self.message.visible = error is not None
        self.message.object = "" if error is None else failure("There is no report.", str(error), "")
