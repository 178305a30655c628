"""The five lessons that ask for a guess: by keyboard alone, by touch, from a link, and the first action at once."""

import re
import time

import pytest
from playwright.sync_api import Browser, Locator, Page, expect

from browser.server import Server
from browser.user import User
from railjoule.dashboard.pages.learn.guesses import GUESSES
from railjoule.dashboard.pages.learn.model import LESSONS

FIRST_ACTION_S = 10.0
"""Within so much of its opening, a lesson has taken its first action."""
# of the metro that has 115 s, whose dashed run holds 52.5 km/h: from the optimum of `railjoule.core`
HIGHEST_KMH = 57.5
ON_PAGE = """highest => [...Bokeh.documents[0].all_models].some((model) => model.type === "ColumnDataSource" &&
  Object.values(model.data).some((column) => column.length &&
    Math.abs(Math.max(...Array.from(column).filter(Number.isFinite)) - highest) < 0.1))"""
FOCUSED = """() => { let one = document.activeElement;
  while (one?.shadowRoot?.activeElement) { one = one.shadowRoot.activeElement; }
  return one?.getAttribute("aria-label") || one?.textContent || ""; }"""


def lesson(page: Page, name: str) -> Locator:
    """Return what a lesson asks."""
    title = next(one.title for one in LESSONS if one.name == name)
    return page.get_by_role("region", name=f"Guess: {title}", exact=True)


def sides(asked: Locator) -> Locator:
    """Return guess and answer side by side."""
    return asked.get_by_role("group", name="Your guess and the answer")


def test_the_first_control_can_be_pressed_at_once(chromium: Browser, server: Server) -> None:
    with User.at(chromium, f"{server.url}?v=1&page=Learn&learn.lesson=gradient", on_drive=False) as user:
        begun = time.monotonic()
        asked = lesson(user.page, "gradient")
        expect(asked).to_be_in_viewport()
        asked.get_by_role("button").first.click()
        assert time.monotonic() - begun < FIRST_ACTION_S
        # 36.6 %, as `answer_of` has it at 15 per mille
        expect(sides(asked)).to_contain_text("36.6 %")
        expect(sides(asked)).to_contain_text("2 %")
        expect(sides(asked)).to_contain_text("34.6 points too low: the plan for level track brakes 6.23 kWh away")


def test_nothing_of_the_optimum_is_on_the_page_before_a_guess_nor_after_a_link_for_a_class(
    chromium: Browser, server: Server
) -> None:
    context = chromium.new_context(viewport={"width": 1280, "height": 900})
    context.grant_permissions(["clipboard-read", "clipboard-write"])
    try:
        with User.on(context, f"{server.url}?v=1&page=Learn&learn.lesson=coasting", on_drive=False) as user:
            link = guess_and_take_back(user.page)
        assert "guess" not in link
        with User.on(context, link.replace("learn.lesson", "learn.coasting=140&learn.lesson"), on_drive=False) as other:
            asked = lesson(other.page, "coasting")
            expect(asked).to_be_in_viewport()
            expect(asked.get_by_text("A metro train has 140 s for 1500 m.", exact=False)).to_be_visible()
            expect(sides(asked)).to_be_hidden()
    finally:
        context.close()


def guess_and_take_back(page: Page) -> str:
    """Guess, look at the answer, and guess anew; return the link for a class that was copied with the guess set."""
    asked = lesson(page, "coasting")
    expect(page.locator(".rj-chart-lesson_coasting canvas").first).to_be_visible()
    expect(page.get_by_text("The best run is hidden until you have guessed.").first).to_be_visible()
    # the run to compare with, and nothing higher
    page.wait_for_function(ON_PAGE, arg=52.5)
    assert not page.evaluate(ON_PAGE, HIGHEST_KMH)
    asked.get_by_role("button", name="This is my guess").click()
    expect(sides(asked)).to_contain_text("8.1 points too high")
    page.wait_for_function(ON_PAGE, arg=HIGHEST_KMH)
    expect(page.get_by_text("Full power to 57.5 km/h, 10.09 kWh drawn", exact=False)).to_be_visible()
    asked.get_by_role("button", name="Copy link for a class").click()
    expect(asked.get_by_text("Copied: this case, without guesses.")).to_be_visible()
    asked.get_by_role("button", name="Try again").click()
    expect(sides(asked)).to_be_hidden()
    page.wait_for_function(f"highest => !({ON_PAGE})(highest)", arg=HIGHEST_KMH)
    expect(page.get_by_text("Full power to 57.5 km/h", exact=False)).to_have_count(0)
    return str(page.evaluate("navigator.clipboard.readText()"))


def test_all_five_by_keyboard_alone(chromium: Browser, server: Server) -> None:
    with User.at(chromium, f"{server.url}?v=1&page=Learn", on_drive=False) as user:
        keys = user.page.keyboard
        for name, guess in GUESSES.items():
            asked = lesson(user.page, name)
            first = asked.get_by_role("button" if guess.choices else "slider").first
            first.focus()
            if guess.choices:
                keys.press("Tab")
            else:
                keys.press("ArrowRight")
            keys.press("Enter")
            expect(sides(asked)).to_be_visible()
            # whoever listens is led to the answer, and goes on from there
            expect(sides(asked)).to_be_focused()
            keys.press("Tab")
            assert user.page.evaluate(FOCUSED) == "Try again"
        keys.press("Enter")
        asked = lesson(user.page, "load")
        expect(asked.get_by_role("slider")).to_be_focused()
        keys.press("Enter")
        expect(sides(asked)).to_be_focused()
        place = user.page.get_by_role("slider", name="Place, m").last
        place.focus()
        keys.press("Home")
        keys.press("ArrowRight")
        expect(place).to_have_attribute("aria-valuetext", "25 m")
        told = user.page.get_by_text(re.compile(r"At 25 m, planned for the actual load: motion \d"))
        expect(told).to_have_count(1)


@pytest.mark.nightly
def test_by_touch_in_a_narrow_window_up_to_the_workbench(chromium: Browser, server: Server) -> None:
    context = chromium.new_context(viewport={"width": 390, "height": 844}, has_touch=True)
    try:
        with User.on(context, f"{server.url}?v=1&page=Learn", on_drive=False) as user:
            for name, guess in GUESSES.items():
                asked = lesson(user.page, name)
                if guess.choices:
                    asked.get_by_role("button").nth(1).tap()
                else:
                    asked.get_by_role("slider").tap()
                    asked.get_by_role("button", name="This is my guess").tap()
                expect(sides(asked)).to_be_visible()
            assert user.page.evaluate("document.documentElement.scrollWidth") == 390
            opens = user.page.get_by_role("button", name="Open in the workbench").locator("visible=true")
            expect(opens).to_have_count(len(LESSONS))
            opens.first.tap()
            expect(user.scenario("Why coasting saves")).to_be_visible()
            # what the lesson has shown
            expect(user.figure_value("Energy from the supply")).to_have_text(re.compile(r"^10\.09"))
    finally:
        context.close()
