"""What axe-core finds on a page that is serious, but for what is listed here with its reason."""

from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Page

from browser.user import User

GRAVE = {"serious", "critical"}
STANDARDS = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa"]
EXCUSED: dict[str, str] = {}
"""Rules that a library makes impossible to keep, and why; it may only shrink."""


def assert_nothing_grave(user: User) -> None:
    """Check what is in sight by all rules."""
    user.settled()
    found = grave_findings(user.page)
    assert found == {}, found


def grave_findings(page: Page) -> dict[str, list[str]]:
    """Return what is serious or critical on a page and not excused, by rule."""
    # without `preload`, axe loads no style sheet again: each of hundreds of shadow roots links to some
    options = {"runOnly": {"type": "tag", "values": STANDARDS}, "resultTypes": ["violations"], "preload": False}
    found = Axe().run(page, options=options).response["violations"]
    grave = {
        violation["id"]: [node["html"][:200] for node in violation["nodes"]]
        for violation in found
        if violation["impact"] in GRAVE
    }
    return {rule: places for rule, places in grave.items() if rule not in EXCUSED}
