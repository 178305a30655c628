"""A page of a server without a browser: what one says over HTTP and the websocket, and nothing of what it draws."""

import asyncio
import json
import re
import time
from collections.abc import Iterator
from typing import Any
from urllib.parse import urlsplit

from tornado.httpclient import AsyncHTTPClient, HTTPRequest
from tornado.websocket import WebSocketClientConnection, websocket_connect

PATIENCE_S = 60.0
LARGEST_MESSAGE_BYTES = 200 << 20
TOKEN = re.compile(r'"token":\s*"([^"]+)"')
READY = {
    "kind": "MessageSent",
    "msg_type": "bokeh_event",
    "msg_data": {"type": "event", "name": "document_ready", "values": {"type": "map", "entries": []}},
}


class Visitor:
    """One open page.

    Parameters
    ----------
    url : str
        Its address.
    """

    def __init__(self, url: str) -> None:
        self.url, self.opened_s = url, 0.0
        self.text = ""
        self.failures: list[str] = []
        """Answers to messages that the server could not take."""
        self._sent = 0
        self._document: asyncio.Future[str] = asyncio.get_running_loop().create_future()
        self._heard, self._ready = asyncio.Event(), asyncio.Event()
        self._connection: WebSocketClientConnection | None = None

    async def open(self) -> None:
        """Load the page, open its websocket, and say that it is there."""
        started = time.perf_counter()
        answer = await AsyncHTTPClient().fetch(HTTPRequest(self.url, request_timeout=PATIENCE_S))
        token = TOKEN.search(answer.body.decode())
        assert token is not None, "the page has no token"
        parts = urlsplit(self.url)
        request = HTTPRequest(f"ws://{parts.netloc}/ws", headers={"Origin": f"http://{parts.netloc}"})
        self._connection = await websocket_connect(
            request,
            subprotocols=["bokeh", token[1]],
            max_message_size=LARGEST_MESSAGE_BYTES,
            # as browsers do
            compression_options={},
        )
        self._reading = asyncio.create_task(self._read())
        await asyncio.wait_for(self._ready.wait(), PATIENCE_S)
        await self.send("PULL-DOC-REQ", {})
        self.text = await asyncio.wait_for(self._document, PATIENCE_S)
        self.opened_s = time.perf_counter() - started
        await self.send("PATCH-DOC", {"events": [READY]})

    async def close(self) -> None:
        """Leave the page."""
        if self._connection is not None:
            self._connection.close()
            await self._reading

    def slider(self, label: str) -> str:
        """Return the id of the slider with a label."""
        return next(str(one["id"]) for one in self._models() if one["attributes"].get("label") == label)

    async def move(self, model: str, value: float, until: str) -> float:
        """Give a slider a value, and return after how many seconds a text comes back."""
        self.text = ""
        started = time.perf_counter()
        change = {"kind": "ModelChanged", "model": {"id": model}, "attr": "value", "new": value}
        await self.send("PATCH-DOC", {"events": [change]})
        while until not in self.text:
            self._heard.clear()
            await asyncio.wait_for(self._heard.wait(), PATIENCE_S)
        return time.perf_counter() - started

    @property
    def is_open(self) -> bool:
        """Whether the server has not closed the connection."""
        return self._connection is not None and not self._reading.done()

    def _models(self) -> Iterator[dict[str, Any]]:
        """Yield the models of the document as it was loaded."""
        # what has changed since may stand behind it
        waiting = [json.JSONDecoder().raw_decode(self.text)[0]]
        while waiting:
            one = waiting.pop()
            if isinstance(one, dict):
                if "id" in one and isinstance(one.get("attributes"), dict) and "start" in one["attributes"]:
                    yield one
                waiting += one.values()
            elif isinstance(one, list):
                waiting += one

    async def send(self, kind: str, content: dict[str, Any]) -> None:
        assert self._connection is not None
        self._sent += 1
        for part in ({"msgid": str(self._sent), "msgtype": kind}, {}, content):
            await self._connection.write_message(json.dumps(part))

    async def _read(self) -> None:
        assert self._connection is not None
        while (head := await self._connection.read_message()) is not None:
            header = json.loads(head)
            await self._connection.read_message()
            content = str(await self._connection.read_message())
            for _ in range(2 * header.get("num_buffers", 0)):
                await self._connection.read_message()
            if header["msgtype"] == "ACK":
                self._ready.set()
            elif header["msgtype"] == "ERROR":
                self.failures.append(content)
            elif header["msgtype"] == "PULL-DOC-REPLY":
                self._document.set_result(content)
            elif header["msgtype"] == "PATCH-DOC":
                self.text += content
                self._heard.set()
