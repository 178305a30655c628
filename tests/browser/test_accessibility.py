"""What axe-core finds on every page, in light and in dark: nothing serious but what is listed here, with its reason."""

from collections.abc import Callable, Iterator

import pytest
from playwright.sync_api import Browser, expect

from browser.findings import grave_findings
from browser.server import Server
from browser.user import User
from railjoule.dashboard.models.workbench import PAGES


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
    assert grave_findings(reader.page) == {}
