"""Start, Learn and Papers, as a user works with them."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, BrowserContext, expect

from browser.findings import assert_nothing_grave
from browser.server import Server
from browser.user import User
from railjoule.dashboard.pages.learn.guesses import GUESSES
from railjoule.dashboard.pages.learn.model import LESSONS


@pytest.fixture(scope="module")
def user(server: Server, window: BrowserContext) -> Iterator[User]:
    """One user, who turns from page to page."""
    with User.on(window, server.drive_url) as someone:
        yield someone


def chart_is_drawn(user: User, name: str) -> None:
    place = user.page.locator(f".rj-chart-{name}:visible")
    place.scroll_into_view_if_needed()
    expect(place.locator("canvas").first).to_be_visible()


def test_a_session_without_an_address_begins_with_start(server: Server, chromium: Browser) -> None:
    page = chromium.new_page(color_scheme="light")
    page.goto(server.url)
    expect(page.get_by_role("heading", name="How little energy does a train need", level=1)).to_be_visible()
    expect(page.get_by_role("img", name="Speed over distance of the optimum of Metro, profile II + I")).to_be_visible()
    assert_nothing_grave(User(page, server.url))
    page.get_by_role("button", name="Tram, flat 950 m", exact=True).click()
    expect(User(page, server.url).scenario("Tram, flat 950 m")).to_be_visible()
    expect(page.get_by_role("button", name="Drive", exact=True)).to_have_attribute("aria-current", "page")
    expect(page.locator(".rj-chart-speed:visible canvas").first).to_be_visible()
    page.close()


def test_a_lesson_answers_its_question(user: User) -> None:
    user.turn_to("Learn")
    for name, guess in GUESSES.items():
        title = next(lesson.title for lesson in LESSONS if lesson.name == name)
        asked = user.page.get_by_role("region", name=f"Guess: {title}", exact=True)
        asked.get_by_role("button", name=f"{guess.choices[0]:g} " if guess.choices else "This is my guess").click()
    for chart in ("lesson_coasting", "lesson_price", "plane_multiplier", "plane_recuperation", "lesson_load"):
        chart_is_drawn(user, chart)
    slider = user.page.get_by_role("slider", name="Gradient of the hump")
    slider.focus()
    slider.press("End")
    # 57 %, as the answer says
    expect(user.page.locator(".figure:visible", has_text="Right plan saves").first.locator(".value")).to_have_text(
        "57.1%"
    )
    answer = user.page.get_by_text("From about 24 per mille.")
    expect(answer).to_be_hidden()
    user.page.get_by_text("Answer", exact=True).nth(3).click()
    expect(answer).to_be_visible()
    assert_nothing_grave(user)


def test_papers_are_shown_computed_and_computed_again_on_request(user: User) -> None:
    user.turn_to("Papers")
    expect(user.page.get_by_text("18 of 18 within 1 %").first).to_be_visible()
    expect(user.page.get_by_text("Corrections").first).to_be_visible()
    expect(user.page.get_by_role("slider", name="Travel time, s", exact=True)).to_be_hidden()
    user.page.get_by_role("button", name="Compute Shtompel again").click()
    stop = user.page.get_by_role("button", name="Stop", exact=True)
    stop.click()
    expect(stop).to_be_hidden()
    expect(user.page.get_by_role("button", name="Compute Shtompel again")).to_be_enabled()
    assert_nothing_grave(user)
