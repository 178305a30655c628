"""What keeps a page: its address follows its state, each change can be undone, files and links are opened."""

from collections.abc import Callable
from typing import Any

import panel as pn
import param

from railjoule.core import RailjouleError, ScenarioError
from railjoule.core.scenario.text_file import LARGEST_FILE_BYTES
from railjoule.dashboard.lifeline import Lifeline
from railjoule.dashboard.models.document import Document, document_of, lay, originals_of
from railjoule.dashboard.models.dropped import scenario_text
from railjoule.dashboard.models.history import History
from railjoule.dashboard.models.kept import Kept
from railjoule.dashboard.models.link import LinkTooLongError, read_link, sentence, write_link
from railjoule.dashboard.models.workbench import Workbench

NOTE_MS = 200
"""The first change after a rest is taken note of this much later, with all that came meanwhile."""
LONGEST_NAME = 80


class Keeping(param.Parameterized):
    """Keeps one page.

    Parameters
    ----------
    state : Workbench
    lifeline : Lifeline
        Its browser's half.
    """

    can_undo = param.Boolean(default=False, doc="Whether there is a step back.")
    can_redo = param.Boolean(default=False, doc="Whether there is a step forth.")
    copied = param.Boolean(default=None, allow_None=True, doc="Whether the last copy reached the clipboard.")
    noted = param.Event(doc="A change has been taken note of.")

    def __init__(self, state: Workbench, lifeline: Lifeline) -> None:
        super().__init__()
        self.state, self.lifeline = state, lifeline
        self._scheduled = self._laying = False
        self._watched: list[Kept] = []
        self._base: tuple[Any, ...] = ()
        self._originals: Document = {}
        for model in (state, *state.models.values()):
            model.param.watch(self._schedule, list(model.kept))
        self._watch_items()
        self.history = History(document_of(state))
        listeners: dict[str, Callable[[dict[str, Any]], None]] = {
            "open": lambda message: self.open_link(str(message.get("text"))),
            "undo": lambda _: self.undo(),
            "redo": lambda _: self.redo(),
            "drop": lambda message: self.open_file(str(message.get("name")), str(message.get("text"))),
            "too_large": lambda _: self.tell(f"The file is larger than the {LARGEST_FILE_BYTES / 1e6:g} MB allowed."),
            "no_text": lambda message: self.tell(f"{str(message.get('name'))[:LONGEST_NAME]}: not a text in UTF-8."),
            "copied": self._take_copied,
        }
        for kind, callback in listeners.items():
            lifeline.listen(kind, callback)

    def begin(self, query: str) -> None:
        """Open the state in the address of a new page; a step back from it there is none."""
        self.open_link(query)
        document = document_of(self.state)
        self.history = History(document)
        self._publish(document)

    def open_link(self, query: str) -> None:
        """Bring the page to the state in a query or fragment, and tell what of it cannot be opened."""
        read = read_link(query)
        refusals: tuple[str, ...] = ()
        if read.document:
            refusals = self._lay(read.document)
            self.note()
        told = " ".join(filter(None, [read.refusal, sentence(list(refusals))]))
        if told:
            self.tell(told)

    def open_file(self, name: str, text: str) -> None:
        """Take the scenario of a dropped file."""
        name = name[:LONGEST_NAME]
        try:
            if len(text) > LARGEST_FILE_BYTES:
                raise ScenarioError(f"{name}: more than the {LARGEST_FILE_BYTES / 1e6:g} MB allowed.")
            self.state.scenario.open(scenario_text(text, name), name)
        except RailjouleError as refusal:
            self.tell(str(refusal))
        else:
            self.state.notice = ""

    def tell(self, text: str) -> None:
        """Show a sentence above the page until it has been read."""
        self.state.notice = text

    def undo(self) -> None:
        """Take back the last step."""
        self.note()
        self._go(self.history.undo())

    def redo(self) -> None:
        """Take the last step that was taken back again."""
        self.note()
        self._go(self.history.redo())

    def note(self) -> None:
        """Take note of what has changed: for undo, for the address, and for the marks at changed fields."""
        self._scheduled = False
        document = document_of(self.state)
        self.history.note(document)
        self._publish(document)

    def _go(self, document: Document | None) -> None:
        if document is None:
            return
        refusals = self._lay({**document, "colours": self.state.colours})
        now = document_of(self.state)
        self.history.settle(now)
        self._publish(now)
        if refusals:
            self.tell(sentence(list(refusals)))

    def _lay(self, document: Document) -> tuple[str, ...]:
        self._laying = True
        try:
            with pn.io.hold():
                return lay(self.state, document)
        finally:
            self._laying = False
            self._watch_items()

    def _schedule(self, *_: Any) -> None:
        self._watch_items()
        document = pn.state.curdoc
        if document is not None and not self._scheduled and not self._laying:
            self._scheduled = True
            document.add_timeout_callback(self.note, NOTE_MS)

    def _watch_items(self) -> None:
        """Listen to the models that lists hold, where they are new."""
        items = [
            item
            for model in self.state.models.values()
            for field in model.kept
            if isinstance(getattr(model, field), list)
            for item in getattr(model, field)
            if isinstance(item, Kept)
        ]
        for item in items:
            if not any(item is known for known in self._watched):
                item.param.watch(self._schedule, list(item.kept))
        self._watched = items

    def _publish(self, document: Document) -> None:
        """Show a document in the address, mark what differs from the preset, and say what can be undone."""
        base = document["preset"], document["toml"], document["edits"]
        if base != self._base:
            self._base, self._originals = base, originals_of(document)
            self._mark()
        with pn.io.hold():
            self.lifeline.address = self._address(document)
            self.param.update(can_undo=self.history.can_undo, can_redo=self.history.can_redo)
            self.param.trigger("noted")

    def _address(self, document: Document) -> str:
        try:
            return write_link(document, self._originals)
        except LinkTooLongError as refusal:
            self.tell(str(refusal))
            return ""

    def _mark(self) -> None:
        """Tell the models of the scenario and the pages their original values."""
        for name, model in self.state.models.items():
            prefix = "" if model is self.state.scenario else f"{name}."
            model.originals = {field: self._originals.get(prefix + field) for field in model.kept}

    def _take_copied(self, message: dict[str, Any]) -> None:
        self.copied = None
        self.copied = bool(message.get("done"))
