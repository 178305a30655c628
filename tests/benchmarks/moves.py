"""`python -m tests.benchmarks.moves [CHECKOUT]` measures what one move of a slider on Drive costs the server.

A client talks to the served page as a browser does, over its websocket, and draws nothing. Where another checkout is
named, its page is served over the same core, and both are moved in turns, so that a busy machine slows both alike.
"""

import argparse
import asyncio
import json
import re
import statistics
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tornado.httpclient import AsyncHTTPClient, HTTPRequest
from tornado.websocket import websocket_connect

from tests.benchmarks.side_by_side import HERE
from tests.browser.server import Server, serving

MOVES, WARM_UP, STEP_S = 30, 5, 0.5
QUIET_S = 0.6
"""A move is over after so long without a message: longer than the page waits before it takes note of a change."""
LARGEST_MESSAGE = 200 * 2**20
SLIDER = "Travel time, s"
IN_SIGHT = ["energy", "line", "phases", "speed"]
READY = {"type": "event", "name": "document_ready", "values": {"type": "map", "entries": []}}


@dataclass
class Move:
    """What the server sent for one move, and how long the client waited for the first of it [s]."""

    messages: int = 0
    events: int = 0
    size_bytes: int = 0
    first_s: float = 0.0


class Client:
    """One open page without a screen."""

    def __init__(self, server: Server) -> None:
        self.server, self.sent, self.began_s = server, 0, 0.0
        self.move, self.news, self.ready = Move(), asyncio.Event(), asyncio.Event()
        self.reply: asyncio.Future[Any] = asyncio.get_running_loop().create_future()
        self.reader: asyncio.Task[None]

    async def open(self) -> None:
        """Open Drive with its first charts in sight."""
        page = await AsyncHTTPClient().fetch(HTTPRequest(self.server.drive_url, request_timeout=120))
        token = re.search(r'"token":\s*"([^"]+)"', page.body.decode())
        assert token is not None
        self.socket = await websocket_connect(
            HTTPRequest(
                f"ws://127.0.0.1:{self.server.port}/ws",
                headers={"Origin": f"http://127.0.0.1:{self.server.port}"},
                request_timeout=120,
            ),
            subprotocols=["bokeh", token[1]],
            max_message_size=LARGEST_MESSAGE,
        )
        self.reader = asyncio.create_task(self._read())
        await asyncio.wait_for(self.ready.wait(), 120)
        await self._send("PULL-DOC-REQ", {})
        document = await asyncio.wait_for(self.reply, 120)
        models = [*models_of(document)]
        self.slider, self.travel_time_s = next(
            (model["id"], model["attributes"]["value"])
            for model in models
            if model["attributes"].get("label") == SLIDER and "start" in model["attributes"]
        )
        browser = next(
            model["attributes"]["data"]["id"] for model in models if model["attributes"].get("class_name") == "Browser"
        )
        await self._patch({"kind": "MessageSent", "msg_type": "bokeh_event", "msg_data": READY})
        await self._rest()
        await self._set(browser, "charts_in_sight", IN_SIGHT)
        await self._rest()

    async def step(self, number: int) -> Move:
        """Move the slider by a step, to and fro, and wait for all that comes of it."""
        self.move, self.began_s = Move(), time.perf_counter()
        self.travel_time_s += STEP_S if number % 10 < 5 else -STEP_S
        await self._set(self.slider, "value", self.travel_time_s)
        await self._rest()
        return self.move

    def close(self) -> None:
        """Leave the page."""
        self.reader.cancel()
        self.socket.close()

    async def _set(self, model: str, name: str, value: Any) -> None:
        await self._patch({"kind": "ModelChanged", "model": {"id": model}, "attr": name, "new": value})

    async def _patch(self, event: dict[str, Any]) -> None:
        await self._send("PATCH-DOC", {"events": [event]})

    async def _send(self, kind: str, content: dict[str, Any]) -> None:
        self.sent += 1
        for part in ({"msgid": f"moves-{self.sent}", "msgtype": kind}, {}, content):
            await self.socket.write_message(json.dumps(part))

    async def _rest(self) -> None:
        with suppress(TimeoutError):
            while True:
                self.news.clear()
                await asyncio.wait_for(self.news.wait(), QUIET_S)

    async def _read(self) -> None:
        while (head := await self.socket.read_message()) is not None:
            header, size = json.loads(head), len(head)
            size += len(str(await self.socket.read_message()))
            content = str(await self.socket.read_message())
            size += len(content)
            for _ in range(header.get("num_buffers", 0)):
                for _ in range(2):
                    size += len(await self.socket.read_message() or "")
            self._take(header["msgtype"], content, size)

    def _take(self, kind: str, content: str, size: int) -> None:
        if kind == "ACK":
            self.ready.set()
        elif kind == "PULL-DOC-REPLY":
            self.reply.set_result(json.loads(content)["doc"])
        elif kind == "ERROR":
            raise RuntimeError(content)
        elif kind == "PATCH-DOC":
            if not self.move.messages:
                self.move.first_s = time.perf_counter() - self.began_s
            self.move.messages += 1
            self.move.events += len(json.loads(content)["events"])
            self.move.size_bytes += size
            self.news.set()


def models_of(node: Any) -> Iterator[dict[str, Any]]:
    """Yield all models within a document as it is sent."""
    if isinstance(node, dict):
        if "id" in node and isinstance(node.get("attributes"), dict):
            yield node
        node = list(node.values())
    if isinstance(node, list):
        for part in node:
            yield from models_of(part)


@contextmanager
def served(checkout: Path) -> Iterator[Server]:
    """Serve the page of a checkout; the core is that of this one, which is compiled already."""
    with tempfile.TemporaryDirectory() as folder:
        package = Path(folder) / "railjoule"
        package.mkdir()
        (package / "__init__.py").touch()
        (package / "core").symlink_to(Path(__file__).parents[2] / "core")
        for name in ("dashboard", "assets"):
            (package / name).symlink_to(checkout.resolve() / name)
        with serving("-m", "railjoule.dashboard", "serve", environment={"PYTHONPATH": folder}) as server:
            yield server


async def measure(servers: list[Server], moves: int) -> Iterator[str]:
    """Move all pages in turns; yields a row for each."""
    clients = [Client(server) for server in servers]
    for client in clients:
        await client.open()
        for number in range(WARM_UP):
            await client.step(5 + number)
    cpu_s = [0.0 for _ in clients]
    found: list[list[Move]] = [[] for _ in clients]
    for number in range(moves):
        for which, client in enumerate(clients):
            before_s = client.server.cpu_s()
            found[which].append(await client.step(number))
            cpu_s[which] += client.server.cpu_s() - before_s
    for client in clients:
        client.close()
    return (row(used_s, made) for used_s, made in zip(cpu_s, found, strict=True))


def row(cpu_s: float, moves: list[Move]) -> str:
    """Return what moves cost, in words."""
    messages, events, size_bytes, first_s = (
        statistics.mean(getattr(move, name) for move in moves)
        for name in ("messages", "events", "size_bytes", "first_s")
    )
    return (
        f"{1e3 * cpu_s / len(moves):6.1f} ms CPU a move, {messages:.1f} messages, {events:.1f} events, "
        f"{1e-3 * size_bytes:.1f} kB, first answer after {1e3 * first_s:.0f} ms"
    )


def main() -> None:
    """Print a row for this checkout, and before it one for the other."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.moves", description=__doc__)
    parser.add_argument("checkout", type=Path, nargs="?", help="folder of another checkout")
    parser.add_argument("--moves", type=int, default=MOVES)
    asked = parser.parse_args()
    checkouts = [*filter(None, [asked.checkout]), HERE]
    with ExitStack() as stack:
        servers = [stack.enter_context(served(checkout)) for checkout in checkouts]
        for checkout, told in zip(checkouts, asyncio.run(measure(servers, asked.moves)), strict=True):
            print(f"{checkout}: {told}")


if __name__ == "__main__":
    main()
