"""The first second of a page: its colours are right from the first paint, and what is pressed answers at once."""

from typing import Literal

import pytest
from playwright.sync_api import Browser, expect

from browser.server import Server, serving
from browser.user import GROUND, GROUNDS, User, open_page
from railjoule.dashboard.look.tokens import THEMES

LINK = "?v=1&page=Drive&load_percent=33"
"""Of no other test, so that the frontier is computed."""
LEAST_CONTRAST = 3.0
"""Of words on the page's ground, as WCAG has it for large ones: dark words on a dark ground have less than 2."""
WATCH = """
window.seen = {grounds: [], contrasts: []};
const light = (colour) => {
  const [r, g, b] = colour.match(/[.\\d]+/g).slice(0, 3)
    .map((part) => part / 255).map((part) => part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4);
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
};
const look = () => {
  requestAnimationFrame(look);
  const sketch = document.getElementById("rj-first");
  if (!document.body || !(sketch || window.railjoule)) { return; }
  const ground = getComputedStyle(document.body).backgroundColor;
  if (!window.seen.grounds.includes(ground)) { window.seen.grounds.push(ground); }
  // a sketch lies over all that is not ready
  if (sketch || !document.documentElement.classList.contains("rj-started")) { return; }
  const below = light(ground);
  for (const one of railjoule.deep("label, .text-button, input.text, [role=tab]")) {
    if (!one.checkVisibility()) { continue; }
    const above = light(getComputedStyle(one).color);
    const ratio = (Math.max(above, below) + 0.05) / (Math.min(above, below) + 0.05);
    window.seen.contrasts.push([ratio, one.textContent || one.value]);
  }
};
requestAnimationFrame(look);
"""
WITHOUT_KEEPING = """() => {
  const [axis] = [...Bokeh.documents[0].all_models].filter((model) => model.type === "LinearAxis");
  window.worn = [];
  axis.connect(axis.properties.axis_line_color.change, () => window.worn.push(axis.axis_line_color));
  Bokeh.documents[0].roots()[0].data._custom_theme = [];
}"""
"""Lets the library lay its colours over figures, and notes those that an axis wears."""
AXIS = "[...Bokeh.documents[0].all_models].find((m) => m.type === 'LinearAxis').major_label_text_color"
MOST_FRAMES = 4
"""A press is answered within so many pictures, as a busy machine makes fewer of them a second."""
COUNT = """
(selector) => addEventListener("click", () => {
  let frames = 0;
  const look = () => {
    frames += 1;
    if (railjoule.deep(selector).length) { window.answered_after = frames; } else { requestAnimationFrame(look); }
  };
  window.answered_after = null;
  requestAnimationFrame(look);
}, {capture: true, once: true})
"""
QUIET_S, MOST_ERRORS = 10, 5
"""The tries after 1, 3 and 7 s leave a line each, and the socket that closes one or two."""


def test_a_dark_page_is_dark_from_its_first_paint_until_other_colours_are_chosen(
    server: Server, chromium: Browser
) -> None:
    with chromium.new_context(color_scheme="dark", viewport={"width": 1280, "height": 900}) as context:
        context.add_init_script(WATCH)
        # the second time the server knows from the first which colours are asked for
        for opening in (1, 2):
            with User.on(context, server.drive_url) as user:
                seen = user.page.evaluate("window.seen")
                assert seen["grounds"] == [GROUNDS["dark"]]
                assert len(seen["contrasts"]) > 0
                assert min(seen["contrasts"])[0] >= LEAST_CONTRAST, min(seen["contrasts"])
                assert user.page.evaluate(AXIS) == THEMES["dark"]["ink3"]
                if opening == 2:
                    see_colours_follow(user)


def see_colours_follow(user: User) -> None:
    """Let the system change its colours, then choose others; figures wear those of the page."""
    user.prefer("light")
    user.page.wait_for_function(f"{AXIS} === '{THEMES['light']['ink3']}'")
    for chosen in ("dark", "light"):
        user.page.get_by_role("button", name="Toggle theme").click()
        user.page.wait_for_function(GROUND, arg=GROUNDS[chosen])
        user.page.wait_for_function(f"{AXIS} === '{THEMES[chosen]['ink3']}'")
    # `library_workarounds.keep_colours`: without it the library still lays its own colours over those of figures
    user.page.evaluate(WITHOUT_KEEPING)
    user.page.get_by_role("button", name="Toggle theme").click()
    own = [colour for theme in THEMES.values() for colour in theme.values()]
    user.page.wait_for_function("own => window.worn.some((colour) => !own.includes(colour))", arg=own)


@pytest.mark.parametrize("colours", ["light", "dark"])
def test_the_ground_is_there_before_anything_in_the_body_is_read(
    server: Server, chromium: Browser, colours: Literal["light", "dark"]
) -> None:
    with chromium.new_context(color_scheme=colours) as context:
        page = context.new_page()
        whole = page.request.get(server.drive_url).text()
        head, _ = whole.split("<body>")
        page.route(server.drive_url, lambda route: route.fulfill(content_type="text/html", body=f"{head}<body>"))
        page.goto(server.drive_url)
        assert page.evaluate("getComputedStyle(document.body).backgroundColor") == GROUNDS[colours]


def test_a_press_is_answered_at_once(user: User) -> None:
    user.page.evaluate(COUNT, ".working:not([hidden])")
    open_page(user, "Trade-off")
    user.page.wait_for_function(f"window.answered_after <= {MOST_FRAMES} && window.answered_after > 0")
    expect(user.page.locator(".rj-chart-frontier:visible canvas").first).to_be_visible()


@pytest.mark.nightly
def test_a_lost_server_leaves_few_lines_in_the_console(chromium: Browser) -> None:
    with chromium.new_context() as context:
        user = User(context.new_page(), "")
        with serving("-m", "railjoule.dashboard", "serve") as own:
            user.url = own.drive_url
            user.load()
        user.errors.clear()
        expect(user.page.get_by_text("The connection to the server is lost")).to_be_visible()
        user.page.wait_for_timeout(1000 * QUIET_S)
        assert len(user.errors) <= MOST_ERRORS, user.errors
