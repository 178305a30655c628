"""What axe-core finds on a page that is serious, but for what is listed here with its reason."""

import time

from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Page

from browser.user import GROUND, GROUNDS, User

GRAVE = {"serious", "critical"}
STANDARDS = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa"]
EXCUSED: dict[str, str] = {}
"""Rules that a library makes impossible to keep, and why; it may only shrink."""


OF_COLOURS = ["color-contrast", "link-in-text-block"]
"""Rules that may be kept in one set of colours and broken in another."""


SETTLED_WITHIN_S = 20


def assert_nothing_grave(user: User) -> None:
    """Hold what is in sight to all rules, then to those of colours once the system asks for the other colours."""
    user.rest()
    found = grave_findings(user.page)
    assert found == {}, found
    light = user.page.evaluate(GROUND, GROUNDS["light"])
    user.prefer("dark" if light else "light")
    deadline = time.monotonic() + SETTLED_WITHIN_S
    # the library's colours take some time to change, and no sign tells when they have
    while (found := grave_findings(user.page, colours_alone=True)) and time.monotonic() < deadline:
        user.rest()
    assert found == {}, found


def grave_findings(page: Page, colours_alone: bool = False) -> dict[str, list[str]]:
    """Return what is serious or critical on a page and not excused, by rule; perhaps by rules of colours alone."""
    rules = {"type": "rule", "values": OF_COLOURS} if colours_alone else {"type": "tag", "values": STANDARDS}
    options = {"runOnly": rules, "resultTypes": ["violations"]}
    found = Axe().run(page, options=options).response["violations"]
    grave = {
        violation["id"]: [node["html"][:200] for node in violation["nodes"]]
        for violation in found
        if violation["impact"] in GRAVE
    }
    return {rule: places for rule, places in grave.items() if rule not in EXCUSED}
