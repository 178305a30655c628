"""My files on Start: the list of the workspace, and what is asked of each of its files."""

from collections.abc import Callable
from typing import Any

import param

from railjoule.core.workspace import OwnFile
from railjoule.dashboard.editor.forms import Form
from railjoule.dashboard.look.scripts import module
from railjoule.dashboard.state.files import FilesModel

LABELS = {"scenarios": "Scenario", "vehicles": "Vehicle", "lines": "Line", "runs": "Run"}
OPENS = {
    "scenarios": "Open",
    "vehicles": "Use in the scenario:",
    "lines": "Use in the scenario:",
    "runs": "Open on Measured runs:",
}
"""What pressing a name does."""


class FileList(Form):
    """The files, drawn and changed in the browser.

    Parameters
    ----------
    files : FilesModel
    opened : callable
        Called when the scenario has changed by one of them.
    show_run : callable
        Called with the name and the content of a measured run that is to be shown.
    """

    files = param.List(default=[], doc="What each row shows.")
    deleted = param.String(default="", doc="Name of what was deleted last.")
    folder = param.String(default="", doc="Where they are.")
    refusal = param.String(default="", doc="Why something was not done.")
    left_out = param.List(default=[], doc="What is not listed, with the reason.")

    _esm = module("file_list")

    def __init__(self, files: FilesModel, opened: Callable[[], None], show_run: Callable[[str, bytes], None]) -> None:
        super().__init__(self._take)
        self.model, self._opened, self._show_run = files, opened, show_run
        self.show()

    def show(self) -> None:
        """Show the list as it is."""
        files = self.model
        self.param.update(
            files=[self._row(file) for file in files.listing.files],
            deleted="" if files.deleted is None else files.deleted.file.name,
            folder="" if files.workspace is None else str(files.workspace.folder),
            refusal=files.refusal,
            left_out=[list(one) for one in files.listing.left_out],
        )

    def _row(self, file: OwnFile) -> dict[str, Any]:
        current = self.model.current
        is_open = current is not None and (current.kind, current.name) == (file.kind, file.name)
        return {
            "kind": file.kind,
            "name": file.name,
            "label": LABELS[file.kind],
            "opens": OPENS[file.kind],
            "changed_s": file.changed_s,
            "open": is_open,
            "stale": is_open and self.model.is_changed,
        }

    def _take(self, message: dict[str, Any]) -> None:
        what, files = message.get("what"), self.model
        if what == "undo":
            files.restore()
        elif what == "add":
            files.add(str(message.get("file"))[:200], str(message.get("text", "")))
        file = files.named(str(message.get("kind")), str(message.get("name")))
        if file is None:
            return
        if what == "rename":
            files.rename(file, str(message.get("text", "")))
        elif what == "open" and file.kind == "runs":
            files.open_run(file, self._show_run)
        elif what == "open":
            files.open(file, self._opened)
        elif what == "duplicate":
            files.duplicate(file)
        elif what == "delete":
            files.delete(file)
