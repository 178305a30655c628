"""What one of several processes does with a connection that it is handed."""

import contextlib
import socket
from collections.abc import Callable

LONGEST_WORD, MOST_AT_ONCE = 1, 1


def take_handed(channel: socket.socket, take: Callable[[socket.socket], None], end: Callable[[], None]) -> None:
    """Take the next connection from a channel that has one.

    Parameters
    ----------
    channel : socket
    take : callable
        Serves a connection.
    end : callable
        Called where whoever handed them on is gone.
    """
    try:
        word, files, _, _ = socket.recv_fds(channel, LONGEST_WORD, MOST_AT_ONCE)
    except OSError:
        word, files = b"", []
    if not word:
        end()
    for file in files:
        connection = socket.socket(fileno=file)
        connection.setblocking(False)
        # the browser may have gone meanwhile
        with contextlib.suppress(OSError):
            take(connection)
