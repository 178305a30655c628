"""The bar of pages, its groups and keys, and what stands in the sidebar, as a user works with them."""

from playwright.sync_api import Locator, expect

from browser.user import User, open_page
from railjoule.dashboard.page_list import KEYED

LINK = "?v=1&page=Drive&preset=ftorek-300s"


def bar(user: User) -> Locator:
    return user.page.get_by_role("navigation", name="Pages")


def question(user: User, page: str) -> None:
    """Wait until a page is in sight."""
    expect(user.question(page)).to_be_visible()


def test_a_group_opens_by_press_and_key_and_not_by_hovering(user: User) -> None:
    group, entry = (bar(user).get_by_role("button", name=name, exact=True) for name in ("Equipment", "Set speeds"))
    group.hover()
    user.settled()
    expect(entry).to_be_hidden()
    group.click()
    expect(entry).to_be_visible()
    user.page.mouse.click(700, 400)
    expect(entry).to_be_hidden()
    group.press("Enter")
    expect(entry).to_be_visible()
    user.page.keyboard.press("Tab")
    expect(entry).to_be_focused()
    user.page.keyboard.press("Escape")
    expect(group).to_be_focused()
    group.press("Enter")
    for _ in range(2):
        user.page.keyboard.press("Tab")
    expect(bar(user).get_by_role("button", name="Motor", exact=True)).to_be_focused()
    user.page.keyboard.press("Enter")
    question(user, "Motor")
    expect(bar(user).locator("li:has([aria-current]) > .group")).to_have_text("Equipment")


def test_keys_open_pages_pin_and_help_but_not_while_typing(user: User) -> None:
    open_page(user, "Drive")
    user.page.keyboard.press(str(KEYED.index("Motor") + 1))
    question(user, "Motor")
    user.page.keyboard.press("?")
    question(user, "Help")
    user.page.keyboard.press("1")
    question(user, "Drive")
    user.page.keyboard.press("p")
    expect(user.page.get_by_role("button", name="Unpin")).to_be_visible()
    user.page.keyboard.press("p")
    expect(user.page.get_by_role("button", name="Pin run")).to_be_visible()
    field = user.page.get_by_role("textbox", name="Travel time, s, as a number", exact=True)
    before = field.input_value()
    field.focus()
    user.page.keyboard.press("End")
    for key in ("2", "?", "p"):
        user.page.keyboard.press(key)
    user.settled()
    question(user, "Drive")
    expect(field).to_have_value(f"{before}2?p")
    field.fill(before)
    field.press("Enter")


def test_this_run_is_a_radio_and_draw_a_box(user: User) -> None:
    open_page(user, "Drive")
    radio, box = user.page.get_by_role("radio", name="EOC"), user.page.get_by_label("Draw EOC")
    expect(user.page.get_by_label("Draw Optimal")).to_be_disabled()
    radio.check()
    expect(box).to_be_checked()
    expect(box).to_be_disabled()
    expect(user.page.get_by_label("Draw Optimal")).to_be_enabled()
    user.page.get_by_role("radio", name="Optimal").check()
    expect(box).not_to_be_checked()
    open_page(user, "Motor")
    expect(radio).to_be_visible()
    expect(box).to_be_hidden()
    open_page(user, "Help")
    expect(radio).to_be_hidden()


def test_one_menu_on_narrow_screens(user: User) -> None:
    user.go()
    menu = bar(user).get_by_role("button", name="Pages, ")
    for width in (390, 768):
        with user.resized(width, 900):
            # the menu of pages shows that the server has heard of the width
            expect(menu).to_be_visible(visible=width < 700)
            expect(user.slider("Travel time, s")).to_be_visible(visible=width >= 900)
            for name in ("Help", "Drive"):
                open_page(user, name)
                assert user.page.evaluate("document.documentElement.scrollWidth - window.innerWidth") <= 0
            if width < 700:
                menu.click()
                expect(bar(user).get_by_role("heading", name="Equipment")).to_be_visible()
                user.page.keyboard.press("Escape")
