"""What the server writes down: one line for each page that was open, and what went wrong.

A page that is closed while something is under way to it is no error, though the libraries tell of it as one.
"""

import logging

from tornado.iostream import StreamClosedError
from tornado.websocket import WebSocketClosedError

GONE = (WebSocketClosedError, StreamClosedError)
"""What writing to a page raises that has just been closed."""
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
    """Write the lines of this program to standard error, each once and with its time."""
    logger = logging.getLogger("railjoule")
    # a second handler would write each line twice, and so would that of the root logger below
    if logger.handlers:
        return
    handler = logging.StreamHandler()
    handler.setFormatter(logging.Formatter("%(asctime)s %(message)s", datefmt="%Y-%m-%d %H:%M:%S"))
    logger.addHandler(handler)
    logger.setLevel(logging.INFO)
    logger.propagate = False
