"""The lesson that is driven, from the front page on: by mouse, by keyboard alone, by touch, and from a link."""

import re

import pytest
from playwright.sync_api import BrowserContext, Locator, Page, expect

from browser.server import Server
from browser.user import User, open_page

ARRIVES_MS = 60_000
DRIVE_MS = 300
MOST_WORDS = 150
# frames come as often as before, and each tells that four times as much time has gone by
HURRY = """() => {
  const own = window.requestAnimationFrame.bind(window);
  window.requestAnimationFrame = (act) => own((time) => act(4 * time));
}"""


def lesson(page: Page) -> Locator:
    """Return the lesson, once it may be driven."""
    found = page.locator("section.drive-it:visible")
    expect(found.get_by_text("Try 1 of 3: press Power to depart.", exact=False)).to_be_visible(timeout=ARRIVES_MS)
    return found


def figure(page: Page) -> Locator:
    """Return the figure of the speed."""
    return page.locator(".rj-chart-by_hand_speed canvas").first


def kwh(text: str) -> list[float]:
    """Return the numbers of a sentence."""
    return [float(one) for one in re.findall(r"\d+\.\d+", text)]


def test_by_mouse_from_the_front_page_to_drive(window: BrowserContext, server: Server) -> None:
    with User.on(window, server.url) as user:
        open_page(user, "Learn")
        drive = lesson(user.page)
        # nothing of the optimum before the first try has arrived
        expect(drive.get_by_text("best possible")).to_have_count(0)
        assert len(drive.inner_text().split()) <= MOST_WORDS
        user.page.evaluate(HURRY)
        drive.get_by_role("button", name="10\u00d7").click()
        drive.get_by_role("button", name="Power").click()
        outcome = drive.locator(".outcome")
        expect(outcome).to_be_visible(timeout=ARRIVES_MS)
        used, bound = kwh(outcome.inner_text())
        # power all the way, and the optimum, as `railjoule.core` gives them for this line
        assert used == 27.49
        assert bound == 7.81
        expect(drive.get_by_text("From 42 m on you differ from the best run: it coasts.")).to_be_visible()
        expect(user.page).to_have_url(re.compile("driven=p0"))
        drive.get_by_role("button", name="Open on Drive").click()
        expect(user.scenario("Metro, profile II + I")).to_be_visible()
        # the try and the optimum of the lesson are pinned, to be compared
        user.turn_to("Compare")
        expect(user.page.get_by_label("Name of pinned run 1")).to_have_value(re.compile("^Optimal"))
        expect(user.page.get_by_label("Name of pinned run 2")).to_have_value(re.compile("^Driven by hand"))


@pytest.mark.nightly
def test_by_keyboard_alone(window: BrowserContext, server: Server) -> None:
    with User.on(window, server.url) as user:
        keys = user.page.keyboard
        learn = user.page.locator("[data-page='Learn']").locator("visible=true").first
        learn.focus()
        keys.press("Enter")
        drive = lesson(user.page)
        user.reach(drive.get_by_role("button", name="10\u00d7"))
        keys.press("Enter")
        keys.press("ArrowUp")
        expect(drive.get_by_role("button", name="Power")).to_have_attribute("aria-pressed", "true")
        user.page.wait_for_timeout(DRIVE_MS)
        keys.press(" ")
        expect(drive.get_by_role("button", name="Coast")).to_have_attribute("aria-pressed", "true")
        user.page.wait_for_timeout(DRIVE_MS)
        keys.press("ArrowDown")
        expect(drive.get_by_role("button", name="Brake")).to_have_attribute("aria-pressed", "true")
        user.page.wait_for_timeout(DRIVE_MS)
        keys.press("ArrowUp")
        expect(drive.locator(".outcome")).to_be_focused(timeout=ARRIVES_MS)
        # the address takes note of it by way of the server
        expect(user.page).to_have_url(re.compile(r"driven=p0c\d+b\d+p\d+"))


@pytest.mark.nightly
def test_by_touch_in_a_narrow_window_three_times(phone: BrowserContext, server: Server) -> None:
    with User.on(phone, f"{server.url}?v=1&page=Learn") as user:
        drive = lesson(user.page)
        user.page.evaluate(HURRY)
        drive.get_by_role("button", name="10\u00d7").tap()
        for number in (1, 2, 3):
            drive.get_by_role("button", name="Power").tap()
            if number == 2:
                # from some 50 km/h on it coasts: late, with little energy
                user.page.wait_for_timeout(DRIVE_MS)
                drive.get_by_role("button", name="Coast").tap()
            expect(drive.get_by_text(f"Arrived: try {number} of 3.")).to_be_visible(timeout=ARRIVES_MS)
            # figure and head of the verdict are in sight, wherever the button was that began it
            expect(figure(user.page)).to_be_in_viewport()
            expect(drive.get_by_role("button", name="Watch your run")).to_be_in_viewport()
            again = drive.get_by_role("button", name=re.compile(r"Drive again \("))
            expect(again).to_have_count(1 if number < 3 else 0)
            if number < 3:
                again.tap()
                expect(figure(user.page)).to_be_in_viewport()
                expect(drive.get_by_role("button", name="Power")).to_be_in_viewport()
        expect(drive.locator("tr.best")).to_have_count(1)
        # the bound is that of a run on time: it stands beside no late try
        _, early, late, _ = (row.split("\t") for row in drive.locator("table").first.locator("tr").all_inner_texts())
        assert early[2].startswith("+")
        assert (late[2], "late" in late[3]) == ("\u2013", True)
        drive.get_by_role("button", name="Begin again with three tries").tap()
        expect(drive.get_by_text("Try 1 of 3: press Power to depart.")).to_be_visible()


def test_a_run_of_a_link_is_raced(window: BrowserContext, server: Server) -> None:
    with User.on(window, f"{server.url}?v=1&page=Learn&learn.driven=p0c300p600") as user:
        drive = lesson(user.page)
        expect(drive.get_by_text("The blue train is the run to race.")).to_be_visible()
        # the optimum stays hidden
        expect(drive.locator(".outcome")).to_have_count(0)
