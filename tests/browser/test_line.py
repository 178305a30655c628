"""Line, as a user works with it: windows of arrival, a given timetable, stations that are dragged."""

import pytest
from playwright.sync_api import Locator, expect

from browser.user import User
from railjoule.dashboard.charts.dress import RIGHT_BORDER_PX

LINK = "?v=1&page=Line"
LENGTH_M, MARKET_M = 10_400.0, 1950.0
"""Of the line, and where its second station between the ends lies."""
LEFT_PX, ABOVE_PX, BELOW_PX = 50.0, 2.0, 7.0
"""Borders of the chart around its frame."""


@pytest.fixture(scope="module")
def user(user: User) -> User:
    """One user, who stays on the page for all tests of this file."""
    user.page.get_by_role("button", name="Open Metro, ten stations").click()
    expect(user.figure_value("Energy of the whole line")).to_have_text("45.02kWh")
    return user


def field(user: User, name: str) -> Locator:
    return user.page.get_by_label(f"{name}, s, as a number", exact=True)


def fill(user: User, name: str, text: str) -> None:
    field(user, name).fill(text)
    field(user, name).press("Enter")


def test_a_timetable_is_taken_over_and_a_station_dragged(user: User) -> None:
    user.page.get_by_role("button", name="Use the arrivals of the proportional supplement").click()
    expect(user.figure_value("Present timetable")).to_have_text("+1.0%")
    expect(user.page.get_by_text("the present timetable costs 1.0 % more")).to_be_visible()
    given = field(user, "Market: Present arrival")
    expect(given).to_have_value("191.4")
    drag_market(user, by_px=-20)
    expect(given).not_to_have_value("191.4")
    later = float(given.input_value())
    # a pixel of the chart is about a third of a second
    assert 3 < later - 191.4 < 12
    expect(user.figure_value("Present timetable")).not_to_have_text("+1.0%")
    user.page.keyboard.press("Control+z")
    expect(given).to_have_value("191.4")
    # the same by the keyboard
    fill(user, "Market: Present arrival", str(later))
    expect(user.figure_value("Present timetable")).not_to_have_text("+1.0%")


def drag_market(user: User, by_px: float) -> None:
    """Drag Market in the chart of supplements; before it is let go, energy and price answer."""
    place = user.page.locator(".rj-chart-supplements:visible")
    place.scroll_into_view_if_needed()
    user.settled()
    top, supplement = user.page.evaluate(
        """() => {
          const models = [...Bokeh.documents[0].all_models], grips = models.find((model) => model.name === "grips");
          const drawn = (model) => model.renderers?.some?.((renderer) => renderer.data_source === grips);
          return [models.find(drawn).y_range.end, grips.data.y[1]];
        }"""
    )
    box = place.locator("canvas").first.bounding_box()
    assert box is not None
    width, height = box["width"] - LEFT_PX - RIGHT_BORDER_PX, box["height"] - ABOVE_PX - BELOW_PX
    x = box["x"] + LEFT_PX + width * MARKET_M / LENGTH_M
    y = box["y"] + ABOVE_PX + height * (1 - supplement / top)
    before = user.picture("leg_price")
    user.page.mouse.move(x, y)
    user.page.mouse.down()
    user.page.mouse.move(x, y + by_px, steps=6)
    user.see_change("leg_price", before)
    user.page.mouse.up()
    user.settled()
