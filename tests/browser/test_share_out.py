"""The lesson on the supplement: by mouse, by keyboard alone, by touch, and from a link."""

import re

import pytest
from playwright.sync_api import BrowserContext, Locator, Page, expect

from browser.server import Server
from browser.user import User

LINK = "?v=1&page=Learn"
READY_MS = 60_000
MOST_WORDS = 150


def lesson(page: Page) -> Locator:
    """Return the lesson, once its borders can be moved."""
    found = page.locator(".rj-lesson-shared:visible")
    expect(found.get_by_role("slider")).to_have_count(2, timeout=READY_MS)
    return found


def test_by_mouse_to_the_best_distribution_and_line(user: User) -> None:
    share = lesson(user.page)
    share.scroll_into_view_if_needed()
    # equal seconds, as `railjoule.core` drives it; nothing of the best distribution before one has asked
    expect(share.get_by_text("16.267 kWh", exact=True)).to_be_visible()
    expect(share.locator(".outcome")).to_have_count(0)
    assert len(share.inner_text().split()) <= MOST_WORDS
    bar, thumb = share.locator(".split").bounding_box(), share.locator(".MuiSlider-thumb").first.bounding_box()
    assert bar is not None
    assert thumb is not None
    height = thumb["y"] + thumb["height"] / 2
    user.page.mouse.move(thumb["x"] + thumb["width"] / 2, height)
    user.page.mouse.down()
    user.page.mouse.move(bar["x"] + bar["width"] * 12 / 60, height, steps=5)
    user.page.mouse.up()
    expect(share.get_by_text("12 s", exact=True)).to_be_visible()
    for _ in range(3):
        share.get_by_role("slider").nth(1).press("ArrowRight")
    expect(share.get_by_text("17 s", exact=True)).to_be_visible()
    share.get_by_role("button", name="Show the best distribution").click()
    expect(share.locator(".outcome")).to_contain_text("no distribution needs less than 15.568", timeout=READY_MS)
    expect(share.get_by_text("distributing it pays")).to_be_visible()
    expect(user.page).to_have_url(re.compile("learn.shared=uneven:12,31,17"))
    share.get_by_role("button", name="Open on Line").click()
    expect(user.question("Line")).to_be_visible()
    expect(user.scenario("Distribute the supplement: uneven legs")).to_be_visible()


@pytest.mark.nightly
def test_by_keyboard_alone_until_it_does_not_pay(window: BrowserContext, server: Server) -> None:
    with User.on(window, f"{server.url}?v=1&page=Learn") as user:
        keys, share = user.page.keyboard, lesson(user.page)

        user.reach(share.get_by_role("slider").first)
        for _ in range(8):
            keys.press("ArrowLeft")
        expect(share.get_by_role("slider").first).to_have_attribute("aria-valuenow", "12")
        expect(share.get_by_text("12 s", exact=True)).to_be_visible()
        user.reach(share.get_by_role("button", name="Show the best distribution"))
        keys.press("Enter")
        expect(share.get_by_role("status")).to_contain_text("no distribution needs less", timeout=READY_MS)
        user.reach(share.get_by_role("button", name="Next: a line with legs alike"))
        keys.press("Enter")
        user.reach(share.get_by_role("slider").first)
        keys.press("ArrowRight")
        expect(share.get_by_text("21 s", exact=True)).to_be_visible()
        user.reach(share.get_by_role("button", name="Show the best distribution"))
        keys.press("Enter")
        expect(share.get_by_text("it does not pay")).to_be_visible(timeout=READY_MS)
