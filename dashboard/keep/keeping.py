"""Persistence of a page: its address follows its state, each change can be undone, files and links are opened."""

import base64
import logging
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import PurePath
from typing import Any

import panel as pn
import param

from railjoule.core import RailjouleError
from railjoule.core.scenario._base import without_misleading
from railjoule.dashboard.browser import Browser
from railjoule.dashboard.keep.dropped import NO_TEXT, TOO_LARGE, refused_file, scenario_text, words_of
from railjoule.dashboard.keep.link import LinkTooLongError, ReadLink, read_link, sentence, write_link
from railjoule.dashboard.keep.snapshot import History, Snapshot, lay, originals_of, snapshot_of
from railjoule.dashboard.library_workarounds import make_turns
from railjoule.dashboard.limits import FILE_SUFFIXES, LARGEST_RUN_BYTES, STUDIES, large_study
from railjoule.dashboard.state.draft import try_opening
from railjoule.dashboard.state.kept import Items, Kept
from railjoule.dashboard.work.worker import SLOW_THREADS
from railjoule.dashboard.workbench import Workbench

LOG = logging.getLogger(__name__)
NOTE_MS = 200
"""Shortest interval between two recorded changes; the first one after a rest is recorded immediately."""
# characters of a file's name in a sentence: it comes from the browser, however long
LONGEST_NAME = 80
LONGEST_AT_ONCE = 50_000
"""A scenario of more characters is read in a thread before the page takes it: that takes up to seconds."""


def read_ahead(toml: str | None) -> None:
    """Read a scenario into the cache of those that are opened."""
    if toml is not None:
        try_opening(toml)


def shown_name(name: str) -> str:
    """Return the name of a file, which comes from the browser, as sentences show it."""
    return without_misleading(name[:LONGEST_NAME])


class Keeping(param.Parameterized):
    """Keeps one page.

    Parameters
    ----------
    state : Workbench
    browser : Browser
    """

    can_undo = param.Boolean(default=False, doc="Whether there is a step back.")
    can_redo = param.Boolean(default=False, doc="Whether there is a step forth.")
    copied = param.Boolean(default=None, allow_None=True, doc="Whether the last copy reached the clipboard.")
    noted = param.Event(doc="A change has been taken note of.")

    def __init__(self, state: Workbench, browser: Browser) -> None:
        super().__init__()
        self.state, self.browser = state, browser
        self._scheduled = self._laying = False
        self._noted_s = 0.0
        self._items = Items(self._schedule)
        self._base: tuple[Any, ...] = ()
        self._originals: Snapshot = {}
        for model in (state, *state.models.values()):
            model.param.watch(self._schedule, list(model.kept))
        state.param.watch(self._note_with_runs, "runs")
        self._watch_items()
        self.history = History(snapshot_of(state))
        listeners: dict[str, Callable[[dict[str, Any]], None]] = {
            "open": lambda message: self.open_link(str(message.get("text"))),
            "drop": self._take_dropped,
            "too_large": lambda message: self.refuse_file(str(message.get("name")), TOO_LARGE),
            "copied": self._take_copied,
        }
        for kind, callback in listeners.items():
            browser.listen(kind, callback)

    def begin(self, query: str) -> None:
        """Open the state in the address of a new page; there is no step back from it.

        One that takes long is opened once the page has loaded. Whatever the address is, there is a page.
        """
        begun = True

        def open_unless_long() -> None:
            nonlocal begun
            read = read_link(query)
            begun = not self._takes_long(read.snapshot)
            if begun:
                self._open(read)

        self._attempt("link", open_unless_long)
        snapshot = snapshot_of(self.state)
        self.history = History(snapshot)
        self._publish(snapshot)
        if not begun:
            # until then a reload finds the same address
            self.browser.address = query
            pn.state.onload(lambda: self.open_link(query))

    def open_link(self, query: str) -> None:
        """Bring the page to the state in a query or fragment, and tell what of it cannot be opened."""

        def read() -> None:
            found = read_link(query)
            self._when_read(found.snapshot, lambda: self._attempt("link", lambda: self._open(found)))

        self._attempt("link", read)

    def _open(self, read: ReadLink) -> None:
        refusals: tuple[str, ...] = ()
        if read.snapshot:
            refusals = self._lay(read.snapshot)
            self.note()
        message = " ".join(filter(None, [read.refusal, sentence(list(refusals))]))
        if message:
            self.tell(message)

    def open_file(self, name: str, text: str) -> None:
        """Take the scenario of a file that was dropped or chosen."""
        name = shown_name(name)

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
            self._when_read({"toml": toml}, lambda: self._attempt("file", lambda: take(toml)))

    def _take_dropped(self, message: dict[str, Any]) -> None:
        """Open a dropped scenario or report, and show any other file on the page of such files."""
        name = shown_name(str(message.get("name")))
        try:
            content = base64.b64decode(str(message.get("data")), validate=True)
        except ValueError:
            return  # the page's script never sends it
        suffix = PurePath(name).suffix.lower()
        if suffix not in {*FILE_SUFFIXES, *STUDIES}:
            try:
                self.open_file(name, content.decode())
            except UnicodeDecodeError:
                self.refuse_file(name, NO_TEXT)
        elif suffix not in STUDIES:
            self.state.turn_to("Files", dropped=(name, content))
        elif len(content) > LARGEST_RUN_BYTES:
            self.tell(large_study(name))
        else:
            self.state.turn_to("Explore", brought=(name, content))

    def refuse_file(self, name: str, reason: str) -> None:
        """Tell why a file was not opened, and what could be."""
        self.tell(refused_file(shown_name(name), reason))

    def _takes_long(self, snapshot: Snapshot) -> bool:
        """Return whether a page with others beside it had better not wait until a scenario is read."""
        toml, is_changed = snapshot.get("toml"), bool(snapshot.get("edits"))
        # without a page there is nobody else who waits, and no later turn
        if pn.state.curdoc is None or not (toml or is_changed):
            return False
        return toml is not None and len(toml) > LONGEST_AT_ONCE

    def _when_read(self, found: Snapshot, then: Callable[[], None]) -> None:
        """Go on with a scenario; with one that takes long in a later turn, once a thread has read it."""
        document = pn.state.curdoc
        if document is None or not self._takes_long(found):
            then()
        else:
            reading = SLOW_THREADS.submit(read_ahead, found.get("toml"))
            turn = make_turns(document)
            # `then` reads it once more, from the cache of `try_opening`
            reading.add_done_callback(lambda _: turn(then))

    def _attempt(self, what: str, act: Callable[[], None]) -> None:
        """Do to the page what a stranger's text asks for; if that fails, leave the page as it was and say so."""
        before = snapshot_of(self.state)
        try:
            act()
        except Exception:  # MemoryError and RecursionError are among them
            LOG.exception("a %s could not be opened", what)
            # what has broken the page may break this too: the sentence must be shown all the same
            with suppress(Exception):
                self._lay(before)
            self.tell(f"The {what} could not be opened; the server's log has the details.")

    def tell(self, text: str) -> None:
        """Show a sentence above the page until it has been read."""
        self.state.notice = text

    def rebase(self, toml: str) -> None:
        """Take a scenario with all its changes, as it was just saved, for the one that further changes are made to."""
        refusals = self._lay({**snapshot_of(self.state), "toml": toml, "edits": {}})
        self.note()
        if refusals:
            self.tell(sentence(list(refusals)))

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
        snapshot = snapshot_of(self.state)
        self.history.note(snapshot)
        self._publish(snapshot)

    def _go(self, snapshot: Snapshot | None) -> None:
        if snapshot is None:
            return
        # colours are in no step, and what a snapshot does not name becomes as on a new page
        refusals = self._lay({**snapshot, "colours": self.state.colours})
        now = snapshot_of(self.state)
        # as it is now: of the step's snapshot, something may have been refused
        self.history.settle(now)
        self._publish(now)
        if refusals:
            self.tell(sentence(list(refusals)))

    def _lay(self, snapshot: Snapshot) -> tuple[str, ...]:
        self._laying = True
        try:
            with pn.io.hold():
                return lay(self.state, snapshot)
        finally:
            self._laying = False
            self._watch_items()

    def _schedule(self, *_: Any) -> None:
        self._watch_items()
        document = pn.state.curdoc
        # what is laid over the page is noted by who lays it
        if document is not None and not self._scheduled and not self._laying:
            self._scheduled = True
            if time.monotonic() - self._noted_s >= NOTE_MS / 1000:
                # in the next turn: what follows from a change comes in the same one
                document.add_next_tick_callback(self._note_if_scheduled)
            else:
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

    def _publish(self, snapshot: Snapshot) -> None:
        """Show a snapshot in the address, mark what differs from the preset, and say what can be undone."""
        base = snapshot["preset"], snapshot["toml"], snapshot["edits"]
        # the originals take the state of a whole new page: they are made again only where they may differ
        if base != self._base:
            self._base, self._originals = base, originals_of(snapshot)
            self._mark()
        with pn.io.hold():
            self.browser.address = self._address(snapshot)
            if (self.can_undo, self.can_redo) != (self.history.can_undo, self.history.can_redo):
                self.param.update(can_undo=self.history.can_undo, can_redo=self.history.can_redo)
            self.param.trigger("noted")

    def _address(self, snapshot: Snapshot) -> str:
        try:
            return write_link(snapshot, self._originals)
        except LinkTooLongError as refusal:
            self.tell(str(refusal))
            return ""

    def _mark(self) -> None:
        """Tell the models of the scenario and the pages their original values."""
        for model in self.state.models.values():
            model.originals = {field: self._originals.get(f"{model.address_prefix}{field}") for field in model.kept}

    def _take_copied(self, message: dict[str, Any]) -> None:
        # so that a second copy that ends alike is a change, and is reported
        self.copied = None
        self.copied = bool(message.get("done"))
