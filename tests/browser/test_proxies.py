"""The page behind nginx and Caddy with the files of assets/docs, where these programs are."""

import asyncio
import contextlib
import shutil
import subprocess
import time
import urllib.request
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from browser.server import free_port, serving
from browser.visitor import Visitor

DOCS = Path(__file__).parents[2] / "assets" / "docs"
PROXIES = {
    "nginx": ("nginx.conf", ("nginx", "-p", "{folder}", "-g", "daemon off;", "-c", "{file}")),
    "caddy": ("Caddyfile", ("caddy", "run", "--adapter", "caddyfile", "--config", "{file}")),
}
PORTS = ("8080", "5006")
"""In the files: that of the proxy, and that of the server."""
LOG_LINE = "access_log off;"
TEMPORARY = " ".join(f"{kind}_temp_path {kind};" for kind in ("client_body", "proxy", "fastcgi", "uwsgi", "scgi"))
"""Where an nginx keeps files that is not the system's own."""
STARTS_WITHIN_S = 20


@contextlib.contextmanager
def proxy(name: str, port: int, to: int, folder: Path) -> Iterator[str]:
    """Run a proxy with its file, but for the ports; gives its address."""
    file, command = PROXIES[name]
    text = (DOCS / file).read_text(encoding="utf-8")
    for known, ours in zip(PORTS, (port, to), strict=True):
        assert text.count(known) > 1
        text = text.replace(known, str(ours))
    (folder / file).write_text(text.replace(LOG_LINE, f"{LOG_LINE} {TEMPORARY}"), encoding="utf-8")
    words = [word.format(folder=folder, file=folder / file) for word in command]
    process = subprocess.Popen(words, cwd=folder)
    url = f"http://127.0.0.1:{port}/"
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


@pytest.mark.nightly
@pytest.mark.parametrize("name", PROXIES)
def test_a_page_works_behind_it_with_two_processes(name: str, tmp_path: Path) -> None:
    if shutil.which(name) is None:
        pytest.skip(f"{name} is not installed")
    port, to = free_port(), free_port()
    command = ("-m", "railjoule.dashboard", "serve", "--no-workspace", "--processes", "2")
    with serving(*command, "--origin", f"127.0.0.1:{port}", port=to), proxy(name, port, to, tmp_path) as url:
        # in a thread, as Playwright keeps a loop running in that of the tests
        with ThreadPoolExecutor(1) as thread:
            assert thread.submit(asyncio.run, moved(url)).result() > 0
        with urllib.request.urlopen(url) as answer:
            assert "frame-ancestors 'self'" in answer.headers["Content-Security-Policy"]
