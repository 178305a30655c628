"""The page What if, as a user works with it."""

import re

from playwright.sync_api import expect

from browser.findings import assert_nothing_grave
from browser.server import Server
from browser.user import User, open_page

WORKED_MS = 60_000


LINK = "?v=1&page=What if&preset=liashenko-ii"


def test_a_press_on_a_cell_shows_its_run(user: User) -> None:
    # 0.5 s late at full load and +10 m, as `railjoule simulate` has it
    expect(user.figure_value("Load 100 %, +10 m")).to_have_text("0.5s late")
    expect(user.figure_value("Largest in table")).to_have_text("+34.9%")
    for chart in ("heatmap", "driven_speed", "driven_effort"):
        expect(user.page.locator(f".rj-chart-{chart}:visible canvas").first).to_be_visible()
    box = user.page.locator(".rj-chart-heatmap:visible canvas").first.bounding_box()
    assert box is not None
    speed = user.picture("driven_speed")
    # the lowest cell at the left: load 0, -25 m
    user.page.mouse.click(box["x"] + 0.18 * box["width"], box["y"] + 0.76 * box["height"])
    expect(user.figure_value("Load 0 %, \u221225 m")).to_be_visible()
    user.see_change("driven_speed", speed)
    field = user.page.get_by_label("Position error, m, as a number").locator("visible=true")
    expect(field).to_have_value("\u221225")


def turn_to_tab(user: User, name: str) -> None:
    """Open a tab."""
    user.page.get_by_role("tab", name=name).click()
    expect(user.page.get_by_role("tab", name=name)).to_have_attribute("aria-selected", "true")


def test_tabs_are_reached_by_keyboard_and_stand_in_the_address(user: User, server: Server) -> None:
    tab = user.page.get_by_role("tab", name="Load and position")
    tab.focus()
    user.page.keyboard.press("ArrowRight")
    user.page.keyboard.press("Enter")
    expect(user.page.get_by_role("tab", name="Events")).to_have_attribute("aria-selected", "true")
    expect(user.page).to_have_url(re.compile(r"what_if\.tab=events"))
    expect(user.page.locator(".rj-chart-heatmap:visible")).to_have_count(0)
    user.page.keyboard.press("ArrowLeft")
    user.page.keyboard.press("Enter")
    expect(user.page.locator(".rj-chart-heatmap:visible canvas").first).to_be_visible()
    assert_nothing_grave(user)


def test_chance_draws_and_can_be_stopped(user: User) -> None:
    user.go(LINK)
    turn_to_tab(user, "Chance")
    note = user.page.get_by_text("runs, seed 1.")
    expect(note).to_contain_text("500 of 500 runs", timeout=WORKED_MS)
    user.page.get_by_role("button", name="Run 10").click()
    stop = user.page.get_by_role("button", name="Stop", exact=True)
    expect(stop).to_be_visible()
    expect(note).to_contain_text("of 10\u202f000 runs")
    # the page stays live in the meantime
    turn_to_tab(user, "Load and position")
    before = user.number("Load 100 %")
    slider = user.slider("Actual load, % of capacity")
    slider.press("PageDown")
    expect(user.figure_value("Load 88 %")).not_to_have_text(before)
    turn_to_tab(user, "Chance")
    stop.click()
    expect(stop).to_be_hidden()
    stopped = note.inner_text()
    user.settled()
    assert note.inner_text() == stopped
    user.page.get_by_role("button", name="Explore the draws", exact=True).click()
    expect(user.question("Explore")).to_be_visible()
    expect(user.page.get_by_text("random draws of What if")).to_be_visible()
    expect(user.page.locator(".legend:visible").get_by_text("Energy, kWh, over load")).to_be_visible()
    open_page(user, "What if")


def test_events_are_dropped_changed_and_removed(user: User) -> None:
    turn_to_tab(user, "Events")
    invitation = user.page.get_by_text('No event yet. Click the speed chart or press "Add a stop".')
    expect(invitation).to_be_visible()
    expect(user.page.locator(".figure:visible")).to_have_count(0)
    user.page.get_by_role("button", name="Add a stop", exact=True).click()
    expect(invitation).to_be_hidden()
    expect(user.figure_value("Driver")).to_contain_text("s late")
    for who in ("Replanning", "Advance notice"):
        expect(user.page.locator(".figure:visible").filter(has_text=who)).to_contain_text("arrives at the same time")
    user.page.get_by_role("button", name="Click adds a limit").click()
    user.settled()
    box = user.page.locator(".rj-chart-ride_speed:visible canvas").first.bounding_box()
    assert box is not None
    user.page.mouse.click(box["x"] + 0.7 * box["width"], box["y"] + 0.5 * box["height"])
    expect(user.page.get_by_label("2 Limit: km/h, as a number")).to_have_value("30")
    before = user.number("Driver")
    user.type("1 Stop: stops for, s", "25")
    expect(user.figure_value("Driver")).not_to_have_text(before)
    user.page.get_by_role("button", name="Remove 2 Limit").click()
    expect(user.page.get_by_label("2 Limit: km/h, as a number")).to_have_count(0)
    user.type("Accepted delay, s", "20")
    expect(user.page.get_by_role("row", name="Replanned")).to_contain_text("+20.0")
    assert_nothing_grave(user)


def test_a_run_plays_and_its_events_are_kept(user: User) -> None:
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
