"""The five lessons that ask for a guess: by keyboard alone, by touch, from a link; and a class of two browsers."""

import re
import time

import pytest
from playwright.sync_api import BrowserContext, Locator, Page, expect

from browser.server import Server
from browser.test_drive_it import HURRY
from browser.user import User
from railjoule.dashboard.pages.learn.lessons import LESSONS

LINK = "?v=1&page=Learn"
FIRST_ACTION_S = 10.0
"""Within so much of its opening, a lesson has taken its first action."""
ARRIVES_MS = 60_000
# of the metro that has 115 s, whose dashed run holds 52.5 km/h: from the optimum of `railjoule.core`
HIGHEST_KMH = 57.5
ON_PAGE = """highest => [...Bokeh.documents[0].all_models].some((model) => model.type === "ColumnDataSource" &&
  Object.values(model.data).some((column) => column.length &&
    Math.abs(Math.max(...Array.from(column).filter(Number.isFinite)) - highest) < 0.1))"""
GUESS, AGAIN = "This is my guess", "Guess again"


def lesson(page: Page, name: str) -> Locator:
    """Return the parts of a lesson."""
    return page.locator(f".rj-lesson-{name}:visible")


def test_a_link_leads_to_its_lesson_with_nothing_of_the_optimum_before_a_guess(
    window: BrowserContext, server: Server
) -> None:
    begun = time.monotonic()
    with User.on(window, f"{server.url}?v=1&page=Learn&learn.lesson=coasting") as user:
        page, asked = user.page, lesson(user.page, "coasting")
        guess = asked.get_by_role("button", name=GUESS)
        expect(guess).to_be_in_viewport()
        expect(page.locator(".rj-chart-lesson_coasting canvas").first).to_be_visible()
        expect(asked.get_by_text("The best run is hidden until you have guessed.")).to_be_visible()
        # the run to compare with, and nothing higher
        page.wait_for_function(ON_PAGE, arg=52.5)
        assert not page.evaluate(ON_PAGE, HIGHEST_KMH)
        guess.click()
        assert time.monotonic() - begun < FIRST_ACTION_S
        expect(asked.get_by_text("8.1 points too high", exact=False)).to_be_visible()
        page.wait_for_function(ON_PAGE, arg=HIGHEST_KMH)
        asked.get_by_text("Why? The best run, stretch by stretch").click()
        expect(asked.get_by_text("Full power to 57.5 km/h, 10.09 kWh drawn", exact=False)).to_be_visible()
        asked.get_by_role("button", name=AGAIN).click()
        page.wait_for_function(f"highest => !({ON_PAGE})(highest)", arg=HIGHEST_KMH)
        expect(asked.get_by_text("Full power to 57.5 km/h", exact=False)).to_have_count(0)


def test_all_five_by_keyboard_alone(user: User) -> None:
    keys = user.page.keyboard
    for one in LESSONS:
        asked = lesson(user.page, one.name)
        first = asked.get_by_role("radio" if one.choices else "slider", disabled=False).first
        first.focus()
        keys.press("ArrowRight")
        button = asked.get_by_role("button", name=GUESS)
        button.focus()
        keys.press("Enter")
        expect(asked.get_by_text("The answer")).to_be_visible()
        # the focus stays where it was, on the button that takes the guess back
        expect(asked.get_by_role("button", name=AGAIN)).to_be_focused()
    keys.press("Enter")
    expect(lesson(user.page, "load").get_by_role("button", name=GUESS)).to_be_focused()


@pytest.mark.nightly
def test_by_touch_in_a_narrow_window_up_to_drive(phone: BrowserContext, server: Server) -> None:
    with User.on(phone, f"{server.url}?v=1&page=Learn") as user:
        for one in LESSONS:
            asked = lesson(user.page, one.name)
            asked.get_by_role("button", name=GUESS).tap()
            expect(asked.get_by_text("The answer")).to_be_in_viewport()
        assert user.page.evaluate("document.documentElement.scrollWidth") == 390
        lesson(user.page, "coasting").get_by_role("button", name="Open on Drive").tap()
        expect(user.scenario("Why coasting saves")).to_be_visible()
        # what the lesson has shown
        expect(user.figure_value("Energy from the supply")).to_have_text(re.compile(r"^10\.09"))


def test_a_run_on_a_phone_comes_to_the_page_of_the_lecturer(phone: BrowserContext, user: User) -> None:
    user.page.get_by_role("button", name="Open a class").click()
    link = user.page.locator(".invitation a:visible")
    expect(link).to_have_attribute("href", re.compile(r"^http.*learn\.class_token="))
    expect(user.page.locator(".invitation svg:visible")).to_be_visible()
    with User.on(phone, link.inner_text()) as student:
        student.page.get_by_label("Your name (optional)").fill("Ada")
        student.page.keyboard.press("Enter")
        expect(user.page.get_by_text("1 of 200 students")).to_be_visible()
        student.page.evaluate(HURRY)
        drive = student.page.locator("section.drive-it:visible")
        drive.get_by_role("button", name="10\u00d7").tap()
        drive.get_by_role("button", name="Power").tap()
        # power all the way, as the test of the lesson has it
        row = user.page.get_by_role("row", name=re.compile("^Ada 1 27.49 "))
        expect(row).to_be_visible(timeout=ARRIVES_MS)
        user.page.get_by_role("button", name="Close the class").click()
        expect(link).to_have_count(0)
        student.page.reload()
        expect(student.page.get_by_text("There is no such class on this server", exact=False)).to_be_visible()
