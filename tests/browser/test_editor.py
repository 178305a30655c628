"""The scenario's editor, as a user works with it."""

import re

import pytest
from playwright.sync_api import BrowserContext, Locator, expect

from browser.findings import assert_nothing_grave
from browser.server import Server
from browser.user import User
from railjoule.dashboard.charts.dress import RIGHT_BORDER_PX
from railjoule.dashboard.editor.view import LIMITS_PX, PROFILE_PX

LENGTH_M = 2300.0
LEFT_PX, ABOVE_PX, BELOW_PX = 50.0, 2.0, 7.0
"""Borders of a chart around its frame."""
PRESS_MS = 400
SLOW = 6
"""Times slower than this machine: what comes in one frame here then comes in several."""


def drawer(user: User) -> Locator:
    return user.page.get_by_role("region", name="Scenario editor")


def head(user: User, group: str) -> Locator:
    return drawer(user).get_by_role("button", name=re.compile(f"^{group}"))


def open_group(user: User, group: str) -> None:
    if not drawer(user).is_visible():
        user.page.get_by_role("button", name="Edit scenario").click()
    if head(user, group).get_attribute("aria-expanded") == "false":
        head(user, group).click()
    expect(head(user, group)).to_have_attribute("aria-expanded", "true")


def field(user: User, label: str) -> Locator:
    return drawer(user).get_by_label(label, exact=True)


def enter(user: User, label: str, text: str) -> None:
    field(user, label).fill(text)
    field(user, label).press("Enter")


def test_it_is_opened_and_closed_by_key_and_gives_the_focus_back(user: User) -> None:
    opener = user.page.get_by_role("button", name="Edit scenario")
    opener.focus()
    user.page.keyboard.press("Enter")
    expect(drawer(user).get_by_role("heading", level=2)).to_be_focused()
    user.page.keyboard.press("Tab")
    user.page.keyboard.press("Tab")
    expect(head(user, "Presets")).to_be_focused()
    user.page.keyboard.press("Escape")
    expect(drawer(user)).to_be_hidden()
    expect(opener).to_be_focused()


def test_a_field_changes_the_run_is_marked_and_taken_back(user: User) -> None:
    open_group(user, "Vehicle")
    energy = user.number("Energy from the supply")
    enter(user, "Tare, kg", "200\u202f000")
    expect(user.figure_value("Energy from the supply")).not_to_have_text(energy)
    expect(field(user, "Tare, kg \u00b7 changed")).to_have_value("200000")
    expect(head(user, "Vehicle")).to_contain_text("1 changed")
    expect(user.page.get_by_text("1 field changed")).to_be_visible()
    drawer(user).get_by_role("button", name="Reset Tare, kg to 160000").click()
    expect(user.figure_value("Energy from the supply")).to_have_text(energy)
    expect(field(user, "Tare, kg")).to_have_value("160000")
    expect(field(user, "Tare, kg")).to_be_focused()


def test_rows_are_added_moved_and_removed_by_key(user: User) -> None:
    open_group(user, "Track")
    drawer(user).get_by_role("button", name="Insert a row below row 1", exact=True).first.press("Enter")
    expect(field(user, "Length, m, row 12")).to_be_visible()
    expect(field(user, "Length, m, row 2")).to_be_focused()
    expect(field(user, "Length, m, row 2")).to_have_value("75")
    drawer(user).get_by_role("button", name="Move down row 2", exact=True).first.press("Enter")
    expect(field(user, "Length, m, row 3")).to_have_value("75")
    drawer(user).get_by_role("button", name="Reset Sections").press("Enter")
    expect(field(user, "Length, m, row 12")).to_be_hidden()


def drag(user: User, chart: str, start: tuple[float, float], end: tuple[float, float]) -> None:
    """Drag from one place to another: shares of the frame, from the left and from above."""
    place = drawer(user).locator(f".rj-chart-{chart}:visible")
    place.scroll_into_view_if_needed()
    canvas = place.locator("canvas").first
    expect(canvas).to_be_visible()
    box = canvas.bounding_box()
    assert box is not None
    width, height = box["width"] - LEFT_PX - RIGHT_BORDER_PX, box["height"] - ABOVE_PX - BELOW_PX

    def at(place: tuple[float, float]) -> tuple[float, float]:
        return box["x"] + LEFT_PX + width * place[0], box["y"] + ABOVE_PX + height * place[1]

    user.page.mouse.move(*at(start))
    user.page.mouse.down()
    # Bokeh takes a shorter press for a tap
    user.page.wait_for_timeout(PRESS_MS)
    user.page.mouse.move(*at(end), steps=6)
    user.page.mouse.up()


def test_the_profile_is_dragged(user: User) -> None:
    open_group(user, "Track")
    user.settled()
    energy = user.number("Energy from the supply")
    # the heights of metro-with-limit's borders go from 0 to -7.95 m; the chart leaves 35 % of its range, which is at
    # least 1 % of the line's length, free above and below
    relief = max(7.95, 0.01 * LENGTH_M)
    share = (7.95 + 0.35 * relief) / (7.95 + 0.7 * relief)
    drag(user, "edit_profile", (750 / LENGTH_M, share), (900 / LENGTH_M, share - 0.2))
    expect(field(user, "Length, m, row 3")).not_to_have_value("400")
    user.see_number(field(user, "Length, m, row 3"), 550, within=8)
    expect(user.figure_value("Energy from the supply")).not_to_have_text(energy)
    drawer(user).get_by_role("button", name="Reset Sections").click()
    expect(user.figure_value("Energy from the supply")).to_have_text(energy)


def test_a_block_is_pasted_into_a_cell_and_a_bad_cell_keeps_its_text(user: User) -> None:
    open_group(user, "Track")
    paste = """(cell, text) => {
      const clipboardData = new DataTransfer();
      clipboardData.setData("text", text);
      cell.dispatchEvent(new ClipboardEvent("paste", {clipboardData, bubbles: true, composed: true, cancelable: true}));
    }"""
    field(user, "Gradient, \u2030, row 1").evaluate(paste, "1.5\t70\n\u22122,5\t60")
    expect(field(user, "Gradient, \u2030, row 2")).to_have_value("-2.5")
    expect(field(user, "Speed limit, km/h, row 1")).to_have_value("70")
    expect(field(user, "Gradient, \u2030, row 1")).to_be_focused()
    enter(user, "Gradient, \u2030, row 2", "300")
    expect(field(user, "Gradient, \u2030, row 3")).to_be_focused()
    expect(drawer(user).get_by_text("Row 2, Gradient, \u2030: '300'. At most 200. Nothing is changed.")).to_be_visible()
    expect(field(user, "Gradient, \u2030, row 2")).to_have_attribute("aria-invalid", "true")
    expect(field(user, "Gradient, \u2030, row 2")).to_have_value("300")
    drawer(user).get_by_role("button", name="Reset Sections").press("Enter")
    expect(field(user, "Gradient, \u2030, row 2")).to_have_attribute("aria-invalid", "false")


def height_px(canvas: Locator) -> float:
    box = canvas.bounding_box()
    return 0.0 if box is None else box["height"]


@pytest.mark.nightly
def test_charts_keep_their_height_on_a_slow_machine(server: Server, window: BrowserContext) -> None:
    with User.on(window, server.drive_url) as reader:
        reader.slow_down(SLOW)
        open_group(reader, "Track")
        for chart, height in (("edit_profile", PROFILE_PX), ("edit_limits", LIMITS_PX)):
            canvas = drawer(reader).locator(f".rj-chart-{chart}:visible canvas").first
            reader.wait_until(lambda canvas=canvas, height=height: height_px(canvas) == height)
            assert height_px(canvas) == height


def test_a_step_back_in_a_cell_is_one_of_the_scenario_unless_letters_wait(user: User) -> None:
    open_group(user, "Vehicle")
    tare = field(user, "Tare, kg")
    enter(user, "Tare, kg", "170000")
    expect(field(user, "Tare, kg \u00b7 changed")).to_be_visible()
    user.settled()
    field(user, "Tare, kg \u00b7 changed").press("Control+z")
    expect(tare).to_have_value("160000")
    tare.press("End")
    tare.press("5")
    expect(tare).to_have_value("1600005")
    tare.press("Control+z")
    expect(tare).to_have_value("160000")
    expect(field(user, "Tare, kg \u00b7 changed")).to_be_hidden()


def test_escape_takes_letters_back_before_it_closes_the_editor(user: User) -> None:
    open_group(user, "Track")
    cell = field(user, "Length, m, row 1")
    before = cell.input_value()
    cell.press("End")
    cell.press("9")
    cell.press("Escape")
    expect(cell).to_have_value(before)
    expect(cell).to_be_focused()
    opener = user.page.get_by_role("button", name="Edit scenario")
    cell.press("Escape")
    # at once, not when the server has hidden the drawer
    assert opener.evaluate("element => element === element.getRootNode().activeElement")
    expect(drawer(user)).to_be_hidden()
    expect(opener).to_be_focused()


def test_nothing_grave_on_a_narrow_screen(user: User) -> None:
    with user.resized(390, 900):
        user.page.locator("header button").first.click()
        user.page.get_by_role("button", name="Edit scenario").click()
        expect(drawer(user).get_by_role("heading", level=2)).to_be_focused()
        box = drawer(user).bounding_box()
        assert box is not None
        assert box["width"] == 390
        for group in ("Vehicle", "Powertrain", "Track", "Disturbance"):
            open_group(user, group)
        expect(field(user, "Departure delay, s")).to_be_visible()
        drawer(user).get_by_role("button", name="Paste a table or open a CSV file").last.click()
        expect(drawer(user).get_by_label("Cells of a spreadsheet").last).to_be_visible()
        enter(user, "Auxiliary power, kW", "12")
        enter(user, "Traction efficiency", "2")
        expect(field(user, "Traction efficiency")).to_have_attribute("aria-invalid", "true")
        expect(drawer(user).get_by_role("alert").first).to_have_text(re.compile(re.escape("At most 1. Kept: ")))
        assert_nothing_grave(user)
        assert user.page.evaluate("document.scrollingElement.scrollWidth") <= 390
        head(user, "Track").press("Escape")
        expect(drawer(user)).to_be_hidden()
