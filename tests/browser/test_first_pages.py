"""Start, Learn and Papers, as a user works with them."""

from playwright.sync_api import Browser, expect

from browser.findings import assert_nothing_grave
from browser.server import Server
from browser.user import User


def test_a_session_without_an_address_begins_with_start(server: Server, chromium: Browser) -> None:
    with User.at(chromium, server.url, on_drive=False) as user:
        page = user.page
        expect(page.get_by_role("heading", name="How little energy does a train need", level=1)).to_be_visible()
        sketch = page.get_by_role("img", name="Speed over distance of the optimum of Metro, profile II + I")
        expect(sketch).to_be_visible()
        assert_nothing_grave(user)
        page.get_by_role("button", name="Tram, flat 950 m", exact=True).click()
        expect(user.scenario("Tram, flat 950 m")).to_be_visible()
        expect(page.get_by_role("button", name="Drive", exact=True)).to_have_attribute("aria-current", "page")
        expect(page.locator(".rj-chart-speed:visible canvas").first).to_be_visible()
