"""The page behind nginx and Caddy with the files of assets/docs, where these programs are."""

import asyncio
import contextlib
import shutil
import subprocess
import threading
import time
import urllib.request
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest

from browser.server import free_port, serving
from browser.visitor import Visitor

pytestmark = pytest.mark.nightly

DOCS = Path(__file__).parents[2] / "assets" / "docs"
PROXIES = {
    "nginx": ("nginx.conf", ("nginx", "-p", "{folder}", "-g", "daemon off;", "-c", "{file}")),
    "caddy": ("Caddyfile", ("caddy", "run", "--adapter", "caddyfile", "--config", "{file}")),
}
PORTS = ("8080", "5006", "5007")
"""In the files: that of the proxy, and those of the servers."""
LOG_LINE = "access_log off;"
TEMPORARY = " ".join(f"{kind}_temp_path {kind};" for kind in ("client_body", "proxy", "fastcgi", "uwsgi", "scgi"))
"""Where an nginx keeps files that is not the system's own."""
STARTS_WITHIN_S = 20
BROWSERS, TURNS = 20, 4
COMMAND = ("-m", "railjoule.dashboard", "serve", "--no-workspace")


@contextlib.contextmanager
def proxy(name: str, ports: tuple[int, ...], folder: Path) -> Iterator[str]:
    """Run a proxy with its file, but for the ports; gives its address."""
    file, command = PROXIES[name]
    text = (DOCS / file).read_text(encoding="utf-8")
    for known, ours in zip(PORTS, ports, strict=True):
        assert known in text
        text = text.replace(known, str(ours))
    (folder / file).write_text(text.replace(LOG_LINE, f"{LOG_LINE} {TEMPORARY}"), encoding="utf-8")
    words = [word.format(folder=folder, file=folder / file) for word in command]
    process = subprocess.Popen(words, cwd=folder)
    url = f"http://127.0.0.1:{ports[0]}/"
    try:
        deadline = time.monotonic() + STARTS_WITHIN_S
        while time.monotonic() < deadline:
            with contextlib.suppress(OSError), urllib.request.urlopen(f"{url}ready"):
                break
            time.sleep(0.2)
        yield url
    finally:
        process.terminate()
        process.wait(10)


async def moved(url: str) -> float:
    """Return how long the first move of a page takes [s]."""
    page = Visitor(f"{url}?v=1&page=Drive")
    await page.open()
    try:
        return await page.move(page.slider("Travel time, s"), 150.0, "figures")
    finally:
        await page.close()


@contextlib.contextmanager
def stand_in(port: int) -> Iterator[None]:
    """Run a server that answers everything with its port."""

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            self.send_response(200)
            self.end_headers()
            self.wfile.write(str(port).encode())

        def log_message(self, *_: object) -> None:
            """Write down nothing."""

    server = ThreadingHTTPServer(("127.0.0.1", port), Handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        yield
    finally:
        server.shutdown()
        server.server_close()


def browser(number: int) -> urllib.request.OpenerDirector:
    """Return a client with a name and cookies of its own."""
    opener = urllib.request.build_opener(urllib.request.HTTPCookieProcessor())
    opener.addheaders = [("User-Agent", f"browser {number}")]
    return opener


def answering(client: urllib.request.OpenerDirector, url: str) -> str:
    """Return the port of the server that answers a client."""
    with client.open(url) as answer:
        return str(answer.read().decode())


@pytest.fixture(params=PROXIES)
def name(request: pytest.FixtureRequest) -> str:
    if shutil.which(request.param) is None:
        pytest.skip(f"{request.param} is not installed")
    return str(request.param)


def test_a_page_works_behind_it_with_two_servers(name: str, tmp_path: Path) -> None:
    ports = (free_port(), free_port(), free_port())
    origin = ("--origin", f"127.0.0.1:{ports[0]}")
    with (
        serving(*COMMAND, *origin, port=ports[1]),
        serving(*COMMAND, *origin, port=ports[2]),
        proxy(name, ports, tmp_path) as url,
    ):
        # in a thread, as Playwright keeps a loop running in that of the tests
        with ThreadPoolExecutor(1) as thread:
            assert thread.submit(asyncio.run, moved(url)).result() > 0
        with urllib.request.urlopen(url) as answer:
            assert "frame-ancestors 'self'" in answer.headers["Content-Security-Policy"]


def test_a_browser_stays_with_one_server_until_that_is_down(name: str, tmp_path: Path) -> None:
    ports = (free_port(), free_port(), free_port())
    clients = [browser(number) for number in range(BROWSERS)]
    with contextlib.ExitStack() as second, stand_in(ports[1]):
        second.enter_context(stand_in(ports[2]))
        with proxy(name, ports, tmp_path) as url:
            found = [{answering(client, url) for _ in range(TURNS)} for client in clients]
            assert all(len(servers) == 1 for servers in found)
            assert set.union(*found) == {str(port) for port in ports[1:]}
            second.close()
            assert {answering(client, url) for client in clients} == {str(ports[1])}
