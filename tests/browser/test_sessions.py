"""Many open pages: none pays for the others, and closed ones are forgotten."""

import time
from pathlib import Path

import pytest
from playwright.sync_api import BrowserContext

from browser.server import Server, serving
from browser.user import PATIENCE_MS, User

PAGES = 3
MOVES = 6
LARGEST_COST = 1.5
"""A slider move may cost the server at most this many times what it costs with one open page."""
FORGOTTEN_WITHIN_S = 60


def pages_alive(server: Server) -> int:
    """Return how many pages the server holds."""
    return int(server.get("pages"))


def cost_of_a_move(server: Server, user: User) -> float:
    """Return the server's processor time for one slider move [s]."""
    user.push("Travel time, s", 3)
    before = server.cpu_s()
    for _ in range(MOVES):
        user.slider("Travel time, s").press("ArrowRight")
        user.settled()
    return (server.cpu_s() - before) / MOVES


@pytest.mark.nightly
def test_many_open_pages(window: BrowserContext) -> None:
    with serving(str(Path(__file__).with_name("watched.py"))) as server:
        with User.on(window, server.drive_url) as mover:
            alone = cost_of_a_move(server, mover)
            others = [window.new_page() for _ in range(PAGES - 1)]
            for page in others:
                page.goto(server.drive_url, wait_until="commit")
            for page in others:
                page.locator("html.rj-started").wait_for(timeout=PAGES * PATIENCE_MS)
            mover.settled()
            assert pages_alive(server) == PAGES
            assert cost_of_a_move(server, mover) < LARGEST_COST * alone
            for page in others:
                page.close()
        deadline = time.monotonic() + FORGOTTEN_WITHIN_S
        while pages_alive(server) > 0 and time.monotonic() < deadline:
            time.sleep(0.5)
        assert pages_alive(server) == 0
