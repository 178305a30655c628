"""Line, as a user works with it: windows of arrival, a given timetable, stations that are dragged."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import BrowserContext, Locator, expect

from browser.findings import assert_nothing_grave
from browser.server import Server
from browser.user import User
from railjoule.dashboard.charts.chart import RIGHT_BORDER_PX

LENGTH_M, MARKET_M = 10_400.0, 1950.0
"""Of the line, and where its second station between the ends lies."""
LEFT_PX, ABOVE_PX, BELOW_PX = 50.0, 2.0, 7.0
"""Borders of the chart around its frame."""


@pytest.fixture(scope="module")
def user(server: Server, window: BrowserContext) -> Iterator[User]:
    """One user, who comes from Start and stays on the page for all tests of this file."""
    with User.on(window, server.drive_url) as someone:
        someone.turn_to("Start")
        someone.turn_to("Line")
        someone.page.get_by_role("button", name="Open Metro, ten stations").click()
        expect(someone.figure_value("Energy of the whole line")).to_have_text("45.02kWh")
        yield someone


def field(user: User, name: str) -> Locator:
    return user.page.get_by_label(f"{name}, s, as a number", exact=True)


def fill(user: User, name: str, text: str) -> None:
    field(user, name).fill(text)
    field(user, name).press("Enter")


def arrival_at(user: User, station: str, kind: str) -> None:
    user.page.get_by_role("group", name=f"{station}: arrival").get_by_role("button", name=kind, exact=True).click()


def test_a_line_shares_its_time(user: User) -> None:
    for chart in ("line_speed", "line", "line_path", "supplements", "leg_price", "leg_energy"):
        place = user.page.locator(f".rj-chart-{chart}:visible")
        place.scroll_into_view_if_needed()
        expect(place.locator("canvas").first).to_be_visible()
    # 1090 s: 43.5926 kWh by `railjoule solve metro-10-stations --set timetable.travel_time_s=1090`
    user.push("Travel time, s", 20)
    expect(user.figure_value("Energy of the whole line")).to_have_text("43.59kWh")
    user.push("Travel time, s", -20)
    fill(user, "Market: Dwell", "60")
    expect(user.page.get_by_text("including 250.0 s of dwell")).to_be_visible()
    fill(user, "Market: Dwell", "30")
    expect(user.figure_value("Energy of the whole line")).to_have_text("45.02kWh")
    expect(user.page.get_by_text("1 field changed")).to_be_hidden()


def test_an_arrival_is_fixed_and_an_impossible_one_told(user: User) -> None:
    arrival_at(user, "Central", "Fixed")
    expect(field(user, "Central: Arrives after")).to_be_visible()
    expect(field(user, "Market: Arrives after")).to_be_hidden()
    fill(user, "Central: Arrives after", "100")
    assert "The arrival at Central must be no later than 100.0 s, and is possible after" in user.alert()
    arrival_at(user, "Central", "Free")
    expect(user.figure_value("Energy of the whole line")).to_have_text("45.02kWh")
    user.see_no_alert()


def test_a_window_binds_is_kept_in_the_address_and_in_the_file(user: User) -> None:
    arrival_at(user, "Market", "Window")
    expect(user.figure_value("Energy of the whole line")).to_have_text("45.02kWh")
    fill(user, "Market: Earliest arrival", "")
    fill(user, "Market: Latest arrival", "190")
    expect(user.figure_value("Energy of the whole line")).not_to_have_text("45.02kWh")
    expect(user.page.get_by_text("same between arrivals that bind")).to_be_visible()
    expect(
        user.page.get_by_text("Proportional reserve: It arrives at Market after 191.4 s, and was to")
    ).to_be_visible()
    fill(user, "Market: Earliest arrival", "195")
    assert user.alert().startswith("At most 190.")
    fill(user, "Market: Earliest arrival", "")
    energy = user.number("Energy of the whole line")
    user.page.reload()
    user.page.locator("html.rj-started").wait_for()
    expect(user.figure_value("Energy of the whole line")).to_have_text(energy.replace("\n", ""))
    expect(field(user, "Market: Latest arrival")).to_have_value("190.0")
    user.page.get_by_role("button", name="Undo all").click()
    expect(user.figure_value("Energy of the whole line")).to_have_text("45.02kWh")
    expect(field(user, "Market: Latest arrival")).to_be_hidden()


def test_a_timetable_is_taken_over_and_a_station_dragged(user: User) -> None:
    user.page.get_by_role("button", name="Take over the arrivals of the proportional reserve").click()
    expect(user.figure_value("Given timetable")).to_have_text("+1.0%")
    expect(user.page.get_by_text("the given timetable costs 1.0 % more")).to_be_visible()
    given = field(user, "Market: Given arrival")
    expect(given).to_have_value("191.4")
    drag_market(user, by_px=-20)
    expect(given).not_to_have_value("191.4")
    later = float(given.input_value())
    # a pixel of the chart is about a third of a second
    assert 3 < later - 191.4 < 12
    expect(user.figure_value("Given timetable")).not_to_have_text("+1.0%")
    user.page.keyboard.press("Control+z")
    expect(given).to_have_value("191.4")
    # the same by the keyboard
    fill(user, "Market: Given arrival", str(later))
    expect(user.figure_value("Given timetable")).not_to_have_text("+1.0%")


def drag_market(user: User, by_px: float) -> None:
    """Drag Market in the chart of supplements; before it is let go, energy and price answer."""
    place = user.page.locator(".rj-chart-supplements:visible")
    place.scroll_into_view_if_needed()
    user.rest()
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
    user.rest()


def test_the_timetable_is_compared_leg_by_leg_and_removed(user: User) -> None:
    table = user.page.locator("table:visible", has_text="given, kWh").first
    expect(table.get_by_role("row").last).to_contain_text("All legs")
    with user.page.expect_download() as download:
        user.page.get_by_text("Legs as CSV").click()
    assert download.value.suggested_filename == "legs.csv"
    user.page.get_by_role("button", name="Remove the given timetable").click()
    expect(user.page.locator(".figure:visible", has_text="Given timetable")).to_have_count(0)
    expect(field(user, "Market: Given arrival")).to_have_value("")
    expect(user.page.get_by_text("1 field changed")).to_be_hidden()


def test_an_old_link_with_a_fixed_arrival_still_opens(user: User, server: Server) -> None:
    stations = (
        '[{"number":0,"station":"Old+Town","position_m":1150,"dwell_s":25,"fixed":false,"arrival_s":0},'
        '{"number":1,"station":"Market","position_m":1950,"dwell_s":30,"fixed":true,"arrival_s":190}]'
    )
    user.page.goto(f"{server.url}?v=1&page=Line&preset=metro-10-stations&line.stations={stations}")
    user.page.locator("html.rj-started").wait_for()
    expect(field(user, "Market: Arrives after")).to_have_value("190.0")
    user.see_no_alert()
    expect(user.page.get_by_text("1 field changed")).to_be_visible()


def test_nothing_grave(user: User) -> None:
    assert_nothing_grave(user)
