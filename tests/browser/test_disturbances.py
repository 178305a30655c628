"""Disturbances, as a user works with it."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import BrowserContext, expect

from browser.findings import assert_nothing_grave
from browser.server import Server
from browser.user import User


@pytest.fixture(scope="module")
def user(server: Server, window: BrowserContext) -> Iterator[User]:
    """One user, who stays on the page for all tests of this file."""
    with User.on(window, server.drive_url) as someone:
        someone.turn_to("Disturbances")
        yield someone


def test_events_are_dropped_changed_and_removed(user: User) -> None:
    user.choose("Metro, profile II")
    invitation = user.page.get_by_text('No event yet. Click the speed chart or press "Add a stop".')
    expect(invitation).to_be_visible()
    expect(user.page.locator(".figure:visible")).to_have_count(0)
    user.page.get_by_role("button", name="Add a stop", exact=True).click()
    expect(invitation).to_be_hidden()
    for who in ("Driver", "Replanned run", "With notice"):
        expect(user.figure_value(f"{who} arrives")).not_to_be_empty()
    user.page.get_by_role("button", name="Click adds a limit").click()
    user.settled()
    box = user.page.locator(".rj-chart-ride_speed:visible canvas").first.bounding_box()
    assert box is not None
    user.page.mouse.click(box["x"] + 0.7 * box["width"], box["y"] + 0.5 * box["height"])
    expect(user.page.get_by_label("2 Limit: km/h, as a number")).to_have_value("30")
    before = user.number("Driver arrives")
    user.type("1 Stop: stops for, s", "25")
    expect(user.figure_value("Driver arrives")).not_to_have_text(before)
    user.page.get_by_role("button", name="Remove 2 Limit").click()
    expect(user.page.get_by_label("2 Limit: km/h, as a number")).to_have_count(0)
    user.type("Accepted delay, s", "20")
    expect(user.figure_value("Replanned run arrives")).to_have_text("+20.0s")
    assert_nothing_grave(user)


def test_a_run_plays_and_its_events_are_kept(user: User) -> None:
    user.choose("Metro, profile II")
    user.page.get_by_role("button", name="Events while the train drives").click()
    user.page.get_by_role("button", name="20\u00d7").click()
    user.settled()
    user.type("Signal red for, s", "5")
    user.page.get_by_role("button", name="Play", exact=True).click()
    expect(user.figure_value("Position")).not_to_have_text("0m")
    # out of sight the clock stops
    hide = "hidden => { Object.defineProperty(document, 'hidden', {value: hidden, configurable: true}); "
    user.page.evaluate(hide + "document.dispatchEvent(new Event('visibilitychange')); }", True)
    user.page.get_by_role("button", name="Play", exact=True).wait_for()
    user.page.evaluate(hide + "document.dispatchEvent(new Event('visibilitychange')); }", False)
    user.page.get_by_role("button", name="Play", exact=True).click()
    user.page.get_by_role("button", name="Set red signal").click()
    expect(user.page.get_by_text("planned again in")).to_be_visible()
    expect(user.page.get_by_text("How it ended")).to_be_visible()
    expect(user.page.get_by_role("button", name="Play again")).to_be_visible()
    user.settled()
    assert_nothing_grave(user)
    user.page.get_by_role("button", name="Keep these events").click()
    user.settled()
    expect(user.page.get_by_label("1 Stop: stops for, s, as a number")).to_have_value("5")
