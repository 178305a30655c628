"""A page whose server stands still, dies and comes back: nothing that was changed is lost, and one may go on."""

import json
import re
import signal
from collections.abc import Iterator
from urllib.parse import parse_qs, urlsplit

import pytest
from playwright.sync_api import Browser, Locator, Page, expect

from browser.server import Server, free_port, serving
from browser.user import PATIENCE_MS, User

COMMAND = ("-m", "railjoule.dashboard", "serve")
LOAD, TIME, TARE = "Load, % of capacity", "Travel time, s", "Tare, kg"
LIMIT = "Limit, km/h, row 1"
KILLED_AFTER_MS = 60
STOPPED_MS = 9000
# when marks are due, WAITING_MS and SILENT_MS in assets/scripts/lifeline.js, with what a busy machine takes
WAITING_MS, SILENT_MS, LATE_MS = 1000, 5000, 1500


@pytest.fixture(scope="module")
def port() -> int:
    """Where the servers of this file come back."""
    return free_port()


@pytest.fixture
def page(chromium: Browser) -> Iterator[Page]:
    context = chromium.new_context(viewport={"width": 1280, "height": 900})
    yield context.new_page()
    context.close()


def open_drive(page: Page, server: Server) -> None:
    page.goto(server.drive_url)
    page.locator("html.rj-started").wait_for(timeout=PATIENCE_MS)
    expect(page.locator(".figure.main:visible .value")).not_to_be_empty()
    page.wait_for_timeout(1000)


def see_again(page: Page) -> None:
    """Wait until the page was opened anew."""
    page.wait_for_function("!document.documentElement.classList.contains('rj-gone')", timeout=PATIENCE_MS)
    page.locator("html.rj-started").wait_for(timeout=PATIENCE_MS)


def field(page: Page, name: str) -> Locator:
    return page.get_by_role("textbox", name=f"{name}, as a number", exact=True)


def test_a_change_just_before_the_server_dies_is_kept_and_one_goes_on_without_it(page: Page, port: int) -> None:
    with serving(*COMMAND, port=port) as server:
        open_drive(page, server)
        page.get_by_role("button", name="Edit scenario").click()
        editor = page.get_by_role("region", name="Scenario editor")
        for group in ("Vehicle", "Track"):
            editor.locator(".turn button", has_text=group).first.click()
        tare, limit = editor.get_by_label(TARE, exact=True), editor.get_by_label(LIMIT, exact=True)
        expect(limit).to_be_visible()
        field(page, LOAD).fill("77")
        field(page, LOAD).press("Enter")
        page.wait_for_timeout(KILLED_AFTER_MS)
        server.process.kill()
        server.process.wait()
    expect(page.get_by_role("alert").filter(has_text="The connection to the server is lost.")).to_be_visible()
    # its numbers look as old as they are, whatever the address has reached
    assert page.evaluate("getComputedStyle(document.documentElement).getPropertyValue('--rj-chart-filter')") != ""
    expect(field(page, LOAD)).to_have_value("77")
    # one goes on: a number can still be changed, and what only a server can do is not begun
    field(page, TIME).fill("190")
    field(page, TIME).press("Enter")
    for cell, text in ((tare, "155000"), (limit, "66")):
        cell.fill(text)
        cell.press("Tab")
    before = page.url
    page.get_by_role("button", name="Compare", exact=True).first.click(force=True)
    assert page.url == before
    with serving(*COMMAND, port=port):
        see_again(page)
        expect(field(page, LOAD)).to_have_value("77")
        expect(field(page, TIME)).to_have_value(re.compile(r"^190"))
        expect(page).to_have_url(re.compile("travel_time_s=190&load_percent=77"))
        expect(page.locator(".figure:visible", has_text="Travel time").locator(".value")).to_have_text("190.0s")
        # what was typed into the editor stands in the address too
        edits = parse_qs(urlsplit(page.url).query)["edits"][0]
        assert json.loads(edits)["vehicle.tare_kg"] == 155_000
        assert json.loads(edits)["line.speed_limits"][0]["limit_kmh"] == 66


@pytest.mark.nightly
def test_a_page_is_not_opened_anew_under_the_hands_of_who_types(page: Page, port: int) -> None:
    with serving(*COMMAND, port=port) as server:
        open_drive(page, server)
        server.process.kill()
        server.process.wait()
    expect(page.get_by_role("alert").filter(has_text="The connection to the server is lost.")).to_be_visible()
    field(page, LOAD).focus()
    field(page, LOAD).press_sequentially("4")
    with serving(*COMMAND, port=port):
        expect(page.get_by_role("alert").filter(has_text="The server is back.")).to_be_visible(timeout=PATIENCE_MS)
        field(page, LOAD).fill("44")
        field(page, LOAD).press("Tab")
        see_again(page)
        expect(field(page, LOAD)).to_have_value("44")


def test_a_server_that_stands_still_is_told_and_no_change_is_lost(chromium: Browser, port: int) -> None:
    with serving(*COMMAND, port=port) as server, User.at(chromium, server.drive_url) as user:
        page = user.page
        energy = user.figure_value("Energy from the supply").inner_text()
        wait, silent = page.locator(".rj-wait"), page.locator(".rj-lost")
        user.rest(2000)
        assert page.evaluate("window.railjoule.wire.waits_ms()") == 0
        server.process.send_signal(signal.SIGSTOP)
        try:
            page.wait_for_timeout(2 * WAITING_MS)
            # nobody waits for anything yet
            expect(wait).to_have_count(0)
            field(page, LOAD).fill("35")
            field(page, LOAD).press("Enter")
            page.wait_for_timeout(WAITING_MS // 2)
            expect(wait).to_have_count(0)
            expect(wait).to_be_visible(timeout=WAITING_MS // 2 + LATE_MS)
            expect(silent).to_have_count(0)
            assert "rj-waiting" in str(page.evaluate("document.documentElement.className"))
            expect(silent).to_be_visible(timeout=SILENT_MS - WAITING_MS + LATE_MS)
            expect(silent).to_contain_text("The server does not answer.")
            silent.get_by_role("button", name="Try now").click()
            # one goes on reading and typing
            field(page, TIME).fill("180")
            field(page, TIME).press("Enter")
            expect(user.figure_value("Energy from the supply")).to_have_text(energy)
            page.wait_for_timeout(STOPPED_MS - SILENT_MS)
        finally:
            server.process.send_signal(signal.SIGCONT)
        expect(silent).to_have_count(0)
        expect(wait).to_have_count(0)
        expect(page).to_have_url(re.compile("travel_time_s=180&load_percent=35"))
        expect(user.figure_value("Energy from the supply")).not_to_have_text(energy)


@pytest.mark.nightly
def test_a_step_back_is_not_undone_by_a_reload(chromium: Browser, port: int) -> None:
    with serving(*COMMAND, port=port) as server, User.at(chromium, server.drive_url) as user:
        expect(field(user.page, LOAD)).to_have_value("50")
        field(user.page, LOAD).fill("20")
        field(user.page, LOAD).press("Enter")
        expect(user.page).to_have_url(re.compile("load_percent=20"))
        user.page.keyboard.press("Control+z")
        expect(field(user.page, LOAD)).to_have_value("50")
        user.page.reload()
        user.page.locator("html.rj-started").wait_for(timeout=PATIENCE_MS)
        user.rest(1000)
        expect(field(user.page, LOAD)).to_have_value("50")
