"""What axe-core finds on every page, in light and in dark: nothing serious but what is listed here, with its reason."""

from collections.abc import Callable, Iterator

import pytest
from playwright.sync_api import Browser, expect

from browser.findings import grave_findings
from browser.server import Server
from browser.user import GROUND, GROUNDS, User
from railjoule.dashboard.look.tokens import THEMES
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


@pytest.fixture(scope="module", params=["light", "dark"])
def colours(request: pytest.FixtureRequest) -> str:
    """What the system asks for."""
    return str(request.param)


@pytest.fixture(scope="module")
def reader(colours: str, server: Server, chromium: Browser) -> Iterator[User]:
    """A user who turns all pages."""
    with User.at(chromium, server.drive_url, dark=colours == "dark") as user:
        yield user


@pytest.mark.parametrize("page", PAGES)
def test_nothing_grave_but_what_is_excused(reader: User, colours: str, page: str) -> None:
    reader.turn_to(page)
    if page in FILLED:
        FILLED[page](reader)
    assert grave_findings(reader.page, colours_alone=colours == "dark") == {}


def test_colours_follow_the_system_until_they_are_chosen(reader: User, colours: str) -> None:
    reader.turn_to("Drive")
    assert reader.page.evaluate(GROUND, GROUNDS[colours])
    axis = "[...Bokeh.documents[0].all_models].find((m) => m.type === 'LinearAxis').major_label_text_color"
    assert reader.page.evaluate(axis) == THEMES[colours]["ink3"]
    reader.page.get_by_role("button", name="Toggle theme").click()
    reader.page.wait_for_function(GROUND, arg=GROUNDS["dark" if colours == "light" else "light"])
