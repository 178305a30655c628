"""What keeps a page: its address follows its state, each change can be undone, files and links are opened."""

import logging
import time
from collections.abc import Callable
from contextlib import suppress
from typing import Any

import panel as pn
import param

from railjoule.core import RailjouleError
from railjoule.dashboard.insides import turns_of
from railjoule.dashboard.keep.dropped import NO_TEXT, TOO_LARGE, refused_file, scenario_text, words_of
from railjoule.dashboard.keep.history import History
from railjoule.dashboard.keep.lifeline import Lifeline
from railjoule.dashboard.keep.link import LinkTooLongError, ReadLink, read_link, sentence, write_link
from railjoule.dashboard.keep.snapshot import Document, document_of, lay, originals_of
from railjoule.dashboard.state.kept import Kept
from railjoule.dashboard.state.opened import outcome_of
from railjoule.dashboard.state.page_work import Items
from railjoule.dashboard.state.workbench import Workbench
from railjoule.dashboard.work.worker import SLOW_THREADS

LOG = logging.getLogger(__name__)
NOTE_MS = 200
"""The first change after a rest is taken note of this much later, with all that came meanwhile."""
# characters of a file's name in a sentence: it comes from the browser, however long
LONGEST_NAME = 80
LONGEST_AT_ONCE = 50_000
"""A scenario of more characters is read in a thread before the page takes it: that takes up to seconds."""


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
        self._noted_s = 0.0
        self._items = Items(self._schedule)
        self._base: tuple[Any, ...] = ()
        self._originals: Document = {}
        for model in (state, *state.models.values()):
            model.param.watch(self._schedule, list(model.kept))
        state.param.watch(self._note_with_runs, "runs")
        self._watch_items()
        self.history = History(document_of(state))
        listeners: dict[str, Callable[[dict[str, Any]], None]] = {
            "open": lambda message: self.open_link(str(message.get("text"))),
            "undo": lambda _: self.undo(),
            "redo": lambda _: self.redo(),
            "drop": lambda message: self.open_file(str(message.get("name")), str(message.get("text"))),
            "too_large": lambda message: self.refuse_file(str(message.get("name")), TOO_LARGE),
            "no_text": lambda message: self.refuse_file(str(message.get("name")), NO_TEXT),
            "copied": self._take_copied,
        }
        for kind, callback in listeners.items():
            lifeline.listen(kind, callback)

    def begin(self, query: str) -> None:
        """Open the state in the address of a new page; there is no step back from it.

        A long one is opened once the page has loaded. Whatever the address is, there is a page.
        """
        begun = True

        def open_unless_long() -> None:
            nonlocal begun
            read = read_link(query)
            begun = not self._takes_long(read.document.get("toml"))
            if begun:
                self._open(read)

        self._attempt("link", open_unless_long)
        document = document_of(self.state)
        self.history = History(document)
        self._publish(document)
        if not begun:
            # until then a reload finds the same address
            self.lifeline.address = query
            pn.state.onload(lambda: self.open_link(query))

    def open_link(self, query: str) -> None:
        """Bring the page to the state in a query or fragment, and tell what of it cannot be opened."""

        def read() -> None:
            found = read_link(query)
            self._when_read(found.document.get("toml"), lambda: self._attempt("link", lambda: self._open(found)))

        self._attempt("link", read)

    def _open(self, read: ReadLink) -> None:
        refusals: tuple[str, ...] = ()
        if read.document:
            refusals = self._lay(read.document)
            self.note()
        told = " ".join(filter(None, [read.refusal, sentence(list(refusals))]))
        if told:
            self.tell(told)

    def open_file(self, name: str, text: str) -> None:
        """Take the scenario of a file that was dropped or chosen."""
        name = name[:LONGEST_NAME]

        def take(toml: str) -> None:
            try:
                self.state.scenario.open(toml, name)
            except RailjouleError as refusal:
                self.tell(words_of(refusal, name))
            else:
                self.state.notice = ""

        try:
            toml = scenario_text(text, name)
        except RailjouleError as refusal:
            self.tell(str(refusal))
        else:
            self._when_read(toml, lambda: self._attempt("file", lambda: take(toml)))

    def refuse_file(self, name: str, reason: str) -> None:
        """Tell why a file was not opened, and what could be."""
        self.tell(refused_file(name[:LONGEST_NAME], reason))

    def _takes_long(self, toml: str | None) -> bool:
        """Return whether a scenario is so long that a page with others beside it had better not wait for it."""
        return toml is not None and len(toml) > LONGEST_AT_ONCE and pn.state.curdoc is not None

    def _when_read(self, toml: str | None, then: Callable[[], None]) -> None:
        """Go on with a scenario; with a long one in a later turn, once a thread has read it."""
        document = pn.state.curdoc
        if toml is None or document is None or not self._takes_long(toml):
            then()
        else:
            reading = SLOW_THREADS.submit(outcome_of, toml)
            turn = turns_of(document)
            # `then` reads it once more, from the cache of `outcome_of`
            reading.add_done_callback(lambda _: turn(then))

    def _attempt(self, what: str, act: Callable[[], None]) -> None:
        """Do to the page what a stranger's text asks for; if that fails, leave the page as it was and say so."""
        before = document_of(self.state)
        try:
            act()
        except Exception:  # MemoryError and RecursionError are among them
            LOG.exception("a %s could not be opened", what)
            with suppress(Exception):
                self._lay(before)
            self.tell(f"The {what} could not be opened; the server's log has the details.")

    def tell(self, text: str) -> None:
        """Show a sentence above the page until it has been read."""
        self.state.notice = text

    def undo(self) -> None:
        """Take back the last step."""
        self.note()
        # only after `note`: what was changed within the last NOTE_MS is a step too
        self._go(self.history.undo())

    def redo(self) -> None:
        """Take the last step that was taken back again."""
        self.note()
        self._go(self.history.redo())

    def note(self) -> None:
        """Take note of what has changed: for undo, for the address, and for the marks at changed fields."""
        self._scheduled, self._noted_s = False, time.monotonic()
        document = document_of(self.state)
        self.history.note(document)
        self._publish(document)

    def _go(self, document: Document | None) -> None:
        if document is None:
            return
        # colours are in no step, and what a document does not name becomes as on a new page
        refusals = self._lay({**document, "colours": self.state.colours})
        now = document_of(self.state)
        # as it is now: of the step's document, something may have been refused
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
        # what is laid over the page is noted by who lays it
        if document is not None and not self._scheduled and not self._laying:
            self._scheduled = True
            document.add_timeout_callback(self._note_if_scheduled, NOTE_MS)

    def _note_if_scheduled(self) -> None:
        if self._scheduled:
            self.note()

    def _note_with_runs(self, *_: Any) -> None:
        """Take note of a change in the message that brings its runs, but no more often than without them.

        Browsers refuse addresses that change more than a few times a second.
        """
        if time.monotonic() - self._noted_s >= NOTE_MS / 1000:
            self._note_if_scheduled()

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
        self._items.follow(items, lambda item: item.kept)

    def _publish(self, document: Document) -> None:
        """Show a document in the address, mark what differs from the preset, and say what can be undone."""
        base = document["preset"], document["toml"], document["edits"]
        # the originals take the state of a whole new page: they are made anew only where they may be others
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
        # so that a second copy that ends alike is a change, and is told
        self.copied = None
        self.copied = bool(message.get("done"))
