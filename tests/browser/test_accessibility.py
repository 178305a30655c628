"""The colours of a page are those that the system prefers, until a user chooses others."""

from playwright.sync_api import BrowserContext

from browser.server import Server
from browser.user import GROUND, GROUNDS, User
from railjoule.dashboard.look.tokens import THEMES

WITHOUT_KEEPING = """() => {
  const [axis] = [...Bokeh.documents[0].all_models].filter((model) => model.type === "LinearAxis");
  window.worn = [];
  axis.connect(axis.properties.axis_line_color.change, () => window.worn.push(axis.axis_line_color));
  Bokeh.documents[0].roots()[0].data._custom_theme = [];
}"""
"""Lets the library lay its colours over figures, and notes those that an axis wears."""


def test_colours_follow_the_system_until_they_are_chosen(server: Server, window: BrowserContext) -> None:
    axis = "[...Bokeh.documents[0].all_models].find((m) => m.type === 'LinearAxis').major_label_text_color"
    with User.on(window, server.drive_url, dark=True) as user:
        assert user.page.evaluate(GROUND, GROUNDS["dark"])
        assert user.page.evaluate(axis) == THEMES["dark"]["ink3"]
        user.prefer("light")
        user.page.wait_for_function(f"{axis} === '{THEMES['light']['ink3']}'")
        for chosen in ("dark", "light"):
            user.page.get_by_role("button", name="Toggle theme").click()
            user.page.wait_for_function(GROUND, arg=GROUNDS[chosen])
            user.page.wait_for_function(f"{axis} === '{THEMES[chosen]['ink3']}'")
        # `library_workarounds.keep_colours`: without it the library still lays its own colours over those of figures
        user.page.evaluate(WITHOUT_KEEPING)
        user.page.get_by_role("button", name="Toggle theme").click()
        own = [colour for theme in THEMES.values() for colour in theme.values()]
        user.page.wait_for_function("own => window.worn.some((colour) => !own.includes(colour))", arg=own)
