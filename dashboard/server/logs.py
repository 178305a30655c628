"""What the server writes down: one line for each page that was open, and what went wrong.

A page that is closed while something is under way to it is no error, though the libraries tell of it as one.
"""

import logging
from typing import TextIO

from tornado.iostream import StreamClosedError
from tornado.websocket import WebSocketClosedError

from railjoule.dashboard.server.options import NO_LOGIN, ServerOptions

LOG = logging.getLogger(__name__)
GONE = (WebSocketClosedError, StreamClosedError)
"""What writing to a page raises that has just been closed."""
WITH_TIME = logging.Formatter("%(asctime)s %(message)s", datefmt="%Y-%m-%d %H:%M:%S")
TOO_LATE = "Failed sending message as connection was closed"
# asyncio tells of errors in writing for which nobody waits
LOGGERS = ("asyncio", "bokeh.server.views.ws", "panel.io.document")


class StillThere(logging.Filter):
    """Lets pass what does not come from a page that has just been closed."""

    def filter(self, record: logging.LogRecord) -> bool:
        """Return whether a record is worth a line."""
        error = record.exc_info[1] if record.exc_info else None
        return not isinstance(error, GONE) and TOO_LATE not in record.getMessage()


def keep_quiet() -> None:
    """Let no line come of pages that have just been closed."""
    for name in LOGGERS:
        logger = logging.getLogger(name)
        # `panel serve` runs app.py for each page that opens: without a look, each would add one more filter for ever
        if not any(isinstance(known, StillThere) for known in logger.filters):
            logger.addFilter(StillThere())


def write_down() -> None:
    """Write what this program and its libraries tell to standard error, each line once and with its time."""
    root = logging.getLogger()
    if any(isinstance(handler, Dated) for handler in root.handlers):
        return
    # libraries add one of their own, without a time, where there is none yet
    root.addHandler(Dated())
    # Bokeh brings its own
    for handler in logging.getLogger("bokeh").handlers:
        handler.setFormatter(WITH_TIME)
    logging.getLogger("railjoule").setLevel(logging.INFO)


def warn_without_login(options: ServerOptions) -> None:
    """Say aloud where others than the users of this machine reach the pages."""
    if not options.is_for_this_machine:
        LOG.warning("%s A proxy that asks for a password belongs before it.", NO_LOGIN)


class Dated(logging.StreamHandler[TextIO]):
    """Writes lines with their time."""

    def __init__(self) -> None:
        super().__init__()
        self.setFormatter(WITH_TIME)
