"""The page as others serve it: below a path of its own, with few places, and only within its own site."""

import urllib.error
import urllib.request
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, expect

from browser.server import Server, serving
from browser.user import PATIENCE_MS, User, open_page
from railjoule.dashboard.page_list import PAGES

PREFIX = "tools/rail/"
PLACES = 2
COMMAND = ("-m", "railjoule.dashboard", "serve", "--no-workspace", "--prefix", f"/{PREFIX}", "--sessions", str(PLACES))


@pytest.fixture(scope="module")
def below() -> Iterator[Server]:
    """A server whose page lies below a path, and has two places."""
    with serving(*COMMAND, path=PREFIX) as running:
        yield running


def test_every_page_works_below_a_path(below: Server, chromium: Browser) -> None:
    with User.at(chromium, below.url, on_drive=False) as user:
        asked: list[str] = []
        user.page.on("request", lambda request: asked.append(request.url))
        for name in PAGES:
            open_page(user, name)
            expect(user.question(name)).to_be_visible()
        # with the components that load what they draw with only where a page needs it
        open_page(user, "Trade-off")
        user.settled()
        beside = [url for url in asked if not url.startswith((below.url, "blob:", "data:")) and "/ws" not in url]
        assert beside == []


def test_a_page_too_many_is_told_so_and_the_others_go_on(below: Server, chromium: Browser) -> None:
    with User.at(chromium, below.url, on_drive=False) as user:
        with User.at(chromium, below.url, on_drive=False):
            with pytest.raises(urllib.error.HTTPError) as refused:
                urllib.request.urlopen(below.url)
            assert refused.value.code == 503
            waiting = chromium.new_page()
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
