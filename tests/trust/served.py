"""Sections 1, 3, 6 and 8 against a server: answers, origins, faults, and what sessions know of each other."""

import asyncio
import contextlib
import http.client
import json
import signal
import statistics
import time
from collections.abc import AsyncIterator, Callable, Coroutine, Mapping
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from browser.server import Server, serving
from browser.visitor import Visitor

from railjoule.core import load_scenario
from railjoule.core.scenario import format_scenario
from tests.trust.rows import Found, Row
from tests.trust.texts import packed

COMMAND = ("-m", "railjoule.dashboard", "serve", "--no-workspace")
OPENED = 101
CANARY = "CANARY-4711"
MOVES = 8
SETTLE_S, PAUSE_S = 1.5, 0.3
# bars with room for a busy machine; the table shows the numbers themselves
MOST_CPU_S, LONGEST_WAIT_S = 0.2, 1.0
STOPPED_S = 9.0
SAFE = {
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Content-Security-Policy": "frame-ancestors",
    "Permissions-Policy": "camera=()",
}


@contextlib.asynccontextmanager
async def visiting(*urls: str) -> AsyncIterator[list[Visitor]]:
    """Open pages one after the other, and leave them all whatever happens."""
    pages = [Visitor(url) for url in urls]
    try:
        for page in pages:
            await page.open()
        yield pages
    finally:
        for page in pages:
            await page.close()


def in_a_loop(act: Coroutine[Any, Any, Found]) -> Found:
    """Return what a coroutine finds; in a thread, as those who call may have a loop of their own."""
    with ThreadPoolExecutor(1) as thread:
        return thread.submit(asyncio.run, act).result()


class Answers:
    """What a server answers to plain requests."""

    def __init__(self, server: Server) -> None:
        self.server = server

    def ask(
        self, path: str, method: str = "GET", headers: Mapping[str, str] | None = None, body: bytes | None = None
    ) -> tuple[int, dict[str, str], bytes]:
        """Return status, headers and body."""
        connection = http.client.HTTPConnection("127.0.0.1", self.server.port, timeout=30)
        try:
            connection.request(method, path, body, dict(headers or {}))
            answer = connection.getresponse()
            return answer.status, dict(answer.getheaders()), answer.read()
        finally:
            connection.close()

    def headers(self) -> Found:
        """Look at the headers of all kinds of answers."""
        asked = {
            "/": {},
            "/nope": {},
            "/health": {},
            "/static/js/bokeh.min.js": {},
            "/x": {"Host": "evil"},
        }
        lacking = []
        for path, headers in asked.items():
            _, found, _ = self.ask(path, headers=headers)
            if not all(words in found.get(name, "") for name, words in SAFE.items()) or "Server" in found:
                lacking.append(path)
            if "Set-Cookie" in found or "Access-Control-Allow-Origin" in found:
                lacking.append(f"{path} (cookie or origin)")
        return Found(f"all on {len(asked)} kinds of answers; lacking: {lacking or 'none'}", not lacking)

    def compression(self) -> Found:
        """Weigh a script and the page, packed."""
        sizes = {}
        for path in ("/static/js/bokeh.min.js", "/"):
            plain, packed = (len(self.ask(path, headers=how)[2]) for how in ({}, {"Accept-Encoding": "gzip"}))
            sizes[path] = (plain // 1000, packed // 1000)
        words = "; ".join(f"{path} {plain} -> {packed} kB" for path, (plain, packed) in sizes.items())
        return Found(words, all(packed < 0.7 * plain for plain, packed in sizes.values()))

    def statuses(self, *asked: tuple[str, str], wanted: tuple[int, ...]) -> Found:
        """Ask by methods for paths."""
        found = [self.ask(path, method)[0] for method, path in asked]
        return Found(", ".join(map(str, found)), all(status in wanted for status in found))

    def walking(self) -> Found:
        """Ask for files above the static ones."""
        paths = (
            "/static/../../etc/passwd",
            "/static/%2e%2e/%2e%2e/etc/passwd",
            "/static//etc/passwd",
            "/static/..%2f..%2fetc/passwd",
        )
        answers = [self.ask(path) for path in paths]
        leak = any(b"root:" in body for _, _, body in answers)
        return Found(
            ", ".join(str(status) for status, _, _ in answers), not leak and all(a[0] in (403, 404) for a in answers)
        )

    def large_body(self) -> Found:
        """Announce a body of 120 MB."""
        status, _, _ = self.ask("/", "POST", {"Content-Length": "120000000"})
        return Found(str(status), status in (400, 405, 413))

    def rebinding(self) -> Found:
        """Call the server by a name that is not its own, over HTTP and by websocket."""
        status, _, _ = self.ask("/", headers={"Host": "evil.example"})
        opened = self._opens({"Host": "evil.example", "Origin": "http://evil.example"})
        return Found(f"HTTP {status}; websocket {opened}", status == 421 and opened != OPENED)

    def origins(self) -> Found:
        """Open websockets for pages of other origins, and of our own."""
        port = self.server.port
        foreign = (
            "http://evil.example",
            f"http://127.0.0.1.evil.example:{port}",
            f"http://127.0.0.1:{port + 1}",
            "null",
            "file://",
            f"http://127.0.0.1:{port}@evil.example",
        )
        let_in = [origin for origin in foreign if self._opens({"Origin": origin}) == OPENED]
        own = self._opens({"Origin": f"http://127.0.0.1:{port}"}) == OPENED
        return Found(f"let in: {let_in or 'none'} of {len(foreign)}; own: {own}", not let_in and own)

    def _opens(self, headers: Mapping[str, str]) -> int:
        """Return the status with which the server answers who wants a websocket; 101 opens it."""
        handshake = {
            "Connection": "Upgrade",
            "Upgrade": "websocket",
            "Sec-WebSocket-Version": "13",
            "Sec-WebSocket-Key": "AAAAAAAAAAAAAAAAAAAAAA==",
            "Sec-WebSocket-Protocol": "bokeh, token",
        }
        connection = http.client.HTTPConnection("127.0.0.1", self.server.port, timeout=30)
        try:
            connection.request("GET", "/ws", headers={**handshake, **headers})
            return connection.getresponse().status
        finally:
            connection.close()

    def health(self) -> Found:
        """Ask how the server is."""
        started = time.perf_counter()
        body = json.loads(self.ask("/health")[2])
        took = time.perf_counter() - started
        heads = [self.ask(path, "HEAD")[0] for path in ("/health", "/ready")]
        return Found(
            f"{body['status']} in {1e3 * took:.0f} ms; HEAD {heads}", body["status"] == "ok" and heads == [200] * 2
        )


async def moved(server: Server) -> Found:
    """Move a slider, and take what it costs."""
    waits, sent = [], []
    async with visiting(server.drive_url) as (page,):
        slider = page.slider("Travel time, s")
        await page.move(slider, 150.0, "figures")
        await asyncio.sleep(SETTLE_S)
        before = server.cpu_s()
        for number in range(MOVES):
            waits.append(await page.move(slider, 151.0 + number % 2, "figures"))
            sent.append(len(page.text) / 1000)
            await asyncio.sleep(PAUSE_S)
        cpu = (server.cpu_s() - before) / MOVES
    wait = statistics.median(waits)
    words = f"{statistics.median(sent):.0f} kB, {1e3 * cpu:.0f} ms CPU, answered after {1e3 * wait:.0f} ms"
    return Found(words, cpu < MOST_CPU_S and wait < LONGEST_WAIT_S)


async def apart(server: Server) -> Found:
    """Give one page a canary, move it, and search all that others are sent."""
    text = format_scenario(load_scenario("metro-with-limit", {"title": CANARY, "vehicle.name": CANARY}))
    link = f"{server.drive_url}&toml={packed(text.encode())}"
    async with visiting(link, server.drive_url, server.drive_url) as (own, *others):
        slider, is_there = own.slider("Travel time, s"), CANARY in own.text
        documents = [page.text for page in others]
        await asyncio.sleep(SETTLE_S)
        for page in others:
            page.text = ""
        for number in range(MOVES):
            await own.move(slider, 151.0 + number % 2, "figures")
        found = sum(CANARY in text for text in (*documents, *(page.text for page in others)))
        sent = sum(len(page.text) for page in others)
    return Found(f"{found} canaries, {sent} bytes sent to others", is_there and found == 0 and sent == 0)


async def failing(server: Server) -> Found:
    """Send a change that no server can take, and read the answer."""
    change = {"kind": "ModelChanged", "model": {"id": "none"}, "attr": "x", "new": 1}
    async with visiting(server.drive_url) as (page,):
        await page.send("PATCH-DOC", {"events": [change]})
        deadline = time.monotonic() + STOPPED_S
        while not page.failures and time.monotonic() < deadline:
            await asyncio.sleep(0.05)
        told = " ".join(page.failures)
    return Found(told[:120] or "no answer", bool(told) and "File " not in told and ".py" not in told)


async def stopped(server: Server) -> Found:
    """Stop the server for a while, move a slider meanwhile, and let it go on."""
    async with visiting(server.drive_url) as (page,):
        slider = page.slider("Travel time, s")
        await page.move(slider, 150.0, "figures")
        await asyncio.sleep(SETTLE_S)
        server.process.send_signal(signal.SIGSTOP)
        asked = asyncio.create_task(page.move(slider, 160.0, "figures"))
        try:
            await asyncio.sleep(STOPPED_S)
        finally:
            server.process.send_signal(signal.SIGCONT)
        waited = await asked
    return Found(f"answered {waited - STOPPED_S:.1f} s after it went on", waited < STOPPED_S + 2)


def terminated() -> Found:
    """End a server by SIGTERM."""
    with serving(*COMMAND) as server:
        started = time.monotonic()
        server.process.terminate()
        status = server.process.wait(20)
        return Found(f"status {status} after {time.monotonic() - started:.1f} s", status in (0, -signal.SIGTERM))


def no_place() -> Found:
    """Ask for more pages than there is place for."""

    async def fill(server: Server) -> Found:
        async with visiting(server.url, server.url):
            status, headers, body = Answers(server).ask("/")
        told = b"keeps 2 pages open at a time" in body
        return Found(f"HTTP {status}, Retry-After {headers.get('Retry-After')}", status == 503 and told)

    with serving(*COMMAND, "--sessions", "2") as server:
        return in_a_loop(fill(server))


def rows(server: Server) -> tuple[Row, ...]:
    """Return the rows that ask a running server."""
    answers = Answers(server)

    def of(act: Callable[[Server], Coroutine[Any, Any, Found]]) -> Callable[[], Found]:
        return lambda: in_a_loop(act(server))

    other = ("POST", "/"), ("PUT", "/"), ("DELETE", "/health"), ("PATCH", "/ready")
    return (
        Row("1", "slider move", "37.2 kB, 39-49 ms CPU", of(moved)),
        Row("1", "compression", "none", answers.compression),
        Row("3", "SIGSTOP for 9 s, a move meanwhile", "applied after SIGCONT", of(stopped), quick=False),
        Row("3", "SIGTERM", "ends at once, rc -15", terminated, quick=False),
        Row("3", "health, by GET and HEAD", "2-3 ms; HEAD 405", answers.health),
        Row("5", "static files above their folder", "403, 404", answers.walking),
        Row("6", "headers, cookies", "none of them; the page can be framed", answers.headers),
        Row("6", "websocket of other origins", "403", answers.origins),
        Row("6", "DNS rebinding", "opens with tornado 6.6.1", answers.rebinding),
        Row(
            "6",
            "/autoload.js",
            "makes a session for any website",
            lambda: answers.statuses(("GET", "/autoload.js"), wanted=(404,)),
        ),
        Row("6", "POST of 120 MB", "400", answers.large_body),
        Row("6", "other methods", "405", lambda: answers.statuses(*other, wanted=(405,))),
        Row("6", "unknown paths", "404", lambda: answers.statuses(("GET", "/nope"), ("GET", "/a/b"), wanted=(404,))),
        Row("6", "limit of sessions", "none", no_place, quick=False),
        Row("6", "error of a websocket", "traceback with paths", of(failing)),
        Row("8", "two sessions", "0 canaries, 0 bytes", of(apart)),
    )
