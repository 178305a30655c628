"""Each page is held to axe-core, and its colours are those that the system prefers."""

import re
from pathlib import Path

from playwright.sync_api import Browser

from browser.server import Server
from browser.user import GROUND, GROUNDS, User
from railjoule.dashboard.look.tokens import THEMES
from railjoule.dashboard.page_list import PAGES

PARTS = {"Start": "first_pages", "Learn": "first_pages", "Papers": "first_pages", "Import": "own_line"}
"""Pages that are tested together with others."""


def test_every_page_is_held_to_the_rules_of_axe() -> None:
    asked = {
        path.stem.removeprefix("test_"): len(re.findall(r"^    assert_nothing_grave\(", path.read_text(), re.MULTILINE))
        for path in Path(__file__).parent.glob("test_*.py")
    }
    files = [PARTS.get(page, page.lower().replace(" ", "_").replace("-", "_")) for page in PAGES]
    for file in set(files):
        assert asked[file] >= files.count(file), file


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
