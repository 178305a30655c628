"""The colours of a page are those that the system prefers, until a user chooses others."""

from playwright.sync_api import Browser

from browser.server import Server
from browser.user import GROUND, GROUNDS, User
from railjoule.dashboard.look.tokens import THEMES


def test_colours_follow_the_system_until_they_are_chosen(server: Server, chromium: Browser) -> None:
    axis = "[...Bokeh.documents[0].all_models].find((m) => m.type === 'LinearAxis').major_label_text_color"
    with User.at(chromium, server.drive_url, dark=True) as user:
        assert user.page.evaluate(GROUND, GROUNDS["dark"])
        assert user.page.evaluate(axis) == THEMES["dark"]["ink3"]
        user.prefer("light")
        user.page.wait_for_function(f"{axis} === '{THEMES['light']['ink3']}'")
        for chosen in ("dark", "light"):
            user.page.get_by_role("button", name="Toggle theme").click()
            user.page.wait_for_function(GROUND, arg=GROUNDS[chosen])
            user.page.wait_for_function(f"{axis} === '{THEMES[chosen]['ink3']}'")
