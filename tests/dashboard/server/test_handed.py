import socket
from collections.abc import Iterator

import pytest

from railjoule.dashboard.server.handed import take_handed


@pytest.fixture
def channel() -> Iterator[tuple[socket.socket, socket.socket]]:
    ours, theirs = socket.socketpair()
    with ours, theirs:
        yield ours, theirs


def test_a_connection_that_is_handed_on_is_the_same_one(channel: tuple[socket.socket, socket.socket]) -> None:
    ours, theirs = channel
    browser, server = socket.socketpair()
    taken: list[socket.socket] = []
    with browser, server:
        socket.send_fds(ours, [b"c"], [server.fileno()])
        take_handed(theirs, taken.append, pytest.fail)
    (connection,) = taken
    with connection:
        assert connection.recv(1) == b""  # the browser's end is closed
        assert not connection.getblocking()


def test_whoever_hands_on_being_gone_ends_it(channel: tuple[socket.socket, socket.socket]) -> None:
    ours, theirs = channel
    ours.close()
    ended: list[bool] = []
    take_handed(theirs, pytest.fail, lambda: ended.append(True))
    assert ended == [True]


def test_a_browser_that_has_gone_meanwhile_is_forgotten(channel: tuple[socket.socket, socket.socket]) -> None:
    ours, theirs = channel
    browser, server = socket.socketpair()

    def take(connection: socket.socket) -> None:
        connection.close()
        raise OSError

    with browser, server:
        socket.send_fds(ours, [b"c"], [server.fileno()])
    take_handed(theirs, take, pytest.fail)
