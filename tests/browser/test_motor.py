"""Motor, as a user works with it."""

import pytest
from playwright.sync_api import expect

from browser.user import User

LINK = "?v=1&page=Motor"


@pytest.fixture(scope="module")
def user(user: User) -> User:
    """One user, who stays on the page for all tests of this file."""
    expect(user.page.get_by_text("The page shows an example")).to_be_visible()
    user.page.get_by_role("button", name="Open Suburban, flat 5 km").click()
    expect(user.figure_value("Tracking error")).not_to_be_empty()
    # charts that are still to be drawn push the others down
    user.settled()
    return user


def test_blocks_and_figures_light_each_other(user: User) -> None:
    block = user.page.locator("svg.wide [data-block=current_control]")
    lit = user.page.locator("svg.wide [data-block].lit")
    chart = user.page.locator(".rj-chart-loop_currents:visible")
    chart.scroll_into_view_if_needed()
    block.hover()
    expect(lit).to_have_count(1)
    expect(user.page.locator(".rj-lit")).to_have_count(1)
    user.page.mouse.move(5, 5)
    expect(lit).to_have_count(0)
    expect(user.page.locator(".rj-lit")).to_have_count(0)
    chart.hover()
    expect(lit).to_have_attribute("data-block", "current_control")
    user.page.mouse.move(5, 5)
    # by key: the block after the one that is focused, and its figure into sight
    block.focus()
    user.page.keyboard.press("Tab")
    expect(lit).to_have_attribute("data-block", "inverter")
    user.page.keyboard.press("Enter")
    expect(user.page.locator(".rj-chart-loop_voltage:visible canvas").first).to_be_in_viewport()
