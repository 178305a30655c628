"""Handling of program errors: the log has the traceback once, and the page continues."""

import logging
import traceback
from collections.abc import Callable
from pathlib import Path
from weakref import WeakKeyDictionary, ref

import panel as pn
from bokeh.document import Document

from railjoule.dashboard.library_workarounds import session_document, thaw

LOG = logging.getLogger(__name__)
PACKAGE_FOLDER = str(Path(__file__).parents[1])
MOST_KNOWN = 200
"""Different errors of one session that are logged: a message may hold a number that each move changes."""
SENTENCE = "That did not work: a program error, which the server\u2019s log describes. Everything else still works."


class Faults:
    """The errors of this program in one session."""

    def __init__(self, tell: Callable[[str], None]) -> None:
        self._tell = tell
        self._known: set[tuple[object, ...]] = set()
        document = pn.state.curdoc
        if document is not None:
            FAULTS[document] = ref(self)

    def note(self, error: Exception, what: str) -> None:
        """Log an error with its traceback, unless the same one from the same line of railjoule is already logged."""
        frames = traceback.extract_tb(error.__traceback__)
        # a line of a library raises the errors of many lines of railjoule
        last = [frame for frame in frames if frame.filename.startswith(PACKAGE_FOLDER)][-1:] or frames[-1:]
        known = (type(error), str(error), *((frame.filename, frame.lineno) for frame in last))
        if known not in self._known and len(self._known) < MOST_KNOWN:
            self._known.add(known)
            LOG.error("%s", what, exc_info=error)

    def tell(self, error: Exception, what: str = "a change on the page failed") -> None:
        """Log an error, and say above the page that something did not work."""
        self.note(error, what)
        self._tell(SENTENCE)


# both weak: the session that has them reaches its document, which would never be freed
FAULTS: WeakKeyDictionary[Document, ref[Faults]] = WeakKeyDictionary()


def handle(error: BaseException) -> None:
    """Take what a callback of the library has raised.

    It is the library's exception handler, called within the turn of a session.
    """
    document = pn.state.curdoc
    known = FAULTS.get(session_document(document)) if document is not None else None
    faults = None if known is None else known()
    if not isinstance(error, Exception) or faults is None:
        LOG.error("a callback failed", exc_info=error)
        return
    # the turn that failed may have left the document frozen, as in `unfrozen`
    thaw(document, 0)
    faults.tell(error)
