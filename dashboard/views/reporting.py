"""The button that makes a report, its progress, and the saver that hands the file to the browser."""

from typing import Any

import panel as pn
import panel_material_ui as pmui
import param
from panel.custom import JSComponent

from railjoule.core import RailjouleError
from railjoule.dashboard.models.reporting import ReportingModel
from railjoule.dashboard.views.parts import failure, html_pane

SAVER_ESM = """
export function render({model}) {
  model.on("text", () => {
    if (!model.text) return;
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([model.text], {type: "text/html"}));
    link.download = model.name_of_file;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 60000);
    model.text = "";
  });
  return document.createElement("span");
}
"""
MESSAGE_CSS = """
:host { position: fixed; top: 52px; right: 8px; max-width: min(420px, 90vw); z-index: 1300;
  background: var(--rj-surface); }
"""


class Saver(JSComponent):
    """Lets the browser save a text as a file; the text is forgotten at once."""

    text = param.String(default="", doc="What to save.")
    name_of_file = param.String(default="report.html", doc="What the file is called.")

    _esm = SAVER_ESM


class ReportButton:
    """The report's part of the app bar."""

    def __init__(self, model: ReportingModel) -> None:
        self.model = model
        self.saver = Saver(width=0, height=0, margin=0)
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
            value=0, variant="determinate", width=56, margin=(0, 6), align="center", visible=False
        )
        self.stop = pmui.Button(
            label="Stop", variant="text", size="small", margin=0, align="center", height=30, visible=False
        )
        self.message = html_pane(visible=False, sizing_mode=None)
        self.message.stylesheets = [*self.message.stylesheets, MESSAGE_CSS]
        self._narrow = False
        self.parts = [self.progress, self.stop, self.button, self.small, self.message, self.saver]
        for button in (self.button, self.small):
            button.on_click(lambda _: model.param.trigger("wanted"))
        self.stop.on_click(lambda _: model.param.trigger("unwanted"))
        model.param.watch(self._show, ["busy", "share"])
        model.param.watch(self._save, "text")
        model.param.watch(self._tell, "failure")

    def fit(self, narrow: bool) -> None:
        """Take the little button on narrow screens."""
        self._narrow = narrow
        self._show()

    def _show(self, *_: Any) -> None:
        busy = self.model.busy
        with pn.io.hold():
            self.progress.value = round(100 * self.model.share)
            self.progress.visible = self.stop.visible = busy
            self.button.visible = not busy and not self._narrow
            self.small.visible = not busy and self._narrow

    def _save(self, *_: Any) -> None:
        if self.model.text:
            self.saver.param.update(name_of_file=self.model.name_of_file, text=self.model.text)
            self.model.text = ""

    def _tell(self, *_: Any) -> None:
        error: RailjouleError | None = self.model.failure
        self.message.visible = error is not None
        self.message.object = "" if error is None else failure("There is no report.", str(error), "")
