"""A relay between a browser and a server that counts what passes, as compressed as it travels."""

import asyncio
import contextlib
import threading
from collections.abc import Iterator

PIECE_BYTES = 1 << 16


class Relay:
    """Passes on all connections to a port of this machine.

    Parameters
    ----------
    port : int
        Where the server listens.
    """

    def __init__(self, port: int) -> None:
        self._to, self.port, self.received_bytes = port, 0, 0
        self._listens, self._ended = threading.Event(), asyncio.Event()
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=lambda: self._loop.run_until_complete(self._run()), daemon=True)

    @classmethod
    @contextlib.contextmanager
    def to(cls, port: int) -> Iterator["Relay"]:
        """Relay until the block ends."""
        relay = cls(port)
        relay._thread.start()
        relay._listens.wait()
        try:
            yield relay
        finally:
            relay._loop.call_soon_threadsafe(relay._ended.set)
            relay._thread.join()

    def taken(self) -> int:
        """Return how many bytes the browser has received since this was last asked."""
        count, self.received_bytes = self.received_bytes, 0
        return count

    async def _run(self) -> None:
        server = await asyncio.start_server(self._connect, "127.0.0.1", 0)
        self.port = int(server.sockets[0].getsockname()[1])
        self._listens.set()
        await self._ended.wait()
        server.close()
        waiting = asyncio.all_tasks() - {asyncio.current_task()}
        for task in waiting:
            task.cancel()
        await asyncio.gather(*waiting, return_exceptions=True)

    async def _connect(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        with contextlib.suppress(ConnectionError, OSError):
            far_reader, far_writer = await asyncio.open_connection("127.0.0.1", self._to)
            await asyncio.gather(self._pass(reader, far_writer, False), self._pass(far_reader, writer, True))

    async def _pass(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter, counts: bool) -> None:
        with contextlib.suppress(ConnectionError, OSError):
            while piece := await reader.read(PIECE_BYTES):
                self.received_bytes += len(piece) * counts
                writer.write(piece)
                await writer.drain()
        writer.close()
