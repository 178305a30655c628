"""The lesson that is drawn: by mouse, by keyboard alone, by touch, and from a link."""

import re

import pytest
from playwright.sync_api import BrowserContext, Locator, Page, expect

from browser.server import Server
from browser.user import User
from railjoule.dashboard.pages.learn.drawing import POINTS, judge

LINK = "?v=1&page=Learn"
READY_MS = 60_000
BUTTON = "Show the best run"


def lesson(page: Page) -> Locator:
    """Return the lesson, once it can be drawn."""
    found = page.locator(".rj-lesson-drawn:visible")
    expect(found.get_by_text("s to spare")).to_be_visible(timeout=READY_MS)
    return found


def find_canvas(draw: Locator) -> Locator:
    """Return the figure of the speeds, drawn and in sight."""
    canvas = draw.locator(".rj-chart-drawn_speed canvas").first
    canvas.scroll_into_view_if_needed()
    expect(draw.locator(".rj-chart-drawn_speed.rj-undrawn")).to_have_count(0)
    return canvas


def test_by_mouse_to_drive(user: User) -> None:
    draw, mouse = lesson(user.page), user.page.mouse
    # the fastest run, and nothing of the best
    expect(draw.get_by_text("34.2 s to spare")).to_be_visible()
    expect(draw.locator(".outcome")).to_have_count(0)
    box = find_canvas(draw).bounding_box()
    assert box is not None
    mouse.move(box["x"] + 60, box["y"] + 90)
    mouse.down()
    mouse.move(box["x"] + 0.6 * box["width"], box["y"] + 100, steps=20)
    mouse.move(box["x"] + 0.95 * box["width"], box["y"] + 160, steps=10)
    mouse.up()
    expect(draw.get_by_text("34.2 s to spare")).to_have_count(0)
    draw.get_by_role("button", name=BUTTON).click()
    outcome = draw.locator(".outcome")
    expect(outcome).to_be_visible(timeout=READY_MS)
    used, bound = re.findall(r"\d+\.\d\d\b", outcome.inner_text())
    # what the address holds gives the same numbers in the library
    expect(user.page).to_have_url(re.compile("learn.drawn="))
    found = re.search(r"learn\.drawn=([\d,]+)", user.page.url)
    assert found is not None
    verdict = judge(found[1])
    assert {used, bound} == {f"{verdict.kwh:.2f}", f"{verdict.bound_kwh:.2f}"}
    expect(draw.locator("li")).to_have_count(len(verdict.sentences))
    draw.get_by_role("button", name="Open on Drive").click()
    expect(user.scenario("Metro, profile III")).to_be_visible()
    expect(user.figure_value("Energy from the supply")).to_have_text(f"{verdict.bound_kwh:.2f}kWh")


@pytest.mark.nightly
def test_by_keyboard_alone(window: BrowserContext, server: Server) -> None:
    with User.on(window, f"{server.url}?v=1&page=Learn") as user:
        keys, draw = user.page.keyboard, lesson(user.page)
        user.reach(draw.get_by_role("button", name="Set this speed"))
        keys.press("Enter")
        expect(draw.get_by_text("13.8 s to spare")).to_be_visible()
        user.reach(draw.get_by_role("button", name=BUTTON))
        keys.press("Enter")
        status = draw.get_by_role("status").first
        # 60 km/h as far as the train can, by `railjoule.core` in test_drawing
        expect(status).to_contain_text("You use 36.40 kWh", timeout=READY_MS)
        expect(status).to_contain_text("less than 27.51")


@pytest.mark.nightly
def test_by_touch_from_a_link(phone: BrowserContext, server: Server) -> None:
    drawn = ",".join(["45"] * POINTS)
    with User.on(phone, f"{server.url}?v=1&page=Learn&learn.drawn={drawn}") as user:
        draw = user.page.locator(".rj-lesson-drawn:visible")
        energy = draw.locator(".figures").get_by_text("30.54")
        expect(energy).to_be_visible(timeout=READY_MS)
        # a link for a class opens at its lesson
        expect(draw.get_by_role("heading").first).to_be_in_viewport()
        find_canvas(draw).tap(position={"x": 200, "y": 60})
        expect(energy).to_have_count(0)
        draw.get_by_role("button", name=BUTTON).tap()
        expect(draw.locator(".outcome")).to_be_visible(timeout=READY_MS)
        assert user.page.evaluate("document.documentElement.scrollWidth") <= 390
