"""The field of a number by mouse, by keys and by touch, and what becomes of it in the meantime."""

import re

import pytest
from playwright.sync_api import BrowserContext, Locator, expect

from browser.server import Server
from browser.user import User

TIME, LOAD = "Travel time, s", "Load, % of capacity"


@pytest.fixture
def user(user: User) -> User:
    """The user before what a new page shows."""
    user.go()
    return user


def text_of(user: User, name: str) -> Locator:
    return user.page.get_by_role("textbox", name=f"{name}, as a number", exact=True)


def place(slider: Locator, share: float) -> tuple[float, float]:
    """Return where the middle of the thumb is at a share of the rail; the thumb is 14 px wide."""
    box = slider.bounding_box()
    assert box is not None
    return box["x"] + 7 + share * (box["width"] - 14), box["y"] + box["height"] / 2


def test_a_thumb_is_dragged_and_number_and_run_follow(user: User) -> None:
    slider, text, mouse = user.slider(LOAD), text_of(user, LOAD), user.page.mouse
    energy = user.number("Energy from the supply")
    mouse.move(*place(slider, 50 / 120))
    mouse.down()
    for load in (52, 60, 80, 96):
        mouse.move(*place(slider, load / 120))
    # the number needs no answer of the server, and the thumb is still held
    expect(text).to_have_value("96")
    expect(user.figure_value("Energy from the supply")).not_to_have_text(energy)
    mouse.up()
    expect(slider).to_have_value("96")
    expect(user.page).to_have_url(re.compile("load_percent=96"))
    expect(user.page.get_by_title("changed: was 50 %")).to_be_visible()
    mouse.click(*place(slider, 0))
    expect(text).to_have_value("0")
    expect(user.page).to_have_url(re.compile("load_percent=0"))


def test_keys_move_a_slider_to_its_ends_and_back(user: User) -> None:
    slider, text = user.slider(LOAD), text_of(user, LOAD)
    slider.focus()
    for key, number in (
        ("End", "120"),
        ("PageDown", "108"),
        ("Home", "0"),
        ("ArrowUp", "1"),
        ("Shift+ArrowRight", "11"),
    ):
        slider.press(key)
        expect(text).to_have_value(number)
        expect(slider).to_have_attribute("aria-valuetext", f"{number} %")
    # a step back that comes immediately is of what the slider was moved to
    slider.press("ArrowLeft")
    slider.press("Control+z")
    expect(user.page).not_to_have_url(re.compile("load_percent=10"))
    user.settled()
    expect(text).not_to_have_value("10")
    expect(slider).to_be_focused()


def test_a_refused_text_stays_until_escape_or_a_better_one(user: User) -> None:
    text, alert = text_of(user, TIME), user.page.get_by_role("alert")
    user.type(TIME, "soon")
    expect(alert).to_contain_text("Travel time: 'soon' is not a time")
    expect(alert).to_contain_text("Kept: 170.0 s.")
    expect(text).to_have_value("soon")
    expect(text).to_have_attribute("aria-invalid", "true")
    text.press("Escape")
    expect(text).to_have_value("170.0")
    user.see_no_alert()
    # leaving the field is enough
    text.fill("3:05")
    text.press("Tab")
    expect(text).to_have_value("185.0")
    expect(user.figure_value("Travel time")).to_have_text("185.0s")
    expect(user.slider(TIME)).to_have_value("185")


def test_what_is_being_typed_is_not_written_over(user: User) -> None:
    text, undo = text_of(user, LOAD), user.page.get_by_role("button", name="Undo", exact=True)
    user.type(LOAD, "60")
    expect(user.page).to_have_url(re.compile("load_percent=60"))
    expect(undo).to_be_enabled()
    text.press("3")
    # pressed from elsewhere, as by another hand: the focus stays where it is
    undo.dispatch_event("click")
    expect(user.slider(LOAD)).to_have_value("50")
    assert text.input_value().endswith("3")
    expect(text).to_be_focused()


def test_a_finger_moves_a_slider_in_a_narrow_window(phone: BrowserContext, server: Server) -> None:
    with User.on(phone, server.drive_url) as user:
        user.page.locator("header button").first.click()
        slider = user.slider(LOAD)
        expect(slider).to_be_visible()
        box = slider.bounding_box()
        assert box is not None
        assert box["height"] >= 40
        user.page.touchscreen.tap(*place(slider, 90 / 120))
        expect(text_of(user, LOAD)).to_have_value("90")
        expect(user.page).to_have_url(re.compile("load_percent=90"))
