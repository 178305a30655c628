"""A page whose server dies and comes back: it says so, takes no changes, and is loaded again as it was."""

import re
from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Locator, Page, expect

from browser.findings import grave_findings
from browser.server import Server, free_port, serving
from browser.user import PATIENCE_MS

COMMAND = ("-m", "railjoule.dashboard", "serve")
LOAD, TARE = "Load, % of capacity", "Tare, kg"
LOST = "The connection to the server is lost. Changes have no effect"


@pytest.fixture(scope="module")
def port() -> int:
    """Where the server of this file comes back."""
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


def field(page: Page, name: str) -> Locator:
    return page.get_by_role("textbox", name=f"{name}, as a number", exact=True)


def test_a_page_without_its_server_takes_no_changes_and_comes_back_as_it_was(page: Page, port: int) -> None:
    banner = page.get_by_role("alert").filter(has_text=LOST)
    with serving(*COMMAND, port=port) as server:
        open_drive(page, server)
        page.get_by_role("button", name="Edit scenario").click()
        editor = page.get_by_role("region", name="Scenario editor")
        editor.get_by_role("button", name="Vehicle", exact=True).click()
        tare = editor.get_by_label(TARE, exact=True)
        tare.fill("155000")
        tare.press("Tab")
        field(page, LOAD).fill("77")
        field(page, LOAD).press("Enter")
        expect(page).to_have_url(re.compile("load_percent=77&edits=.*155000"))
        energy = page.locator(".figure.main:visible .value")
        expect(page.locator(".working")).to_be_hidden()
        address, before = page.url, energy.inner_text()
        server.process.kill()
        server.process.wait()
    expect(banner).to_be_visible()
    # its numbers look as old as they are, and nothing can be changed, pressed or dropped
    assert page.evaluate("getComputedStyle(document.documentElement).getPropertyValue('--rj-chart-filter')") != ""
    for line in (field(page, LOAD), editor.get_by_role("textbox").first):
        expect(line).not_to_be_editable()
    for control in (page.get_by_role("slider", name=LOAD, exact=True), page.get_by_role("button", name="Share")):
        expect(control).to_be_disabled()
    assert grave_findings(page) == {}
    page.get_by_role("button", name="Compare", exact=True).first.click(force=True)
    page.get_by_role("button", name="Edit scenario").click(force=True)
    page.keyboard.press("Control+z")
    dropped = page.evaluate(
        "() => !document.body.dispatchEvent(new DragEvent('drop', {bubbles: true, cancelable: true, composed: true}))"
    )
    assert dropped, "the browser would open the file in place of the page"
    assert page.url == address
    with serving(*COMMAND, port=port):
        expect(banner).to_have_count(0, timeout=PATIENCE_MS)
        page.locator("html.rj-started").wait_for(timeout=PATIENCE_MS)
        expect(field(page, LOAD)).to_have_value("77")
        expect(field(page, LOAD)).to_be_enabled()
        expect(energy).to_have_text(before)
        assert page.url == address
