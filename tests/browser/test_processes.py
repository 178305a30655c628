"""The page where several processes serve it behind one port."""

from collections.abc import Iterator

import psutil
import pytest
from playwright.sync_api import Browser, Locator, Page, expect
from playwright.sync_api import TimeoutError as PlaywrightTimeoutError

from browser.server import Server, serving
from browser.user import PATIENCE_MS, User

COMMAND = ("-m", "railjoule.dashboard", "serve", "--processes", "2", "--sessions", "3")
TIME = "Travel time, s, as a number"
CAME_BACK = "!window.rjSame && document.documentElement.classList.contains('rj-started')"


@pytest.fixture(scope="module")
def server() -> Iterator[Server]:
    with serving(*COMMAND) as running:
        yield running


def workers(server: Server) -> dict[int, psutil.Process]:
    """Return the processes that serve, those with more connections last."""
    found = [one for one in server.processes()[1:] if "spawn_main" in " ".join(one.cmdline())]
    return {one.pid: one for one in sorted(found, key=lambda one: len(one.net_connections("tcp")))}


def test_a_page_comes_back_where_its_process_dies_and_another_goes_on(server: Server, chromium: Browser) -> None:
    contexts = [chromium.new_context(viewport={"width": 1280, "height": 900}) for _ in range(2)]
    try:
        pages = [context.new_page() for context in contexts]
        for page, time_s in zip(pages, (190, 195), strict=True):
            page.goto(f"{server.drive_url}&travel_time_s={time_s}")
            page.locator("html.rj-started").wait_for(timeout=PATIENCE_MS)
            expect(page.locator(".figure:visible", has_text="Travel time").locator(".value")).to_have_text(
                f"{time_s}.0s"
            )
            page.evaluate("window.rjSame = true")
        before = workers(server)
        assert len(before) == 2
        next(iter(before.values())).kill()
        # each process has had one of the pages
        lost = [page for page in pages if _comes(page, CAME_BACK)]
        assert len(lost) == 1
        for page, time_s in zip(pages, (190, 195), strict=True):
            expect(page.get_by_label(TIME, exact=True)).to_have_value(f"{time_s}.0", timeout=PATIENCE_MS)
            expect(page.locator(".figure:visible", has_text="Travel time").locator(".value")).to_have_text(
                f"{time_s}.0s"
            )
        after = workers(server)
        assert len(after) == 2
        assert len(set(after) - set(before)) == 1
    finally:
        for context in contexts:
            context.close()


def _shown(page: Page) -> Locator:
    """Return the travel time of the run in sight."""
    return page.locator(".figure:visible", has_text="Travel time").locator(".value")


def _comes(page: Page, what: str) -> bool:
    """Return whether something becomes true of a page within a while."""
    try:
        page.wait_for_function(what, timeout=15_000)
    # one of the two pages shall not change
    except PlaywrightTimeoutError:
        return False
    return True


def test_places_are_counted_over_all_processes(server: Server, chromium: Browser) -> None:
    with (
        User.at(chromium, server.url, on_drive=False),
        User.at(chromium, server.url, on_drive=False),
        User.at(chromium, server.url, on_drive=False),
    ):
        waiting = chromium.new_page()
        waiting.goto(server.url)
        expect(waiting.get_by_text("keeps 3 pages open at a time")).to_be_visible()
        waiting.close()
