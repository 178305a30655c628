"""The page as others serve it: below a path of its own, with few places, and only within its own site."""

import asyncio
import http.client
import urllib.error
import urllib.request
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from playwright.sync_api import Browser, BrowserContext, expect

from browser.server import Server, serving
from browser.user import PATIENCE_MS, User, open_page
from browser.visitor import Visitor
from railjoule.core import load_scenario
from railjoule.core.scenario import format_scenario
from railjoule.dashboard.keep.link import write_link

PREFIX = "tools/rail/"
PLACES = 2
CANARY, SETTLED_S = "CANARY-4711", 1.5
COMMAND = (
    "-m",
    "railjoule.dashboard",
    "serve",
    "--prefix",
    f"/{PREFIX}",
    "--sessions",
    str(PLACES),
    "--address",
    "0.0.0.0",
)


@pytest.fixture(scope="module")
def below() -> Iterator[Server]:
    """A server for all machines, without a folder, whose page lies below a path, and has two places."""
    with serving(*COMMAND, path=PREFIX) as running:
        yield running


@pytest.fixture(scope="module")
def user(below: Server, window: BrowserContext) -> Iterator[User]:
    """One user of that server for all tests of this file."""
    with User.on(window, below.url) as someone:
        yield someone


def test_without_a_folder_nothing_is_listed_and_saving_is_a_download(user: User) -> None:
    expect(user.page.get_by_role("heading", name="First steps")).to_be_visible()
    expect(user.page.get_by_text("My files").locator("visible=true")).to_have_count(0)
    open_page(user, "Drive")
    with user.page.expect_download() as download:
        user.page.get_by_role("button", name="Save scenario").click()
    assert download.value.suggested_filename == "metro-profile-ii-i.toml"
    assert load_scenario(Path(download.value.path())).travel_time_s == 170


def test_pages_work_below_a_path(below: Server, user: User) -> None:
    asked: list[str] = []
    user.page.on("request", lambda request: asked.append(request.url))
    for name in ("Drive", "Explore", "Help"):
        open_page(user, name)
        expect(user.question(name)).to_be_visible()
    # with the components that load what they draw with only where a page needs it
    open_page(user, "Trade-off")
    user.settled()
    beside = [url for url in asked if not url.startswith((below.url, "blob:", "data:")) and "/ws" not in url]
    assert beside == []


@pytest.mark.nightly
def test_a_page_too_many_is_told_so_and_the_others_go_on(below: Server, user: User, window: BrowserContext) -> None:
    with User.on(window, below.url):
        with pytest.raises(urllib.error.HTTPError) as refused:
            urllib.request.urlopen(below.url)
        assert refused.value.code == 503
        waiting = window.new_page()
        waiting.goto(below.url)
        expect(waiting.get_by_text("keeps 2 pages open at a time")).to_be_visible()
        open_page(user, "Drive")
        user.see_drive()
    # the place that was left is taken without a press
    expect(waiting.get_by_role("button", name="Drive", exact=True)).to_be_visible(timeout=60_000)
    waiting.close()


def test_the_pages_of_all_these_tests_are_under_the_policy(server: Server) -> None:
    with urllib.request.urlopen(server.url) as answer:
        policy = answer.headers["Content-Security-Policy"]
    assert "frame-ancestors 'self'" in policy
    assert "object-src 'none'" in policy


FOREIGN = ("http://evil.example", "http://127.0.0.1.evil.example:{port}", "http://127.0.0.1:{other}", "null", "file://")
HANDSHAKE = {
    "Connection": "Upgrade",
    "Upgrade": "websocket",
    "Sec-WebSocket-Version": "13",
    "Sec-WebSocket-Key": "AAAAAAAAAAAAAAAAAAAAAA==",
    "Sec-WebSocket-Protocol": "bokeh, token",
}


def test_pages_of_other_origins_open_no_websocket(server: Server) -> None:
    def status(origin: str) -> int:
        connection = http.client.HTTPConnection("127.0.0.1", server.port, timeout=30)
        connection.request("GET", "/ws", headers={**HANDSHAKE, "Origin": origin})
        try:
            return connection.getresponse().status
        finally:
            connection.close()

    assert status(f"http://127.0.0.1:{server.port}") == 101
    for origin in FOREIGN:
        assert status(origin.format(port=server.port, other=server.port + 1)) == 403, origin


def test_a_page_is_sent_nothing_of_another(server: Server) -> None:
    scenario = format_scenario(load_scenario("metro-with-limit", {"title": CANARY, "vehicle.name": CANARY}))
    link = server.url + write_link({"page": "Drive", "toml": scenario}, {})

    async def visit() -> None:
        own, other = Visitor(link), Visitor(server.drive_url)
        await own.open()
        await other.open()
        assert CANARY in own.text
        assert CANARY not in other.text
        # until its own figures have come
        while other.text:
            other.text = ""
            await asyncio.sleep(SETTLED_S)
        slider = own.slider("Travel time, s")
        for value in (151.0, 152.0, 151.0):
            await own.move(slider, value, "figures")
        assert other.text == ""
        await own.close()
        await other.close()

    # Playwright keeps a loop running in the thread of the tests
    with ThreadPoolExecutor(1) as thread:
        thread.submit(asyncio.run, visit()).result()


def test_a_page_that_cannot_be_made_says_so(chromium: Browser, tmp_path: Path) -> None:
    log = tmp_path / "log"
    with serving(str(Path(__file__).with_name("broken.py")), log=log) as server:
        page = chromium.new_page()
        page.goto(server.url)
        told = page.get_by_role("status").filter(has_text="This page could not be opened")
        expect(told).to_be_visible(timeout=PATIENCE_MS)
        page.close()
    text = log.read_text()
    assert "a page could not be opened" in text
    assert "broken on purpose" in text
