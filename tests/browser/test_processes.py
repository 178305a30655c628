"""The page where several processes serve it behind one port."""

import re
from collections.abc import Iterator

import psutil
import pytest
from playwright.sync_api import Browser, Page, expect
from playwright.sync_api import TimeoutError as PlaywrightTimeoutError

from browser.server import Server, serving
from browser.user import PATIENCE_MS, User

COMMAND = ("-m", "railjoule.dashboard", "serve", "--no-workspace", "--processes", "2", "--sessions", "3")
TIME = "Travel time, s, as a number"


@pytest.fixture(scope="module")
def server() -> Iterator[Server]:
    with serving(*COMMAND) as running:
        yield running


def workers(server: Server) -> dict[int, psutil.Process]:
    """Return the processes that serve, those with more connections last."""
    found = [one for one in server.processes()[1:] if "spawn_main" in " ".join(one.cmdline())]
    return {one.pid: one for one in sorted(found, key=lambda one: len(one.net_connections("tcp")))}


def test_a_page_comes_back_where_its_process_dies_and_another_goes_on(server: Server, chromium: Browser) -> None:
    with User.at(chromium, server.drive_url) as one:
        one.type("Travel time, s", "190")
        expect(one.page).to_have_url(re.compile("travel_time_s=190"))
        context = chromium.new_context(viewport={"width": 1280, "height": 900})
        other = context.new_page()
        other.goto(server.drive_url)
        other.locator("html.rj-started").wait_for(timeout=PATIENCE_MS)
        energy = other.locator(".figure.main:visible .value")
        expect(energy).not_to_be_empty()
        first = energy.inner_text()
        before = workers(server)
        assert len(before) == 2
        pages = {"one": one.page, "other": other}
        for page in pages.values():
            page.evaluate("window.rjSame = true")
        victim = next(iter(before.values()))
        victim.kill()
        # the page of the dead process comes back by itself
        died = "!window.rjSame && document.documentElement.classList.contains('rj-started')"
        lost = [name for name, page in pages.items() if _comes(page, died)]
        assert len(lost) == 1
        expect(energy).to_have_text(first, timeout=PATIENCE_MS)
        expect(one.page.get_by_label(TIME, exact=True)).to_have_value("190", timeout=PATIENCE_MS)
        one.errors.clear()
        context.close()
    assert len(workers(server)) == 2


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
