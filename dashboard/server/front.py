"""Several processes behind one port: this one takes the connections and hands each on, and does nothing else.

A page lives in the process that has its websocket, where it is made: see `railjoule.dashboard.server.opening`. So each
websocket goes to the process with the fewest pages, and everything else to any. What is handed on is the connection
itself, so that no byte of a page passes through here.
"""

import asyncio
import contextlib
import logging
import re
import signal
import socket
import time
from collections import deque
from collections.abc import Callable, MutableSequence
from dataclasses import dataclass, field
from multiprocessing.process import BaseProcess

from tornado.netutil import bind_sockets

from railjoule.dashboard.server.options import ServerOptions
from railjoule.dashboard.server.places import NUMBERS

LOG = logging.getLogger(__name__)
LOOK_BYTES, QUEUE, MOST_SILENT = 2048, 256, 1000
SILENT_S = 60.0
"""A browser may connect before it knows what to ask for; after this long without a word it is gone."""
COUNTED_AFTER_S = 3.0
"""A page is made within that time; until then it counts for the process that was handed its websocket."""
LOOKS_EVERY_S, ENDS_WITHIN_S = 0.25, 5.0
SHORT_LIFE_S, LONGEST_PAUSE_S = 10.0, 30.0
"""A process that ends sooner than that is started again after a pause, which grows."""
HANDED, SERVES = b"c", b"s"
"""What goes with a connection to a process, and what a process says when it serves."""

Start = Callable[[int, socket.socket, MutableSequence[int]], BaseProcess]


@dataclass
class Member:
    """One of the processes.

    Parameters
    ----------
    number : int
        Which of them.
    process : BaseProcess
    channel : socket
        On which it is handed connections.
    """

    number: int
    process: BaseProcess
    channel: socket.socket
    serves: bool = False
    started_s: float = field(default_factory=time.monotonic)
    websockets: deque[float] = field(default_factory=deque)

    def pages(self, shared: MutableSequence[int]) -> int:
        """Return how many pages it has, with those of which it has just been handed the websocket."""
        since = time.monotonic() - COUNTED_AFTER_S
        while self.websockets and self.websockets[0] < since:
            self.websockets.popleft()
        return shared[NUMBERS * self.number] + len(self.websockets)


class Front:
    """What stands before the processes.

    Parameters
    ----------
    options : ServerOptions
    start : callable
        Starts a process: given its number, its end of a channel, and where all tell how many pages they have.
    shared : mutable sequence of int
        The latter, NUMBERS for each process.
    may_start_all : callable
        Returns whether more than one may start: the first compiles the kernels, where that is yet to do.
    """

    def __init__(
        self,
        options: ServerOptions,
        start: Start,
        shared: MutableSequence[int],
        may_start_all: Callable[[], bool] = lambda: True,
    ) -> None:
        self._options, self._start, self._shared, self._may_start_all = options, start, shared, may_start_all
        self._listeners = bind_sockets(options.port, options.address or None)
        self._websocket = re.compile(rb"GET " + re.escape(f"{options.prefix}/ws").encode() + rb"[ ?]")
        self._members: dict[int, Member] = {}
        self._pauses: dict[int, float] = {}
        self._silent: dict[socket.socket, asyncio.TimerHandle] = {}
        self._waiting: deque[socket.socket] = deque()
        self._begins: list[asyncio.TimerHandle] = []
        self._turn = 0

    async def run(self) -> signal.Signals:
        """Serve until a signal says to end; return which."""
        loop = asyncio.get_running_loop()
        ended: asyncio.Future[signal.Signals] = loop.create_future()

        def end(by: signal.Signals) -> None:
            if not ended.done():
                ended.set_result(by)

        for one in (signal.SIGTERM, signal.SIGINT):
            loop.add_signal_handler(one, end, one)
        for listener in self._listeners:
            loop.add_reader(listener, self._accept, listener)
        starting = asyncio.create_task(self._start_all())
        try:
            return await ended
        finally:
            starting.cancel()
            for member in self._members.values():
                loop.remove_reader(member.process.sentinel)
                loop.remove_reader(member.channel)
            for pause in self._begins:
                pause.cancel()
            for connection in [*self._silent]:
                self._drop(connection)
            for listener in self._listeners:
                loop.remove_reader(listener)
            await asyncio.to_thread(self._end_all)
            for ours in (*self._listeners, *self._waiting, *(member.channel for member in self._members.values())):
                ours.close()

    async def _start_all(self) -> None:
        self._begin(0)
        while not self._may_start_all():
            await asyncio.sleep(LOOKS_EVERY_S)
        for number in range(1, self._options.processes):
            self._begin(number)

    def _begin(self, number: int) -> None:
        loop = asyncio.get_running_loop()
        ours, theirs = socket.socketpair()
        with theirs:
            member = Member(number, self._start(number, theirs, self._shared), ours)
        ours.setblocking(False)
        self._members[number] = member
        loop.add_reader(ours, self._hear, member)
        loop.add_reader(member.process.sentinel, self._begin_again, member)

    def _hear(self, member: Member) -> None:
        """Take note that a process serves; its end is told by its sentinel."""
        with contextlib.suppress(OSError):
            if member.channel.recv(1) == SERVES:
                member.serves = True
                while self._waiting:
                    self._hand_on(self._waiting.popleft(), False)
                return
        asyncio.get_running_loop().remove_reader(member.channel)

    def _begin_again(self, member: Member) -> None:
        """Start a process anew that has ended."""
        loop = asyncio.get_running_loop()
        loop.remove_reader(member.process.sentinel)
        loop.remove_reader(member.channel)
        member.channel.close()
        member.process.join()
        first = NUMBERS * member.number
        self._shared[first : first + NUMBERS] = [0] * NUMBERS
        del self._members[member.number]
        short = time.monotonic() - member.started_s < SHORT_LIFE_S
        pause = min(2 * self._pauses.get(member.number, 0.5), LONGEST_PAUSE_S) if short else 0.0
        self._pauses[member.number] = pause or 0.5
        code = member.process.exitcode
        LOG.warning("process %d has ended (%s) and is started again in %.0f s", member.number + 1, code, pause)
        self._begins = [one for one in self._begins if one.when() > loop.time()]
        self._begins.append(loop.call_later(pause, self._begin, member.number))

    def _accept(self, listener: socket.socket) -> None:
        for _ in range(QUEUE):
            try:
                connection, _ = listener.accept()
            # nobody is waiting any more, or has gone meanwhile, or there are too many files
            except OSError:
                return
            connection.setblocking(False)
            if len(self._silent) >= MOST_SILENT:
                self._hand_on(connection, False)
                continue
            loop = asyncio.get_running_loop()
            self._silent[connection] = loop.call_later(SILENT_S, self._drop, connection)
            loop.add_reader(connection, self._look, connection)

    def _look(self, connection: socket.socket) -> None:
        """Look at what a connection asks for, and leave it there."""
        self._forget(connection)
        try:
            words = connection.recv(LOOK_BYTES, socket.MSG_PEEK)
        except OSError:
            words = b""
        if words:
            # the whole first line comes at once; where it does not, any process can answer it too
            self._hand_on(connection, self._websocket.match(words) is not None)
        else:
            connection.close()

    def _drop(self, connection: socket.socket) -> None:
        self._forget(connection)
        connection.close()

    def _forget(self, connection: socket.socket) -> None:
        asyncio.get_running_loop().remove_reader(connection)
        self._silent.pop(connection).cancel()

    def _hand_on(self, connection: socket.socket, is_websocket: bool) -> None:
        """Give a connection to the process with the fewest pages, or to the next one where it has none itself."""
        able = [member for member in self._members.values() if member.serves]
        if not able:
            self._keep(connection)
            return
        self._turn += 1
        if is_websocket:
            able.sort(key=lambda member: member.pages(self._shared))
        else:
            able = able[self._turn % len(able) :] + able[: self._turn % len(able)]
        for member in able:
            # its channel is full, or it has just ended: then another one takes it
            with contextlib.suppress(OSError):
                socket.send_fds(member.channel, [HANDED], [connection.fileno()])
                if is_websocket:
                    member.websockets.append(time.monotonic())
                break
        connection.close()

    def _keep(self, connection: socket.socket) -> None:
        """Keep a connection until a process serves."""
        if len(self._waiting) >= MOST_SILENT:
            self._waiting.popleft().close()
        self._waiting.append(connection)

    def _end_all(self) -> None:
        members = list(self._members.values())
        for member in members:
            member.process.terminate()
        until = time.monotonic() + ENDS_WITHIN_S
        for member in members:
            member.process.join(max(until - time.monotonic(), 0.0))
            if member.process.exitcode is None:
                member.process.kill()
                member.process.join()
