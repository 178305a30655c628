"""What axe-core finds on every page, in light and in dark: nothing serious but what is listed here, with its reason."""

from collections.abc import Callable, Iterator

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Browser, expect

from browser.server import Server
from browser.user import User
from railjoule.dashboard.models.workbench import PAGES

GRAVE = {"serious", "critical"}
STANDARDS = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa"]
EXCUSED: dict[str, str] = {}
"""Rules that a library makes impossible to keep, and why; it may only shrink."""


def open_ten_stations(user: User) -> None:
    """Give Line a line with stations."""
    user.page.get_by_role("button", name="Open Metro, ten stations").click()
    expect(user.figure_value("Energy of the whole line")).not_to_be_empty()


def compare_ftorek(user: User) -> None:
    """Give Papers a paper's tables."""
    user.page.get_by_role("button", name="Compute Ftorek").click()
    expect(user.page.get_by_text("Corrections")).to_be_visible()


FILLED: dict[str, Callable[[User], None]] = {"Line": open_ten_stations, "Papers": compare_ftorek}
"""Pages that show little at first, and what fills them."""


@pytest.fixture(scope="module", params=[False, True], ids=["light", "dark"])
def reader(request: pytest.FixtureRequest, server: Server, chromium: Browser) -> Iterator[User]:
    """A user whose system asks for light or for dark colours, and who turns all pages."""
    with User.at(chromium, server.drive_url, dark=request.param) as user:
        yield user


@pytest.mark.parametrize("page", PAGES)
def test_nothing_grave_but_what_is_excused(reader: User, page: str) -> None:
    reader.turn_to(page)
    if page in FILLED:
        FILLED[page](reader)
    options = {"runOnly": {"type": "tag", "values": STANDARDS}, "resultTypes": ["violations"]}
    found = Axe().run(reader.page, options=options).response["violations"]
    grave = {
        violation["id"]: [node["html"][:200] for node in violation["nodes"]]
        for violation in found
        if violation["impact"] in GRAVE
    }
    assert {rule: places for rule, places in grave.items() if rule not in EXCUSED} == {}
