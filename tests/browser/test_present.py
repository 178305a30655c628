"""The presentation: one figure on the whole screen, live, by mouse, keys and touch; and the page as it was after it."""

import re
from typing import Any

from playwright.sync_api import Browser, Locator, Page, expect

from browser.findings import assert_nothing_grave
from browser.server import Server
from browser.user import User, open_page

# what is on the screen of the figure of a chart, and how finely it is painted; `frame` is where it draws lines
FIGURE = """(name) => {
  const place = railjoule.deep(`.rj-chart-${name}`).find((one) => one.checkVisibility());
  const within = (node) => node && (node === place || within(node.parentNode ?? node.host));
  const [view] = [...Bokeh.index.query((one) => one.model.type === "Figure" && within(one.el))];
  const {canvas} = view.canvas_view.primary, {left, top, width, height} = canvas.getBoundingClientRect();
  const [{left: x, width: w}, {start, end}] = [view.frame.bbox, view.model.x_range];
  return {
    left, top, width, height, painted: [canvas.width, canvas.height], factor: width / view.bbox.width,
    frame: {left: left + x * width / view.bbox.width, width: w * width / view.bbox.width}, start, end,
    axis: view.model.below[0].visible, model_height: view.model.height, style: view.el.style.cssText,
  };
}"""
PLACE = """(name) => {
  const place = railjoule.deep(`.rj-chart-${name}`).find((one) => one.checkVisibility());
  const {left, top, width, height} = place.getBoundingClientRect();
  return [place.style.cssText, left, top, width, height, railjoule.deep(".main-content")[0].scrollTop];
}"""
SWIPE_PX, SWIPE_STEPS = 160, 5


def wall(page: Page) -> Locator:
    """Return the presentation."""
    return page.get_by_role("dialog", name="Presentation")


def number(page: Page, label: str) -> Locator:
    """Return a number beneath the figure that is presented."""
    return wall(page).locator(".numbers > div", has_text=label).locator(".value")


def see_figure(page: Page, which: int) -> None:
    """Wait until this figure is presented."""
    expect(wall(page).get_by_role("status")).to_have_text(re.compile(f"^{which} of "))


def figure(page: Page, name: str) -> dict[str, Any]:
    """Return where the figure of a chart is, and how it is painted."""
    found: dict[str, Any] = page.evaluate(FIGURE, name)
    return found


def swipe(page: Page, pixels: int) -> None:
    """Draw a finger over the figure, to the right or to the left."""
    session = page.context.new_cdp_session(page)
    x, y = 200, 300

    def touch(kind: str, places: list[dict[str, float]]) -> None:
        session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": places})

    touch("touchStart", [{"x": x, "y": y}])
    for k in range(1, SWIPE_STEPS + 1):
        touch("touchMove", [{"x": x + pixels * k / SWIPE_STEPS, "y": y + k}])
    touch("touchEnd", [])


def test_from_the_front_page_to_the_wall_and_back(server: Server, chromium: Browser) -> None:
    with User.at(chromium, server.url, 1280, 800, on_drive=False) as user:
        page = user.page
        start = page.get_by_role("button", name="Present the figures (F)")
        # the front page has cards, and no figures of a run
        expect(start).to_be_hidden()
        open_page(user, "Drive")
        user.see_drive()
        page.locator(".rj-chart-speed:visible").hover()
        page.mouse.wheel(0, 120)
        user.rest()
        place, drawn = page.evaluate(PLACE, "speed"), figure(page, "speed")
        start.click()

        expect(wall(page)).to_be_focused()
        see_figure(page, 1)
        expect(wall(page).locator(".caption")).to_have_text("Speed, km/h")
        for label in ("Energy from the supply", "Travel time", "Above the optimum"):
            expect(number(page, label)).to_have_text(user.number(label).replace("\n", ""))
        expect(wall(page).get_by_text("✓ proven")).to_be_visible()
        page.wait_for_function(f"name => ({FIGURE})(name).height > 600", arg="speed")
        shown = figure(page, "speed")
        # the whole width but for the margins, words 1280 / 760 times as large, painted as finely as the screen
        assert shown["width"] > 1240
        assert 1.6 < shown["factor"] < 1.75
        assert abs(shown["painted"][0] - shown["width"]) <= 1
        assert shown["axis"], "it stands alone"
        assert not drawn["axis"]

        # the mouse meets what it points at: the middle of the frame is the middle of the axis
        frame = shown["frame"]
        page.mouse.move(frame["left"] + frame["width"] / 2, shown["top"] + 200)
        middle = f"{(shown['start'] + shown['end']) / 2:,.0f}".replace(",", "\u202f")
        expect(wall(page).locator(".caption")).to_contain_text(f"{middle} m: ")

        walk_by_keys(page)
        see_live(user)
        for _ in range(6):
            page.keyboard.press("Tab")
            assert page.evaluate("document.activeElement.closest('.rj-wall') !== null")
        assert_nothing_grave(user)

        page.keyboard.press("Home")
        page.keyboard.press("Escape")
        expect(wall(page)).to_have_count(0)
        expect(start).to_be_focused()
        page.mouse.move(5, 5)
        user.rest()
        assert page.evaluate(PLACE, "speed") == place
        after = figure(page, "speed")
        assert {name: after[name] for name in ("model_height", "painted", "axis", "style")} == {
            name: drawn[name] for name in ("model_height", "painted", "axis", "style")
        }


def walk_by_keys(page: Page) -> None:
    """Go on and back by all keys."""
    told = wall(page).get_by_role("status").text_content() or ""
    last = int(told.partition(" of ")[2].partition(":")[0])
    assert last >= 7
    for key, which in (
        ("PageDown", 2),
        (" ", 3),
        ("ArrowRight", 4),
        ("ArrowLeft", 3),
        ("PageUp", 2),
        ("End", last),
        ("ArrowRight", last),
        ("Home", 1),
        ("ArrowLeft", 1),
    ):
        page.keyboard.press(key)
        see_figure(page, which)
    # what opens pages elsewhere does nothing here
    page.keyboard.press("3")
    expect(wall(page)).to_be_visible()


def see_live(user: User) -> None:
    """Move the slider beneath the figure: figure, numbers and the page itself follow."""
    page = user.page
    before, energy = user.picture("speed"), number(page, "Energy from the supply").inner_text()
    slider = wall(page).get_by_role("slider", name="Travel time, s")
    slider.focus()
    for _ in range(10):
        page.keyboard.press("ArrowRight")
    # 170 s, and ten steps of half a second
    expect(number(page, "Travel time")).to_have_text("175.0s")
    expect(number(page, "Energy from the supply")).not_to_have_text(energy)
    user.see_change("speed", before)
    expect(page.get_by_role("textbox", name="Travel time, s, as a number", exact=True)).to_have_value("175.0")
    see_figure(page, 1)


def test_by_key_and_mouse_alone(user: User) -> None:
    page = user.page
    page.keyboard.press("f")
    see_figure(page, 1)
    wall(page).get_by_role("button", name="Next figure").click()
    see_figure(page, 2)
    # the space of a clicker goes on, whatever was pressed last
    expect(wall(page)).to_be_focused()
    page.keyboard.press(" ")
    see_figure(page, 3)
    wall(page).get_by_role("button", name="Previous figure").click()
    see_figure(page, 2)
    wall(page).get_by_role("button", name="End the presentation").click()
    expect(wall(page)).to_have_count(0)


def test_by_touch_in_the_dark_on_a_phone(server: Server, chromium: Browser) -> None:
    context = chromium.new_context(
        viewport={"width": 390, "height": 844}, color_scheme="dark", has_touch=True, is_mobile=True
    )
    with User.on(context, server.drive_url) as user:
        page = user.page
        page.get_by_role("button", name="Present the figures (F)").tap()
        see_figure(page, 1)
        box = wall(page).bounding_box()
        assert box is not None
        assert (box["width"], box["height"]) == (390, 844)
        assert page.evaluate("document.documentElement.scrollWidth") == 390
        expect(number(page, "Travel time")).to_be_in_viewport()
        # the sidebar that has it is closed here
        expect(wall(page).get_by_role("slider")).to_have_count(0)
        swipe(page, -SWIPE_PX)
        see_figure(page, 2)
        swipe(page, SWIPE_PX)
        see_figure(page, 1)
        # no zoom of the figure
        shown = figure(page, "speed")
        assert shown["start"] == 0
        wall(page).get_by_role("button", name="Next figure").tap()
        see_figure(page, 2)
        wall(page).get_by_role("button", name="End the presentation").tap()
        expect(wall(page)).to_have_count(0)
    context.close()
