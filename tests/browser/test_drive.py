"""Drive, as a user works with it."""

import re
from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, BrowserContext, expect

from browser.findings import assert_nothing_grave
from browser.server import Server
from browser.user import User
from railjoule.dashboard.charts.chart import END_LABEL_SHARE


@pytest.fixture(scope="module")
def opened(server: Server, window: BrowserContext) -> Iterator[User]:
    """A page that all tests of this file share."""
    with User.on(window, server.drive_url) as someone:
        yield someone


@pytest.fixture
def user(opened: User) -> User:
    """A user before what a new page shows."""
    opened.begin_anew()
    return opened


SLOWER = 5
"""A processor this many times slower."""


def test_a_timetable_that_no_train_can_keep(user: User) -> None:
    figures = ("Energy from the supply", "Travel time", "Highest speed", "Recuperated")
    before = [user.number(figure) for figure in figures]
    user.type("Travel time, s", "120")
    alert = user.alert()
    assert alert.startswith("120.0 s is too short. The shortest possible run takes 133.6 s.")
    assert "Shown: the last valid run, 170.0 s." in alert
    assert [user.number(figure) for figure in figures] == before
    user.page.get_by_role("button", name="Use 133.7 s").click()
    user.see_no_alert()
    expect(user.figure_value("Travel time")).to_have_text("133.7s")


def test_pinning_a_run(user: User) -> None:
    user.page.get_by_role("button", name="Pin run").click()
    user.push("Travel time, s", 20)
    main = user.page.locator(".figure.main:visible")
    expect(main).to_contain_text("▼")
    expect(main).to_contain_text("against pinned 7.8")
    expect(user.page.locator(".rj-chart-difference:visible")).to_be_visible()
    user.push("Travel time, s", -20)
    user.page.get_by_role("button", name="Unpin").click()
    expect(user.page.locator(".rj-chart-difference")).to_be_hidden()


def test_a_strategy_that_refuses_says_why(user: User) -> None:
    user.page.get_by_label("Draw ENOC").check()
    reasons = user.page.locator(".result .reason").get_by_text("needs a line without limits", exact=True)
    expect(reasons.first).to_be_visible()


def test_over_time(user: User) -> None:
    speed = user.picture("speed")
    user.page.get_by_role("button", name="Time", exact=True).click()
    user.see_change("speed", speed)
    user.settled()
    assert x_range(user)[1] == pytest.approx(170 * (1 + END_LABEL_SHARE), rel=1e-6)


def x_range(user: User) -> tuple[float, float]:
    """Return the ends of the axis that all charts share, as the browser has them."""
    script = """() => {
      const figures = [...Bokeh.documents[0].all_models].filter((model) => model.type === "Figure");
      return [figures[0].x_range.start, figures[0].x_range.end];
    }"""
    start, end = user.page.evaluate(script)
    return start, end


def test_a_zoom_survives_a_slider(user: User) -> None:
    whole = x_range(user)
    box = user.page.locator(".rj-chart-speed:visible canvas").first.bounding_box()
    assert box is not None
    middle = box["y"] + box["height"] / 2
    user.page.mouse.move(box["x"] + 200, middle)
    user.page.mouse.down()
    user.page.mouse.move(box["x"] + 500, middle, steps=8)
    user.page.mouse.up()
    user.wait_until(lambda: x_range(user) != whole)
    zoomed = x_range(user)
    assert zoomed[1] - zoomed[0] < 0.6 * (whole[1] - whole[0])
    user.push("Travel time, s", 5)
    assert x_range(user) == zoomed
    user.page.mouse.dblclick(box["x"] + 300, middle)
    user.wait_until(lambda: x_range(user) == whole)
    assert x_range(user) == whole


def test_one_cursor_through_all_charts(user: User) -> None:
    box = user.page.locator(".rj-chart-speed:visible canvas").first.bounding_box()
    assert box is not None
    user.page.mouse.move(box["x"] + 400, box["y"] + 100)
    user.page.mouse.move(box["x"] + 420, box["y"] + 100)
    captions = [user.page.locator(f".rj-chart-{chart}:visible .rj-caption div").first for chart in ("speed", "energy")]
    expect(captions[1]).to_contain_text("kWh")
    speed, energy = (caption.inner_text() for caption in captions)
    assert "m: " in speed
    assert speed.endswith("km/h")
    assert energy.endswith("kWh")
    user.push("Travel time, s", 20)
    expect(captions[0]).not_to_have_text(speed)
    expect(captions[1]).not_to_have_text(energy)


def test_on_a_slow_machine_slider_number_and_run_stay_together(user: User) -> None:
    """Changes come faster than the page draws them, and it must not send old ones back."""
    machine = user.page.context.new_cdp_session(user.page)
    machine.send("Emulation.setCPUThrottlingRate", {"rate": SLOWER})
    for steps in (20, -12):
        user.push("Travel time, s", steps)
    machine.send("Emulation.setCPUThrottlingRate", {"rate": 1})
    expect(user.figure_value("Travel time")).to_have_text("174.0s")
    expect(user.page.get_by_label("Travel time, s, as a number", exact=True)).to_have_value("174.0")
    expect(user.slider("Travel time, s")).to_have_value("174")


def test_a_figure_out_of_sight_rests_until_it_comes_into_sight(chromium: Browser, server: Server) -> None:
    find = """(label) => {
      const name_of = ({html_attributes: a}) => a instanceof Map ? a.get("aria-label") : a["aria-label"];
      const found = Bokeh.index.query(({model}) => model.type === "Figure" && name_of(model) === label);
      const [{model, _render_count}] = [...found];
      return {rests: model.hold_render, painted: _render_count};
    }"""
    with User.at(chromium, server.drive_url, height=500) as user:

        def speed() -> dict[str, int]:
            return dict(user.page.evaluate(find, "Speed, km/h"))

        def power() -> dict[str, int]:
            return dict(user.page.evaluate(find, "Power from the supply, MW"))

        user.page.locator(".rj-chart-power:visible:not(.rj-undrawn)").wait_for(state="attached")
        user.wait_until(lambda: bool(power()["rests"]))
        assert power()["rests"]
        before = speed()["painted"], power()["painted"]
        user.push("Travel time, s", 2)
        user.wait_until(lambda: speed()["painted"] > before[0])
        assert speed()["painted"] > before[0]
        assert power()["painted"] == before[1]
        user.page.locator(".rj-chart-power:visible").scroll_into_view_if_needed()
        user.wait_until(lambda: not power()["rests"] and power()["painted"] > before[1])
        # it is in sight again, and follows
        after = power()["painted"]
        assert after > before[1]
        user.push("Travel time, s", 2)
        user.wait_until(lambda: power()["painted"] > after)
        assert power()["painted"] > after


def test_simpler_advice_by_mouse_from_start(user: User) -> None:
    user.turn_to("Start")
    user.page.get_by_role("button", name="Metro, profile II + I").first.click()
    user.see_drive()
    head = user.page.get_by_role("button", name="Simpler advice", exact=True)
    orders = user.page.get_by_role("list", name="Simpler advice", exact=True)
    expect(orders).to_have_count(0)
    head.click()
    expect(head).to_have_attribute("aria-expanded", "true")
    # the optimum has the limit of 50 km/h to brake for: with two changes the train may only hold one speed
    expect(orders.locator("li").first).to_be_visible()
    row = user.page.locator("tr.chosen:visible", has_text="+0.86")
    expect(row.locator("td").first).to_have_text("3")
    expect(user.page.get_by_text("More than 4 changes would gain less than 0.1 %.")).to_be_visible()
    expect(user.page.locator(".rj-chart-orders:visible canvas").first).to_be_visible()
    before, chart = orders.inner_text(), user.picture("orders")

    user.page.get_by_role("button", name="2", exact=True).click()
    expect(user.page.locator("tr.chosen:visible", has_text="+64.6")).to_be_visible()
    user.wait_until(lambda: orders.inner_text() != before)
    user.see_change("orders", chart)
    # by the keyboard, and by a click at the right end of the chart
    user.page.get_by_role("button", name="3", exact=True).press("Enter")
    expect(row).to_be_visible()
    box = user.page.locator(".rj-chart-orders:visible canvas").first.bounding_box()
    assert box is not None
    user.page.mouse.click(box["x"] + box["width"] - 40, box["y"] + box["height"] / 2)
    expect(user.page.locator("tr.chosen:visible td", has_text="+0.09")).to_be_visible()

    user.page.get_by_role("button", name="Print the simpler advice").click()
    sheet = user.page.frame_locator("#rj-print")
    expect(sheet.locator("h1")).to_have_text("Metro, profile II + I: 170.0 s, at most 4 changes of regime")
    expect(sheet.locator("h2")).to_have_text(["Timetable", "Orders", "Speed limits"])
    expect(sheet.locator("td", has_text="50 km/h")).to_have_count(1)

    again = user.page.get_by_role("button", name="Compute again", exact=True)
    user.type("Travel time, s", "180")
    expect(user.page.get_by_text("the figures from before")).to_be_visible()
    again.click()
    # computing takes both the button and the sentence away, the result brings its own
    expect(user.page.get_by_text(re.compile(r"More than \d changes"))).to_be_visible()
    expect(again).to_be_hidden()
    user.page.get_by_role("button", name="Print the simpler advice").click()
    expect(sheet.locator("h1")).to_contain_text("180.0 s")
    user.page.get_by_role("button", name="Pin these orders", exact=True).click()
    expect(user.page.get_by_text("Pinned: Simpler advice, 180.0 s").first).to_be_visible()
    expect(user.page.locator(".rj-chart-difference:visible canvas").first).to_be_visible()
    assert_nothing_grave(user)
    head.click()
    expect(orders).to_be_hidden()
