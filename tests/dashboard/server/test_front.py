"""What stands before the processes, with processes that only tell which of them was asked for what."""

import asyncio
import contextlib
import gc
import os
import signal
import socket
import threading
import time
from collections.abc import Iterator, MutableSequence
from multiprocessing import get_context
from multiprocessing.process import BaseProcess

import pytest

from railjoule.dashboard.server.front import SERVES, Front
from railjoule.dashboard.server.options import ServerOptions
from railjoule.dashboard.server.places import NUMBERS

PROCESSES = 2
WAIT_S = 20.0
CONTEXT = get_context("spawn")


def answer(number: int, channel: socket.socket) -> None:
    """Answer each connection with its number, and keep what asks for a websocket."""
    kept = []
    channel.send(SERVES)
    while True:
        word, files, _, _ = socket.recv_fds(channel, 1, 1)
        if not word:
            return
        connection = socket.socket(fileno=files[0])
        kept.append(connection)
        connection.setblocking(True)
        asked = connection.recv(100)
        if asked.startswith(b"GET /die"):
            os.kill(os.getpid(), signal.SIGKILL)
        connection.sendall(str(number).encode() + asked[:7])
        connection.shutdown(socket.SHUT_WR)


def start(number: int, channel: socket.socket, _: MutableSequence[int]) -> BaseProcess:
    process = CONTEXT.Process(target=answer, args=(number, channel))
    process.start()
    return process


class Running:
    """A front in a thread."""

    def __init__(self) -> None:
        self.port = free_port()
        self.shared = [0] * (NUMBERS * PROCESSES)
        self.front = Front(ServerOptions(port=self.port, prefix="/rail", processes=PROCESSES), start, self.shared)

    def ask(self, line: str) -> str:
        """Return which process answers a first line, and what it was asked; empty where it closes instead."""
        with socket.create_connection(("127.0.0.1", self.port), WAIT_S) as connection:
            connection.sendall(f"{line} HTTP/1.1\r\n\r\n".encode())
            with contextlib.suppress(ConnectionError):
                return connection.recv(100).decode()
        return ""

    def members(self) -> list[int]:
        return [int(member.process.pid or 0) for member in self.front._members.values() if member.serves]

    def wait(self) -> None:
        until = time.monotonic() + WAIT_S
        while len(self.members()) < PROCESSES and time.monotonic() < until:
            time.sleep(0.05)
        assert len(self.members()) == PROCESSES


def free_port() -> int:
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return int(listener.getsockname()[1])


@pytest.fixture(scope="module")
def running() -> Iterator[Running]:
    found, loop = Running(), asyncio.new_event_loop()
    # signals reach the main thread alone
    loop.add_signal_handler = lambda *_: None  # type: ignore[method-assign]
    serving = loop.create_task(found.front.run())
    thread = threading.Thread(target=lambda: loop.run_until_complete(asyncio.wait([serving])))
    thread.start()
    try:
        found.wait()
        yield found
    finally:
        processes = [member.process for member in found.front._members.values()]
        loop.call_soon_threadsafe(serving.cancel)
        thread.join(WAIT_S)
        assert all(process.exitcode is not None for process in processes)
        loop.close()


def test_all_processes_answer_in_turn_and_get_what_was_asked(running: Running) -> None:
    answers = [running.ask("GET /rail/") for _ in range(4)]
    assert {one[1:] for one in answers} == {"GET /ra"}
    assert sorted(one[0] for one in answers) == ["0", "0", "1", "1"]


def test_a_websocket_goes_to_the_process_with_the_fewest_pages(running: Running) -> None:
    running.shared[0], running.shared[NUMBERS] = 7, 3
    try:
        # three have been handed on before they are counted as pages, which they make up for
        assert [running.ask("GET /rail/ws")[0] for _ in range(3)] == ["1", "1", "1"]
        running.shared[0] = 0
        assert running.ask("GET /rail/ws?x")[0] == "0"
    finally:
        running.shared[0] = running.shared[NUMBERS] = 0


def test_a_process_that_dies_is_started_again_and_the_other_goes_on(
    running: Running, caplog: pytest.LogCaptureFixture
) -> None:
    before = running.members()
    running.shared[0] = running.shared[NUMBERS] = 1
    assert running.ask("GET /die") == ""
    assert running.ask("GET /rail/")[1:] == "GET /ra"
    until = time.monotonic() + WAIT_S
    while (set(running.members()) & set(before) == set(before) or len(running.members()) < PROCESSES) and (
        time.monotonic() < until
    ):
        time.sleep(0.05)
    assert len(set(running.members()) - set(before)) == 1
    # what the dead one told of its pages is forgotten
    assert sorted(running.shared[::NUMBERS]) == [0, 1]
    assert "has ended (-9) and is started again" in caplog.text
    assert {running.ask("GET /rail/")[0] for _ in range(PROCESSES)} == {"0", "1"}


def test_whoever_connects_and_leaves_without_a_word_costs_nothing(running: Running) -> None:
    for _ in range(20):
        socket.create_connection(("127.0.0.1", running.port), WAIT_S).close()
    assert running.ask("GET /rail/")[1:] == "GET /ra"
    assert running.front._silent == {}


# tornado leaves the socket open that it could not bind
@pytest.mark.filterwarnings("ignore:Exception ignored in. <socket:pytest.PytestUnraisableExceptionWarning")
def test_a_port_that_is_taken_is_told(running: Running) -> None:
    with pytest.raises(OSError, match="in use"):
        Front(ServerOptions(port=running.port), start, [])
    gc.collect()
