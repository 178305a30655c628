"""What axe-core finds on every page, in light and in dark: nothing serious but what is listed here, with its reason."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser

from browser.findings import grave_findings
from browser.server import Server
from browser.user import User
from railjoule.dashboard.models.workbench import PAGES


@pytest.fixture(scope="module", params=[False, True], ids=["light", "dark"])
def reader(request: pytest.FixtureRequest, server: Server, chromium: Browser) -> Iterator[User]:
    """A user whose system asks for light or for dark colours, and who turns all pages."""
    with User.at(chromium, server.url, dark=request.param) as user:
        yield user


@pytest.mark.parametrize("page", PAGES)
def test_nothing_grave_but_what_is_excused(reader: User, page: str) -> None:
    reader.turn_to(page)
    assert grave_findings(reader.page) == {}
