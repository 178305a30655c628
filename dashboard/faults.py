"""What happens when this program makes an error: the log has its traceback once, and the page goes on."""

import logging
import traceback
from collections.abc import Callable
from weakref import WeakKeyDictionary

import panel as pn
from bokeh.document import Document

from railjoule.dashboard.insides import session_document, thaw

LOG = logging.getLogger(__name__)
SENTENCE = "That did not work: a program error, which the server\u2019s log describes. Everything else still works."


class Faults:
    """The errors of this program in one session."""

    def __init__(self, tell: Callable[[str], None]) -> None:
        self._tell = tell
        self._known: set[tuple[str, str, int]] = set()
        document = pn.state.curdoc
        if document is not None:
            FAULTS[document] = self

    def note(self, error: Exception, what: str) -> None:
        """Log an error with its traceback, unless one of its kind from the same place is in the log already."""
        last = traceback.extract_tb(error.__traceback__)[-1:]
        place = (type(error).__name__, *((last[0].filename, last[0].lineno or 0) if last else ("", 0)))
        if place not in self._known:
            self._known.add(place)
            LOG.error("%s", what, exc_info=error)

    def tell(self, error: Exception, what: str = "a change on the page failed") -> None:
        """Log an error, and say above the page that something did not work."""
        self.note(error, what)
        self._tell(SENTENCE)


# weak, as a document must not outlive its session for this
FAULTS: WeakKeyDictionary[Document, Faults] = WeakKeyDictionary()


def handle(error: BaseException) -> None:
    """Take what a callback of the library has raised.

    It is the library's exception handler, called within the turn of a session.
    """
    document = pn.state.curdoc
    faults = FAULTS.get(session_document(document)) if document is not None else None
    if not isinstance(error, Exception) or faults is None:
        LOG.error("a callback failed", exc_info=error)
        return
    # the turn that failed may have left the document frozen, as in `unfrozen`
    thaw(document, 0)
    faults.tell(error)
