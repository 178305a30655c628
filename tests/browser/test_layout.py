"""Narrow and wide: nothing is cut off, no page scrolls sideways, no hole gapes within a page.

Colours hardly change sizes; the width between is looked at in both on the walks of `test_from_page_to_page`.
"""

from typing import Any

import pytest
from playwright.sync_api import BrowserContext

from browser.layout import layout_faults
from browser.server import Server
from browser.user import User
from railjoule.dashboard.page_list import PAGES


@pytest.mark.nightly
@pytest.mark.parametrize("width", [390, 1920])
def test_nothing_is_cut_off(window: BrowserContext, server: Server, width: int) -> None:
    faults: dict[str, Any] = {}
    with User.on(window, server.drive_url + "&preset=ftorek-300s", size=(width, 1000)) as user:
        for page in PAGES:
            user.turn_to(page)
            faults |= layout_faults(user, page)
    assert faults == {}
